#include "analysis/lattice/lattice_sums.h"

#include "analysis/lattice/lattice_kernel.h"
#include "analysis/lattice/wide_registers.h"

namespace jnd {

JND_WIDE_REGISTERS void interpolate_rows(const double* rows, std::size_t stride, const double* weights,
                                         const double* by_centre, std::size_t n, double* __restrict out,
                                         double* __restrict slope) noexcept {
  static_assert(kInterpolationNodes == 10);
  const double *a = rows, *b = rows + 5 * stride;
  const double *v = weights, *d = by_centre;
  for (std::size_t i = 0; i < n; ++i) {
    const double r0 = a[i], r1 = a[stride + i], r2 = a[2 * stride + i], r3 = a[3 * stride + i], r4 = a[4 * stride + i],
                 r5 = b[i], r6 = b[stride + i], r7 = b[2 * stride + i], r8 = b[3 * stride + i], r9 = b[4 * stride + i];
    out[i] = (v[0] * r0 + v[1] * r1) + (v[2] * r2 + v[3] * r3) + (v[4] * r4 + v[5] * r5) + (v[6] * r6 + v[7] * r7) +
             (v[8] * r8 + v[9] * r9);
    slope[i] = (d[0] * r0 + d[1] * r1) + (d[2] * r2 + d[3] * r3) + (d[4] * r4 + d[5] * r5) + (d[6] * r6 + d[7] * r7) +
               (d[8] * r8 + d[9] * r9);
  }
}

JND_WIDE_REGISTERS void add_to_rows(const double* by_out, std::size_t stride, const double* weights, std::size_t n,
                                    double* __restrict by_rows) noexcept {
  for (std::size_t row = 0; row < kInterpolationNodes; ++row) {
    double* to = by_rows + row * stride;
    for (std::size_t i = 0; i < n; ++i) to[i] += weights[row] * by_out[i];
  }
}

JND_WIDE_REGISTERS void weighted_sums(const LatticeRow& along, const double* row, double* out) noexcept {
  for (std::size_t place = 0; place < along.places; ++place) {
    const double *a = along.weights + place * along.taps, *b = row + (along.starts[place] - along.first);
    double sum[4] = {0, 0, 0, 0};
    std::size_t i = 0;
    for (; i + 4 <= along.taps; i += 4)
      for (std::size_t j = 0; j < 4; ++j) sum[j] += a[i + j] * b[i + j];
    for (; i < along.taps; ++i) sum[0] += a[i] * b[i];
    out[place] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  }
}

JND_WIDE_REGISTERS void add_slopes(const LatticeRow& along, const double* row, const double* by_sum,
                                   double* __restrict by_weights, double* __restrict by_row) noexcept {
  for (std::size_t place = 0; place < along.places; ++place) {
    const double by = by_sum[place];
    const double *weights = along.weights + place * along.taps, *read = row + (along.starts[place] - along.first);
    double *to_weights = by_weights + place * along.taps, *to_row = by_row + (along.starts[place] - along.first);
    for (std::size_t tap = 0; tap < along.taps; ++tap) to_weights[tap] += by * read[tap];
    for (std::size_t tap = 0; tap < along.taps; ++tap) to_row[tap] += by * weights[tap];
  }
}

JND_WIDE_REGISTERS double dot(const double* a, const double* b, std::size_t n) noexcept {
  double sum[4] = {0, 0, 0, 0};
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4)
    for (std::size_t j = 0; j < 4; ++j) sum[j] += a[i + j] * b[i + j];
  for (; i < n; ++i) sum[0] += a[i] * b[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

JND_WIDE_REGISTERS void add_answers(double positive, const double* log_positive, double negative,
                                    const double* log_negative, std::size_t n, double* __restrict row) noexcept {
  for (std::size_t i = 0; i < n; ++i) row[i] += positive * log_positive[i] + negative * log_negative[i];
}

}  // namespace jnd
