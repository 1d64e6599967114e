/* Arithmetic of three numbers. */
#ifndef JND_VECTOR_H
#define JND_VECTOR_H

static inline float jnd_dot(const float a[3], const float b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* out must not be a or b. */
static inline void jnd_cross(const float a[3], const float b[3], float out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/* What is not a number becomes `low`. */
static inline float jnd_clip(float value, float low, float high) {
  if (!(value > low)) return low;
  return value < high ? value : high;
}

#endif
