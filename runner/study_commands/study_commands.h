// The commands that look after studies: what is said about them, copies of them, and how they are getting on. Each adds
// itself in its own command_*.cpp; runner/command_line.cpp collects them.
#pragma once

#include "data/log/session_log.h"
#include "devices/clock.h"
#include "runner/terminal/command_tree.h"

namespace jnd {

void add_note(CommandTree& tree);
void add_exclude(CommandTree& tree);
void add_unblind(CommandTree& tree);
void add_backup(CommandTree& tree);
void add_merge(CommandTree& tree);
void add_recover(CommandTree& tree);
void add_studies(CommandTree& tree);
void add_watch(CommandTree& tree);

// By this machine's clocks.
inline Stamp stamp_now() {
  const SteadyClock clock;
  return {clock.utc_ns(), clock.now_ns()};
}

}  // namespace jnd
