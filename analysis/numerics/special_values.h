// The two doubles that are no measurement: undefined, and without bound. Writers turn the first into null or an empty
// cell; every result that may hold one carries a status that says why.
#pragma once

#include <limits>

namespace jnd {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInf = std::numeric_limits<double>::infinity();

}  // namespace jnd
