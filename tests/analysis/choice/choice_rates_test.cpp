// ABX and reminder tasks from hits and false alarms: R's numbers and the edges.
#include "analysis/choice/choice_dprime.h"
#include "analysis/choice/choice_task.h"
#include "analysis/numerics/normal.h"
#include "tests/analysis/detection/detection_fixtures.h"

namespace jnd {
namespace {

using testing::agrees;

void compare_two_rates(const TwoRates& found, const nlohmann::json& expected) {
  CHECK(agrees(found.hit_rate, expected.at("H"), 1e-14));
  CHECK(agrees(found.false_alarm_rate, expected.at("F"), 1e-14));
  CHECK(agrees(found.z_difference, expected.at("z_difference"), 1e-12));
  CHECK(agrees(found.dprime_differencing, expected.at("dprime_differencing"), 1e-9));
  CHECK(agrees(found.dprime_independent, expected.at("dprime_independent"), 1e-9));
  if (expected.contains("pc_unbiased")) CHECK(agrees(found.pc_unbiased, expected.at("pc_unbiased"), 1e-12));
}

TEST_CASE("d' of hits and false alarms in ABX and after a reminder agrees with R", "[analysis][choice]") {
  for (const nlohmann::json& one : reference_numbers("choice").at("rates")) {
    CAPTURE(one.at("name").get<std::string>());
    const nlohmann::json& input = one.at("input");
    const RatesTask task = input.at("task") == "abx" ? RatesTask::abx : RatesTask::reminder_one_interval;
    const RatesDprime found =
        dprime_of_rates(task, {input.at("n_signal"), input.at("hits"), input.at("n_noise"), input.at("false_alarms")});
    compare_two_rates(found.raw, one.at("expected").at("raw"));
    compare_two_rates(found.loglinear, one.at("expected").at("loglinear"));
  }
}

TEST_CASE("a reminder before two intervals halves what differencing gives before one", "[analysis][choice]") {
  const Counts counts{40, 30, 40, 9};
  const RatesDprime one = dprime_of_rates(RatesTask::reminder_one_interval, counts);
  const RatesDprime two = dprime_of_rates(RatesTask::reminder_two_intervals, counts);
  CHECK(one.raw.dprime_differencing == Approx(2 * two.raw.dprime_differencing).epsilon(1e-14));
  CHECK(two.raw.dprime_independent == two.raw.dprime_differencing);
  CHECK(two.raw.pc_unbiased == Approx(normal_cdf(two.raw.dprime_independent / std::sqrt(2))).epsilon(1e-14));
  CHECK(std::isnan(one.raw.pc_unbiased));
  CHECK(one.differencing_low == Approx(std::sqrt(2) * one.z_difference_low).epsilon(1e-14));
  CHECK(one.independent_low < one.raw.dprime_independent);
  CHECK(one.independent_high > one.raw.dprime_independent);
}

TEST_CASE("rates of 0 and 1, below chance, and without a class", "[analysis][choice]") {
  const RatesDprime perfect = dprime_of_rates(RatesTask::abx, {12, 12, 12, 0});
  CHECK(perfect.raw.z_difference == kInf);
  CHECK(perfect.raw.pc_unbiased == 1);
  CHECK(perfect.raw.dprime_differencing == kInf);
  CHECK(perfect.differencing_high == kInf);
  CHECK(perfect.differencing_low > 0);
  CHECK(std::isfinite(perfect.loglinear.dprime_independent));

  const RatesDprime below = dprime_of_rates(RatesTask::abx, {12, 3, 12, 8});
  CHECK(below.raw.z_difference < 0);
  CHECK(below.raw.dprime_independent == 0);
  CHECK(below.independent_low == 0);
  CHECK(dprime_of_rates(RatesTask::reminder_one_interval, {12, 3, 12, 8}).raw.dprime_differencing < 0);

  const RatesDprime alike = dprime_of_rates(RatesTask::abx, {12, 12, 12, 12});
  CHECK(alike.status == RateStatus::no_information);
  CHECK(std::isnan(alike.raw.z_difference));
  CHECK(std::isnan(alike.raw.dprime_differencing));
  CHECK(alike.loglinear.dprime_differencing == 0);
  CHECK(alike.differencing_low == 0);
  CHECK(alike.differencing_high == kInf);

  const RatesDprime missing = dprime_of_rates(RatesTask::reminder_two_intervals, {0, 0, 12, 3});
  CHECK(missing.status == RateStatus::missing);
  CHECK(std::isnan(missing.loglinear.z_difference));
  CHECK(std::isnan(missing.loglinear.dprime_independent));
  CHECK(std::isnan(missing.independent_high));
}

}  // namespace
}  // namespace jnd
