#include "analysis/group/p_adjust.h"

#include <algorithm>
#include <cmath>

namespace jnd {

namespace {

// The places of the defined p values, the smallest p first.
std::vector<std::size_t> ascending(std::span<const double> p) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!std::isnan(p[i])) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  return order;
}

}  // namespace

std::vector<double> holm(std::span<const double> p, std::size_t family) {
  const std::vector<std::size_t> order = ascending(p);
  const std::size_t tests = std::max(family, order.size());
  std::vector<double> adjusted(p.begin(), p.end());
  double largest = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, static_cast<double>(tests - i) * p[order[i]]);
    adjusted[order[i]] = std::min(1.0, largest);
  }
  return adjusted;
}

std::vector<double> benjamini_hochberg(std::span<const double> p, std::size_t family) {
  const std::vector<std::size_t> order = ascending(p);
  const auto tests = static_cast<double>(std::max(family, order.size()));
  std::vector<double> adjusted(p.begin(), p.end());
  double smallest = 1;
  for (std::size_t i = order.size(); i-- > 0;) {
    smallest = std::min(smallest, tests / static_cast<double>(i + 1) * p[order[i]]);
    adjusted[order[i]] = smallest;
  }
  return adjusted;
}

std::vector<double> bonferroni(std::span<const double> p, std::size_t family) {
  const auto tests = static_cast<double>(std::max(family, ascending(p).size()));
  std::vector<double> adjusted(p.begin(), p.end());
  for (double& value : adjusted)
    if (!std::isnan(value)) value = std::min(1.0, tests * value);
  return adjusted;
}

}  // namespace jnd
