/* What is in a struct jnd_fingertip, so that it can be a static variable. Nothing but the firmware's own files looks
 * into it. */
#ifndef JND_FINGERTIP_STATE_H
#define JND_FINGERTIP_STATE_H

#include "jnd_burst.h"
#include "jnd_calibration.h"
#include "jnd_fingertip.h"
#include "jnd_law.h"
#include "jnd_render.h"

#ifdef __cplusplus
extern "C" {
#endif

struct jnd_fingertip {
  struct jnd_fingertip_config config;
  struct jnd_hardware hardware;
  struct jnd_own_limits own;
  struct jnd_linkage linkage;
  struct jnd_calibration calibration;
  float rest_joint_rad[3];
  bool sound; /* the configuration is one that can be run */

  uint8_t state;     /* enum jnd_state */
  uint16_t faults;   /* latched */
  uint16_t standing; /* found in the last step */
  uint16_t limits;   /* that acted in the last step */

  struct jnd_command command; /* the last accepted one */
  uint64_t command_us;        /* when it came */
  bool commanded;             /* there was one */
  uint16_t rejected;

  uint64_t active_us; /* when it became active */
  uint64_t step_us;   /* of the last step */
  bool stepped;       /* there was one */
  float force_n;      /* that the law gave in the last step */
  struct jnd_burst burst;

  struct jnd_sensors sensors; /* the last that were plausible, with the latest buttons, temperature and battery */
  struct jnd_here here;       /* the last pose that was one */
  uint32_t sequence;          /* of the last telemetry */

  uint8_t answer[JND_REPORT_SIZE]; /* waiting for room */
  bool answer_waits;
};

/* What the device tells: the telemetry of this step. */
struct jnd_telemetry jnd_telemetry_of(const struct jnd_fingertip* self);

/* The causes of faults in what the sensors say: bits of jnd_fault_bit. */
uint16_t jnd_sensor_faults(const struct jnd_own_limits* own, const struct jnd_sensors* sensors);

#ifdef __cplusplus
}
#endif

#endif
