#include "runner/device_health.h"

#include <algorithm>

namespace jnd {

DeviceHealth health_of(const LoopGlimpse& glimpse) {
  DeviceHealth health;
  health.rate_hz = glimpse.elapsed_s > 0 ? static_cast<double>(glimpse.ticks) / glimpse.elapsed_s : 0;
  health.lateness_p99_us = glimpse.lateness_p99_us;
  health.lateness_max_us = glimpse.lateness_max_us;
  health.force_n = glimpse.force_n;
  health.force_cap_n = glimpse.force_cap_n;
  return health;
}

DeviceHealth health_of(const Presentation& presentation) {
  DeviceHealth health;
  health.rate_hz = presentation.duration_s > 0 ? static_cast<double>(presentation.ticks) / presentation.duration_s : 0;
  health.lateness_p99_us = presentation.lateness_p99_us;
  health.lateness_max_us = presentation.lateness_max_us;
  for (const FingerPresentation& finger : presentation.fingers)
    health.force_n = std::max(health.force_n, finger.peak_force_n);
  if (presentation.fault != Fault::none) health.fault = to_string(presentation.fault);
  return health;
}

}  // namespace jnd
