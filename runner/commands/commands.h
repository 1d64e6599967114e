// The commands for protocols and studies. Each adds itself to the program in its own command_*.cpp;
// runner/command_line.cpp collects them.
#pragma once

#include <optional>
#include <string>

#include "runner/terminal/command_tree.h"

namespace jnd {

void add_new(CommandTree& tree);
void add_init(CommandTree& tree);
void add_check(CommandTree& tree);
void add_plan(CommandTree& tree);
void add_combine(CommandTree& tree);
void add_diff(CommandTree& tree);
void add_run(CommandTree& tree);
void add_simulate(CommandTree& tree);
void add_status(CommandTree& tree);
void add_verify(CommandTree& tree);
void add_analyze(CommandTree& tree);
void add_export(CommandTree& tree);
void add_report(CommandTree& tree);

// What `jnd check` says of a protocol's file, on standard output. False where it has mistakes.
bool report_check(const std::string& protocol);

// --kind and --by: which sessions are analysed, and over which stiffness differences. Where they are not given, the
// only kind that there is, or real; and what the protocol registers.
void add_kind_and_by(const Command& command, std::optional<std::string>& kind, std::optional<std::string>& by);

}  // namespace jnd
