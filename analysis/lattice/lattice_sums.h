// The long sums over lattice nodes, of which a likelihood is made: in the processor's widest registers, and the same bits
// on every processor.
#pragma once

#include <cstddef>

namespace jnd {

// Of rows of a table, interpolated between with kInterpolationNodes (lattice_kernel.h) weights:
// out[i] = sum over the taps of weights[tap] rows[tap * stride + i], i < n; slope[i] the same with by_centre.
void interpolate_rows(const double* rows, std::size_t stride, const double* weights, const double* by_centre,
                      std::size_t n, double* out, double* slope) noexcept;

// Backwards, of out alone: of a number that changes by by_out[i] with out[i], what is added to its derivatives by the rows.
void add_to_rows(const double* by_out, std::size_t stride, const double* weights, std::size_t n,
                 double* by_rows) noexcept;

// Places along one row of nodes, each with `taps` weights for the nodes from starts[place] - first on.
struct LatticeRow {
  const int* starts;
  const double* weights;
  std::size_t taps, places;
  int first;
};
// out[place] = sum of weights times row.
void weighted_sums(const LatticeRow& along, const double* row, double* out) noexcept;
// Backwards: of a number that changes by by_sum[place] with each of those sums, what is added to its derivatives by the
// weights (places x taps) and by the row.
void add_slopes(const LatticeRow& along, const double* row, const double* by_sum, double* by_weights,
                double* by_row) noexcept;

// sum of a[i] b[i].
double dot(const double* a, const double* b, std::size_t n) noexcept;

// row[i] += positive * log_positive[i] + negative * log_negative[i].
void add_answers(double positive, const double* log_positive, double negative, const double* log_negative,
                 std::size_t n, double* row) noexcept;

}  // namespace jnd
