// What a calibration is worth: its residuals against stated limits.
#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "devices/hid/calibration/calibration.h"
#include "protocols/input/input_error.h"

namespace jnd {

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
