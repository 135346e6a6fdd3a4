"""What goes wrong, by name; exit_code is that of the commands (docs/commands.md)."""


class Error(Exception):
    """Base of all; of itself a mistake of the library."""
    exit_code = 1


class UsageError(Error, ValueError):
    """An argument or a setting."""
    exit_code = 2


class InputError(Error, ValueError):
    """A mesh or a program that cannot be used; `file` and `line` where they are known."""
    exit_code = 3

    def __init__(self, message="", file=None, line=None):
        super().__init__(message)
        self.file, self.line = file, line


class NotCuttable(Error):
    """The plan would be over its tolerance or over a limit."""
    exit_code = 4


class OverTolerance(Error):
    """A cut was measured to be over the tolerance."""
    exit_code = 5


class ControllerError(Error):
    """The controller refused or faulted, or the link was lost."""
    exit_code = 6


class FileError(Error, OSError):
    """A file is missing, unreadable, unwritable or already there."""
    exit_code = 7


# Hints of the commands that name their options, and what stands for them here.
HINTS = (("use --force to overwrite", "say force=True to overwrite"),
         ("plan it with --cell", "plan it with cell="),
         ("check --units", "check units="),
         ("read that with --up y", "read that with up=\"y\""),
         ("or say with --format what it is", "or say with format= what it is"),
         ("say which with --format or design.format", "say which with format= or design.format"),
         ("ask again with --partial", "ask again with partial=True"))


def raised(name, message, file=None, line=None):
    """The error of this name, in words of Python."""
    for of_command, here in HINTS:
        message = message.replace(of_command, here)
    kind = globals()[name]
    return kind(message, file, line) if kind is InputError else kind(message)
