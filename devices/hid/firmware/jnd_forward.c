#include "jnd_forward.h"

#include <math.h>

#include "jnd_statics.h"

/* Poses looked at in one search. From the last pose it takes 2 or 3, from rest to anywhere in the limits up to 15. */
enum { MOST_POSES = 16 };
/* Single precision resolves some 2e-7 rad of a joint: a nanometre or two of the platform. */
static const float solved_rad = 3e-7F;
/* Where no step improves any more: rounding, also of a leg near its stretch. */
static const float rounding_rad = 2e-5F;
/* Farthest that one step goes, so that no other assembly is jumped to. */
static const float longest_tilt_rad = 0.2F;
static const float longest_lift = 0.3F; /* of the platform's radius b */
static const float whole_turn_rad = 6.283185307F;

struct iterate {
  struct jnd_coordinates xi;
  struct jnd_configuration configuration;
  struct jnd_differential differential;
  float residual[3]; /* asked - here */
  float size;        /* its largest element */
  bool positive;     /* side of the parallel singularities: sign of det J */
};

static bool evaluate(const struct jnd_linkage* linkage, const float asked[3], struct iterate* out) {
  if (!jnd_configuration_at(linkage, &out->xi, &out->configuration)) return false;
  if (!jnd_differential_at(linkage, &out->configuration, &out->differential)) return false;
  float q[3];
  jnd_joint_angles(&out->configuration, q);
  out->size = 0;
  for (int leg = 0; leg < 3; ++leg) {
    out->residual[leg] = remainderf(asked[leg] - q[leg], whole_turn_rad);
    out->size = fmaxf(out->size, fabsf(out->residual[leg]));
  }
  float(*j)[3] = out->differential.j;
  out->positive = j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) -
                      j[1][0] * (j[0][1] * j[2][2] - j[0][2] * j[2][1]) +
                      j[2][0] * (j[0][1] * j[1][2] - j[0][2] * j[1][1]) >
                  0;
  return true;
}

/* The step of Newton's method in xi: J Brate move = residual, Brate as in Rrs3Kinematics::rate_map. */
static bool newton(const struct jnd_linkage* linkage, const struct iterate* now, float move[3]) {
  const float cp = cosf(now->xi.pitch_rad);
  const float cy = now->configuration.platform.cos_yaw, sy = now->configuration.platform.sin_yaw;
  float j_xi[3][3];
  for (int row = 0; row < 3; ++row) {
    const float* j = now->differential.j[row];
    j_xi[row][0] = j[0];
    j_xi[row][1] = (j[1] * cy + j[2] * sy) * cp;
    j_xi[row][2] = j[2] * cy - j[1] * sy;
  }
  jnd_solve(j_xi, now->residual, move);
  const float tilt = fmaxf(fabsf(move[1]), fabsf(move[2])), lift = fabsf(move[0]) / linkage->b_m;
  if (!isfinite(tilt + lift + move[1] + move[2])) return false;
  const float shorten = fmaxf(1, fmaxf(tilt / longest_tilt_rad, lift / longest_lift));
  for (int i = 0; i < 3; ++i) move[i] /= shorten;
  return true;
}

/* The pose after a step, or after a part of it, that is nearer to the asked one. */
static bool improve(const struct jnd_linkage* linkage, const float joint_rad[3], float move[3], struct iterate* now,
                    struct iterate* next, int* poses) {
  while (++*poses <= MOST_POSES) {
    next->xi.pz_m = now->xi.pz_m + move[0];
    next->xi.roll_rad = now->xi.roll_rad + move[1];
    next->xi.pitch_rad = now->xi.pitch_rad + move[2];
    if (evaluate(linkage, joint_rad, next) && next->positive == now->positive && next->size < now->size) {
      *now = *next;
      return true;
    }
    if (now->size <= rounding_rad) return false; /* near the end: shorter steps change nothing */
    for (int i = 0; i < 3; ++i) move[i] /= 2;
  }
  return false;
}

bool jnd_forward(const struct jnd_linkage* linkage, const float joint_rad[3], struct jnd_coordinates* xi,
                 struct jnd_configuration* configuration, struct jnd_differential* differential) {
  struct iterate now, next;
  now.xi = *xi;
  if (!isfinite(joint_rad[0]) || !isfinite(joint_rad[1]) || !isfinite(joint_rad[2])) return false;
  if (!evaluate(linkage, joint_rad, &now)) return false;
  int poses = 1;
  while (now.size > solved_rad) {
    float move[3];
    if (!newton(linkage, &now, move) || !improve(linkage, joint_rad, move, &now, &next, &poses)) break;
  }
  if (!(now.size <= rounding_rad)) return false;
  *xi = now.xi;
  *configuration = now.configuration;
  *differential = now.differential;
  return true;
}
