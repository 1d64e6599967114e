// Units that tests count in.
#pragma once

#include <cstdint>
#include <numbers>

namespace jnd {

inline constexpr std::int64_t kMs = 1'000'000, kUs = 1'000;  // nanoseconds
inline constexpr double kDegree = std::numbers::pi / 180;    // rad

}  // namespace jnd
