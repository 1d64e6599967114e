/* The position-controlled renderings (Chinello et al. 2017, section 4), as devices/rrs3/rrs3_position_control.h: the
 * platform is sent to where the surface would be, with the gain of the rendered stiffness. Pure functions. */
#ifndef JND_POSITION_H
#define JND_POSITION_H

#include "jnd_kinematics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The pose that lies a displacement (m) into the finger, along the platform's normal at that tilt. */
struct jnd_coordinates jnd_pressed_by(const struct jnd_linkage* linkage, float displacement_m, float roll_rad,
                                      float pitch_rad);

/* w = Kd [n n^T (pd - p); rotvec(Rd R^T)]: its force along n is at most most_n, and negative where the platform lies
 * deeper than desired. kphi is kS read as N mm/rad. The turn between the two must be well below half a turn. */
void jnd_position_wrench(const struct jnd_platform* at, const struct jnd_platform* desired, float stiffness_n_per_m,
                         float most_n, float wrench[6]);

/* The joint angles of a pose that is so many metres into the finger, or of the deepest before it that the legs reach.
 * False where the tilt alone is out of reach. */
bool jnd_reachable_joints(const struct jnd_linkage* linkage, float displacement_m, float roll_rad, float pitch_rad,
                          float joint_rad[3]);

#ifdef __cplusplus
}
#endif

#endif
