#include "jnd_burst.h"

#include "jnd_vector.h"

void jnd_burst_command(struct jnd_burst* self, const struct jnd_command* command) {
  if (command->vibration_mg == 0 || command->mode == JND_MODE_REST) self->asked_off = true;
}

void jnd_burst_step(struct jnd_burst* self, const struct jnd_own_limits* own, const struct jnd_command* command,
                    uint64_t now_us, float* vibration_g, float* vibration_hz, uint16_t* limits) {
  *vibration_g = *vibration_hz = 0;
  if (self->asked_off && self->running) {
    self->running = self->asked_off = false;
    return;
  }
  self->asked_off = false;
  if (command->vibration_mg == 0) return;
  if (!self->running) {
    self->running = true;
    self->begun_us = now_us;
  }
  if (now_us - self->begun_us >= own->most_burst_us) {
    *limits = (uint16_t)(*limits | JND_LIMIT_BURST);
    return;
  }
  const float g = (float)command->vibration_mg * 1e-3F, hz = (float)command->vibration_dhz * 0.1F;
  *vibration_g = jnd_clip(g, own->least_vibration_g, own->most_vibration_g);
  *vibration_hz = jnd_clip(hz, own->least_vibration_hz, own->most_vibration_hz);
  if (*vibration_g != g || *vibration_hz != hz) *limits = (uint16_t)(*limits | JND_LIMIT_VIBRATION);
}
