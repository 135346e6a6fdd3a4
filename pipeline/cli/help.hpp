// How --help, the manual page and wrong words on the command line are put for people.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Error;
class Option;
}  // namespace CLI

namespace hotblade::pipeline {

// An option's kind of value without the parser's own notes: "obj|ply" for "obj|ply:{obj,ply}", "MM (0.1 -
// 100)" for "MM:FLOAT in [0.1 - 100]".
[[nodiscard]] std::string value_words(const CLI::Option& option);

// Has --help written with value_words(); commands added later inherit it.
void set_help_format(CLI::App& app);

// What is wrong with the words after `hotblade help`, which name a command; empty: nothing is.
[[nodiscard]] std::string unknown_topic(const CLI::App& app, const std::vector<std::string>& words);

// The message that says what is wrong with the command line, in one or two lines: the parser's words, the
// nearest command for a word that is none, and whose --help says more.
[[nodiscard]] std::string usage_message(const CLI::App& app, const CLI::Error& error);

}  // namespace hotblade::pipeline
