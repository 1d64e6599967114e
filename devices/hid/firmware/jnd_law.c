#include "jnd_law.h"

#include <math.h>

#include "jnd_vector.h"

struct jnd_own_limits jnd_own_limits_of(const struct jnd_limits* limits, uint16_t watchdog_ms) {
  struct jnd_own_limits own;
  own.most_force_n = (float)limits->most_force_un * 1e-6F;
  own.most_stiffness_n_per_m = (float)limits->most_stiffness_mn_per_m * 1e-3F;
  own.most_damping_n_s_per_m = (float)limits->most_damping_cn_s_per_m * 1e-2F;
  own.most_rise_n_per_s = (float)limits->most_force_rise_mn_per_s * 1e-3F;
  own.lowest_m = (float)limits->lowest_height_nm * 1e-9F;
  own.highest_m = (float)limits->highest_height_nm * 1e-9F;
  own.most_roll_rad = (float)limits->most_roll_dmrad * 1e-4F;
  own.most_pitch_rad = (float)limits->most_pitch_dmrad * 1e-4F;
  own.least_vibration_g = (float)limits->least_vibration_mg * 1e-3F;
  own.most_vibration_g = (float)limits->most_vibration_mg * 1e-3F;
  own.least_vibration_hz = (float)limits->least_vibration_dhz * 0.1F;
  own.most_vibration_hz = (float)limits->most_vibration_dhz * 0.1F;
  own.most_temperature_c = (float)limits->most_temperature_cdeg * 1e-2F;
  own.most_burst_us = (uint32_t)limits->most_burst_ms * 1000U;
  own.soft_start_us = (uint32_t)limits->soft_start_ms * 1000U;
  own.watchdog_us = (uint32_t)watchdog_ms * 1000U;
  return own;
}

/* A force that the host rounded to reports' units and allowed as such is not called limited. */
static const float rounding_n = 2e-5F;

/* The smaller of the two; the bit tells that it was not the asked one. */
static float at_most(float asked, float most, uint16_t bit, uint16_t* limits) {
  if (asked <= most) return asked;
  *limits = (uint16_t)(*limits | bit);
  return most;
}

float jnd_law_stiffness(const struct jnd_own_limits* own, const struct jnd_command* command, uint16_t* limits) {
  return at_most((float)command->stiffness_mn_per_m * 1e-3F, own->most_stiffness_n_per_m, JND_LIMIT_STIFFNESS, limits);
}

bool jnd_law_normal(const struct jnd_command* command, float normal[3], uint16_t* limits) {
  const float one = 1.0F / (float)JND_NORMAL_ONE;
  for (int i = 0; i < 3; ++i) normal[i] = (float)command->normal[i] * one;
  const float length = sqrtf(jnd_dot(normal, normal));
  if (!(fabsf(length - 1) <= 1e-3F) || !(normal[2] > 0)) {
    *limits = (uint16_t)(*limits | JND_LIMIT_DIRECTION);
    return false;
  }
  for (int i = 0; i < 3; ++i) normal[i] /= length;
  return true;
}

float jnd_law_force(const struct jnd_own_limits* own, const struct jnd_command* command,
                    const struct jnd_law_input* input, uint16_t* limits) {
  if (!command->touching) return 0;
  const float stiffness = jnd_law_stiffness(own, command, limits);
  const float damping =
      at_most((float)command->damping_cn_s_per_m * 1e-2F, own->most_damping_n_s_per_m, JND_LIMIT_STIFFNESS, limits);
  float force = stiffness * ((float)command->penetration_nm * 1e-9F) +
                damping * ((float)command->penetration_rate_um_per_s * 1e-6F);
  if (!(force > 0)) return 0;
  const float most = fminf((float)command->most_force_un * 1e-6F, own->most_force_n);
  if (force > most + rounding_n) *limits |= JND_LIMIT_FORCE;
  force = fminf(force, most);
  if (input->since_us < own->soft_start_us) {
    const float share = (float)(uint32_t)input->since_us / (float)own->soft_start_us;
    force = at_most(force, share * own->most_force_n, JND_LIMIT_SOFT_START, limits);
  }
  if (!input->in_workspace) {
    *limits = (uint16_t)(*limits | JND_LIMIT_WORKSPACE);
    return 0;
  }
  float normal[3];
  if (!jnd_law_normal(command, normal, limits)) return 0;
  return at_most(force, input->previous_n + own->most_rise_n_per_s * input->elapsed_s, JND_LIMIT_RISE, limits);
}

void jnd_law_tilt(const struct jnd_own_limits* own, const struct jnd_command* command, float* roll_rad,
                  float* pitch_rad, uint16_t* limits) {
  const float roll = (float)command->roll_dmrad * 1e-4F, pitch = (float)command->pitch_dmrad * 1e-4F;
  *roll_rad = jnd_clip(roll, -own->most_roll_rad, own->most_roll_rad);
  *pitch_rad = jnd_clip(pitch, -own->most_pitch_rad, own->most_pitch_rad);
  if (*roll_rad != roll || *pitch_rad != pitch) *limits = (uint16_t)(*limits | JND_LIMIT_TILT);
}
