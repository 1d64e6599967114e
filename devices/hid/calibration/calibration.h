// The calibration of a device's force: known forces beside the sensor's own figures in, the table that corrects the
// sensor and a verdict out. And of its stiffness: force over depth. Pure functions; they throw InputError where the
// readings cannot be those of a working device.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "devices/hid/firmware/jnd_report.h"

namespace jnd {

// A second of readings, in a few figures.
struct ReadingSummary {
  double mean = 0;
  double sd = 0;           // of the readings about their mean
  double drift_per_s = 0;  // slope of a straight line through them
  int count = 0;
};
// Times in s, as many as values; at least two readings.
ReadingSummary summarise_readings(std::span<const double> times_s, std::span<const double> values);

// The force on the finger by the sensor's own figure: straight lines between points, the first and the last drawn on.
// Both columns rise. Fewer than two points: as the sensor says.
struct ForceTable {
  std::vector<double> sensor_n, force_n;
};
double force_of(const ForceTable& table, double sensor_n) noexcept;
double sensor_of(const ForceTable& table, double force_n) noexcept;  // the other way round
ForceTable from_report(const jnd_force_table& table);
jnd_force_table to_report(const ForceTable& table);  // rounded to 1 uN

// One point of a force calibration, in the order in which they were taken.
struct ForcePoint {
  double known_n = 0;     // by the reference
  ReadingSummary sensor;  // N, by the sensor's own figure
};

struct ForceFit {
  ForceTable table;
  std::vector<double> residuals_n;  // fitted minus known, by point
  double rms_n = 0, largest_n = 0;
  // Fitted force going up minus going down at the same known force, the largest by size; none where no known force was
  // met both ways.
  std::optional<double> hysteresis_n;
};

// The table of 2 to 6 points that fits best by least squares while it rises everywhere. The number of points is that
// of the least corrected Akaike criterion, so that a table bends only where the readings ask for it; a level at least
// is left over for the residuals to mean something. At least three points at three known forces.
ForceFit fit_force(std::span<const ForcePoint> points);

// One line of a verdict.
struct CalibrationFinding {
  std::string what, unit;
  double value = 0, limit = 0;  // limit: at most; of the range, at least
  bool ok = false;
};

// Largest error of a calibrated force, as a share of full scale. An assumption: no published limit was found. Of 4.7 N
// it is 0.094 N, a seventh of the force that one JND (208.5 N/m, Chinello et al. 2017) makes at 3 mm.
inline constexpr double kMostForceError = 0.02;
// Least range of the known forces, as a share of full scale: an assumption, beyond which a table is drawn on for long.
inline constexpr double kLeastForceRange = 0.5;
// Largest relative error of a rendered stiffness. An assumption: at 700 N/m it is 35 N/m, a sixth of that JND.
inline constexpr double kMostStiffnessError = 0.05;
std::string calibration_limits_source();  // the above, in words for a certificate

// Residuals, hysteresis, noise and drift of single readings, range. full_scale_n: the most that the device gives.
std::vector<CalibrationFinding> judge_force(const ForceFit& fit, std::span<const ForcePoint> points,
                                            double full_scale_n);

// Force at a commanded depth.
struct StiffnessPoint {
  double depth_m = 0;
  ReadingSummary force;  // N, calibrated
};
struct StiffnessFit {
  double asked_n_per_m = 0;
  double slope_n_per_m = 0, intercept_n = 0;
  double rms_n = 0;  // of the residuals
  double relative_error() const noexcept { return slope_n_per_m / asked_n_per_m - 1; }
};
// A straight line by least squares. At least three points at different depths.
StiffnessFit fit_stiffness(double asked_n_per_m, std::span<const StiffnessPoint> points);
CalibrationFinding judge_stiffness(const StiffnessFit& fit);

}  // namespace jnd
