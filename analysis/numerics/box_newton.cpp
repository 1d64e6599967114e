#include "analysis/numerics/box_newton.h"

#include <algorithm>

namespace jnd {

bool solve_positive_definite(std::vector<double>& a, std::vector<double>& b) noexcept {
  const std::size_t n = b.size();
  for (std::size_t j = 0; j < n; ++j) {
    double pivot = a[j * n + j];
    const double least = 1e-13 * std::abs(pivot);
    for (std::size_t k = 0; k < j; ++k) pivot -= a[j * n + k] * a[j * n + k];
    if (!(pivot > least) || !std::isfinite(pivot)) return false;
    const double root = std::sqrt(pivot);
    a[j * n + j] = root;
    for (std::size_t i = j + 1; i < n; ++i) {
      double sum = a[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
      a[i * n + j] = sum / root;
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i * n + k] * b[k];
    b[i] /= a[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k * n + i] * b[k];
    b[i] /= a[i * n + i];
  }
  return true;
}

std::vector<double> inverse_positive_definite(const std::vector<double>& matrix, std::size_t n) {
  std::vector<double> inverse;
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> factor = matrix, column(n, 0);
    column[i] = 1;
    if (!solve_positive_definite(factor, column)) return {};
    inverse.insert(inverse.end(), column.begin(), column.end());
  }
  return inverse;
}

namespace {

// matrix restricted to the free variables, its diagonal grown by the factor 1 + damping.
bool solve_free(const std::vector<double>& matrix, const std::vector<double>& gradient,
                const std::vector<std::size_t>& free, double damping, std::vector<double>& direction) {
  const std::size_t n = gradient.size(), m = free.size();
  std::vector<double> a(m * m), b(m);
  for (std::size_t i = 0; i < m; ++i) {
    b[i] = gradient[free[i]];
    for (std::size_t j = 0; j < m; ++j) a[i * m + j] = matrix[free[i] * n + free[j]];
    a[i * m + i] += damping * std::max(std::abs(a[i * m + i]), 1e-12);
  }
  if (!solve_positive_definite(a, b)) return false;
  for (std::size_t i = 0; i < m; ++i) {
    if (!std::isfinite(b[i])) return false;
    direction[free[i]] = b[i];
  }
  return true;
}

}  // namespace

bool newton_direction(const NewtonDerivatives& at, const NewtonBox& box, const std::vector<double>& place,
                      std::vector<double>& direction) {
  const std::size_t n = place.size();
  std::vector<char> held(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    if (box.lower[i] == box.upper[i] || (place[i] <= box.lower[i] && at.gradient[i] <= 0) ||
        (place[i] >= box.upper[i] && at.gradient[i] >= 0))
      held[i] = 1;
  std::vector<std::size_t> free;
  for (;;) {
    free.clear();
    for (std::size_t i = 0; i < n; ++i)
      if (!held[i]) free.push_back(i);
    direction.assign(n, 0);
    if (free.empty()) return false;
    bool solved = solve_free(at.curvature, at.gradient, free, 0, direction);
    double damping = 1e-6;
    for (int attempt = 0; !solved && attempt < 9; ++attempt) {
      solved = solve_free(at.expected, at.gradient, free, damping, direction);
      damping *= 100;
    }
    if (!solved) return false;
    // A step out of the box from a bound: hold that variable too, and solve again for the others.
    bool outward = false;
    for (const std::size_t i : free) {
      if ((place[i] > box.lower[i] || direction[i] >= 0) && (place[i] < box.upper[i] || direction[i] <= 0)) continue;
      held[i] = 1;
      outward = true;
    }
    if (!outward) return true;
  }
}

}  // namespace jnd
