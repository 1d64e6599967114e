/* Vibration within the motor's range, and never longer than a burst. */
#ifndef JND_BURST_H
#define JND_BURST_H

#include "jnd_law.h"

#ifdef __cplusplus
extern "C" {
#endif

struct jnd_burst {
  bool running;      /* a burst was begun, and the host has not yet asked for 0 */
  bool asked_off;    /* it has, since the last step */
  uint64_t begun_us; /* device clock */
};

/* For every accepted command, so that a 0 between two steps is not missed. */
void jnd_burst_command(struct jnd_burst* self, const struct jnd_command* command);

/* Each step: what the motor gets. A new burst begins one step after the old one ended at the earliest. */
void jnd_burst_step(struct jnd_burst* self, const struct jnd_own_limits* own, const struct jnd_command* command,
                    uint64_t now_us, float* vibration_g, float* vibration_hz, uint16_t* limits);

#ifdef __cplusplus
}
#endif

#endif
