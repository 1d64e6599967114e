// How punctual a loop of 1 ms has to be: one scale for jnd doctor, for readiness, and for what a session shows.
#pragma once

#include <cstdint>

#include "devices/loop/control_loop.h"
#include "devices/loop/governor.h"

namespace jnd {

struct LoopLimits {
  double p99_us;         // 99th percentile of the lateness
  double largest_us;     // lateness
  double skipped_share;  // of the ticks that were due, 0..1
};

// Beyond one of these a warning: a tenth of a period; a period, which is a skipped tick.
inline constexpr LoopLimits kTightLoop{.p99_us = 100, .largest_us = 1000, .skipped_share = 0};

// A tick that comes this late voids its trial (command_gap): with the period before it no command for 20 ms.
inline constexpr double kGapLateness_us = 1e-3 * static_cast<double>(kMaxAge_ns - kPeriod_ns);

// At one of these the loop is unfit: one tick in a hundred is late by a period or skipped, or a tick is half as late as
// voids a trial: who measures for seconds sees the usual largest, and a session lasts hundreds of times as long.
inline constexpr LoopLimits kUnfitLoop{.p99_us = 1000, .largest_us = kGapLateness_us / 2, .skipped_share = 0.01};

inline double skipped_share(std::int64_t ticks, std::int64_t skipped) noexcept {
  return skipped > 0 ? static_cast<double>(skipped) / static_cast<double>(ticks + skipped) : 0;
}

}  // namespace jnd
