// One answered trial out of the text of its event, in one pass: the million-trial path of every analysis. What a whole
// record holds is read by data/log/event_body.h.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string_view>

#include "protocols/vocabulary.h"

namespace jnd {

// What one interval gave the participant to go by: means over its devices; NaN where no device measured it.
struct IntervalCues {
  double stiffness = 0;     // fitted, in the study's unit; NaN where none could be fitted
  double peak_force_n = 0;  // the largest of a device
  double work_j = 0;
  double dwell_s = 0;
};

// What counts and times are made of.
struct CountedTrial {
  int session = 0;                // place in the list of sessions that was read
  int series = 0, condition = 0;  // places in the protocol
  int index = 0;                  // of the plan, from 1
  bool practice = false;
  int target = -1;  // of the task's classes; -1: none
  int said = -1;
  int sureness = 0;
  std::optional<double> number{};  // of an answer with a number
  double standard = 0;
  int standard_place = -1;                            // Trial::standard_place
  bool same() const noexcept { return target == 0; }  // of same-different
  bool said_different() const noexcept { return said == 1; }
  bool by_participant = true;
  double response_time_s = 0, duration_s = 0, saturated_share = 0;
  bool off_prescription = false;
  Intervals asked{};                                // of the intervals, in the study's unit
  std::array<IntervalCues, kMostIntervals> cues{};  // as delivered
  std::optional<double> delivered(std::size_t interval) const noexcept {
    const double stiffness = cues[interval].stiffness;
    return stiffness == stiffness ? std::optional<double>(stiffness) : std::nullopt;
  }
};

// Reads bodies of `trial.completed`. Thread rule: one reader a thread (it keeps its buffers).
class TrialBodyReader {
 public:
  explicit TrialBodyReader(Unit unit);
  ~TrialBodyReader();
  // Throws StorageError where the body is not such an event's; `session` stays 0.
  CountedTrial read(std::string_view body);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace jnd
