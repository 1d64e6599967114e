/* A platform of 5 g on a pulp of 1000 N/m, critically damped, that turns at once: just enough of a finger for the
 * firmware to press. And the board around it: jnd_hardware filled in, on simulated time. */
#ifndef PLANT_H
#define PLANT_H

#include "../jnd_fingertip.h"
#include "../jnd_kinematics.h"

struct plant {
  struct jnd_linkage linkage;
  float compression_m, velocity_m_per_s, roll_rad, pitch_rad;
  struct jnd_sensors sensors;
  struct jnd_actuation actuation;
  uint64_t now_us;
  struct jnd_telemetry telemetry; /* the last that was sent */
  unsigned told, damaged;         /* reports sent: telemetry, and what was none */
  uint8_t memory[128];
  size_t kept;
};

void plant_begin(struct plant* self, const struct jnd_geometry* geometry);
struct jnd_hardware plant_hardware(struct plant* self);

/* A millisecond under the last actuation. False where the platform left its reach. */
bool plant_advance(struct plant* self);

#endif
