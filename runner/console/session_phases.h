// Where the session stands in time: how long an interval, a question or a break still takes, how long a pause lasts.
#pragma once

#include <cstdint>
#include <optional>

#include "devices/clock.h"
#include "protocols/protocol.h"
#include "runner/console/console_display.h"
#include "runner/session/session_view.h"

namespace jnd {

// What counts down goes by the session's clock, which may run ahead; what counts up by the machine's.
class SessionPhases {
 public:
  // Both must outlive it.
  SessionPhases(const Protocol& protocol, Clock& clock) noexcept : protocol_(protocol), clock_(clock) {}

  Phase interval_begins(CuePlace place);
  // From the first contact on an interval is as long as the protocol says, whatever is felt.
  Phase interval(const DeviceHealth& health);
  static Phase question(double gone_s, double time_out_s);

  // False: it goes on, after a note.
  bool pause_begins();
  Phase pause() const;
  double pause_over();  // how long it was, in seconds

  void break_begins(double duration_s);
  Phase break_now() const;
  std::int64_t break_ends_ns() const noexcept { return break_ends_ns_; }  // of the session's clock
  double break_left_s() const;                                            // below 0: it may end
  double break_lasted_s() const;

 private:
  const Protocol& protocol_;
  Clock& clock_;
  CuePlace interval_ = CuePlace::first;  // that is felt, or was last
  std::optional<double> contact_s_;      // when it was first touched
  std::int64_t pause_since_ns_ = 0, break_since_ns_ = 0, break_ends_ns_ = 0;
  double break_s_ = 0;
};

// Since a time of the machine's clock.
double seconds_since(std::int64_t began_ns);

}  // namespace jnd
