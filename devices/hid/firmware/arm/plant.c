#include "plant.h"

#include <math.h>
#include <string.h>

#include "../jnd_statics.h"

enum { SUBSTEPS = 20 };
static const float pulp_n_per_m = 1000, mass_kg = 0.005F, substep_s = 1e-3F / SUBSTEPS;

static bool pose(const struct plant* self, struct jnd_configuration* at, struct jnd_differential* rates) {
  const struct jnd_coordinates xi = {
      self->linkage.rest_z_m + self->compression_m / (cosf(self->roll_rad) * cosf(self->pitch_rad)), self->roll_rad,
      self->pitch_rad};
  return jnd_configuration_at(&self->linkage, &xi, at) && jnd_differential_at(&self->linkage, at, rates);
}

void plant_begin(struct plant* self, const struct jnd_geometry* geometry) {
  struct jnd_configuration at;
  struct jnd_differential rates;
  memset(self, 0, sizeof *self);
  self->linkage = jnd_linkage_of(geometry);
  self->sensors.ok = true;
  self->sensors.temperature_c = 30;
  self->sensors.battery_percent = JND_BATTERY_NONE;
  if (pose(self, &at, &rates)) jnd_joint_angles(&at, self->sensors.joint_rad);
}

bool plant_advance(struct plant* self) {
  struct jnd_configuration at;
  struct jnd_differential rates;
  self->now_us += 1000;
  if (!pose(self, &at, &rates)) return false;
  const float force = jnd_force_along(&rates, self->actuation.torque_n_m, jnd_normal_z(&at.platform));
  const float hold = self->actuation.hold_n_per_m, from_m = self->compression_m;
  const float damping = 2 * sqrtf(mass_kg * (pulp_n_per_m + hold));
  for (int i = 0; i < SUBSTEPS; ++i) {
    const float net = force - hold * (self->compression_m - from_m) - pulp_n_per_m * self->compression_m -
                      damping * self->velocity_m_per_s;
    self->velocity_m_per_s += net / mass_kg * substep_s;
    self->compression_m += self->velocity_m_per_s * substep_s;
    if (self->compression_m < 0) self->compression_m = self->velocity_m_per_s = 0;
  }
  self->roll_rad = self->actuation.roll_rad;
  self->pitch_rad = self->actuation.pitch_rad;
  if (!pose(self, &at, &rates)) return false;
  jnd_joint_angles(&at, self->sensors.joint_rad);
  self->sensors.force_n = pulp_n_per_m * self->compression_m;
  self->sensors.vibration_g = self->actuation.vibration_g;
  return true;
}

/* -- the board --------------------------------------------------------------------------------------------------- */

static uint64_t time_us(void* context) {
  return ((struct plant*)context)->now_us;
}

static void read(void* context, struct jnd_sensors* sensors) {
  *sensors = ((struct plant*)context)->sensors;
}

static void actuate(void* context, const struct jnd_actuation* actuation) {
  ((struct plant*)context)->actuation = *actuation;
}

static bool send(void* context, const uint8_t report[64]) {
  struct plant* self = context;
  struct jnd_answer answer;
  if (jnd_decode_telemetry(report, JND_REPORT_SIZE, &self->telemetry) == JND_DECODE_OK)
    ++self->told;
  else if (jnd_decode_answer(report, JND_REPORT_SIZE, &answer) != JND_DECODE_OK)
    ++self->damaged;
  return true;
}

static bool load(void* context, void* bytes, size_t count) {
  const struct plant* self = context;
  if (count > sizeof self->memory || self->kept != count) return false;
  memcpy(bytes, self->memory, count);
  return true;
}

static bool store(void* context, const void* bytes, size_t count) {
  struct plant* self = context;
  if (count > sizeof self->memory) return false;
  memcpy(self->memory, bytes, count);
  self->kept = count;
  return true;
}

struct jnd_hardware plant_hardware(struct plant* self) {
  const struct jnd_hardware hardware = {self, time_us, read, actuate, send, load, store};
  return hardware;
}
