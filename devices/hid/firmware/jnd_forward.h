/* Forward kinematics: which pose the joint angles stand for. Newton's method from a pose that is known to be near, as
 * devices/rrs3/rrs3_kinematics.h; it never crosses a parallel singularity. */
#ifndef JND_FORWARD_H
#define JND_FORWARD_H

#include "jnd_kinematics.h"

#ifdef __cplusplus
extern "C" {
#endif

/* xi: the pose to start at, and the pose found, with its configuration. False, and nothing changed, where none is
 * found within 16 tries. */
bool jnd_forward(const struct jnd_linkage* linkage, const float joint_rad[3], struct jnd_coordinates* xi,
                 struct jnd_configuration* configuration, struct jnd_differential* differential);

#ifdef __cplusplus
}
#endif

#endif
