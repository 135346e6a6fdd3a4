#include "pipeline/cli/manual.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <sstream>

#include "pipeline/cli/help.hpp"
#include "pipeline/program/version.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

namespace {

// Backslashes and leading dots or quotes mean something to roff; a plain hyphen would become a typographic
// one.
std::string roff(const std::string& text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    line_start = c == '\n';
  }
  return out;
}

// Positionals first, as they are written on the command line.
std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  std::vector<const CLI::Option*> all;
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) all.push_back(option);
  }
  std::stable_partition(all.begin(), all.end(),
                        [](const CLI::Option* o) { return o->nonpositional() == false; });
  return all;
}

std::string option_head(const CLI::Option& option) {
  std::string head = option.nonpositional() ? option.get_name(false, true) : option.get_name(true);
  std::string::size_type comma = 0;
  while ((comma = head.find(',', comma)) != std::string::npos) {
    head.replace(comma, 1, ", ");
    comma += 2;
  }
  if (option.get_items_expected_max() > 0 && option.nonpositional() && option.get_type_size_max() > 0) {
    head += " " + value_words(option);
  }
  return head;
}

void append_options(std::string& page, const CLI::App& app) {
  for (const CLI::Option* option : options_of(app)) {
    page += fmt::format(".TP\n.B {}\n{}\n", roff(option_head(*option)), roff(option->get_description()));
  }
}

void append_footer(std::string& page, const CLI::App& app) {
  if (!app.get_footer().empty()) page += ".PP\n.nf\n" + roff(app.get_footer()) + "\n.fi\n";
}

void append_command(std::string& page, const CLI::App& command, const std::string& path) {
  page += fmt::format(".SS {}\n{}\n", roff(path), roff(command.get_description()));
  append_options(page, command);
  append_footer(page, command);
  for (const CLI::App* inner : command.get_subcommands({}))
    append_command(page, *inner, path + " " + inner->get_name());
}

// Words a choice option's type name offers: "a|b|c"; nothing for MM, FILE and the like.
std::string choices_of(const CLI::Option& option) {
  std::string words = value_words(option);
  const bool choice = words.find('|') != std::string::npos &&
                      words.find_first_of(" []") == std::string::npos &&
                      std::none_of(words.begin(), words.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
  if (!choice) return "";
  std::replace(words.begin(), words.end(), '|', ' ');
  return words;
}

std::vector<std::string> flags_of(const CLI::App& app) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : options_of(app)) {
    for (const std::string& name : option->get_snames()) flags.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  }
  return flags;
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

// The settings as they begin on the command line: "design.units=".
std::vector<std::string> setting_names() {
  std::vector<std::string> names;
  for (const SettingInfo& info : describe_settings()) names.push_back(info.key + "=");
  return names;
}

// In single quotes of fish, which know two escapes.
std::string fish_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c == '\n' ? ' ' : c;
  }
  return quoted + "'";
}

// `complete` lines for the options of one command; `condition` says when they go.
void append_fish_options(std::string& script, const CLI::App& command, const std::string& condition) {
  for (const CLI::Option* option : options_of(command)) {
    if (!option->nonpositional()) continue;
    script += "complete -c hotblade" + condition;
    for (const std::string& name : option->get_snames()) script += " -s " + name;
    for (const std::string& name : option->get_lnames()) script += " -l " + name;
    if (option->get_items_expected_max() > 0 && option->get_type_size_max() > 0) script += " -r";
    std::string values = choices_of(*option);
    if (option->check_lname("set")) values = joined(setting_names());
    if (!values.empty()) script += " -f -a " + fish_quoted(values);
    script += " -d " + fish_quoted(option->get_description()) + "\n";
  }
}

// `case` branches for the options of one command that take words of a choice.
std::string choice_cases(const CLI::App& command) {
  std::string script;
  for (const CLI::Option* option : options_of(command)) {
    const std::string choices = choices_of(*option);
    std::vector<std::string> names;
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    if (!choices.empty() && !names.empty())
      script += fmt::format("        {}) values='{}' ;;\n", fmt::join(names, "|"), choices);
  }
  return script;
}

// `case` branches for one command: what follows it, and what follows its options.
void append_case(std::string& script, const CLI::App& command, const std::string& path,
                 const std::string& global) {
  std::vector<std::string> words = flags_of(command);
  for (const CLI::App* inner : command.get_subcommands({})) words.push_back(inner->get_name());
  script += fmt::format("    '{}')\n      words='{} {}'\n      case \"$previous\" in\n", path, joined(words),
                        global);
  script += choice_cases(command);
  for (const CLI::Option* option : options_of(command)) {
    if (option->check_lname("set")) script += "        --set) values=\"$settings\" ;;\n";
  }
  script += "      esac ;;\n";
  for (const CLI::App* inner : command.get_subcommands({})) {
    append_case(script, *inner, path + " " + inner->get_name(), global);
  }
}

}  // namespace

std::string manual_page(const CLI::App& app) {
  std::string page =
      fmt::format(".TH HOTBLADE 1 \"\" \"hotblade {}\" \"User Commands\"\n.SH NAME\nhotblade \\- {}\n",
                  version(), "plan hot\\-blade cutting of formwork");
  page += ".SH SYNOPSIS\n.B hotblade\n.I command\n[options]\n.SH DESCRIPTION\n" +
          roff(app.get_description()) + "\n";
  append_footer(page, app);
  page += ".SH OPTIONS\nThese go with every command.\n";
  append_options(page, app);
  page += ".SH COMMANDS\n";
  for (const CLI::App* command : app.get_subcommands({}))
    append_command(page, *command, "hotblade " + command->get_name());
  return page;
}

namespace {

// A function of bash that completes the words of a command line; zsh runs it as well.
std::string completing_function(const CLI::App& app, const std::string& name) {
  std::vector<std::string> commands;
  for (const CLI::App* command : app.get_subcommands({})) commands.push_back(command->get_name());
  const std::string global = joined(flags_of(app));
  std::string script =
      name +
      "() {\n"
      "  local current=\"${COMP_WORDS[COMP_CWORD]}\" previous=\"${COMP_WORDS[COMP_CWORD-1]}\" path='' "
      "words='' values='' word\n"
      "  local settings='" +
      joined(setting_names()) +
      "'\n"
      "  for word in \"${COMP_WORDS[@]:1:$((COMP_CWORD-1))}\"; do\n"
      "    case \"$path $word\" in\n";
  for (const CLI::App* command : app.get_subcommands({})) {
    script += fmt::format("      ' {0}') path='{0}' ;;\n", command->get_name());
    for (const CLI::App* inner : command->get_subcommands({})) {
      script += fmt::format("      '{0} {1}') path='{0} {1}' ;;\n", command->get_name(), inner->get_name());
    }
  }
  script += "      ' help') path=help ;;\n    esac\n  done\n  case \"$path\" in\n";
  script += fmt::format("    '') words='{} help {}' ;;\n", joined(commands), global);
  script += fmt::format("    help) words='{}' ;;\n", joined(commands));
  for (const CLI::App* command : app.get_subcommands({}))
    append_case(script, *command, command->get_name(), global);
  script += "  esac\n  case \"$previous\" in\n" + choice_cases(app);
  script +=
      "  esac\n"
      "  [[ $values != \"$settings\" ]] || compopt -o nospace 2> /dev/null\n  if [[ -n $values ]]; then\n    "
      "COMPREPLY=($(compgen -W \"$values\" -- \"$current\"))\n"
      "  elif [[ $current == -* || -z $path ]]; then\n    COMPREPLY=($(compgen -W \"$words\" -- "
      "\"$current\"))\n"
      "  else\n    COMPREPLY=($(compgen -W \"$words\" -- \"$current\") $(compgen -f -- \"$current\"))\n  "
      "fi\n}\n";
  return script;
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
  return "# bash completion for hotblade, made by `hotblade completion bash`\n" +
         completing_function(app, "_hotblade") + "complete -o filenames -F _hotblade hotblade\n";
}

// As a file `_hotblade` of the function path it is the body of the function that completes; read by `source`
// it is not called.
std::string zsh_completion(const CLI::App& app) {
  return "#compdef hotblade\n# zsh completion for hotblade, made by `hotblade completion zsh`\n"
         "autoload -U +X bashcompinit && bashcompinit\n" +
         completing_function(app, "_hotblade_words") +
         "if [[ ${funcstack[1]} == _hotblade ]]; then\n  _bash_complete -o filenames -F _hotblade_words\n"
         "else\n  complete -o filenames -F _hotblade_words hotblade\nfi\n";
}

std::string fish_completion(const CLI::App& app) {
  std::string script = "# fish completion for hotblade, made by `hotblade completion fish`\n";
  append_fish_options(script, app, "");
  script += "complete -c hotblade -n __fish_use_subcommand -f -a help -d 'Print the help of a command'\n";
  for (const CLI::App* command : app.get_subcommands({})) {
    const std::string name = command->get_name();
    script += "complete -c hotblade -n __fish_use_subcommand -f -a " + name + " -d " +
              fish_quoted(command->get_description()) + "\n";
    script += "complete -c hotblade -n '__fish_seen_subcommand_from help' -f -a " + name + "\n";
    append_fish_options(script, *command, " -n '__fish_seen_subcommand_from " + name + "'");
    for (const CLI::App* inner : command->get_subcommands({})) {
      script += "complete -c hotblade -n '__fish_seen_subcommand_from " + name + "' -f -a " +
                inner->get_name() + " -d " + fish_quoted(inner->get_description()) + "\n";
      append_fish_options(script, *inner, " -n '__fish_seen_subcommand_from " + inner->get_name() + "'");
    }
  }
  return script;
}

}  // namespace hotblade::pipeline
