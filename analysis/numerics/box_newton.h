// The largest value of a smooth function of a few variables within bounds: damped Newton steps with exact derivatives.
//
// Source: Nocedal and Wright 2006, Numerical Optimization, sections 3.4 (modified Newton) and 16.7 (active bounds).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "analysis/numerics/special_values.h"

namespace jnd {

// A function at one place. Matrices are square, by rows.
struct NewtonDerivatives {
  double value = 0;
  std::vector<double> gradient;
  std::vector<double> curvature;  // minus the second derivatives: the observed information of a likelihood
  std::vector<double>
      expected;  // positive semidefinite stand-in where that is not positive definite: Fisher information
};

// Entries with lower == upper are held.
struct NewtonBox {
  std::vector<double> lower, upper;
};

struct NewtonResult {
  std::vector<double> place;
  double value = 0;
  bool converged = false;
  int steps = 0;
};

// Solves A x = b for a symmetric positive definite A (n x n, by rows); A is overwritten by its Cholesky factor and b by
// x. False, with both spoilt, where a pivot falls below 1e-13 of its diagonal entry.
bool solve_positive_definite(std::vector<double>& a, std::vector<double>& b) noexcept;

// Of a symmetric matrix of n rows; empty where it is not positive definite.
std::vector<double> inverse_positive_definite(const std::vector<double>& matrix, std::size_t n);

// The step of one iteration: direction in the free variables, 0 in the held ones. False where there is none left.
bool newton_direction(const NewtonDerivatives& at, const NewtonBox& box, const std::vector<double>& place,
                      std::vector<double>& direction);

// function.value(place) -> double (-inf where impossible) and function.derivatives(place, NewtonDerivatives&); where it has
// function.turned_down(), this is called when the place whose derivatives came last is not gone to. start
// must lie in the box and have a finite value. Thread-safe; converged where the next step promises a gain below
// `negligible` (1e-18: the remaining step is below 1e-9 standard errors). Values may err by `error`: steps that seem to
// lose less are taken. A search that after its first steps promises no more than `wanted`, even were its gain kMostGain
// times what its steps promise, is given up; and, where the function has is_known(place, value), one that comes to such a
// place.
template <typename Function>
NewtonResult maximise_in_box(const Function& function, std::vector<double> start, const NewtonBox& box,
                             double wanted = -kInf, double negligible = 1e-18, double error = 0) {
  constexpr int kMostSteps = 200, kMostHalvings = 50, kFirstSteps = 3;
  constexpr double kMostGain = 4;
  constexpr double kQuadratic = 1e-9, kRounding = 1e-13;
  NewtonResult result;
  result.place = std::move(start);
  NewtonDerivatives at, next;
  std::vector<double> direction, trial;
  function.derivatives(result.place, at);
  for (; result.steps < kMostSteps; ++result.steps) {
    result.value = at.value;
    if (!newton_direction(at, box, result.place, direction)) {
      result.converged = true;
      return result;
    }
    double ascent = 0, longest = 1;
    std::ptrdiff_t blocking = -1;
    for (std::size_t i = 0; i < direction.size(); ++i) {
      ascent += at.gradient[i] * direction[i];
      if (direction[i] == 0) continue;
      const double room = ((direction[i] > 0 ? box.upper[i] : box.lower[i]) - result.place[i]) / direction[i];
      if (room < longest) {
        longest = room;
        blocking = static_cast<std::ptrdiff_t>(i);
      }
    }
    if (!(ascent > negligible)) {
      result.converged = true;
      return result;
    }
    if (result.steps >= kFirstSteps && at.value + kMostGain * ascent < wanted) return result;
    if constexpr (requires { function.is_known(result.place, at.value); })
      if (result.steps >= kFirstSteps && function.is_known(result.place, at.value)) return result;
    bool moved = false;
    double step = longest;
    for (int halving = 0; halving < kMostHalvings && !moved; ++halving) {
      if (halving > 0) step /= 2;
      trial = result.place;
      for (std::size_t i = 0; i < trial.size(); ++i) trial[i] += step * direction[i];
      if (blocking >= 0 && halving == 0) {
        const auto i = static_cast<std::size_t>(blocking);
        trial[i] = direction[i] > 0 ? box.upper[i] : box.lower[i];
      }
      // Most first trials are taken, and then their derivatives are needed anyway. So close to the top that rounding
      // hides the gain, the quadratic model is better than the values.
      double value = 0;
      if (halving == 0) {
        function.derivatives(trial, next);
        value = next.value;
        moved = ascent < kQuadratic + kRounding * std::abs(at.value) && std::isfinite(value);
      } else {
        value = function.value(trial);
      }
      moved = moved || value >= at.value + 1e-4 * step * ascent - std::max(error, negligible);
      if constexpr (requires { function.turned_down(); })
        if (halving == 0 && !moved) function.turned_down();
      if (moved && halving > 0) function.derivatives(trial, next);
    }
    if (!moved) {
      result.converged = ascent < 1e-6;
      return result;
    }
    std::swap(result.place, trial);
    std::swap(at, next);
  }
  result.value = at.value;
  return result;
}

}  // namespace jnd
