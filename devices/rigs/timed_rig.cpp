#include "devices/rigs/timed_rig.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace jnd {
namespace {

constexpr double kReach_s = 0.7;               // of a simulated participant, until the first contact
constexpr double kPress_s = 1;                 // of theirs, from one contact to the next
constexpr std::int64_t kLook_ns = 50'000'000;  // between two looks at the stop

}  // namespace

Presentation TimedRig::present(const PresentRequest& request) {
  Presentation presentation;
  const std::int64_t begin = clock_.now_ns();
  const double reach_s = info_.simulated ? kReach_s : 0;
  const double felt_s =
      request.contacts > 0 ? std::min(request.explore_s, kPress_s * request.contacts) : request.explore_s;
  const std::int64_t touched = begin + std::llround(1e9 * reach_s), end = touched + std::llround(1e9 * felt_s);
  while (clock_.now_ns() < end && !stop.latched()) {
    if (request.enough && clock_.now_ns() >= touched && request.enough()) break;
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
