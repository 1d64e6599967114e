// What stands on the terminal when a session is over: what was done, where it is, what comes next. Pure.
#pragma once

#include <string>

#include "protocols/delivery.h"

namespace jnd {

struct SessionSummary {
  std::string study;  // path of the file that has the answers
  int trials_done = 0, trials_total = 0, trials_voided = 0;
  double run_s = 0;                                          // this run, by the machine's clock
  bool resumable = false;                                    // the same command goes on with it
  bool moved = false;                                        // it was rescued into another file than was given
  bool free_interaction = false;                             // objects are counted instead of trials
  double slowest_presenting_ms = 0, slowest_waiting_ms = 0;  // as in DeviceLinkReport; both 0: no external rig
  Deliveries deliveries{};                                   // of the session
};

// "in 4 of 20 intervals ...", for the operator.
std::string not_as_asked_text(const Deliveries& deliveries);

// Lines, each with its end; to be read below the last words.
std::string summary_text(const SessionSummary& summary);

}  // namespace jnd
