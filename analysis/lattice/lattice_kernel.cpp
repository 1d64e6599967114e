#include "analysis/lattice/lattice_kernel.h"

#include <array>
#include <cmath>

#include "analysis/lattice/lattice_sums.h"
#include "analysis/numerics/normal.h"

namespace jnd {

namespace {

// Gauss and Hermite's rule for the standard normal density (Abramowitz and Stegun 1964, table 25.10, scaled).
struct NormalNode {
  double z, share;
};
constexpr std::array<NormalNode, 9> kNormalNodes = {{{-4.51274586339978, 2.23458440077466e-05},
                                                     {-3.20542900285647, 2.78914132123177e-03},
                                                     {-2.07684797867783, 4.99164067652179e-02},
                                                     {-1.02325566378913, 2.44097502894939e-01},
                                                     {0, 4.06349206349206e-01},
                                                     {1.02325566378913, 2.44097502894939e-01},
                                                     {2.07684797867783, 4.99164067652179e-02},
                                                     {3.20542900285647, 2.78914132123177e-03},
                                                     {4.51274586339978, 2.23458440077466e-05}}};

// Lagrange's polynomial through the nodes 0..kInterpolationNodes-1, at x: the weights of all nodes, and their slopes.
struct LagrangeWeights {
  explicit LagrangeWeights(double x) {
    double product = 1, slope = 0;  // of x less each node before; then of x less each after
    for (int a = 0; a < kInterpolationNodes; ++a) {
      const auto at = static_cast<std::size_t>(a);
      values[at] = product;
      slopes[at] = slope;
      slope = slope * (x - a) + product;
      product *= x - a;
    }
    product = 1;
    slope = 0;
    for (int a = kInterpolationNodes - 1; a >= 0; --a) {
      const auto at = static_cast<std::size_t>(a);
      slopes[at] = (slopes[at] * product + values[at] * slope) * kScales[at];
      values[at] *= product * kScales[at];
      slope = slope * (x - a) + product;
      product *= x - a;
    }
  }

  std::array<double, kInterpolationNodes> values{}, slopes{};

 private:
  static constexpr std::array<double, kInterpolationNodes> scales() {
    std::array<double, kInterpolationNodes> out{};
    for (int a = 0; a < kInterpolationNodes; ++a) {
      double product = 1;
      for (int b = 0; b < kInterpolationNodes; ++b)
        if (b != a) product *= a - b;
      out[static_cast<std::size_t>(a)] = 1 / product;
    }
    return out;
  }
  static const std::array<double, kInterpolationNodes> kScales;
};
constexpr std::array<double, kInterpolationNodes> LagrangeWeights::kScales = LagrangeWeights::scales();

int first_node(double at) {
  return static_cast<int>(std::floor(at)) - kInterpolationNodes / 2 + 1;
}

}  // namespace

LatticeKernel::LatticeKernel(double centre, double spacing, int first, int last, double spread, double step,
                             double reach)
    : first_(first), step_(step) {
  const auto count = static_cast<std::size_t>(last - first) + 1;
  const double nodes = spread / step;
  const bool summed = nodes >= kNarrowestSum;
  int beside = summed ? static_cast<int>(std::ceil(reach * nodes)) + 1
                      : static_cast<int>(std::ceil(kNormalNodes.back().z * nodes));
  if (spread > 0 && (beside % 2 == 0) != summed) ++beside;  // taps by fours fit into registers
  taps_ = static_cast<std::size_t>(summed ? 2 * beside : kInterpolationNodes + 2 * beside);
  starts_.resize(count);
  weights_.assign(count * taps_, 0);
  by_centre_ = by_spread_ = weights_;
  for (std::size_t place = 0; place < count; ++place) {
    const double at = (centre + spacing * (first + static_cast<int>(place))) / step;
    starts_[place] = summed ? static_cast<int>(std::floor(at)) - beside + 1 : first_node(at) - beside;
    summed ? sum_over_nodes(place, at, nodes) : interpolate(place, at, nodes);
  }
}

void LatticeKernel::sum_over_nodes(std::size_t place, double at, double spread) {
  for (std::size_t tap = 0; tap < taps_; ++tap) {
    const double z = (starts_[place] + static_cast<int>(tap) - at) / spread;
    const double weight = normal_density(z) / spread;
    const std::size_t to = place * taps_ + tap;
    weights_[to] = weight;
    by_centre_[to] = weight * z / (spread * step_);
    by_spread_[to] = weight * (z * z - 1) / (spread * step_);
  }
}

void LatticeKernel::interpolate(std::size_t place, double at, double spread) {
  for (const NormalNode& node : kNormalNodes) {
    if (spread == 0 && node.z != 0) continue;
    const double share = spread == 0 ? 1 : node.share, here = at + spread * node.z;
    const int from = first_node(here);
    const std::size_t to = place * taps_ + static_cast<std::size_t>(from - starts_[place]);
    const LagrangeWeights weights(here - from);
    for (std::size_t a = 0; a < kInterpolationNodes; ++a) {
      weights_[to + a] += share * weights.values[a];
      by_centre_[to + a] += share * weights.slopes[a] / step_;
      by_spread_[to + a] += share * weights.slopes[a] * node.z / step_;
    }
  }
}

LatticeKernel::Slopes LatticeKernel::slopes(int m, std::span<const double> by_weight) const noexcept {
  const double *by_centre = &by_centre_[place(m) * taps_], *by_spread = &by_spread_[place(m) * taps_];
  return {dot(by_weight.data(), by_centre, by_weight.size()), dot(by_weight.data(), by_spread, by_weight.size())};
}

}  // namespace jnd
