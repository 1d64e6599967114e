// Why a statistic has no value: every undefined number of the group statistics (NaN) has one of these beside it.
#pragma once

namespace jnd {

enum class StatisticStatus {
  ok,
  too_few,         // fewer values than the statistic needs
  too_many,        // more values than its source covers (Shapiro-Wilk: 5000)
  no_variance,     // the values, or the differences, are all equal up to rounding: 0/0
  singular,        // the covariance has no inverse: too few participants, or one condition follows from the others
  not_applicable,  // the question does not arise, as sphericity with two conditions
};

// "ok", "too_few", ... as in JSON.
constexpr const char* to_text(StatisticStatus status) noexcept {
  switch (status) {
    case StatisticStatus::ok:
      return "ok";
    case StatisticStatus::too_few:
      return "too_few";
    case StatisticStatus::too_many:
      return "too_many";
    case StatisticStatus::no_variance:
      return "no_variance";
    case StatisticStatus::singular:
      return "singular";
    case StatisticStatus::not_applicable:
      return "not_applicable";
  }
  return "unknown";
}

}  // namespace jnd
