/* Kinematics of the 3RRS platform (Chinello et al. 2017, section 3) in single precision: the same equations, frames and
 * corrections of misprints as devices/rrs3/rrs3_kinematics.h, which says where they come from.
 *
 * Frame S0 (fixed on the finger): z dorsal, the platform below, so pz < 0, and pressing means pz increasing.
 * R = Rz(yaw) Ry(pitch) Rx(roll). Lengths m, angles rad. Pure functions. */
#ifndef JND_KINEMATICS_H
#define JND_KINEMATICS_H

#include <stdbool.h>

#include "jnd_report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The lengths, and what follows from them once. Elements are legs. */
struct jnd_linkage {
  float a_m, b_m, bh_m, bd_m, l1_m, l2_m, rest_z_m;
  float cos_azimuth[3], sin_azimuth[3];
  float joint_x_m[3], joint_y_m[3]; /* of the platform joints, in the platform's plane */
};

/* xi: the three coordinates that the device controls. */
struct jnd_coordinates {
  float pz_m, roll_rad, pitch_rad;
};

/* The platform with the yaw and the shift that come with the coordinates: (1)..(3). */
struct jnd_platform {
  float rotation[3][3]; /* R, platform to S0; the normal is column 2 */
  float position[3];    /* p */
  float sin_yaw, cos_yaw;
};

struct jnd_configuration {
  struct jnd_platform platform;
  float platform_joint[3][3]; /* b_i, by leg */
  float knee[3][2];           /* of the platform joints in the leg's plane, from its base joint: radial, z */
  float link[3][2];           /* of the elbows, the same */
};

/* q' = J chi and [v, w] = H chi, chi = [vz, wx, wy]. */
struct jnd_differential {
  float h[6][3]; /* (17) */
  float j[3][3]; /* (22) */
};

struct jnd_linkage jnd_linkage_of(const struct jnd_geometry* geometry);

/* Whether the legs reach it or not. False beyond a quarter turn of tilt, or where a coordinate is no number. */
bool jnd_platform_at(const struct jnd_linkage* linkage, const struct jnd_coordinates* xi, struct jnd_platform* out);

/* False where a leg cannot reach as well. */
bool jnd_configuration_at(const struct jnd_linkage* linkage, const struct jnd_coordinates* xi,
                          struct jnd_configuration* out);

/* (6), (7). */
void jnd_joint_angles(const struct jnd_configuration* at, float joint_rad[3]);

/* (11)..(22). False at a singularity. */
bool jnd_differential_at(const struct jnd_linkage* linkage, const struct jnd_configuration* at,
                         struct jnd_differential* out);

/* The normal's share along z; never zero for a pose that jnd_platform_at gives. */
static inline float jnd_normal_z(const struct jnd_platform* platform) {
  return platform->rotation[2][2];
}

#ifdef __cplusplus
}
#endif

#endif
