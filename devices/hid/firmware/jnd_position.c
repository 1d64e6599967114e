#include "jnd_position.h"

#include <math.h>

#include "jnd_vector.h"

/* Halvings of a displacement in search of the deepest reachable pose: a micrometre of a metre. */
enum { HALVINGS = 20 };

struct jnd_coordinates jnd_pressed_by(const struct jnd_linkage* linkage, float displacement_m, float roll_rad,
                                      float pitch_rad) {
  struct jnd_coordinates xi;
  xi.pz_m = linkage->rest_z_m + displacement_m / (cosf(roll_rad) * cosf(pitch_rad));
  xi.roll_rad = roll_rad;
  xi.pitch_rad = pitch_rad;
  return xi;
}

/* The axis of the turn from `at` to `desired` times its angle. */
static void turn_between(const struct jnd_platform* at, const struct jnd_platform* desired, float out[3]) {
  float q[3][3]; /* Rd R^T */
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) q[row][column] = jnd_dot(desired->rotation[row], at->rotation[column]);
  const float twice[3] = {q[2][1] - q[1][2], q[0][2] - q[2][0], q[1][0] - q[0][1]}; /* 2 sin(angle) axis */
  const float sine = sqrtf(jnd_dot(twice, twice)) / 2, cosine = (q[0][0] + q[1][1] + q[2][2] - 1) / 2;
  const float scale = sine > 1e-6F ? atan2f(sine, cosine) / sine : 1;
  for (int i = 0; i < 3; ++i) out[i] = scale * twice[i] / 2;
}

void jnd_position_wrench(const struct jnd_platform* at, const struct jnd_platform* desired, float stiffness_n_per_m,
                         float most_n, float wrench[6]) {
  const float normal[3] = {at->rotation[0][2], at->rotation[1][2], at->rotation[2][2]};
  float error[3], turn[3];
  for (int i = 0; i < 3; ++i) error[i] = desired->position[i] - at->position[i];
  const float force = fminf(stiffness_n_per_m * jnd_dot(normal, error), most_n);
  turn_between(at, desired, turn);
  for (int i = 0; i < 3; ++i) {
    wrench[i] = force * normal[i];
    wrench[3 + i] = 1e-3F * stiffness_n_per_m * turn[i];
  }
}

bool jnd_reachable_joints(const struct jnd_linkage* linkage, float displacement_m, float roll_rad, float pitch_rad,
                          float joint_rad[3]) {
  float high = displacement_m, low = 0;
  struct jnd_configuration there, deepest;
  struct jnd_coordinates xi = jnd_pressed_by(linkage, high, roll_rad, pitch_rad);
  if (!jnd_configuration_at(linkage, &xi, &deepest)) {
    xi = jnd_pressed_by(linkage, 0, roll_rad, pitch_rad);
    if (!jnd_configuration_at(linkage, &xi, &deepest)) return false;
    for (int i = 0; i < HALVINGS; ++i) {
      const float middle = (low + high) / 2;
      xi = jnd_pressed_by(linkage, middle, roll_rad, pitch_rad);
      if (jnd_configuration_at(linkage, &xi, &there)) {
        deepest = there;
        low = middle;
      } else {
        high = middle;
      }
    }
  }
  jnd_joint_angles(&deepest, joint_rad);
  return true;
}
