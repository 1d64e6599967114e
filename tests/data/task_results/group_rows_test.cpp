// The rows of the group: everyone counts, each number with its own n, and no participant is dropped silently.
#include <cmath>

#include "tests/catch.h"
#include "tests/data/pair_results.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

JndEstimate estimate(JndStatus status, double slope) {
  JndEstimate result;
  result.status = status;
  result.slope = slope;
  result.jnd = status == JndStatus::ok ? 1 / slope : kNaN;
  result.weber = result.jnd / 900;
  result.series_used = 3;
  return result;
}

JndEstimate jnd(double value) {
  return estimate(JndStatus::ok, 1 / value);
}

const JndEstimate kWorse = estimate(JndStatus::no_sensitivity, -1e-3);
const JndEstimate kBetter = estimate(JndStatus::ceiling, kInf);
const JndEstimate kUnknown = estimate(JndStatus::no_information, kNaN);

// One condition.
TaskResults grouped(const std::vector<JndEstimate>& estimates) {
  Protocol protocol = chinello();
  protocol.conditions.resize(1);
  TaskResults results = empty_task_results(protocol);
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    TaskEstimateRow& row = results.estimates.emplace_back();
    row.participant = "P" + std::to_string(i);
    row.estimates = estimates_of(estimates[i], 900);
  }
  add_group(results, protocol);
  return results;
}

TEST_CASE("a group of JNDs counts everyone, each number with its own n", "[data]") {
  const TaskResults results = grouped({jnd(200), jnd(400), kWorse, kBetter, kUnknown});
  const TaskGroupRow &jnds = group_of(results, 0, kJnd), &slopes = group_of(results, 0, kSlope);
  CHECK(jnds.participants == 5);
  CHECK(jnds.mean.n == 2);
  CHECK(jnds.mean.mean == Approx(300));
  CHECK(group_of(results, 0, kWeber).mean.mean == Approx(1.0 / 3));
  CHECK(std::exp(jnds.logarithms.mean) == Approx(std::sqrt(200.0 * 400)));
  CHECK(jnds.median_n == 4);  // below all, 200, 400, above all
  CHECK(jnds.median == Approx(300));
  CHECK(jnds.middle == Beyond::no);
  CHECK(jnds.without == std::map<std::string, int>{{"ceiling", 1}, {"no_information", 1}, {"no_sensitivity", 1}});
  CHECK(std::isnan(jnds.inverse_mean));
  CHECK(slopes.mean.n == 3);
  CHECK(slopes.inverse_mean == Approx(3 / (1.0 / 200 + 1.0 / 400 - 1e-3)));
}

TEST_CASE("infinite medians and unusable mean slopes are said, not hidden", "[data]") {
  const TaskResults poor = grouped({kWorse, kWorse, jnd(1000)});
  CHECK(group_of(poor, 0, kJnd).median == kInf);
  CHECK(group_of(poor, 0, kJnd).middle == Beyond::above);
  CHECK(std::isnan(group_of(poor, 0, kSlope).inverse_mean));
  const TaskResults nobody = grouped({});
  const TaskGroupRow& empty = group_of(nobody, 0, kJnd);
  CHECK(empty.participants == 0);
  CHECK(empty.median_n == 0);
  CHECK(std::isnan(empty.median));
  CHECK(std::isnan(empty.mean.mean));
}

TEST_CASE("a median below what was tested is no number", "[data]") {
  // Half of the way between nothing and a JND would be the JND of no participant.
  for (const auto& estimates : {std::vector{kBetter, kBetter}, std::vector{kBetter, jnd(200)}}) {
    const TaskResults results = grouped(estimates);
    const TaskGroupRow& row = group_of(results, 0, kJnd);
    CHECK(row.median_n == 2);
    CHECK(row.middle == Beyond::below);
    CHECK(std::isnan(row.median));
  }
}

}  // namespace
}  // namespace jnd
