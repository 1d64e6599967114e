#include "runner/terminal/command_tree.h"

#include <CLI/CLI.hpp>

namespace jnd {

CommandOption CommandOption::required() const {
  return option_->required();
}

CommandOption CommandOption::one_of(std::vector<std::string> words) const {
  return option_->check(CLI::IsMember(std::move(words)));
}

CommandOption CommandOption::range(int least, int most) const {
  return option_->check(CLI::Range(least, most));
}

CommandOption CommandOption::range(double least, double most) const {
  return option_->check(CLI::Range(least, most));
}

CommandOption CommandOption::check(const std::function<std::string(const std::string&)>& why_not) const {
  return option_->check(why_not);
}

CommandOption CommandOption::show_default() const {
  return option_->capture_default_str();
}

CommandOption CommandOption::delimiter(char between) const {
  return option_->delimiter(between);
}

CommandOption CommandOption::values(int least, int most) const {
  return option_->expected(least, most);
}

CommandOption CommandOption::needs(const CommandOption& other) const {
  return option_->needs(other.option_);
}

CommandOption CommandOption::excludes(const CommandOption& other) const {
  return option_->excludes(other.option_);
}

CommandOption CommandOption::variable(const std::string& name) const {
  return option_->envname(name);
}

CommandOption CommandOption::hidden() const {
  return option_->group("");
}

template <typename Value>
CommandOption Command::add_option(const std::string& name, Value& value, const std::string& what) const {
  CLI::Option* const option = command_->add_option(name, value, what);
  if (name.starts_with('-')) option->allow_extra_args(false);  // else a list takes the arguments that follow it
  return option;
}

template CommandOption Command::add_option(const std::string&, std::string&, const std::string&) const;
template CommandOption Command::add_option(const std::string&, int&, const std::string&) const;
template CommandOption Command::add_option(const std::string&, double&, const std::string&) const;
template CommandOption Command::add_option(const std::string&, std::uint64_t&, const std::string&) const;
template CommandOption Command::add_option(const std::string&, std::optional<std::string>&, const std::string&) const;
template CommandOption Command::add_option(const std::string&, std::optional<int>&, const std::string&) const;
template CommandOption Command::add_option(const std::string&, std::optional<double>&, const std::string&) const;
template CommandOption Command::add_option(const std::string&, std::optional<std::uint64_t>&, const std::string&) const;
template CommandOption Command::add_option(const std::string&, std::vector<std::string>&, const std::string&) const;
template CommandOption Command::add_option(const std::string&, std::vector<int>&, const std::string&) const;
template CommandOption Command::add_option(const std::string&, std::vector<double>&, const std::string&) const;

CommandOption Command::add_word(const std::string& name, const std::function<void(const std::string&)>& take,
                                const std::string& what) const {
  return command_->add_option_function<std::string>(name, take, what);
}

CommandOption Command::add_flag(const std::string& name, bool& value, const std::string& what) const {
  return command_->add_flag(name, value, what);
}

CommandOption Command::add_flag(const std::string& name, int& value, const std::string& what) const {
  return command_->add_flag(name, value, what);
}

CommandOption Command::option(const std::string& name) const {
  return command_->get_option(name);
}

void Command::add_notes(const std::string& text) const {
  command_->footer(text + command_->get_footer());
}

Command CommandTree::add_command(const std::string& name, const std::string& what, const std::string& example,
                                 std::function<int()> run) {
  CLI::App& command = *parent_.add_subcommand(name, what);
  command.footer(example);
  if (!heading_.empty()) command.group(heading_);
  command.callback([&chosen = chosen_, run = std::move(run)] { chosen = run; });
  return Command(command);
}

CommandTree CommandTree::add_group(const std::string& name, const std::string& what, const std::string& example) {
  CLI::App& group = *parent_.add_subcommand(name, what);
  group.require_subcommand(0, 1);  // alone it prints its help
  group.footer(example);
  if (!heading_.empty()) group.group(heading_);
  return {group, chosen_};
}

void refuse_arguments(const std::string& problem) {
  throw CLI::ParseError(problem, CLI::ExitCodes::BaseClass);
}

}  // namespace jnd
