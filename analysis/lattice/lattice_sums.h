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

// Places along rows of nodes, each with `taps` weights for the nodes from starts[place] - first on, the same in every row.
struct LatticeRows {
  const int* starts;
  const double* weights;
  std::size_t taps, places;
  int first;
  std::size_t rows, nodes;  // nodes: of a row
};
// out[row * places + place] = sum of weights times the row.
void weighted_sums(const LatticeRows& along, const double* rows, double* out) noexcept;
// Backwards: of a number that changes by by_sums[i] with sum i, the derivatives by the weights (places x taps). Returns its
// derivative by a variable by which the nodes have the derivatives by_variable.
double slopes_by_weights(const LatticeRows& along, const double* rows, const double* by_variable, const double* by_sums,
                         double* by_weights) noexcept;
// Of one row, what is added to the derivatives by its nodes.
void add_slopes(const LatticeRows& along, const double* by_sums, double* by_row) noexcept;

// sum of a[i] b[i].
double dot(const double* a, const double* b, std::size_t n) noexcept;

// row[i] += positive * log_positive[i] + negative * log_negative[i].
void add_answers(double positive, const double* log_positive, double negative, const double* log_negative,
                 std::size_t n, double* row) noexcept;

}  // namespace jnd
