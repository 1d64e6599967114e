#include "jnd_render.h"

#include <math.h>

#include "jnd_position.h"
#include "jnd_statics.h"

/* A contact softer than this is none: its surface would lie metres inside. */
static const float softest_n_per_m = 1;

static void press(const struct jnd_here* here, const struct jnd_target* target, float torque_n_m[3]) {
  /* While the platform still turns, a force along n would press harder than |f| along the platform's own normal: the
   * finger must never get more than was commanded. */
  const float share = fminf(1, jnd_normal_z(&here->configuration.platform) / target->normal[2]);
  float wrench[6] = {0};
  for (int i = 0; i < 3; ++i) wrench[i] = target->force_n * share * target->normal[i];
  jnd_joint_torques(&here->differential, wrench, torque_n_m);
}

static bool move(const struct jnd_linkage* linkage, const struct jnd_here* here, const struct jnd_target* target,
                 float torque_n_m[3]) {
  const struct jnd_coordinates xi =
      jnd_pressed_by(linkage, target->force_n / target->stiffness_n_per_m, target->roll_rad, target->pitch_rad);
  struct jnd_platform desired;
  float wrench[6];
  if (!jnd_platform_at(linkage, &xi, &desired)) return false;
  jnd_position_wrench(&here->configuration.platform, &desired, target->stiffness_n_per_m, target->force_n, wrench);
  jnd_bound_moment(wrench, target->most_moment_n_m);
  jnd_joint_torques(&here->differential, wrench, torque_n_m);
  return true;
}

static bool move_joints(const struct jnd_linkage* linkage, const struct jnd_here* here, const struct jnd_target* target,
                        float torque_n_m[3]) {
  float error[3], q[3];
  if (!jnd_reachable_joints(linkage, target->force_n / target->stiffness_n_per_m, target->roll_rad, target->pitch_rad,
                            error))
    return false;
  jnd_joint_angles(&here->configuration, q);
  for (int leg = 0; leg < 3; ++leg) error[leg] -= q[leg];
  jnd_stiffness_torques(&here->differential, target->stiffness_n_per_m, 1e-3F * target->stiffness_n_per_m,
                        target->most_moment_n_m, error, torque_n_m);
  return true;
}

/* Neither presses harder than asked, nor pulls harder than allowed. */
static void bound(const struct jnd_here* here, const struct jnd_target* target, float torque_n_m[3]) {
  const float force = jnd_force_along(&here->differential, torque_n_m, jnd_normal_z(&here->configuration.platform));
  float share = 1;
  if (force > target->force_n) share = target->force_n / force;
  if (force < -target->most_pull_n) share = -target->most_pull_n / force;
  for (int leg = 0; leg < 3; ++leg) torque_n_m[leg] *= share;
}

void jnd_render(const struct jnd_linkage* linkage, const struct jnd_here* here, const struct jnd_target* target,
                struct jnd_actuation* out) {
  const bool position_controlled = (target->mode == JND_MODE_PD || target->mode == JND_MODE_PD_LITERAL) &&
                                   target->stiffness_n_per_m >= softest_n_per_m;
  out->hold_n_per_m = 0;
  for (int leg = 0; leg < 3; ++leg) out->torque_n_m[leg] = 0;
  if (!(target->force_n > 0)) return;
  if (!position_controlled) {
    press(here, target, out->torque_n_m);
    return;
  }
  const bool moved = target->mode == JND_MODE_PD ? move(linkage, here, target, out->torque_n_m)
                                                 : move_joints(linkage, here, target, out->torque_n_m);
  out->hold_n_per_m = target->stiffness_n_per_m;
  if (moved) bound(here, target, out->torque_n_m);
}

bool jnd_tilted_joints(const struct jnd_linkage* linkage, const struct jnd_here* here, float roll_rad, float pitch_rad,
                       float joint_rad[3]) {
  struct jnd_configuration tilted;
  const struct jnd_coordinates xi = {here->xi.pz_m, roll_rad, pitch_rad};
  const bool reached = jnd_configuration_at(linkage, &xi, &tilted);
  jnd_joint_angles(reached ? &tilted : &here->configuration, joint_rad);
  return reached;
}
