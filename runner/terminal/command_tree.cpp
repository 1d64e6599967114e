#include "runner/terminal/command_tree.h"

#include <CLI/CLI.hpp>

namespace jnd {

CLI::App& CommandTree::add_command(const std::string& name, const std::string& what, const std::string& example,
                                   std::function<int()> run) {
  CLI::App& command = *parent_.add_subcommand(name, what);
  command.footer(example);
  if (!heading_.empty()) command.group(heading_);
  command.callback([&chosen = chosen_, run = std::move(run)] { chosen = run; });
  return command;
}

CommandTree CommandTree::add_group(const std::string& name, const std::string& what, const std::string& example) {
  CLI::App& group = *parent_.add_subcommand(name, what);
  group.require_subcommand(0, 1);  // alone it prints its help
  group.footer(example);
  if (!heading_.empty()) group.group(heading_);
  return {group, chosen_};
}

}  // namespace jnd
