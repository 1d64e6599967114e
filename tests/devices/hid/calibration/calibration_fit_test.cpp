// The fit of a force table: known sensors are recovered, whatever comes rises, nonsense is refused.
#include <cmath>
#include <random>

#include <rapidcheck.h>

#include "devices/hid/calibration/calibration.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

ForcePoint point(double known_n, double sensor_n) {
  return {.known_n = known_n, .sensor = {.mean = sensor_n, .sd = 0, .drift_per_s = 0, .count = 1000}};
}

// A sensor that shows gain * force + offset, met at each force.
std::vector<ForcePoint> straight(const std::vector<double>& forces, double gain, double offset_n) {
  std::vector<ForcePoint> points;
  for (const double force : forces) points.push_back(point(force, gain * force + offset_n));
  return points;
}

const std::vector<double> kUpAndDown = {0, 1, 2, 3, 4, 4.5, 4, 3, 2, 1, 0};

void check_rises(const ForceTable& table) {
  REQUIRE(table.sensor_n.size() == table.force_n.size());
  REQUIRE(table.sensor_n.size() >= 2);
  REQUIRE(table.sensor_n.size() <= std::size_t{JND_FORCE_POINTS});
  const jnd_force_table report = to_report(table);
  std::uint8_t data[JND_PAGE_SIZE];
  jnd_encode_force_table(&report, data);
  jnd_force_table again{};
  CHECK(jnd_decode_force_table(data, &again));  // which refuses what does not rise
}

bool refused(const std::vector<ForcePoint>& points) {
  try {
    (void)fit_force(points);
  } catch (const InputError&) {
    return true;
  }
  return false;
}

double uniform(std::mt19937_64& draw, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(draw);
}

}  // namespace

TEST_CASE("a straight sensor's gain and offset are recovered exactly, with two points") {
  REQUIRE(rc::check("any gain and offset", [] {
    std::mt19937_64 draw(*rc::gen::arbitrary<std::uint64_t>());
    const double gain = uniform(draw, 0.3, 3), offset = uniform(draw, -2, 2);
    const ForceFit fit = fit_force(straight(kUpAndDown, gain, offset));
    RC_ASSERT(fit.table.sensor_n.size() == 2U);
    RC_ASSERT(fit.largest_n < 1e-9);
    RC_ASSERT(fit.hysteresis_n && std::abs(*fit.hysteresis_n) < 1e-9);
    for (double force = -1; force < 8; force += 0.37)  // beyond the ends too
      RC_ASSERT(std::abs(force_of(fit.table, gain * force + offset) - force) < 1e-9);
  }));
}

TEST_CASE("noise of known size leaves a line within its standard error") {
  REQUIRE(rc::check("residuals and slope as noise would have them", [] {
    std::mt19937_64 draw(*rc::gen::arbitrary<std::uint64_t>());
    const double gain = uniform(draw, 0.5, 2), sd_n = 0.02;
    std::normal_distribution<double> noise(0, sd_n);
    std::vector<ForcePoint> points;
    for (int pass = 0; pass < 3; ++pass)
      for (const double force : kUpAndDown) points.push_back(point(force, gain * (force + noise(draw))));
    const ForceFit fit = fit_force(points);
    RC_ASSERT(fit.rms_n > 0.4 * sd_n);
    RC_ASSERT(fit.rms_n < 1.6 * sd_n);
    // The knot at an end may rest on three of the 33 readings alone, and is then known to sd / sqrt(3). Six of those
    // are never reached.
    for (double force = 0; force <= 4.5; force += 0.5)
      RC_ASSERT(std::abs(force_of(fit.table, gain * force) - force) < 6 * sd_n / std::sqrt(3.0));
  }));
}

TEST_CASE("a bent sensor gets a table that bends, and is better for it") {
  std::vector<ForcePoint> points;
  for (int pass = 0; pass < 2; ++pass)
    for (double force = 0; force < 4.6; force += 0.25)
      points.push_back(point(force, force < 2.5 ? force : 2.5 + 0.6 * (force - 2.5)));
  const ForceFit fit = fit_force(points);
  CHECK(fit.table.sensor_n.size() >= 3);
  CHECK(fit.largest_n < 0.08);
  check_rises(fit.table);
}

TEST_CASE("whatever is fitted rises, and is the other way round again") {
  REQUIRE(rc::check("scattered readings", [] {
    std::mt19937_64 draw(*rc::gen::arbitrary<std::uint64_t>());
    std::vector<ForcePoint> points;
    const int count = static_cast<int>(uniform(draw, 3, 30));
    for (int i = 0; i < count; ++i) {
      const double known = uniform(draw, 0, 5);
      points.push_back(point(known, 0.7 * known + uniform(draw, -1.5, 1.5)));
    }
    RC_PRE(!refused(points));
    const ForceFit fit = fit_force(points);
    check_rises(fit.table);
    RC_ASSERT(fit.residuals_n.size() == points.size());
    for (double sensor = -3; sensor < 8; sensor += 0.21)
      RC_ASSERT(std::abs(sensor_of(fit.table, force_of(fit.table, sensor)) - sensor) < 1e-6);
    double last = force_of(fit.table, -3);
    for (double sensor = -2.99; sensor < 8; sensor += 0.01) {
      RC_ASSERT(force_of(fit.table, sensor) > last);
      last = force_of(fit.table, sensor);
    }
  }));
}

TEST_CASE("among all tables with these knots none that rises is nearer") {
  REQUIRE(rc::check("small changes make it worse", [] {
    std::mt19937_64 draw(*rc::gen::arbitrary<std::uint64_t>());
    std::vector<ForcePoint> points;
    for (double known = 0; known < 5; known += 0.4)
      points.push_back(point(known, std::sqrt(known + 0.1) + uniform(draw, -0.2, 0.2)));
    RC_PRE(!refused(points));
    const ForceFit fit = fit_force(points);
    const auto squares = [&](const ForceTable& table) {
      double sum = 0;
      for (const ForcePoint& one : points) sum += std::pow(force_of(table, one.sensor.mean) - one.known_n, 2);
      return sum;
    };
    const double least = squares(fit.table);
    for (int i = 0; i < 200; ++i) {
      ForceTable other = fit.table;
      for (double& force : other.force_n) force += uniform(draw, -0.02, 0.02);
      bool rises = true;
      for (std::size_t k = 1; k < other.force_n.size(); ++k)
        rises = rises && other.force_n[k] - other.force_n[k - 1] >= 0.05 * (other.sensor_n[k] - other.sensor_n[k - 1]);
      if (rises) RC_ASSERT(squares(other) >= least - 1e-12);
    }
  }));
}

TEST_CASE("nonsense is refused") {
  CHECK(refused({}));
  CHECK(refused(straight({0, 1}, 1, 0)));
  CHECK(refused(straight({1, 2, 1, 2, 1}, 1, 0)));             // two known forces only
  CHECK(refused(straight({0, 1, 2, 3}, -1, 0)));               // the wrong way round
  CHECK(refused(straight({0, 1, 2, 3}, 0, 0.4)));              // a dead sensor
  CHECK(refused(straight({0, 102, 204, 306}, 1 / 102.0, 0)));  // grams for newtons
  CHECK(refused(straight({0, 1, 2, NAN}, 1, 0)));
  std::vector<ForcePoint> points = straight({0, 1, 2, 3}, 1, 0);
  points[2].sensor.mean = INFINITY;
  CHECK(refused(points));
  CHECK_FALSE(refused(straight({0, 1, 2}, 1, 0)));
}

TEST_CASE("hysteresis is what lies between going up and coming down") {
  std::vector<ForcePoint> points = straight({0, 2, 4, 2, 0}, 1, 0);
  points[3].sensor.mean = 2.1;  // higher on the way down
  const ForceFit fit = fit_force(points);
  REQUIRE(fit.hysteresis_n);
  CHECK(*fit.hysteresis_n == Approx(-0.1).margin(0.01));
  CHECK_FALSE(fit_force(straight({0, 2, 4}, 1, 0)).hysteresis_n);
}

TEST_CASE("a verdict names what is beyond its limit") {
  const auto bad = [](const std::vector<CalibrationFinding>& findings) {
    std::string names;
    for (const CalibrationFinding& finding : findings)
      if (!finding.ok) names += finding.what + ";";
    return names;
  };
  std::vector<ForcePoint> points = straight(kUpAndDown, 1.1, 0.2);
  CHECK(bad(judge_force(fit_force(points), points, 4.7)).empty());
  points[2].sensor.sd = 0.2;
  points[3].sensor.drift_per_s = -0.2;
  CHECK(bad(judge_force(fit_force(points), points, 4.7)) == "noise of a reading (SD);drift within a reading;");
  points = straight(kUpAndDown, 1.1, 0.2);
  points[8].sensor.mean += 0.4;
  CHECK(bad(judge_force(fit_force(points), points, 4.7)) == "largest residual;hysteresis;");
  points = straight({0, 0.5, 1, 1.5}, 1, 0);
  CHECK(bad(judge_force(fit_force(points), points, 4.7)) == "largest known force;");
  CHECK(calibration_limits_source().find("assumptions") == 0);
}

TEST_CASE("readings of a second become their mean, spread and drift") {
  std::vector<double> times, values;
  for (int i = 0; i < 1000; ++i) {
    times.push_back(0.001 * i);
    values.push_back(2 + 0.3 * 0.001 * i + (i % 2 == 0 ? 0.01 : -0.01));
  }
  const ReadingSummary summary = summarise_readings(times, values);
  CHECK(summary.count == 1000);
  CHECK(summary.mean == Approx(2.15).margin(1e-3));
  CHECK(summary.drift_per_s == Approx(0.3).margin(1e-3));
  CHECK(summary.sd == Approx(std::sqrt(0.09 / 12 + 1e-4)).margin(1e-3));
  CHECK_THROWS_AS(summarise_readings({}, {}), InputError);
}

TEST_CASE("a table of a report and back") {
  const ForceTable table{.sensor_n = {-0.1, 1, 3}, .force_n = {0, 1.25, 3.5}};
  const ForceTable again = from_report(to_report(table));
  CHECK(again.sensor_n == table.sensor_n);
  CHECK(again.force_n == table.force_n);
  CHECK(from_report({}).sensor_n.empty());
  CHECK(force_of({}, 1.5) == 1.5);  // as the sensor says
  CHECK(force_of(table, 4) == Approx(3.5 + 2.25 / 2));
  CHECK(force_of(table, -1.2) == Approx(-1.25));
}

TEST_CASE("a stiffness is the slope of force over depth") {
  std::vector<StiffnessPoint> points;
  for (double depth = 0; depth < 0.0041; depth += 0.001)
    points.push_back({.depth_m = depth, .force = {.mean = 690 * depth + 0.05, .sd = 0, .drift_per_s = 0, .count = 9}});
  const StiffnessFit fit = fit_stiffness(700, points);
  CHECK(fit.slope_n_per_m == Approx(690));
  CHECK(fit.intercept_n == Approx(0.05));
  CHECK(fit.rms_n < 1e-9);
  CHECK(judge_stiffness(fit).ok);
  CHECK_FALSE(judge_stiffness(fit_stiffness(900, points)).ok);
  CHECK_THROWS_AS(fit_stiffness(700, std::span(points).first(2)), InputError);
  for (StiffnessPoint& one : points) one.depth_m = 0.001;
  CHECK_THROWS_AS(fit_stiffness(700, points), InputError);
}
