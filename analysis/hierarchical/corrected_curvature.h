// The curvature of a function whose slopes are known, corrected by every step of a search.
//
// Source: Broyden, Fletcher, Goldfarb and Shanno; Nocedal and Wright 2006, Numerical Optimization, equation 6.19.
#pragma once

#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

namespace jnd {

// Minus the second derivatives, positive definite: a square matrix by rows. Of one search, from its first place on.
class CorrectedCurvature {
 public:
  bool empty() const noexcept { return matrix_.empty(); }
  const std::vector<double>& matrix() const noexcept { return matrix_; }

  // At the first place, whose slope is `gradient`: any positive definite matrix near the curvature there.
  void begin(std::vector<double> matrix, const std::vector<double>& place, const std::vector<double>& gradient) {
    matrix_ = std::move(matrix);
    place_ = place;
    gradient_ = gradient;
  }

  // The last correction was of a step that was not taken: from so far off a slope tells little of the curvature here.
  void undo() { std::tie(matrix_, place_, gradient_) = before_; }

  void correct(const std::vector<double>& place, const std::vector<double>& gradient) {
    before_ = {matrix_, place_, gradient_};
    constexpr double kLeastFall = 1e-3;  // of what was expected: else the curvature would not stay positive
    const std::size_t n = place.size();
    std::vector<double> step(n), fall(n), predicted(n, 0);
    double along = 0, expected = 0;
    for (std::size_t i = 0; i < n; ++i) {
      step[i] = place[i] - place_[i];
      fall[i] = gradient_[i] - gradient[i];
      along += step[i] * fall[i];
    }
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) predicted[i] += matrix_[i * n + j] * step[j];
    for (std::size_t i = 0; i < n; ++i) expected += step[i] * predicted[i];
    place_ = place;
    gradient_ = gradient;
    if (!(expected > 0) || along < kLeastFall * expected) return;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        matrix_[i * n + j] += fall[i] * fall[j] / along - predicted[i] * predicted[j] / expected;
  }

 private:
  std::vector<double> matrix_, place_, gradient_;
  std::tuple<std::vector<double>, std::vector<double>, std::vector<double>> before_;  // the same before the last one
};

}  // namespace jnd
