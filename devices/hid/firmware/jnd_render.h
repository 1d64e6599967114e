/* From a force to what the actuators get: the three modes of rendering, as devices/rrs3/rrs3_device.cpp. */
#ifndef JND_RENDER_H
#define JND_RENDER_H

#include "jnd_hardware.h"
#include "jnd_kinematics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where the platform is. */
struct jnd_here {
  struct jnd_coordinates xi;
  struct jnd_configuration configuration;
  struct jnd_differential differential;
};

/* What the platform should do. */
struct jnd_target {
  enum jnd_mode mode;
  float force_n; /* >= 0 */
  float normal[3];
  float stiffness_n_per_m;
  float roll_rad, pitch_rad;
  /* A platform that lies too deep is drawn back no harder, and one that lies askew is turned no harder. */
  float most_pull_n, most_moment_n_m;
};

/* Torques and hold of `out`; the rest of it is left alone. Never presses harder than force_n. */
void jnd_render(const struct jnd_linkage* linkage, const struct jnd_here* here, const struct jnd_target* target,
                struct jnd_actuation* out);

/* The joint angles of a tilt at the present height. False, with the present ones, where the legs do not reach it. */
bool jnd_tilted_joints(const struct jnd_linkage* linkage, const struct jnd_here* here, float roll_rad, float pitch_rad,
                       float joint_rad[3]);

#ifdef __cplusplus
}
#endif

#endif
