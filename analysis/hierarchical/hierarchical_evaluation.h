// One evaluation of the marginal likelihood: the nodes of everybody's integrals, and the integral of the participant at work.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "analysis/hierarchical/hierarchical_likelihood.h"
#include "analysis/lattice/lattice_sums.h"

namespace jnd {

// Of what has that standard deviation, once answers tell so much of it.
inline double sd_with(double prior, double information) noexcept {
  return prior / std::sqrt(1 + prior * prior * information);
}

struct HierarchicalLikelihood::Evaluation {
  Evaluation(const HierarchicalPlace& at, const NodeOffset& beginning)
      : place(at), offset(beginning), has_u(at.tu > 0), has_w(at.tw > 0) {}

  const HierarchicalPlace& place;
  NodeOffset offset;
  bool has_u, has_w;
  double spacing_u = 1, spacing_w = 1;
  Rectangle all;                              // of nodes that the kernels reach
  std::vector<bool> rows_at_nodes;            // by condition: the rows of the lattice are the nodes of w
  std::vector<LatticeKernel> over_s, over_k;  // by condition; the second not of choices

  // Of the participant at work: nodes of w by nodes of u, w outermost.
  Rectangle box;
  std::size_t wide = 0, high = 0;
  std::vector<int> first_s;  // by condition: the first lattice node that is read
  // By condition: the likelihood at the criteria of the nodes, over ln s, and its derivative by the criterion.
  std::vector<std::vector<double>> read, by_criterion;
  std::vector<std::vector<double>> inner;  // by condition: the integral over v
  std::vector<double> prior, joint, adjoint, by_read;
  std::vector<std::vector<double>> by_s;  // by condition: derivatives of ln L by the weights of the nodes
  std::vector<double> by_kappa;           // by condition: derivative of ln L
  // By condition, where it is asked for: derivatives of ln L by the log-likelihoods of the lattice nodes that were read.
  bool back_to_cells = false;
  std::vector<std::vector<double>> by_cell;
  std::vector<double> in_u, in_w;  // joint, summed over the other direction
  double total = 0;
  // The place is not so far from the answers that their product underflows, at most nodes if not at all.
  bool anything_left() const noexcept { return total > 1e-250; }

  struct Moments {
    double u = 0, uu = 0, w = 0, ww = 0, uw = 0;
  };
  Moments moments() const noexcept;
  double u(int node) const noexcept { return has_u ? (node + offset.u) * spacing_u : 0; }
  double w(int node) const noexcept { return has_w ? (node + offset.w) * spacing_w : 0; }
  LatticeRange read_by(std::size_t condition, const Rectangle& nodes) const noexcept;
  LatticeRows rows_of(std::size_t condition) const noexcept;  // of what was read
  void lay_out_prior();
  void multiply();
};

}  // namespace jnd
