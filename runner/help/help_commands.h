// The commands about the program itself: help, completions and manual pages, all made from the tree of commands.
#pragma once

#include "runner/terminal/command_tree.h"

namespace jnd {

void add_help(CommandTree& tree);         // jnd help [COMMAND [SUBCOMMAND]]
void add_completions(CommandTree& tree);  // jnd completions SHELL
void add_man(CommandTree& tree);          // jnd man FOLDER

// The help of the command, with the program's closing words where it is the program itself; as wide as the terminal.
std::string help_of(const CLI::App& command);

}  // namespace jnd
