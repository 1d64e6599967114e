#include "protocols/device_lint.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "analysis/normal.h"
#include "protocols/protocol_reading.h"

namespace jnd {
namespace {

constexpr double kPressSd_m = 0.001;
constexpr double kPressPeriod_s = 1;
constexpr double kToldShare = 0.05;  // rarer saturation is not worth a warning
constexpr double kUsablePressShare = 0.25;

class Lint {
 public:
  Lint(const Protocol& protocol, const DeviceSpec& spec, const std::string& file)
      : protocol_(protocol), spec_(spec), file_(file) {
    if (!protocol.bytes.empty()) root_ = parse_json(protocol.bytes, file);
  }

  DeviceLint run() {
    for (std::size_t i = 0; i < protocol_.series.size(); ++i) {
      const std::string path = fmt::format("$.series[{}].pair", i);
      const auto& pair = protocol_.series[i].pair_n_per_m;
      for (std::size_t j = 0; j < 2; ++j) {
        if (pair[j] > spec_.max_stiffness_n_per_m) {
          error(fmt::format("{}[{}]", path, j),
                fmt::format("{} N/m is more than the {} renders stably, {} N/m", plain(pair[j]), spec_.name,
                            plain(spec_.max_stiffness_n_per_m)),
                "take a softer sphere");
        }
      }
      look_at_forces(path, pair);
      look_at_vibrations(path, pair);
    }
    warn_about_forces();
    warn_about_vibrations();
    return std::move(lint_);
  }

 private:
  void error(const std::string& path, std::string message, std::string suggestion) {
    lint_.errors.push_back(diagnostic_at_path(root_, file_, path, std::move(message), std::move(suggestion)));
  }
  void warn(const std::string& path, std::string message, std::string suggestion) {
    lint_.warnings.push_back(diagnostic_at_path(root_, file_, path, std::move(message), std::move(suggestion)));
  }

  double clamped_g(double stiffness) const {
    return std::clamp(burst_amplitude_g(stiffness), spec_.min_vibration_g, spec_.max_vibration_g);
  }

  bool any(bool (*wanted)(const Cues&)) const {
    return std::any_of(protocol_.conditions.begin(), protocol_.conditions.end(),
                       [wanted](const Condition& condition) { return wanted(condition.cues); });
  }

  // Only the force limit is felt where even the softer sphere reaches it early in the press.
  void look_at_forces(const std::string& path, const std::array<double, 2>& pair) {
    const double softer = std::min(pair[0], pair[1]);
    const double usable = depth_at_force_limit_m(softer, spec_);
    if (usable >= kUsablePressShare * protocol_.stimulus.expected_press_m) return;
    for (const Condition& condition : protocol_.conditions) {
      if (!condition.cues.force || condition.cues.vibration) continue;
      error(
          path,
          fmt::format(
              "in condition {} both spheres reach the force limit of {} N within {:.2f} mm of a {:.1f} mm press: they "
              "would feel the same",
              condition.name, plain(spec_.max_force_n), 1e3 * usable, 1e3 * protocol_.stimulus.expected_press_m),
          "take softer spheres");
    }
  }

  void look_at_vibrations(const std::string& path, const std::array<double, 2>& pair) {
    if (clamped_g(pair[0]) != clamped_g(pair[1])) return;
    for (const Condition& condition : protocol_.conditions) {
      if (!condition.cues.vibration || condition.cues.force) continue;
      error(path,
            fmt::format(
                "in condition {} both spheres vibrate with {} g ({:.3f} and {:.3f} g asked): they would feel the same",
                condition.name, plain(clamped_g(pair[0])), burst_amplitude_g(pair[0]), burst_amplitude_g(pair[1])),
            fmt::format("the {} gives {} to {} g: take stiffnesses whose k/1500 + 0.4 lies within", spec_.name,
                        plain(spec_.min_vibration_g), plain(spec_.max_vibration_g)));
    }
  }

  std::set<double> stiffnesses() const {
    std::set<double> all;
    for (const Series& series : protocol_.series) all.insert(series.pair_n_per_m.begin(), series.pair_n_per_m.end());
    return all;
  }

  void warn_about_forces() {
    if (!any([](const Cues& cues) { return cues.force; })) return;
    std::string numbers;
    double worst = 0;
    for (const double stiffness : stiffnesses()) {
      const double share = expected_saturated_intervals(stiffness, protocol_, spec_);
      worst = std::max(worst, share);
      numbers += fmt::format("{}{} N/m at {:.2f} mm, in {:.0f} % of intervals", numbers.empty() ? "" : "; ",
                             plain(stiffness), 1e3 * depth_at_force_limit_m(stiffness, spec_), 100 * share);
    }
    if (worst <= kToldShare) return;
    const bool repeats = protocol_.stimulus.on_saturation == OnSaturation::repeat;
    warn("$.stimulus.expected_press_m",
         fmt::format("presses of {:.1f} +- 1 mm reach the {}'s limit of {} N: {}",
                     1e3 * protocol_.stimulus.expected_press_m, spec_.name, plain(spec_.max_force_n), numbers),
         repeats ? "\"on_saturation\": \"repeat\" would void these trials, mostly stiff ones, and bias the study: "
                   "write \"flag\""
                 : "recorded for every interval; the delivered stiffness is fitted on unsaturated samples");
  }

  void warn_about_vibrations() {
    if (!any([](const Cues& cues) { return cues.vibration; })) return;
    std::string numbers;
    for (const double stiffness : stiffnesses()) {
      if (clamped_g(stiffness) == burst_amplitude_g(stiffness)) continue;
      numbers += fmt::format("{}{} N/m asks {:.3f} g and gets {} g", numbers.empty() ? "" : "; ", plain(stiffness),
                             burst_amplitude_g(stiffness), plain(clamped_g(stiffness)));
    }
    if (numbers.empty()) return;
    warn("$.series",
         fmt::format("vibrations are clamped to {} to {} g: {}", plain(spec_.min_vibration_g),
                     plain(spec_.max_vibration_g), numbers),
         "flagged in every interval");
  }

  const Protocol& protocol_;
  const DeviceSpec& spec_;
  const std::string& file_;
  JsonNode root_;
  DeviceLint lint_;
};

}  // namespace

double depth_at_force_limit_m(double stiffness_n_per_m, const DeviceSpec& spec) noexcept {
  return spec.max_force_n / stiffness_n_per_m;
}

double expected_saturated_intervals(double stiffness_n_per_m, const Protocol& protocol,
                                    const DeviceSpec& spec) noexcept {
  const double presses = std::max(1.0, std::floor(protocol.timeline.explore_s / kPressPeriod_s)) *
                         static_cast<double>(protocol.rig.fingers.size());
  const double margin = depth_at_force_limit_m(stiffness_n_per_m, spec) - protocol.stimulus.expected_press_m;
  return 1 - std::pow(normal_cdf(margin / kPressSd_m), presses);
}

double burst_amplitude_g(double stiffness_n_per_m) noexcept {
  return stiffness_n_per_m / 1500 + 0.4;
}

DeviceLint lint_against_device(const Protocol& protocol, const DeviceSpec& spec, const std::string& file) {
  return Lint(protocol, spec, file).run();
}

}  // namespace jnd
