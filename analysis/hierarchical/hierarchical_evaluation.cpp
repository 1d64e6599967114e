#include "analysis/hierarchical/hierarchical_evaluation.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "analysis/lattice/fast_functions.h"

namespace jnd {

namespace {

// What a sum over equally spaced nodes makes of the variance of a normal density falls short of it by so much. Divided by
// the fourth power of a spread it is part of the slope of ln L by the spread's square: of a small one, where the answers
// tell no more than the prior, it would be the larger part.
// Source: Poisson's summation formula, as Trefethen and Weideman 2014, SIAM Review 56:385, section 5.
double lost_variance(double mean, double summed, double prior, double spacing, double offset) noexcept {
  constexpr double kLikePrior = 0.9;  // of its variance: what is narrower need not be a normal density
  if (summed < kLikePrior * prior * prior) return 0;
  const double turn = 2 * std::numbers::pi, phase = std::cos(turn * (mean / spacing - offset));
  const auto lost = [&](double variance) {
    const double nodes = turn * turn * variance / (spacing * spacing);
    return 2 * variance * nodes * std::exp(-nodes / 2) * phase;
  };
  return lost(summed + lost(summed));
}

}  // namespace

// The lattice nodes that the kernels of those nodes read.
LatticeRange HierarchicalLikelihood::Evaluation::read_by(std::size_t condition, const Rectangle& nodes) const noexcept {
  const LatticeKernel& s = over_s[condition];
  const int s0 = s.start(nodes.u0), s1 = s.start(nodes.u1) + static_cast<int>(s.taps()) - 1;
  if (choice) return {s0, s1, nodes.w0, nodes.w1};
  const LatticeKernel& k = over_k[condition];
  return {s0, s1, k.start(nodes.w0), k.start(nodes.w1) + static_cast<int>(k.taps()) - 1};
}

LatticeRows HierarchicalLikelihood::Evaluation::rows_of(std::size_t condition) const noexcept {
  const LatticeKernel& s = over_s[condition];
  return {s.starts(box.u0), s.weights(box.u0), s.taps(), wide, first_s[condition], high, read[condition].size() / high};
}

void HierarchicalLikelihood::Evaluation::lay_out_prior() {
  prior.resize(wide * high);
  const double spare = 1 - place.rho * place.rho;
  double scale = 1 / std::sqrt(spare);
  if (has_u) scale *= spacing_u / place.tu / std::sqrt(2 * std::numbers::pi);
  if (has_w) scale *= spacing_w / place.tw / std::sqrt(2 * std::numbers::pi);
  for (std::size_t j = 0; j < high; ++j) {
    const double b = has_w ? w(box.w0 + static_cast<int>(j)) / place.tw : 0;
    for (std::size_t i = 0; i < wide; ++i) {
      const double a = has_u ? u(box.u0 + static_cast<int>(i)) / place.tu : 0;
      prior[j * wide + i] = -(a * a - 2 * place.rho * a * b + b * b) / (2 * spare);
    }
  }
  exponentiate(prior, 0);
  for (double& one : prior) one *= scale;
}

void HierarchicalLikelihood::Evaluation::multiply() {
  joint = prior;
  for (const std::vector<double>& one : inner)
    for (std::size_t i = 0; i < joint.size(); ++i) joint[i] *= one[i];
  in_u.assign(wide, 0);
  in_w.assign(high, 0);
  total = 0;
  for (std::size_t j = 0; j < high; ++j)
    for (std::size_t i = 0; i < wide; ++i) {
      const double one = joint[j * wide + i];
      total += one;
      in_u[i] += std::abs(one);  // interpolation may fall below 0 where there is next to nothing
      in_w[j] += std::abs(one);
    }
}

HierarchicalLikelihood::Evaluation::Moments HierarchicalLikelihood::Evaluation::moments() const noexcept {
  Moments mean;
  std::vector<double> xs(wide), squares(wide);
  for (std::size_t i = 0; i < wide; ++i) {
    xs[i] = u(box.u0 + static_cast<int>(i));
    squares[i] = xs[i] * xs[i];
  }
  for (std::size_t j = 0; j < high; ++j) {
    const double* row = &joint[j * wide];
    const double y = w(box.w0 + static_cast<int>(j)), share = std::accumulate(row, row + wide, 0.0) / total,
                 x = dot(row, xs.data(), wide) / total;
    mean.u += x;
    mean.uu += dot(row, squares.data(), wide) / total;
    mean.w += share * y;
    mean.ww += share * y * y;
    mean.uw += x * y;
  }
  if (has_u) mean.uu += lost_variance(mean.u, mean.uu - mean.u * mean.u, place.tu, spacing_u, offset.u);
  if (has_w) mean.ww += lost_variance(mean.w, mean.ww - mean.w * mean.w, place.tw, spacing_w, offset.w);
  return mean;
}

}  // namespace jnd
