#include "jnd_kinematics.h"

#include <math.h>

#include "jnd_vector.h"

/* Relative size below which a determinant or a lever counts as zero: above rounding (1e-7), below any pose that a
 * device could hold. */
static const float singular = 1e-5F;

static float metres(uint32_t nm) {
  return (float)nm * 1e-9F;
}

struct jnd_linkage jnd_linkage_of(const struct jnd_geometry* geometry) {
  struct jnd_linkage out;
  out.a_m = metres(geometry->a_nm);
  out.b_m = metres(geometry->b_nm);
  out.bh_m = metres(geometry->bh_nm);
  out.bd_m = metres(geometry->bd_nm);
  out.l1_m = metres(geometry->l1_nm);
  out.l2_m = metres(geometry->l2_nm);
  out.rest_z_m = (float)geometry->rest_height_nm * 1e-9F;
  const float half = out.bd_m / 2, radius = sqrtf(half * half + out.bh_m * out.bh_m);
  out.cos_azimuth[0] = 1;
  out.sin_azimuth[0] = 0;
  out.joint_x_m[0] = out.b_m;
  out.joint_y_m[0] = 0;
  for (int leg = 1; leg < 3; ++leg) {
    const float side = leg == 1 ? -half : half;
    out.cos_azimuth[leg] = -out.bh_m / radius;
    out.sin_azimuth[leg] = side / radius;
    out.joint_x_m[leg] = -out.bh_m;
    out.joint_y_m[leg] = side;
  }
  return out;
}

bool jnd_platform_at(const struct jnd_linkage* linkage, const struct jnd_coordinates* xi, struct jnd_platform* out) {
  const float sr = sinf(xi->roll_rad), cr = cosf(xi->roll_rad);
  const float sp = sinf(xi->pitch_rad), cp = cosf(xi->pitch_rad);
  /* (1), general: tan(yaw) = (bd^2/4) sin(pitch) sin(roll) / (bh (b + bh) cos(pitch) + (bd^2/4) cos(roll)). */
  const float square = linkage->bd_m * linkage->bd_m / 4;
  const float rise = square * sp * sr;
  const float run = linkage->bh_m * (linkage->b_m + linkage->bh_m) * cp + square * cr;
  if (!(run > 0) || !(cr > 0) || !(cp > 0) || !isfinite(xi->pz_m)) return false;
  const float length = sqrtf(rise * rise + run * run);
  const float sy = rise / length, cy = run / length;
  const float rotation[3][3] = {{cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr},
                                {sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr},
                                {-sp, cp * sr, cp * cr}};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) out->rotation[row][column] = rotation[row][column];
  out->sin_yaw = sy;
  out->cos_yaw = cy;
  /* (2), (3), exact. */
  out->position[0] = linkage->bh_m * (rotation[0][0] - rotation[1][1]);
  out->position[1] = -linkage->b_m * rotation[1][0];
  out->position[2] = xi->pz_m;
  return true;
}

static bool reach(const struct jnd_linkage* linkage, int leg, struct jnd_configuration* out) {
  /* (4); B_i lies in the platform's plane. */
  for (int axis = 0; axis < 3; ++axis)
    out->platform_joint[leg][axis] = out->platform.position[axis] +
                                     out->platform.rotation[axis][0] * linkage->joint_x_m[leg] +
                                     out->platform.rotation[axis][1] * linkage->joint_y_m[leg];
  const float* joint = out->platform_joint[leg];
  const float radial = joint[0] * linkage->cos_azimuth[leg] + joint[1] * linkage->sin_azimuth[leg] - linkage->a_m;
  const float z = joint[2];
  /* The triangle base joint, elbow, platform joint: the elbow at `along` the line s and `across` it, outward. The
   * root is factored, so that a leg near its stretch keeps its digits. */
  const float squared = radial * radial + z * z, length = sqrtf(squared);
  const float l1 = linkage->l1_m, l2 = linkage->l2_m;
  const float along = (squared + (l1 - l2) * (l1 + l2)) / 2;                                               /* |s| x */
  const float across4 = (l1 + l2 - length) * (length + l1 + l2) * (length + l2 - l1) * (length + l1 - l2); /* 16 A^2 */
  if (!(across4 >= 0) || !(squared > 0)) return false;
  const float across = sqrtf(across4) / 2;
  out->knee[leg][0] = radial;
  out->knee[leg][1] = z;
  out->link[leg][0] = (along * radial - across * z) / squared;
  out->link[leg][1] = (along * z + across * radial) / squared;
  return true;
}

bool jnd_configuration_at(const struct jnd_linkage* linkage, const struct jnd_coordinates* xi,
                          struct jnd_configuration* out) {
  if (!jnd_platform_at(linkage, xi, &out->platform)) return false;
  for (int leg = 0; leg < 3; ++leg)
    if (!reach(linkage, leg, out)) return false;
  return true;
}

void jnd_joint_angles(const struct jnd_configuration* at, float joint_rad[3]) {
  for (int leg = 0; leg < 3; ++leg) {
    const float* s = at->knee[leg];
    const float* link = at->link[leg];
    /* alpha of (7) with its sign, and delta as the angle from s to the elbow: accurate where its cosine is near 1. */
    /* It is 0..pi: of a folded leg rounding must not make it -pi. */
    const float across = s[0] * link[1] - s[1] * link[0];
    joint_rad[leg] = atan2f(s[1], s[0]) + atan2f(across > 0 ? across : 0, s[0] * link[0] + s[1] * link[1]);
  }
}

/* (9): u . v + w . (r x u) = 0 with r = b - p, for each leg; split as in (14) into chi and [vx, vy, wz]. */
static bool solve_constraints(const struct jnd_linkage* linkage, const struct jnd_configuration* at,
                              struct jnd_differential* out) {
  float ux[3], uy[3], turn[3], about_x[3], about_y[3], r0[3], r1[3], r2[3];
  for (int leg = 0; leg < 3; ++leg) {
    const float* joint = at->platform_joint[leg];
    const float* p = at->platform.position;
    ux[leg] = linkage->sin_azimuth[leg];
    uy[leg] = -linkage->cos_azimuth[leg];
    turn[leg] = (joint[0] - p[0]) * uy[leg] - (joint[1] - p[1]) * ux[leg];
    about_x[leg] = -(joint[2] - p[2]) * uy[leg];
    about_y[leg] = (joint[2] - p[2]) * ux[leg];
  }
  jnd_cross(uy, turn, r0);
  jnd_cross(turn, ux, r1);
  jnd_cross(ux, uy, r2);
  const float determinant = jnd_dot(ux, r0);
  if (!(fabsf(determinant) > singular * linkage->b_m)) return false;
  const float scale = -1 / determinant;
  const float h[6][3] = {{0, scale * jnd_dot(r0, about_x), scale * jnd_dot(r0, about_y)},
                         {0, scale * jnd_dot(r1, about_x), scale * jnd_dot(r1, about_y)},
                         {1, 0, 0},
                         {0, 1, 0},
                         {0, 0, 1},
                         {0, scale * jnd_dot(r2, about_x), scale * jnd_dot(r2, about_y)}};
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 3; ++column) out->h[row][column] = h[row][column];
  return true;
}

bool jnd_differential_at(const struct jnd_linkage* linkage, const struct jnd_configuration* at,
                         struct jnd_differential* out) {
  if (!solve_constraints(linkage, at, out)) return false;
  for (int leg = 0; leg < 3; ++leg) {
    const float* knee = at->knee[leg];
    const float* link = at->link[leg];
    const float along = knee[0] - link[0], z = knee[1] - link[1];
    const float distal[3] = {along * linkage->cos_azimuth[leg], along * linkage->sin_azimuth[leg], z}; /* b - d */
    float arm[3], turning[3];
    for (int axis = 0; axis < 3; ++axis) arm[axis] = at->platform_joint[leg][axis] - at->platform.position[axis];
    jnd_cross(arm, distal, turning);
    /* (20), signs corrected: E = [(b-d)^T, ((b-p) x (b-d))^T]; F = (b-d) . (u x (d-a)), here in the leg's plane. */
    const float lever = knee[1] * link[0] - knee[0] * link[1];
    if (!(fabsf(lever) > singular * linkage->l1_m * linkage->l2_m)) return false;
    out->j[leg][0] = z / lever;
    for (int column = 1; column < 3; ++column)
      out->j[leg][column] = (distal[0] * out->h[0][column] + distal[1] * out->h[1][column] + turning[column - 1] +
                             turning[2] * out->h[5][column]) /
                            lever;
  }
  const float determinant = out->j[0][0] * (out->j[1][1] * out->j[2][2] - out->j[1][2] * out->j[2][1]) -
                            out->j[1][0] * (out->j[0][1] * out->j[2][2] - out->j[0][2] * out->j[2][1]) +
                            out->j[2][0] * (out->j[0][1] * out->j[1][2] - out->j[0][2] * out->j[1][1]);
  return fabsf(determinant) * linkage->b_m > singular && isfinite(determinant);
}
