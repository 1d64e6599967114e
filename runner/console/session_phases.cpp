#include "runner/console/session_phases.h"

#include <algorithm>
#include <utility>

#include "runner/console/session_words.h"
#include "runner/words/words.h"

namespace jnd {

namespace {
constexpr double kNanoseconds = 1e9;
}  // namespace

double seconds_since(std::int64_t began_ns) {
  return static_cast<double>(SteadyClock().now_ns() - began_ns) / kNanoseconds;
}

Phase SessionPhases::interval_begins(CuePlace place) {
  interval_ = place;
  contact_s_.reset();
  return {.word = interval_word(place, protocol_)};
}

Phase SessionPhases::interval(const DeviceHealth& health) {
  const Timeline& timeline = protocol_.timeline;
  // Specimens are in the hand when the interval begins, and nothing tells of a contact.
  const bool in_the_hand = protocol_.rig.device == kSpecimenRig;
  if ((health.contact || in_the_hand) && !contact_s_) contact_s_ = in_the_hand ? 0 : health.elapsed_s;
  Phase phase{.word = interval_word(interval_, protocol_)};
  phase.total_s = contact_s_ ? timeline.explore_s : timeline.no_contact_time_out_s;
  phase.left_s = std::max(0.0, phase.total_s - (health.elapsed_s - contact_s_.value_or(0)));
  if (!contact_s_) phase.more = tr("for the first contact");
  if (contact_s_ && timeline.interval_end != IntervalEnd::time) phase.more = tr("at most");
  return phase;
}

Phase SessionPhases::question(double gone_s, double time_out_s) {
  return {.word = tr("QUESTION"),
          .left_s = std::max(0.0, time_out_s - gone_s),
          .total_s = time_out_s,
          .shade = Shade::question};
}

bool SessionPhases::pause_begins() {
  if (pause_since_ns_ != 0) return false;
  pause_since_ns_ = SteadyClock().now_ns();
  return true;
}

Phase SessionPhases::pause() const {
  return {.word = tr("PAUSED"), .since_ns = pause_since_ns_, .holds = true, .shade = Shade::warning};
}

double SessionPhases::pause_over() {
  return seconds_since(std::exchange(pause_since_ns_, 0));
}

void SessionPhases::break_begins(double duration_s) {
  break_s_ = duration_s;
  break_ends_ns_ = clock_.now_ns() + static_cast<std::int64_t>(duration_s * kNanoseconds);
  break_since_ns_ = SteadyClock().now_ns();
}

Phase SessionPhases::break_now() const {
  Phase phase{.word = tr("BREAK"), .since_ns = break_since_ns_};
  const double left_s = break_left_s();
  phase.holds = left_s <= 0;
  if (left_s > 0) {
    phase.left_s = left_s;
    phase.total_s = break_s_;
  }
  return phase;
}

double SessionPhases::break_left_s() const {
  return static_cast<double>(break_ends_ns_ - clock_.now_ns()) / kNanoseconds;
}

double SessionPhases::break_lasted_s() const {
  return seconds_since(break_since_ns_);
}

}  // namespace jnd
