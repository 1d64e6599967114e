/* Statics of the platform by virtual work (Chinello et al. 2017, (23)..(26), (35)); see devices/rrs3/rrs3_statics.h.
 * w = [f, m] is what the platform does to the finger: N and N m. Torques N m. Pure functions. */
#ifndef JND_STATICS_H
#define JND_STATICS_H

#include "jnd_kinematics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* (26): tau = J^-T H^T w. */
void jnd_joint_torques(const struct jnd_differential* at, const float wrench[6], float torque_n_m[3]);

/* The force along a unit direction, of which `normal_z` is the z component, that the torques put on a finger which
 * takes no moment. */
float jnd_force_along(const struct jnd_differential* at, const float torque_n_m[3], float normal_z);

/* Shortens the moment of a wrench to at most so many N m. The force along the normal does not depend on it. */
void jnd_bound_moment(float wrench[6], float most_n_m);

/* (35) times a joint error: J^-T H^T Kd H J^-1 e, Kd = diag(kS, kS, kS, kphi, kphi, kphi), with the moment of the
 * wrench bounded. */
void jnd_stiffness_torques(const struct jnd_differential* at, float translational_n_per_m, float rotational_n_m_per_rad,
                           float most_moment_n_m, const float joint_error_rad[3], float torque_n_m[3]);

/* x of M x = r, M by rows. Not finite where M is singular. */
void jnd_solve(float m[3][3], const float r[3], float x[3]);

#ifdef __cplusplus
}
#endif

#endif
