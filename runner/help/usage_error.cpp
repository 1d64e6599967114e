#include "runner/help/usage_error.h"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "runner/help/command_page.h"
#include "runner/terminal/study_variable.h"

namespace jnd {

namespace {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options({}))
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

const CLI::App* find_command(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (command->get_name() == name) return command;
  return nullptr;
}

// "device test", of "jnd device test".
std::string without_program(const CLI::App& command) {
  return command_page(command).name.substr(std::string("jnd ").size());
}

std::string unknown_command(const CLI::App& parent, const std::string& word) {
  const std::string near = did_you_mean(word, command_names(parent));
  if (parent.get_parent() == nullptr) return fmt::format("there is no command '{}'{}", word, near);
  return fmt::format("{} has no command '{}'{}", without_program(parent), word, near);
}

std::string unknown_option(const CLI::App& command, const std::string& name) {
  const std::string near = name.find('.') == std::string::npos ? did_you_mean(name, option_names(command))
                                                               : fmt::format("; a file of that name is ./{}", name);
  if (command.get_parent() == nullptr) return fmt::format("there is no option {} before the command{}", name, near);
  return fmt::format("{} has no option {}{}", without_program(command), name, near);
}

bool is_long_option(const std::string& argument) {
  return argument.starts_with("--") && argument.size() > 2;
}

// "-x", and no number.
bool is_short_option(const std::string& argument) {
  return argument.size() > 1 && argument[0] == '-' && argument[1] != '-' && argument[1] != '.' &&
         std::isdigit(static_cast<unsigned char>(argument[1])) == 0;
}

// How many of the arguments that follow are values of the option, as the parser takes them.
std::size_t values_behind(const CLI::Option& option, bool has_value) {
  const int least = option.get_items_expected_min();
  return least > 0 && !has_value ? static_cast<std::size_t>(least) : 0;
}

}  // namespace

NamedCommand named_command(const CLI::App& program, const std::vector<std::string>& arguments) {
  NamedCommand named{&program, ""};
  for (std::size_t i = 0; i < arguments.size() && arguments[i] != "--"; ++i) {
    const std::string& argument = arguments[i];
    if (is_long_option(argument) || is_short_option(argument)) {
      const std::string name = argument.substr(0, argument.find('='));
      const CLI::Option* const option = named.command->get_option_no_throw(name);
      if (option == nullptr) {
        named.problem = unknown_option(*named.command, name);
        return named;
      }
      i += values_behind(*option, name.size() < argument.size());
    } else if (!argument.starts_with("-") && !command_names(*named.command).empty()) {
      const CLI::App* const command = find_command(*named.command, argument);
      if (command == nullptr) {
        named.problem = unknown_command(*named.command, argument);
        return named;
      }
      named.command = command;
    }
  }
  return named;
}

std::string problem_of(const CLI::ParseError& error) {
  std::string text = error.what();
  // "--task: wich not in {which,yes-no}", from CLI::IsMember.
  constexpr std::string_view kNotAmong = " not in {";
  const std::size_t colon = text.find(": "), among = text.rfind(kNotAmong);
  if (colon != std::string::npos && among != std::string::npos && among >= colon + 2 && text.ends_with('}')) {
    const std::string given = text.substr(colon + 2, among - colon - 2);
    std::vector<std::string> words;
    std::istringstream list(text.substr(among + kNotAmong.size(), text.size() - 1 - among - kNotAmong.size()));
    for (std::string word; std::getline(list, word, ',');) words.push_back(word);
    return fmt::format("{} takes {}, not '{}'{}", text.substr(0, colon), listed({words.begin(), words.end()}), given,
                       did_you_mean(given, words));
  }
  if (text == "STUDY is required") return fmt::format("STUDY is missing, and {} names none", kStudyVariable);
  while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
  if (text.size() > 1 && std::isupper(static_cast<unsigned char>(text[0])) != 0 &&
      std::islower(static_cast<unsigned char>(text[1])) != 0)
    text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

std::string help_command_of(const CLI::App& command) {
  return command.get_parent() == nullptr ? "jnd help" : "jnd help " + without_program(command);
}

std::string usage_message(const CLI::App& command, const std::string& problem) {
  return fmt::format("jnd: {}\n  usage: {}\n  more:  {}\n", problem, usage_of(command_page(command)),
                     help_command_of(command));
}

}  // namespace jnd
