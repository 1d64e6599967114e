// What is said where the arguments are not understood: what is wrong, what may have been meant, how the command is used.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace jnd {

// How far the arguments name commands.
struct NamedCommand {
  const CLI::App* command = nullptr;  // the innermost that they name; the program itself where they name none
  // Of a command or an option that there is none of, with the nearest one; empty where all are known.
  std::string problem;
};
// arguments: without the program's name.
NamedCommand named_command(const CLI::App& program, const std::vector<std::string>& arguments);

// The parser's words for what is wrong, and the nearest value where only some are taken.
std::string problem_of(const CLI::ParseError& error);

// "jnd help device test".
std::string help_command_of(const CLI::App& command);

// The whole message: the problem, the command's usage, and where its help is.
std::string usage_message(const CLI::App& command, const std::string& problem);

}  // namespace jnd
