// Weights that read a smooth function off a lattice: at a place, or averaged over a normal distribution around it.
//
// The function is known at the nodes i step. A distribution that is wide enough is summed over the nodes themselves (the
// trapezoid rule, whose error falls with exp(-2 pi^2 (width/step)^2)); a narrow one by Gauss and Hermite's rule of nine
// points, each read by Lagrange's polynomial through the ten nodes around it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace jnd {

inline constexpr int kInterpolationNodes = 10;

// Of a row of places centre + m spacing, m = first..last, each with as many weights.
class LatticeKernel {
 public:
  // step > 0; spread >= 0: the standard deviation, in the unit of step, summed up to so many of it; first <= last.
  LatticeKernel(double centre, double spacing, int first, int last, double spread, double step, double reach);

  int first() const noexcept { return first_; }
  std::size_t taps() const noexcept { return taps_; }
  // The first node that place m reads, and its weights.
  int start(int m) const noexcept { return starts_[place(m)]; }
  const int* starts(int m) const noexcept { return &starts_[place(m)]; }
  const double* weights(int m) const noexcept { return &weights_[place(m) * taps_]; }
  // Their derivatives by the centre.
  const double* by_centre(int m) const noexcept { return &by_centre_[place(m) * taps_]; }

  // sum over the weights of places m, m + 1, ... of by_weight * d weight / d centre, and / d spread.
  struct Slopes {
    double by_centre = 0, by_spread = 0;
  };
  Slopes slopes(int m, std::span<const double> by_weight) const noexcept;

 private:
  std::size_t place(int m) const noexcept { return static_cast<std::size_t>(m - first_); }
  void sum_over_nodes(std::size_t place, double at, double spread);
  void interpolate(std::size_t place, double at, double spread);

  int first_;
  std::size_t taps_ = 0;
  double step_;
  std::vector<int> starts_;
  std::vector<double> weights_, by_centre_, by_spread_;
};

// The narrowest distribution, in steps, that is summed over the nodes.
inline constexpr double kNarrowestSum = 1.05;

}  // namespace jnd
