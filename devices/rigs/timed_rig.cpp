#include "devices/rigs/timed_rig.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace jnd {
namespace {

constexpr double kReach_s = 0.7;               // of a simulated participant, until the first contact
constexpr std::int64_t kLook_ns = 50'000'000;  // between two looks at the stop

}  // namespace

Presentation TimedRig::present(const PresentRequest& request) {
  Presentation presentation;
  const std::int64_t begin = clock_.now_ns();
  const double reach_s = info_.simulated ? kReach_s : 0;
  const std::int64_t end = begin + std::llround(1e9 * (reach_s + request.explore_s));
  while (clock_.now_ns() < end && !stop.latched()) {
    clock_.sleep_until_ns(std::min(end, clock_.now_ns() + kLook_ns));
    if (look_) look_({.elapsed_s = static_cast<double>(clock_.now_ns() - begin) * 1e-9});
  }
  presentation.duration_s = static_cast<double>(clock_.now_ns() - begin) * 1e-9;
  if (stop.latched()) {
    presentation.fault = Fault::emergency_stop;
    presentation.stopped_by = to_string(stop.source());
    return presentation;
  }
  if (request.tap_g > 0) return presentation;
  presentation.first_contact_s = reach_s;
  if (info_.simulated) presentation.delivered = request.stimulus.stiffness;
  return presentation;
}

RigInfo timed_rig_info(const RigRequest& rig, bool simulated) {
  return {.name = simulated ? fmt::format("{} (not there: simulated)", rig.device) : rig.device,
          .mode = "",
          .tracker = "",
          .sha256 = "",
          .simulated = simulated};
}

}  // namespace jnd
