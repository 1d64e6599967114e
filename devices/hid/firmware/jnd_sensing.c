/* What the sensors say, and whether it can be. */
#include <math.h>

#include "jnd_fingertip_state.h"

enum { LEAST_BATTERY_PERCENT = 5 };

uint16_t jnd_sensor_faults(const struct jnd_own_limits* own, const struct jnd_sensors* sensors) {
  uint16_t faults = 0;
  const bool numbers = isfinite(sensors->joint_rad[0]) && isfinite(sensors->joint_rad[1]) &&
                       isfinite(sensors->joint_rad[2]) && isfinite(sensors->force_n) &&
                       isfinite(sensors->vibration_g) && !isinf(sensors->temperature_c);
  const bool battery = sensors->battery_percent <= 100 || sensors->battery_percent == JND_BATTERY_NONE;
  if (!sensors->ok || !numbers || !battery) faults |= JND_FAULT_SENSOR;
  if (sensors->temperature_c > own->most_temperature_c) faults |= JND_FAULT_TEMPERATURE; /* never where it is NAN */
  if (sensors->battery_percent < LEAST_BATTERY_PERCENT) faults |= JND_FAULT_BATTERY;
  if (sensors->stop_button) faults |= JND_FAULT_BUTTON;
  return faults;
}
