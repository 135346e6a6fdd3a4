"""Compares what a program says of its commands in --help, in its manual page and in docs/commands.md:
check_help.py PROGRAM ROOT

  man       a command, option or kind of value is in --help and not in `PROGRAM completion man`, or the other way round
  synopsis  the indented lines of docs/commands.md that begin a command's section have other options than its --help, or
            other words to choose from
  global    the table of global options has other options than `PROGRAM --help`
  word      a document names a command or an option that --help does not know
Prints one line a difference and exits with 1 when there is any.
"""
import pathlib
import re
import subprocess
import sys

OPTION = re.compile(r"(?<![\w-])--?[a-z][\w-]*")
CODE = re.compile(r"`([^`]+)`")
INDENT = " " * 30
CHOICE = re.compile(r"[a-z0-9]+(?:\|[a-z0-9]+)+")


class Option:
    """An option's or positional's names, and its kind of value as people read it."""

    def __init__(self, head):
        names, _, value = head.partition(" ")
        self.names = frozenset(name.strip() for name in names.split(","))
        self.value = value.removesuffix(" REQUIRED").removesuffix(" ...").partition("=")[0]

    def __str__(self):
        return ",".join(sorted(self.names, key=len)) + (" " + self.value if self.value else "")


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def help_of(program, path):
    """{command: [options]} of a command and all below it; positionals are options without dashes."""
    section, options, inner = "", [], []
    lines = output_of(program, *path, "--help").splitlines()
    for line, next_line in zip(lines, [*lines[1:], ""]):
        if re.fullmatch(r"\w+:", line):
            section = line
        elif not line:
            section = ""
        elif re.match(r"  \S", line):
            # A head that is too long for its column has the description on the next line.
            head = (line if next_line.startswith(INDENT) else line[: len(INDENT)]).strip()
            if section == "Subcommands:":
                inner.append(head)
            elif section:
                options.append(Option(head))
    commands = {" ".join(path): options}
    for name in inner:
        commands.update(help_of(program, [*path, name]))
    return commands


def manual_of(program):
    """The same from the manual page."""
    commands, command, head = {"": []}, "", False
    for line in output_of(program, "completion", "man").replace("\\-", "-").replace("\\e", "\\").splitlines():
        if line.startswith(".SS hotblade "):
            command = line.removeprefix(".SS hotblade ")
            commands[command] = []
        elif head and line.startswith(".B "):
            commands[command].append(Option(line.removeprefix(".B ").replace(", ", ",")))
        head = line == ".TP"
    return commands


def compare_manual(known, manual):
    for command in sorted(known.keys() ^ manual.keys()):
        yield f"man: `{command}` is missing in {'--help' if command in manual else 'the manual page'}"
    for command in known.keys() & manual.keys():
        said = {str(option).partition(" ")[0] if positional(option) else str(option) for option in known[command]}
        printed = {str(option) for option in manual[command]}
        for option in sorted(said ^ printed):
            yield f"man: `{command}` {option} is missing in {'--help' if option in printed else 'the manual page'}"


def positional(option):
    return not any(name.startswith("-") for name in option.names)


def sections(text):
    """The sections of docs/commands.md by heading."""
    parts = re.split(r"^## (.*)\n", text, flags=re.M)
    return dict(zip(parts[1::2], parts[2::2]))


def alternatives(words, known):
    """The commands that the first words of a line name, `curve fit|arcs` being two, and what is left of the words."""
    commands = [""]
    while words:
        longer = [f"{command} {word}".strip() for command in commands for word in words[0].split("|")]
        if not all(command in known for command in longer):
            break
        commands, words = longer, words[1:]
    return commands, words


def synopsis(section, known):
    """{command: the words after it} of a section's indented lines."""
    lines = {}
    for line in re.findall(r"^    hotblade (.*)$", section, re.M):
        commands, words = alternatives(line.split(), known)
        for command in commands:
            lines.setdefault(command, []).extend(words)
    return lines


def compare_synopsis(known, parts):
    for command, options in known.items():
        has_inner = any(other.startswith(command + " ") for other in known)
        if not command or has_inner:
            continue
        section = parts.get("hotblade " + command.split()[0])
        words = synopsis(section or "", known).get(command)
        if words is None:
            yield f"synopsis: `{command}` has none in docs/commands.md"
            continue
        text = " ".join(words)
        named = set(OPTION.findall(text))
        for option in options:
            if positional(option) or "--help" in option.names:
                continue
            if not option.names & named:
                yield f"synopsis: `{command}` {option} is missing in docs/commands.md"
            elif CHOICE.fullmatch(option.value) and option.value not in text:
                yield f"synopsis: `{command}` {option} has other words in docs/commands.md"
        names = {name for option in options for name in option.names}
        for name in sorted(named - names):
            yield f"synopsis: `{command}` {name} is missing in --help"


def compare_global(known, section):
    said = {name for option in known[""] for name in option.names}
    rows = "\n".join(line.split(" | ")[0] for line in section.splitlines() if line.startswith("| `"))
    documented = set(OPTION.findall(rows))
    for name in sorted(said ^ documented):
        yield f"global: {name} is missing in {'--help' if name in documented else 'docs/commands.md'}"


def names_below(command, known):
    """All options that go with a command: its own, those of the commands below it, and the global ones."""
    return {
        name
        for other, options in known.items()
        if other in ("", command) or other.startswith(command + " ") or command == ""
        for option in options
        for name in option.names
    }


def unknown_words(file, known, heading_decides):
    """Commands and options in a document's code that no --help knows."""
    section = ""
    for number, line in enumerate(file.read_text().splitlines(), 1):
        if line.startswith("## hotblade "):
            section = line.removeprefix("## hotblade ").strip()
        elif line.startswith("## "):
            section = ""
        codes = [line.strip()] if line.startswith("    ") else CODE.findall(line)
        for code in codes:
            words = re.sub(r"^(build/release/)?hotblade ", "", code).split("#")[0].split()
            called = code != " ".join(words) and "hotblade " in code
            commands, rest = alternatives(words, known)
            if called and not commands[0] and rest and re.fullmatch(r"[a-z]+", rest[0]):
                yield f"word: {file.name}:{number}: `{rest[0]}` is no command"
            if commands == [""]:
                if not called and not (heading_decides and section and words and words[0].startswith(("-", "["))):
                    continue
                commands = [section if not called else ""]
            allowed = set.union(*(names_below(command, known) for command in commands))
            for name in OPTION.findall(" ".join(rest)):
                if name not in allowed:
                    yield f"word: {file.name}:{number}: {name} is no option of `{' or '.join(commands)}`"


def main():
    program, root = sys.argv[1], pathlib.Path(sys.argv[2])
    page = root / "docs/commands.md"
    known, parts = help_of(program, []), sections(page.read_text())
    found = [*compare_manual(known, manual_of(program)), *compare_synopsis(known, parts)]
    found += compare_global(known, parts.get("Global options", ""))
    for file in [root / "README.md", *sorted((root / "docs").glob("*.md")), *sorted((root / "samples").glob("*.md"))]:
        if file.is_file():
            found += unknown_words(file, known, file == page)
    print("".join(line + "\n" for line in found), end="")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
