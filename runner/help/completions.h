// `jnd completions`: what the shells offer on the Tab key, made from the tree of commands.
#pragma once

#include <string>

#include "runner/help/command_page.h"

namespace jnd {

// Scripts for the shells. Commands, options, the values of options that take some words only, shipped names as they are
// when this is called, and files by what the option takes.
std::string bash_completions(const CommandPage& program);
std::string zsh_completions(const CommandPage& program);
std::string fish_completions(const CommandPage& program);

}  // namespace jnd
