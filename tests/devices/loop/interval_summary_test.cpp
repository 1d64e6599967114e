// The summary on samples whose numbers are known.
#include "devices/loop/interval_summary.h"

#include "tests/catch.h"

using namespace jnd;

namespace {
IntervalSample touch(double x, double f) {
  return {.duration_s = 0.001, .touching = true, .penetration = x, .force_n = f};
}
const IntervalSample kAway{.duration_s = 0.001};
}  // namespace

TEST_CASE("stiffness is the least-squares slope through the origin") {
  IntervalSummary summary;
  summary.begin(true);
  summary.add(touch(0.001, 0.6));
  summary.add(touch(0.002, 1.1));
  summary.add(touch(0.003, 1.4));
  const FingerPresentation result = summary.result();
  // (0.001*0.6 + 0.002*1.1 + 0.003*1.4) / (1 + 4 + 9) 1e-6
  CHECK(*result.stiffness == Approx(7.0e-3 / 14e-6));
  CHECK(result.fit_samples == 3);
  CHECK(result.peak_force_n == 1.4);
  CHECK(result.deepest_penetration == 0.003);
  CHECK(result.dwell_s == Approx(0.003));
  CHECK(result.contacts == 1);
  CHECK(result.mean_speed == Approx(1.0));
  // From the surface: 0.3 mN m + 0.85 + 1.25.
  CHECK(result.work_j == Approx(0.3e-3 + 0.85e-3 + 1.25e-3));
}

TEST_CASE("limited and soft-start samples do not enter the fit, but are counted") {
  IntervalSummary summary;
  summary.begin(true);
  summary.add(touch(0.001, 0.5));
  IntervalSample limited = touch(0.006, 1.0);
  limited.force_reduced = true;
  summary.add(limited);
  IntervalSample soft = touch(0.004, 0.1);
  soft.soft_start = true;
  summary.add(soft);
  summary.add(touch(0.002, 1.0));
  const FingerPresentation result = summary.result();
  CHECK(*result.stiffness == Approx(500));
  CHECK(result.fit_samples == 2);
  CHECK(result.saturated_share == Approx(0.25));
}

TEST_CASE("nothing is fitted without force, without contact or without a usable sample") {
  IntervalSummary summary;
  summary.begin(false);
  summary.add(touch(0.001, 0));
  CHECK_FALSE(summary.result().stiffness);
  CHECK(summary.result().fit_samples == 0);
  summary.begin(true);
  summary.add(kAway);
  CHECK_FALSE(summary.result().stiffness);
  CHECK(summary.result().saturated_share == 0);
  CHECK(summary.result().mean_speed == 0);
  IntervalSample limited = touch(0.006, 4.7);
  limited.force_reduced = true;
  summary.add(limited);
  CHECK_FALSE(summary.result().stiffness);
  CHECK(summary.result().saturated_share == 1);
}

TEST_CASE("work counts the way in only, and speed only within contacts") {
  IntervalSummary summary;
  summary.begin(true);
  for (int contact = 0; contact < 2; ++contact) {
    summary.add(kAway);
    summary.add(touch(0.002, 1.0));
    summary.add(touch(0.001, 0.5));
  }
  const FingerPresentation result = summary.result();
  CHECK(result.contacts == 2);
  CHECK(result.work_j == Approx(2 * 0.5 * 1.0 * 0.002));
  CHECK(result.mean_speed == Approx(1.0));
  CHECK(result.dwell_s == Approx(0.004));
}

TEST_CASE("vibration keeps its largest delivered amplitude and its flag") {
  IntervalSummary summary;
  summary.begin(false);
  IntervalSample buzz = kAway;
  buzz.vibration_g = 0.7;
  summary.add(buzz);
  buzz.vibration_g = 0.3;
  buzz.vibration_clamped = true;
  summary.add(buzz);
  CHECK(summary.result().vibration_g == 0.7);
  CHECK(summary.result().vibration_clamped);
  summary.begin(false);
  CHECK(summary.result().vibration_g == 0);
  CHECK_FALSE(summary.result().vibration_clamped);
}

TEST_CASE("lateness percentiles") {
  LatenessHistogram histogram;
  CHECK(histogram.percentile_us(0.5) == 0);
  for (int us = 1; us <= 100; ++us) histogram.add(us * 1000);
  CHECK(histogram.percentile_us(0.50) == 50);
  CHECK(histogram.percentile_us(0.99) == 99);
  histogram.add(9'876'543);
  CHECK(histogram.largest_us() == Approx(9876.543));
  histogram.add(-5);
  CHECK(histogram.percentile_us(0) == 0);
  histogram.clear();
  CHECK(histogram.largest_us() == 0);
}
