/* A 3RRS fingertip device: takes commands, keeps its own limits and watchdog, closes the platform's loop, tells how it
 * is. Portable C11 without heap, operating system or global state; single-precision arithmetic.
 *
 *   power-up:            jnd_fingertip_init
 *   an output report:    jnd_fingertip_receive, from the same thread or interrupt level as the step
 *   each loop period:    jnd_fingertip_step
 */
#ifndef JND_FINGERTIP_H
#define JND_FINGERTIP_H

#include "jnd_hardware.h"
#include "jnd_report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the maker of a device fixes. Identity's calibration fields are those of a device that never stored any. */
struct jnd_fingertip_config {
  struct jnd_identity identity;
  struct jnd_limits limits;
  struct jnd_geometry geometry;
};

/* The 3RRS device of Chinello et al. 2017 with the geometry and limits of devices/specs/rrs3.json. serial: 1 to 16
 * printable characters. */
struct jnd_fingertip_config jnd_fingertip_default_config(const char* serial, enum jnd_finger finger);

struct jnd_fingertip; /* jnd_fingertip_state.h shows what is in it, so that it can be a static variable */

/* False where the configuration breaks the ranges of its pages, has no watchdog, or a geometry that cannot hold its
 * rest pose: the device then stays stopped with JND_FAULT_INTERNAL, and still answers. Calls load, nothing else. */
bool jnd_fingertip_init(struct jnd_fingertip* self, const struct jnd_fingertip_config* config,
                        const struct jnd_hardware* hardware);
void jnd_fingertip_receive(struct jnd_fingertip* self, const uint8_t* bytes, size_t count);
void jnd_fingertip_step(struct jnd_fingertip* self);

#ifdef __cplusplus
}
#endif

#endif
