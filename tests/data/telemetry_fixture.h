// Telemetry of an imagined press with a thumb's platform and its joint, and events that carry it.
#pragma once

#include <bit>
#include <cmath>

#include "data/log/telemetry.h"
#include "tests/data/study_fixture.h"

namespace jnd {

// `ticks` ticks of two devices: 2 ticks records.
inline Telemetry press(int ticks) {
  Telemetry telemetry;
  telemetry.channels = {{0, Channel::cutaneous}, {0, Channel::kinaesthetic}};
  for (int i = 0; i < ticks; ++i)
    for (std::int32_t channel = 0; channel < 2; ++channel) {
      TickRecord tick;
      tick.time_ns = 5'000'000'000 + i * 1'000'000LL;
      tick.lateness_ns = 900 + i % 7;
      tick.channel = channel;
      tick.penetration = 0.005 * std::sin(0.05 * i);
      tick.asked_n = 900 * tick.penetration;
      tick.given_n = std::min(tick.asked_n, 4.25 + channel);
      tick.limits = tick.given_n < tick.asked_n ? 1U : 0U;
      tick.measured_n = tick.given_n + 1e-3 * (i % 3);
      tick.vibration_g = i < 3 ? 0.7 : 0;
      tick.travel = channel == 0 ? 0.0375 : 0.6125;
      tick.finger_m = {0.001 * i, -0.065, 0.25};
      telemetry.ticks.push_back(tick);
    }
  return telemetry;
}

// Value for value, NaNs by their bits.
inline bool same_to_the_bit(const Telemetry& a, const Telemetry& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  if (a.unit != b.unit || a.channels != b.channels || a.dropped != b.dropped || a.ticks.size() != b.ticks.size())
    return false;
  for (std::size_t i = 0; i < a.ticks.size(); ++i) {
    const TickRecord &x = a.ticks[i], &y = b.ticks[i];
    if (x.time_ns != y.time_ns || x.lateness_ns != y.lateness_ns || x.channel != y.channel || x.limits != y.limits ||
        !same(x.penetration, y.penetration) || !same(x.asked_n, y.asked_n) || !same(x.given_n, y.given_n) ||
        !same(x.measured_n, y.measured_n) || !same(x.vibration_g, y.vibration_g) || !same(x.travel, y.travel) ||
        !same(x.finger_m[0], y.finger_m[0]) || !same(x.finger_m[1], y.finger_m[1]) ||
        !same(x.finger_m[2], y.finger_m[2]))
      return false;
  }
  return true;
}

// A completed trial with the ticks of both intervals.
inline void append_with_telemetry(SessionLog& log, const Trial& trial, const std::array<Telemetry, 2>& intervals) {
  std::vector<TelemetryBlob> blobs;
  for (int i = 0; i < 2; ++i) blobs.push_back(encode_telemetry(i, intervals[static_cast<std::size_t>(i)]));
  auto body = to_body(record_of(tutorial(), trial, usual_answer(trial)));
  body["telemetry"] = telemetry_body(blobs);
  log.append(event_kind::kTrialCompleted, body, stamp_of(trial), blobs);
}

}  // namespace jnd
