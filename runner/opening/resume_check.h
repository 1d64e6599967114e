// How a session that was interrupted goes on: what stopped it, how long that lasted and by which clock, and what the
// protocol then asks for.
//
// The events of a log are stamped by the wall clock and by CLOCK_MONOTONIC, which stands still while the machine is
// suspended. Within one run of the machine the interruption lasted at least as long as the monotonic clock went on, and
// at most as long as that and all the time that the machine was suspended since its start. Where it never was, that is
// one number, and the wall clock has no say. Otherwise the wall clock is believed between these bounds, and the longer
// one is taken where it lies outside them. A log needs nothing more for this than the boot id in the bodies of
// session.opened and session.resumed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "data/log/event_body.h"
#include "protocols/protocol.h"

namespace jnd {

struct ResumeMoment {
  std::string boot_id;             // empty where unknown
  std::int64_t monotonic_ns = 0;   // of the clock that stamps the log
  std::int64_t since_boot_ns = 0;  // devices/machine/boot_id.h
  std::int64_t utc_ns = 0;
  // A quick rehearsal, in which waits are skipped: its log is ahead of every clock, and no clock is at fault.
  bool fast = false;
};
ResumeMoment resume_moment(bool fast);  // of this machine, now

enum class GapClock { monotonic, wall, none };
std::string_view to_string(GapClock clock) noexcept;

struct ResumeCheck {
  std::string cause;            // "left by the operator", "the program was killed", "the machine was restarted"
  std::optional<double> gap_s;  // none: no clock tells; then it counts as longer than any limit
  GapClock clock = GapClock::none;
  double clock_set_back_s = 0;  // by how much the wall clock was set back meanwhile, at least; 0: it was not
  std::string warning;          // about the clocks; empty: nothing to say
  bool too_long = false;        // goes on with the operator's reason only
  bool practice_again = false;  // the last practice round
  bool redo_block = false;      // the interrupted block begins anew
};

ResumeCheck check_resume(const SessionState& state, const ResumePolicy& policy, const ResumeMoment& now);

// Body of session.resumed. reason: the operator's, where the gap is too long; may be empty.
nlohmann::ordered_json resumed_body(const ResumeCheck& check, const ResumeMoment& now, int trials_done,
                                    const std::string& reason);
// For the operator: a few lines, each with its end of line.
std::string resume_text(const ResumeCheck& check, const ResumePolicy& policy);
// "45 s", "3 min 20 s", "2 h 5 min", "1 day 3 h".
std::string gap_text(double seconds);

}  // namespace jnd
