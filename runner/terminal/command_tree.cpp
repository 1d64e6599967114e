#include "runner/terminal/command_tree.h"

#include <CLI/CLI.hpp>

namespace jnd {

const CommandOption& CommandOption::required() const {
  option_->required();
  return *this;
}

const CommandOption& CommandOption::one_of(std::vector<std::string> words) const {
  option_->check(CLI::IsMember(std::move(words)));
  return *this;
}

const CommandOption& CommandOption::range(int least, int most) const {
  option_->check(CLI::Range(least, most));
  return *this;
}

const CommandOption& CommandOption::range(double least, double most) const {
  option_->check(CLI::Range(least, most));
  return *this;
}

const CommandOption& CommandOption::check(const std::function<std::string(const std::string&)>& why_not,
                                          const std::string& name) const {
  option_->check(CLI::Validator([why_not](std::string& text) { return why_not(text); }, "", name));
  return *this;
}

const CommandOption& CommandOption::show_default() const {
  option_->capture_default_str();
  return *this;
}

const CommandOption& CommandOption::delimiter(char between) const {
  option_->delimiter(between);
  return *this;
}

const CommandOption& CommandOption::values(int least, int most) const {
  option_->expected(least, most);
  return *this;
}

const CommandOption& CommandOption::one_at_a_time() const {
  option_->allow_extra_args(false);
  return *this;
}

const CommandOption& CommandOption::needs(const CommandOption& other) const {
  option_->needs(other.option_);
  return *this;
}

const CommandOption& CommandOption::excludes(const CommandOption& other) const {
  option_->excludes(other.option_);
  return *this;
}

const CommandOption& CommandOption::value_name(const std::string& name) const {
  option_->type_name(name);
  return *this;
}

const CommandOption& CommandOption::variable(const std::string& name) const {
  option_->envname(name);
  return *this;
}

const CommandOption& CommandOption::hidden() const {
  option_->group("");
  return *this;
}

const CommandOption& CommandOption::description(const std::string& what) const {
  option_->description(what);
  return *this;
}

template <typename Value>
CommandOption Command::add_option(const std::string& name, Value& value, const std::string& what) const {
  return CommandOption(*command_->add_option(name, value, what));
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
  return CommandOption(*command_->add_option_function<std::string>(name, take, what));
}

CommandOption Command::add_flag(const std::string& name, bool& value, const std::string& what) const {
  return CommandOption(*command_->add_flag(name, value, what));
}

CommandOption Command::add_flag(const std::string& name, int& value, const std::string& what) const {
  return CommandOption(*command_->add_flag(name, value, what));
}

CommandOption Command::option(const std::string& name) const {
  return CommandOption(*command_->get_option(name));
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

void refuse_missing(const std::string& name) {
  throw CLI::RequiredError(name);
}

void refuse_without(const std::string& name, const std::string& others) {
  throw CLI::RequiresError(name, others);
}

void refuse_together(const std::string& one, const std::string& other) {
  throw CLI::ExcludesError(one, other);
}

}  // namespace jnd
