#include "pipeline/cli/help.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <vector>

#include "pipeline/settings/edit_distance.hpp"

namespace hotblade::pipeline {

namespace {

class PlainFormatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0) return "";
    std::string text = " " + value_words(*option);
    if (!option->get_default_str().empty()) text += "=" + option->get_default_str();
    if (option->get_expected_max() == CLI::detail::expected_max_vector_size) text += " ...";
    if (option->get_required()) text += " REQUIRED";
    return text;
  }
};

// The innermost command that was named.
const CLI::App& command_reached(const CLI::App& app) {
  const std::vector<CLI::App*> named = app.get_subcommands();
  return named.empty() ? app : command_reached(*named.front());
}

std::string path_of(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name() : path_of(*app.get_parent()) + " " + app.get_name();
}

// The command that a word is a few letters from; empty: none is.
std::string nearest_command(const CLI::App& app, const std::string& word) {
  std::string nearest;
  std::size_t best = (word.size() + 2) / 3 + 1;
  for (const CLI::App* command : app.get_subcommands({})) {
    const std::size_t distance = edit_distance(word, command->get_name());
    if (distance >= best) continue;
    best = distance;
    nearest = command->get_name();
  }
  return nearest;
}

// The option of a command, its parents' included, that a word is a few letters from; empty: none is.
std::string nearest_option(const CLI::App& reached, const std::string& word) {
  const std::string wanted = word.substr(0, word.find('='));
  std::string nearest;
  std::size_t best = std::max<std::size_t>(2, wanted.size() / 3) + 1;
  for (const CLI::App* app = &reached; app != nullptr; app = app->get_parent()) {
    for (const CLI::Option* option : app->get_options()) {
      for (const std::string& name : option->get_lnames()) {
        const std::size_t distance = edit_distance(wanted, "--" + name);
        if (distance >= best) continue;
        best = distance;
        nearest = "--" + name;
      }
    }
  }
  return nearest;
}

// The names of an app's commands, as a list.
std::string command_names(const CLI::App& app) {
  std::string text;
  for (const CLI::App* command : app.get_subcommands({}))
    text += (text.empty() ? "" : ", ") + command->get_name();
  return text;
}

// The command of this name; null: none has it.
const CLI::App* command_named(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands({})) {
    if (command->get_name() == name) return command;
  }
  return nullptr;
}

// What a word that is no command may have meant.
std::string unknown_word(const CLI::App& reached, const std::string& word) {
  const bool option = word.starts_with("-");
  const std::string nearest = option ? nearest_option(reached, word) : nearest_command(reached, word);
  if (!nearest.empty()) return "unknown command or option: " + word + ": did you mean " + nearest + "?";
  return "unknown command or option: " + word + (option ? "" : ": give one of " + command_names(reached));
}

// What the command cannot do without and was not given: a command of its own, or options.
std::string what_is_missing(const CLI::App& reached) {
  std::string text;
  for (const CLI::Option* option : reached.get_options()) {
    if (!option->get_required() || option->count() > 0) continue;
    text += fmt::format("{}{} {} is missing: {}", text.empty() ? "" : "\n", option->get_name(),
                        value_words(*option), option->get_description());
  }
  if (text.empty()) text = "no command was given: give one of " + command_names(reached);
  return text;
}

// What is left over, in the order it was typed.
std::string stray_words(const CLI::App& reached, const std::vector<std::string>& unknown) {
  std::string text = unknown.size() == 1 ? "unexpected argument: " : "unexpected arguments: ";
  for (std::size_t i = 0; i < unknown.size(); ++i) text += (i > 0 ? " " : "") + unknown[i];
  for (const std::string& word : unknown) {
    if (!word.starts_with("--")) continue;
    if (const std::string nearest = nearest_option(reached, word); !nearest.empty())
      return text + ": did you mean " + nearest + "?";
  }
  return text;
}

}  // namespace

std::string value_words(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto choices = type.find(":{"), range = type.find(":"), in = type.find(" in [");
  if (choices != std::string::npos) return type.substr(0, choices);
  if (type.ends_with(":POSITIVE")) return type.substr(0, range) + " (above 0)";
  if (range == std::string::npos || in == std::string::npos) return type;
  const auto open = in + 5;
  return type.substr(0, range) + " (" + type.substr(open, type.find(']', open) - open) + ")";
}

void set_help_format(CLI::App& app) {
  app.formatter(std::make_shared<PlainFormatter>());
}

std::string unknown_topic(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* reached = &app;
  for (const std::string& word : words) {
    const CLI::App* next = command_named(*reached, word);
    if (next == nullptr)
      return unknown_word(*reached, word) + "\n`" + path_of(*reached) + " --help` says more.\n";
    reached = next;
  }
  return "";
}

std::string usage_message(const CLI::App& app, const CLI::Error& error) {
  const CLI::App& reached = command_reached(app);
  const std::vector<std::string> unknown = app.remaining(true);
  const bool incomplete = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  std::string message = error.what();
  if (incomplete)
    message = unknown.empty() ? what_is_missing(reached) : unknown_word(reached, unknown.front());
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !unknown.empty())
    message = stray_words(reached, unknown);
  return message + "\n`" + path_of(reached) + " --help` says more.\n";
}

}  // namespace hotblade::pipeline
