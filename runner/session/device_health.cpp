#include "runner/session/device_health.h"

namespace jnd {

namespace {

// Others are an end of the presentation that was asked for, or the participant's doing.
bool of_the_devices(Fault fault) {
  return fault != Fault::none && fault != Fault::no_contact && fault != Fault::emergency_stop &&
         fault != Fault::interrupted;
}

}  // namespace

DeviceHealth health_of(const LoopSnapshot& snapshot) {
  DeviceHealth health;
  health.presenting = true;
  health.contact = snapshot.contact;
  health.elapsed_s = snapshot.elapsed_s;
  health.rate_hz = snapshot.elapsed_s > 0 ? static_cast<double>(snapshot.ticks) / snapshot.elapsed_s : 0;
  health.lateness_max_us = snapshot.lateness_max_us;
  return health;
}

DeviceHealth health_of(const Presentation& presentation) {
  DeviceHealth health;
  health.rate_hz = presentation.duration_s > 0 ? static_cast<double>(presentation.ticks) / presentation.duration_s : 0;
  health.lateness_max_us = presentation.lateness_max_us;
  if (of_the_devices(presentation.fault)) health.fault = to_string(presentation.fault);
  return health;
}

}  // namespace jnd
