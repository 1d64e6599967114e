#include "analysis/lattice/lattice_sums.h"

#include <cstring>

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

namespace {

using Four __attribute__((vector_size(32))) = double;

// Of kRows rows, a place's weighted sums.
template <std::size_t kRows>
inline __attribute__((always_inline)) void sum_some(const LatticeRows& along, const double* weights, const double* rows,
                                                    double* out) {
  const std::size_t whole = along.taps - along.taps % 4;
  Four sum[kRows] = {}, weight, read;
  for (std::size_t i = 0; i < whole; i += 4) {
    std::memcpy(&weight, weights + i, sizeof(Four));
    for (std::size_t row = 0; row < kRows; ++row) {
      std::memcpy(&read, rows + row * along.nodes + i, sizeof(Four));
      sum[row] += weight * read;
    }
  }
  for (std::size_t row = 0; row < kRows; ++row) {
    double rest = 0;
    for (std::size_t i = whole; i < along.taps; ++i) rest += weights[i] * rows[row * along.nodes + i];
    out[row * along.places] = (sum[row][0] + sum[row][1]) + (sum[row][2] + sum[row][3]) + rest;
  }
}

// Of kFours times four weights of one place.
template <std::size_t kFours>
inline __attribute__((always_inline)) double slopes_of_some(const LatticeRows& along, const double* weights,
                                                            const double* rows, const double* by_variable,
                                                            const double* by_sums, double* by_weights) {
  Four by_weight[kFours] = {}, changed[kFours] = {}, read;
  for (std::size_t row = 0; row < along.rows; ++row) {
    const double by = by_sums[row * along.places];
    for (std::size_t i = 0; i < kFours; ++i) {
      std::memcpy(&read, rows + row * along.nodes + 4 * i, sizeof(Four));
      by_weight[i] += by * read;
      std::memcpy(&read, by_variable + row * along.nodes + 4 * i, sizeof(Four));
      changed[i] += by * read;
    }
  }
  std::memcpy(by_weights, by_weight, sizeof(by_weight));
  Four sum = {};
  for (std::size_t i = 0; i < kFours; ++i) {
    std::memcpy(&read, weights + 4 * i, sizeof(Four));
    sum += changed[i] * read;
  }
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

}  // namespace

JND_WIDE_REGISTERS void weighted_sums(const LatticeRows& along, const double* rows, double* __restrict out) noexcept {
  for (std::size_t place = 0; place < along.places; ++place) {
    const double *weights = along.weights + place * along.taps, *read = rows + (along.starts[place] - along.first);
    std::size_t row = 0;
    for (; row + 4 <= along.rows; row += 4)
      sum_some<4>(along, weights, read + row * along.nodes, out + row * along.places + place);
    for (; row < along.rows; ++row)
      sum_some<1>(along, weights, read + row * along.nodes, out + row * along.places + place);
  }
}

JND_WIDE_REGISTERS double slopes_by_weights(const LatticeRows& along, const double* rows, const double* by_variable,
                                            const double* by_sums, double* by_weights) noexcept {
  double sum = 0;
  for (std::size_t place = 0; place < along.places; ++place) {
    const auto beside = along.starts[place] - along.first;
    const double *weights = along.weights + place * along.taps, *read = rows + beside, *by = by_variable + beside;
    double* to = by_weights + place * along.taps;
    std::size_t i = 0;
    for (; i + 12 <= along.taps; i += 12)
      sum += slopes_of_some<3>(along, weights + i, read + i, by + i, by_sums + place, to + i);
    for (; i + 4 <= along.taps; i += 4)
      sum += slopes_of_some<1>(along, weights + i, read + i, by + i, by_sums + place, to + i);
    for (; i < along.taps; ++i) {
      double changed = 0;
      to[i] = 0;
      for (std::size_t row = 0; row < along.rows; ++row) {
        to[i] += by_sums[row * along.places + place] * read[row * along.nodes + i];
        changed += by_sums[row * along.places + place] * by[row * along.nodes + i];
      }
      sum += weights[i] * changed;
    }
  }
  return sum;
}

JND_WIDE_REGISTERS void add_slopes(const LatticeRows& along, const double* by_sums,
                                   double* __restrict by_row) noexcept {
  for (std::size_t place = 0; place < along.places; ++place) {
    const double* weights = along.weights + place * along.taps;
    double* to_row = by_row + (along.starts[place] - along.first);
    for (std::size_t tap = 0; tap < along.taps; ++tap) to_row[tap] += by_sums[place] * weights[tap];
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
