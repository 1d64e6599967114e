#include "jnd_statics.h"

#include <math.h>

#include "jnd_vector.h"

/* Cramer's rule for the matrix of which a, b and c are the columns. */
static void solve_columns(const float a[3], const float b[3], const float c[3], const float r[3], float x[3]) {
  float ab[3], bc[3], ca[3];
  jnd_cross(b, c, bc);
  jnd_cross(c, a, ca);
  jnd_cross(a, b, ab);
  const float determinant = jnd_dot(a, bc);
  x[0] = jnd_dot(r, bc) / determinant;
  x[1] = jnd_dot(r, ca) / determinant;
  x[2] = jnd_dot(r, ab) / determinant;
}

void jnd_solve(float m[3][3], const float r[3], float x[3]) {
  const float a[3] = {m[0][0], m[1][0], m[2][0]};
  const float b[3] = {m[0][1], m[1][1], m[2][1]};
  const float c[3] = {m[0][2], m[1][2], m[2][2]};
  solve_columns(a, b, c, r, x);
}

void jnd_joint_torques(const struct jnd_differential* at, const float wrench[6], float torque_n_m[3]) {
  /* H^T w without the zeros and ones of (17). */
  float load[3] = {wrench[2], wrench[3], wrench[4]};
  for (int column = 1; column < 3; ++column)
    load[column] += at->h[0][column] * wrench[0] + at->h[1][column] * wrench[1] + at->h[5][column] * wrench[5];
  /* J^T tau = load: the rows of J are the columns of J^T. */
  solve_columns(at->j[0], at->j[1], at->j[2], load, torque_n_m);
}

float jnd_force_along(const struct jnd_differential* at, const float torque_n_m[3], float normal_z) {
  /* H's first column is [0, 0, 1, 0, 0, 0]: only the force's z component works in vz. */
  return (at->j[0][0] * torque_n_m[0] + at->j[1][0] * torque_n_m[1] + at->j[2][0] * torque_n_m[2]) / normal_z;
}

void jnd_bound_moment(float wrench[6], float most_n_m) {
  const float moment = sqrtf(jnd_dot(wrench + 3, wrench + 3));
  if (moment <= most_n_m) return;
  for (int i = 3; i < 6; ++i) wrench[i] *= most_n_m / moment;
}

void jnd_stiffness_torques(const struct jnd_differential* at, float translational_n_per_m, float rotational_n_m_per_rad,
                           float most_moment_n_m, const float joint_error_rad[3], float torque_n_m[3]) {
  float j[3][3], chi[3], wrench[6];
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) j[row][column] = at->j[row][column];
  jnd_solve(j, joint_error_rad, chi);
  for (int row = 0; row < 6; ++row)
    wrench[row] = (row < 3 ? translational_n_per_m : rotational_n_m_per_rad) * jnd_dot(at->h[row], chi);
  jnd_bound_moment(wrench, most_moment_n_m);
  jnd_joint_torques(at, wrench, torque_n_m);
}
