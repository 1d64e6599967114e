// The commands that deal with protocols and studies. Each adds itself to the program in its own command_*.cpp;
// runner/command_line.cpp collects them.
#pragma once

#include <optional>
#include <string>

#include "runner/terminal/command_tree.h"

namespace jnd {

void add_new(CommandTree& tree);
void add_check(CommandTree& tree);
void add_plan(CommandTree& tree);
void add_run(CommandTree& tree);
void add_simulate(CommandTree& tree);
void add_status(CommandTree& tree);
void add_verify(CommandTree& tree);
void add_export(CommandTree& tree);
void add_note(CommandTree& tree);
void add_exclude(CommandTree& tree);
void add_unblind(CommandTree& tree);
void add_backup(CommandTree& tree);
void add_merge(CommandTree& tree);
void add_recover(CommandTree& tree);

// --kind and --by: which sessions are analysed, and over which stiffness differences. Where they are not given, the
// only kind that there is, or real; and what the protocol registers.
void add_kind_and_by(CLI::App& command, std::optional<std::string>& kind, std::optional<std::string>& by);

struct AnalyzeOptions {
  std::string study;
  std::optional<std::string> kind;    // real, pilot or simulated
  std::optional<std::string> by;      // nominal or delivered; without it, what the protocol registers
  std::string models = "registered";  // or "all": every model, method and correction beside the registered one
  bool cells = false;
  bool json = false;
  std::string csv;       // a folder for the results as CSV; empty: none
  bool replace = false;  // that folder, where an earlier one is there
  std::string methods;   // the file for the methods in words; empty: methods.md beside the study
  bool no_methods = false;
};
int command_analyze(const AnalyzeOptions& options);

}  // namespace jnd
