/* From the device's state to what it tells. */
#include <math.h>

#include "jnd_fingertip_state.h"

/* The nearest whole number of units within a range; what is none becomes `low`. */
static int32_t whole(float value, float units, int32_t low, int32_t high) {
  const float scaled = value * units;
  if (!(scaled > (float)low)) return low;
  return scaled < (float)high ? (int32_t)lroundf(scaled) : high;
}

static int16_t dmrad(float value_rad) {
  return (int16_t)whole(value_rad, 1e4F, INT16_MIN, INT16_MAX);
}

static uint16_t command_age_us(const struct jnd_fingertip* self) {
  if (!self->commanded || self->command_us > self->step_us) return JND_COMMAND_AGE_NONE;
  const uint64_t age = self->step_us - self->command_us;
  return age < JND_COMMAND_AGE_NONE ? (uint16_t)age : (uint16_t)JND_COMMAND_AGE_NONE;
}

struct jnd_telemetry jnd_telemetry_of(const struct jnd_fingertip* self) {
  const struct jnd_sensors* sensors = &self->sensors;
  const struct jnd_platform* platform = &self->here.configuration.platform;
  struct jnd_telemetry out;
  out.state = self->state;
  out.buttons = sensors->buttons;
  out.sequence = self->sequence;
  out.command_sequence = self->commanded ? self->command.sequence : 0;
  out.time_us = self->step_us;
  for (int leg = 0; leg < 3; ++leg) out.joint_urad[leg] = whole(sensors->joint_rad[leg], 1e6F, INT32_MIN, INT32_MAX);
  out.force_un = whole(jnd_calibrated_n(&self->calibration.table, sensors->force_n), 1e6F, INT32_MIN, INT32_MAX);
  out.height_nm = whole(self->here.xi.pz_m, 1e9F, INT32_MIN, INT32_MAX);
  out.roll_dmrad = dmrad(self->here.xi.roll_rad);
  out.pitch_dmrad = dmrad(self->here.xi.pitch_rad);
  out.yaw_dmrad = dmrad(atan2f(platform->sin_yaw, platform->cos_yaw));
  out.vibration_mg = (uint16_t)whole(sensors->vibration_g, 1e3F, 0, UINT16_MAX);
  out.faults = self->faults;
  out.limits = self->limits;
  out.rejected = self->rejected;
  out.command_age_us = command_age_us(self);
  out.temperature_cdeg = isfinite(sensors->temperature_c)
                             ? (int16_t)whole(sensors->temperature_c, 1e2F, INT16_MIN + 1, INT16_MAX)
                             : (int16_t)JND_TEMPERATURE_NONE;
  out.battery_percent = sensors->battery_percent;
  return out;
}
