#include "devices/hid/calibration/calibration.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Dense>
#include <fmt/format.h>

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

// Row: how the height at `sensor` follows from the first knot's height and the rises to each next one.
Eigen::RowVectorXd basis(const std::vector<double>& knots, double sensor) {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(knots.size()));
  row[0] = 1;
  for (std::size_t i = 1; i < knots.size(); ++i) {
    double share = (sensor - knots[i - 1]) / (knots[i] - knots[i - 1]);
    if (i > 1) share = std::max(share, 0.0);                 // below the first knot the first piece goes on
    if (i + 1 < knots.size()) share = std::min(share, 1.0);  // above the last one, the last piece
    row[static_cast<Eigen::Index>(i)] = share;
  }
  return row;
}

struct Candidate {
  ForceTable table;
  double sum_of_squares = kInf;
};

// Least squares with every rise at least its least: the best of all choices of rises held there. At most 2^5 of them.
Candidate fit_rising(const std::vector<double>& knots, std::span<const ForcePoint> points) {
  const auto size = static_cast<Eigen::Index>(knots.size());
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(points.size()), size);
  Eigen::VectorXd known(static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = basis(knots, points[i].sensor.mean);
    known[static_cast<Eigen::Index>(i)] = points[i].known_n;
  }
  Eigen::VectorXd least(size);
  least[0] = 0;
  for (Eigen::Index i = 1; i < size; ++i)
    least[i] = kLeastSlope * (knots[static_cast<std::size_t>(i)] - knots[static_cast<std::size_t>(i) - 1]);

  Candidate best;
  Eigen::VectorXd best_rises;
  for (unsigned held = 0; held < (1U << static_cast<unsigned>(size - 1)); ++held) {
    std::vector<Eigen::Index> free = {0};
    Eigen::VectorXd rises = least;
    for (Eigen::Index i = 1; i < size; ++i)
      if ((held & (1U << static_cast<unsigned>(i - 1))) == 0) free.push_back(i);
    for (const Eigen::Index i : free) rises[i] = 0;
    const Eigen::MatrixXd part = rows(Eigen::all, free);
    const Eigen::VectorXd rest = known - rows * rises;
    const Eigen::VectorXd solved = part.completeOrthogonalDecomposition().solve(rest);
    rises(free) = solved;
    if (((rises - least).tail(size - 1).array() < -1e-12).any()) continue;
    const double sum = (rows * rises - known).squaredNorm();
    if (sum >= best.sum_of_squares) continue;
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
  Eigen::MatrixX2d line(static_cast<Eigen::Index>(points.size()), 2);
  Eigen::VectorXd sensor(static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    line.row(static_cast<Eigen::Index>(i)) << 1, points[i].known_n;
    sensor[static_cast<Eigen::Index>(i)] = points[i].sensor.mean;
  }
  const double gain = line.colPivHouseholderQr().solve(sensor).eval()[1];
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
  const auto n = static_cast<Eigen::Index>(out.count);
  const Eigen::ArrayXd t = Eigen::Map<const Eigen::ArrayXd>(times_s.data(), n);
  const Eigen::ArrayXd y = Eigen::Map<const Eigen::ArrayXd>(values.data(), n);
  out.mean = y.mean();
  const Eigen::ArrayXd from_mean = t - t.mean();
  out.sd = std::sqrt((y - out.mean).square().sum() / static_cast<double>(n - 1));
  const double spread = from_mean.square().sum();
  out.drift_per_s = spread > 0 ? (from_mean * (y - out.mean)).sum() / spread : 0;
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
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::ArrayXd depth(n), force(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    depth[i] = points[static_cast<std::size_t>(i)].depth_m;
    force[i] = points[static_cast<std::size_t>(i)].force.mean;
  }
  if (n < 3 || !depth.allFinite() || !force.allFinite() || !(asked_n_per_m > 0))
    throw InputError(fmt::format("calibration: {} readings of a stiffness of {:g} N/m: at least three are needed", n,
                                 asked_n_per_m));
  const Eigen::ArrayXd from_mean = depth - depth.mean();
  const double spread = from_mean.square().sum();
  if (!(spread > 0)) throw InputError("calibration: all depths of a stiffness are the same: take different ones");
  StiffnessFit fit;
  fit.asked_n_per_m = asked_n_per_m;
  fit.slope_n_per_m = (from_mean * force).sum() / spread;
  fit.intercept_n = force.mean() - fit.slope_n_per_m * depth.mean();
  fit.rms_n = std::sqrt((fit.intercept_n + fit.slope_n_per_m * depth - force).square().mean());
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
