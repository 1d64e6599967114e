#include "devices/hid/calibration/calibration.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "analysis/numerics/box_newton.h"
#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "protocols/input/input_error.h"

namespace jnd {

namespace {

// Gains between force and sensor that a working device has: beyond, units or cables are mistaken.
constexpr double kLeastGain = 0.2, kMostGain = 5;
// Least slope of the table: it must rise, and a flat piece would say nothing about the force.
constexpr double kLeastSlope = 0.05;
// Residuals below this are as good as none, N: far below any force sensor's noise.
constexpr double kFineResidual_n = 1e-4;

// Sensor figures by known force: the mean of each level.
std::map<double, double> levels_of(std::span<const ForcePoint> points) {
  std::map<double, std::pair<double, int>> sums;
  for (const ForcePoint& point : points) {
    auto& [sum, count] = sums[point.known_n];
    sum += point.sensor.mean;
    ++count;
  }
  std::map<double, double> levels;
  for (const auto& [known, sum] : sums) levels[known] = sum.first / sum.second;
  return levels;
}

// Where the table may bend: at levels, evenly among them. Empty where `count` of them lie too close together.
std::vector<double> knots_among(std::vector<double> levels, std::size_t count) {
  std::sort(levels.begin(), levels.end());
  const double least_gap = 0.01 * (levels.back() - levels.front());
  std::vector<double> knots;
  for (std::size_t i = 0; i < count; ++i) {
    const double place = static_cast<double>(i * (levels.size() - 1)) / static_cast<double>(count - 1);
    const double knot = levels[static_cast<std::size_t>(std::lround(place))];
    if (!knots.empty() && knot - knots.back() < least_gap) return {};
    knots.push_back(knot);
  }
  return knots;
}

// The line of least squares through places and values; flat where all places are the same.
struct Line {
  double slope = 0, intercept = 0;
};
Line line_through(std::span<const double> places, std::span<const double> values) {
  const double middle = moments(places).mean, mean = moments(values).mean;
  double products = 0, spread = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    products += (places[i] - middle) * (values[i] - mean);
    spread += (places[i] - middle) * (places[i] - middle);
  }
  const double slope = spread > 0 ? products / spread : 0;
  return {slope, mean - slope * middle};
}

// How the height at `sensor` follows from the first knot's height and the rises to each next one.
std::vector<double> basis(const std::vector<double>& knots, double sensor) {
  std::vector<double> row = {1};
  for (std::size_t i = 1; i < knots.size(); ++i) {
    double share = (sensor - knots[i - 1]) / (knots[i] - knots[i - 1]);
    if (i > 1) share = std::max(share, 0.0);                 // below the first knot the first piece goes on
    if (i + 1 < knots.size()) share = std::min(share, 1.0);  // above the last one, the last piece
    row.push_back(share);
  }
  return row;
}

struct Candidate {
  ForceTable table;
  double sum_of_squares = kInf;
};

// Least squares with every rise at least its least: the best of all choices of rises held there. At most 2^5 of them.
Candidate fit_rising(const std::vector<double>& knots, std::span<const ForcePoint> points) {
  std::vector<std::vector<double>> rows;
  for (const ForcePoint& point : points) rows.push_back(basis(knots, point.sensor.mean));
  std::vector<double> least = {0};
  for (std::size_t i = 1; i < knots.size(); ++i) least.push_back(kLeastSlope * (knots[i] - knots[i - 1]));
  const auto left = [&](std::size_t point, const std::vector<double>& rises) {
    return std::inner_product(rises.begin(), rises.end(), rows[point].begin(), -points[point].known_n);
  };

  Candidate best;
  std::vector<double> best_rises;
  for (unsigned held = 0; held < 1U << (knots.size() - 1); ++held) {
    std::vector<double> rises = least;
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < knots.size(); ++i)
      if (((held << 1U) & (1U << i)) == 0) {
        rises[i] = 0;
        free.push_back(i);
      }
    std::vector<double> squares(free.size() * free.size()), solved(free.size());
    for (std::size_t point = 0; point < points.size(); ++point)
      for (std::size_t i = 0; i < free.size(); ++i) {
        solved[i] -= rows[point][free[i]] * left(point, rises);
        for (std::size_t j = 0; j < free.size(); ++j)
          squares[i * free.size() + j] += rows[point][free[i]] * rows[point][free[j]];
      }
    if (!solve_positive_definite(squares, solved)) continue;
    for (std::size_t i = 0; i < free.size(); ++i) rises[free[i]] = solved[i];
    bool rising = true;
    for (std::size_t i = 1; i < knots.size(); ++i) rising = rising && rises[i] - least[i] >= -1e-12;
    double sum = 0;
    for (std::size_t point = 0; point < points.size(); ++point) sum += std::pow(left(point, rises), 2);
    if (!rising || sum >= best.sum_of_squares) continue;
    best.sum_of_squares = sum;
    best_rises = rises;
  }
  best.table.sensor_n = knots;
  double height = 0;
  for (const double rise : best_rises) best.table.force_n.push_back(height += rise);
  return best;
}

// Akaike's criterion, corrected for few readings; `count` knots and the noise are fitted.
std::optional<double> criterion(double sum_of_squares, std::size_t readings, std::size_t count) {
  const auto n = static_cast<double>(readings), k = static_cast<double>(count + 1);
  if (n - k - 1 <= 0) return std::nullopt;
  const double square = std::max(sum_of_squares / n, kFineResidual_n * kFineResidual_n);
  return n * std::log(square) + 2 * k + 2 * k * (k + 1) / (n - k - 1);
}

std::optional<double> hysteresis_of(std::span<const ForcePoint> points, const ForceTable& table) {
  struct Ways {
    double sum[2] = {0, 0};
    int count[2] = {0, 0};
  };
  std::map<double, Ways> levels;
  int way = 0;  // 0: up
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0 && points[i].known_n != points[i - 1].known_n) way = points[i].known_n < points[i - 1].known_n ? 1 : 0;
    Ways& ways = levels[points[i].known_n];
    ways.sum[way] += force_of(table, points[i].sensor.mean);
    ++ways.count[way];
  }
  std::optional<double> largest;
  for (const auto& [known, ways] : levels) {
    if (ways.count[0] == 0 || ways.count[1] == 0) continue;
    const double difference = ways.sum[0] / ways.count[0] - ways.sum[1] / ways.count[1];
    if (!largest || std::abs(difference) > std::abs(*largest)) largest = difference;
  }
  return largest;
}

void check_readings(std::span<const ForcePoint> points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!std::isfinite(points[i].known_n) || !std::isfinite(points[i].sensor.mean))
      throw InputError(fmt::format("calibration: point {} is not a finite number: take it again", i + 1));
  const std::map<double, double> levels = levels_of(points);
  if (points.size() < 3 || levels.size() < 3)
    throw InputError(fmt::format("calibration: {} point{} at {} known force{}: at least three of three are needed",
                                 points.size(), points.size() == 1 ? "" : "s", levels.size(),
                                 levels.size() == 1 ? "" : "s"));
  std::vector<double> known, sensor;
  for (const ForcePoint& point : points) {
    known.push_back(point.known_n);
    sensor.push_back(point.sensor.mean);
  }
  const double gain = line_through(known, sensor).slope;
  if (!(gain >= kLeastGain && gain <= kMostGain))
    throw InputError(
        fmt::format("calibration: the sensor shows {:.3g} N for each known newton, where {:g} to {:g} can be: look "
                    "whether the known forces are in newtons and the reference really presses on the device",
                    gain, kLeastGain, kMostGain));
}

std::size_t piece_of(const std::vector<double>& column, double value) noexcept {
  std::size_t i = 1;
  while (i + 1 < column.size() && value > column[i]) ++i;
  return i;
}

double along(const std::vector<double>& from, const std::vector<double>& to, double value) noexcept {
  if (from.size() < 2) return value;
  const std::size_t i = piece_of(from, value);
  return to[i - 1] + (value - from[i - 1]) * (to[i] - to[i - 1]) / (from[i] - from[i - 1]);
}

}  // namespace

ReadingSummary summarise_readings(std::span<const double> times_s, std::span<const double> values) {
  ReadingSummary out;
  out.count = static_cast<int>(std::min(times_s.size(), values.size()));
  if (out.count < 2) throw InputError("calibration: fewer than two readings: the device tells nothing");
  const auto n = static_cast<std::size_t>(out.count);
  const Moments of_values = moments(values.first(n));
  out.mean = of_values.mean;
  out.sd = of_values.sd;
  out.drift_per_s = line_through(times_s.first(n), values.first(n)).slope;
  return out;
}

double force_of(const ForceTable& table, double sensor_n) noexcept {
  return along(table.sensor_n, table.force_n, sensor_n);
}

double sensor_of(const ForceTable& table, double force_n) noexcept {
  return along(table.force_n, table.sensor_n, force_n);
}

ForceTable from_report(const jnd_force_table& table) {
  ForceTable out;
  for (std::size_t i = 0; i < table.points; ++i) {
    out.sensor_n.push_back(table.sensor_un[i] / 1e6);
    out.force_n.push_back(table.force_un[i] / 1e6);
  }
  return out;
}

jnd_force_table to_report(const ForceTable& table) {
  jnd_force_table out{};
  const std::size_t points = std::min<std::size_t>(table.sensor_n.size(), JND_FORCE_POINTS);
  out.points = static_cast<std::uint8_t>(points);
  for (std::size_t i = 0; i < points; ++i) {
    out.sensor_un[i] = static_cast<std::int32_t>(std::lround(1e6 * table.sensor_n[i]));
    out.force_un[i] = static_cast<std::int32_t>(std::lround(1e6 * table.force_n[i]));
  }
  return out;
}

ForceFit fit_force(std::span<const ForcePoint> points) {
  check_readings(points);
  std::vector<double> levels;
  for (const auto& [known, sensor] : levels_of(points)) levels.push_back(sensor);
  Candidate chosen = fit_rising(knots_among(levels, 2), points);
  std::optional<double> least = criterion(chosen.sum_of_squares, points.size(), 2);
  for (std::size_t count = 3; count <= JND_FORCE_POINTS && count < levels.size(); ++count) {
    const std::vector<double> knots = knots_among(levels, count);
    if (knots.empty()) continue;
    const Candidate candidate = fit_rising(knots, points);
    const std::optional<double> value = criterion(candidate.sum_of_squares, points.size(), count);
    if (!value || !least || *value >= *least) continue;
    least = value;
    chosen = candidate;
  }
  ForceFit fit;
  fit.table = chosen.table;
  double sum = 0;
  for (const ForcePoint& point : points) {
    const double residual = force_of(fit.table, point.sensor.mean) - point.known_n;
    fit.residuals_n.push_back(residual);
    sum += residual * residual;
    fit.largest_n = std::max(fit.largest_n, std::abs(residual));
  }
  fit.rms_n = std::sqrt(sum / static_cast<double>(points.size()));
  fit.hysteresis_n = hysteresis_of(points, fit.table);
  return fit;
}

// What a calibration is worth: its residuals against stated limits.

std::string calibration_limits_source() {
  return fmt::format(
      "assumptions, as no published limits were found: force within {:g} % of full scale, of 4.7 N a seventh of the "
      "force that one JND (208.5 N/m, Chinello et al. 2017) makes at 3 mm; known forces up to at least {:g} % of full "
      "scale; stiffness within {:g} %, at 700 N/m a sixth of that JND",
      100 * kMostForceError, 100 * kLeastForceRange, 100 * kMostStiffnessError);
}

std::vector<CalibrationFinding> judge_force(const ForceFit& fit, std::span<const ForcePoint> points,
                                            double full_scale_n) {
  const double most = kMostForceError * full_scale_n;
  double noise = 0, drift = 0, range = 0;
  for (const ForcePoint& point : points) {
    noise = std::max(noise, point.sensor.sd);
    drift = std::max(drift, std::abs(point.sensor.drift_per_s));
    range = std::max(range, point.known_n);
  }
  const auto at_most = [](const char* what, const char* unit, double value, double limit) {
    return CalibrationFinding{.what = what, .unit = unit, .value = value, .limit = limit, .ok = value <= limit};
  };
  std::vector<CalibrationFinding> findings = {at_most("largest residual", "N", fit.largest_n, most)};
  if (fit.hysteresis_n) findings.push_back(at_most("hysteresis", "N", std::abs(*fit.hysteresis_n), most));
  findings.push_back(at_most("noise of a reading (SD)", "N", noise, most));
  findings.push_back(at_most("drift within a reading", "N/s", drift, most));
  const double least = kLeastForceRange * full_scale_n;
  findings.push_back(
      {.what = "largest known force", .unit = "N", .value = range, .limit = least, .ok = range >= least});
  return findings;
}

StiffnessFit fit_stiffness(double asked_n_per_m, std::span<const StiffnessPoint> points) {
  std::vector<double> depth, force;
  bool finite = asked_n_per_m > 0;
  for (const StiffnessPoint& point : points) {
    depth.push_back(point.depth_m);
    force.push_back(point.force.mean);
    finite = finite && std::isfinite(point.depth_m) && std::isfinite(point.force.mean);
  }
  if (points.size() < 3 || !finite)
    throw InputError(fmt::format("calibration: {} readings of a stiffness of {:g} N/m: at least three are needed",
                                 points.size(), asked_n_per_m));
  const auto [least, most] = std::minmax_element(depth.begin(), depth.end());
  if (*least == *most) throw InputError("calibration: all depths of a stiffness are the same: take different ones");
  StiffnessFit fit;
  fit.asked_n_per_m = asked_n_per_m;
  const Line line = line_through(depth, force);
  fit.slope_n_per_m = line.slope;
  fit.intercept_n = line.intercept;
  double sum = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) sum += std::pow(line.intercept + line.slope * depth[i] - force[i], 2);
  fit.rms_n = std::sqrt(sum / static_cast<double>(depth.size()));
  return fit;
}

CalibrationFinding judge_stiffness(const StiffnessFit& fit) {
  const double error = std::abs(fit.relative_error());
  return {.what = fmt::format("error of {:g} N/m", fit.asked_n_per_m),
          .unit = "%",
          .value = 100 * error,
          .limit = 100 * kMostStiffnessError,
          .ok = error <= kMostStiffnessError};
}

}  // namespace jnd
