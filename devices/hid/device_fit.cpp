#include "devices/hid/device_fit.h"

#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace jnd {

namespace {

class Shortcomings {
 public:
  // part: one step of the page's field, by which a limit may have been rounded.
  void at_least(std::string_view what, std::string_view unit, double has, double needed, double part) {
    if (has < needed - part) add(fmt::format("{} up to {:.6g} {}, needed {:.6g}", what, has, unit, needed));
  }
  void at_most(std::string_view what, std::string_view unit, double has, double needed, double part) {
    if (has > needed + part) add(fmt::format("{} from {:.6g} {}, needed {:.6g}", what, has, unit, needed));
  }
  void add(const std::string& one) { text_ += (text_.empty() ? "" : "; ") + one; }
  const std::string& text() const noexcept { return text_; }

 private:
  std::string text_;
};

}  // namespace

std::string shortcomings(const DeviceSpec& spec, bool damps, const jnd_identity& identity, const jnd_limits& limits) {
  Shortcomings found;
  if (identity.model != JND_MODEL_RRS3) found.add(fmt::format("it is no 3RRS device (model {})", identity.model));
  const unsigned can = identity.capabilities;
  if ((can & JND_CAN_FORCE) == 0) found.add("it renders no force");
  if ((can & JND_CAN_TILT) == 0) found.add("it does not tilt");
  if ((can & JND_CAN_VIBRATE) == 0) found.add("it does not vibrate");
  if (damps && (can & JND_CAN_DAMP) == 0) found.add("it renders no viscosity, which the protocol asks for");
  if (identity.watchdog_ms == 0 || identity.watchdog_ms > kLongestWatchdog_ms)
    found.add(identity.watchdog_ms == 0 ? std::string("it has no watchdog")
                                        : fmt::format("its watchdog waits {} ms, at most {} is safe",
                                                      identity.watchdog_ms, kLongestWatchdog_ms));
  found.at_least("force", "N", 1e-6 * limits.most_force_un, spec.max_force_n, 1e-6);
  found.at_least("stiffness", "N/m", 1e-3 * limits.most_stiffness_mn_per_m, spec.max_stiffness, 1e-3);
  found.at_least("roll", "rad", 1e-4 * limits.most_roll_dmrad, spec.max_roll_rad, 1e-4);
  found.at_least("pitch", "rad", 1e-4 * limits.most_pitch_dmrad, spec.max_pitch_rad, 1e-4);
  found.at_most("height", "m", 1e-9 * limits.lowest_height_nm, spec.lowest_travel, 1e-9);
  found.at_least("height", "m", 1e-9 * limits.highest_height_nm, spec.highest_travel, 1e-9);
  found.at_most("vibration", "g", 1e-3 * limits.least_vibration_mg, spec.min_vibration_g, 1e-3);
  found.at_least("vibration", "g", 1e-3 * limits.most_vibration_mg, spec.max_vibration_g, 1e-3);
  found.at_most("vibration", "Hz", 0.1 * limits.least_vibration_dhz, spec.min_vibration_hz, 0.1);
  found.at_least("vibration", "Hz", 0.1 * limits.most_vibration_dhz, spec.max_vibration_hz, 0.1);
  return found.text();
}

}  // namespace jnd
