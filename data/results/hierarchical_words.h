// What limits the numbers of the hierarchical model, in the words of every output.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/hierarchical/predictive_check.h"

namespace jnd {

// How many different levels there were, and how many after pooling (pool_levels); 0 if nothing was pooled.
struct PooledLevels {
  std::size_t from = 0, to = 0;
  explicit operator bool() const noexcept { return from > 0; }
};
PooledLevels pooled(std::vector<HierarchicalCell>& cells);

// Percentages of 95 % intervals that hold the true value with so few people: measured by hierarchical_coverage_bench, 400
// studies per row, 36 trials per condition, 2 conditions, tu .25, tv .15. Studies with an open end are left out.
struct IntervalCoverage {
  int participants = 0;
  double jnd = 0, ratio = 0;
};
inline constexpr IntervalCoverage kIntervalCoverage[] = {{3, 95.3, 96.4}, {6, 92.0, 93.0}, {12, 94.8, 97.2}};
inline constexpr std::size_t kFewParticipants = 6;  // fewer get a caution

// Whether the JNDs of all people in a condition are equal: no other spread was found, or could be.
constexpr bool are_alike(SpreadStatus persons, SpreadStatus by_condition) noexcept {
  const auto differ = [](SpreadStatus one) {
    return one == SpreadStatus::ok || one == SpreadStatus::at_limit || one == SpreadStatus::by_condition;
  };
  return !differ(persons) && !differ(by_condition);
}
inline constexpr std::string_view kPeopleAlike =
    "The answers show no difference between people's JNDs: everybody's is the group's.";

// What a range of a single person's JND holds: measured by hierarchical_calibration_bench.
inline constexpr std::string_view kPersonRange =
    "The sd beside a participant's shrunken JND takes the group's estimates as certain. So the range from JND / exp(1.96 sd) "
    "to JND exp(1.96 sd) holds the true JND of 84 % (studies of 12 people) to 88 % (18 people) of simulated participants, "
    "not of 95 %. Shrunken JNDs differ less than people do: do not test them against each other.";

// "no_sensitivity, interval out_of_work": what the status column of a table says of an estimate and its interval.
std::string status_with_interval(std::string_view status, EndsStatus interval);

// Where the test of it is significant; else empty.
std::string lapse_caution(const SharedEstimate& lapses);

// One sentence for each thing that limits the numbers of a fit, the gravest first. conditions: names by their place.
std::vector<std::string> hierarchical_cautions(const HierarchicalFit& fit, const std::vector<std::string>& conditions,
                                               const PooledLevels& pooled);

// What a check of the model says, in a sentence.
std::string predictive_verdict(const PredictiveCheck& check);

}  // namespace jnd
