/* The law of force and the device's own limits on it: PROTOCOL.md, "The law of force". Pure functions; SI units. */
#ifndef JND_LAW_H
#define JND_LAW_H

#include "jnd_report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The limits and identity pages in the units that the device calculates with. */
struct jnd_own_limits {
  float most_force_n, most_stiffness_n_per_m, most_damping_n_s_per_m, most_rise_n_per_s;
  float lowest_m, highest_m, most_roll_rad, most_pitch_rad;
  float least_vibration_g, most_vibration_g, least_vibration_hz, most_vibration_hz;
  float most_temperature_c;
  uint32_t most_burst_us, soft_start_us, watchdog_us;
};
struct jnd_own_limits jnd_own_limits_of(const struct jnd_limits* limits, uint16_t watchdog_ms);

/* What the law is worked out with, besides the command. */
struct jnd_law_input {
  float previous_n;  /* the force of the step before */
  float elapsed_s;   /* since then */
  uint64_t since_us; /* since the device became active */
  bool in_workspace;
};

/* The command's stiffness within the device's own, N/m; the limit's bit is added to `limits`. */
float jnd_law_stiffness(const struct jnd_own_limits* own, const struct jnd_command* command, uint16_t* limits);

/* The command's normal, of length 1. False, with the limit's bit, where it is no unit vector to 1e-3, or pulls. */
bool jnd_law_normal(const struct jnd_command* command, float normal[3], uint16_t* limits);

/* The force along the normal, N, 0..most_force_n; the bits of what limited it are added to `limits`. */
float jnd_law_force(const struct jnd_own_limits* own, const struct jnd_command* command,
                    const struct jnd_law_input* input, uint16_t* limits);

/* Roll and pitch as the command asks, within the limits. */
void jnd_law_tilt(const struct jnd_own_limits* own, const struct jnd_command* command, float* roll_rad,
                  float* pitch_rad, uint16_t* limits);

#ifdef __cplusplus
}
#endif

#endif
