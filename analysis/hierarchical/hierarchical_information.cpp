#include "analysis/hierarchical/hierarchical_information.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "analysis/numerics/box_newton.h"

namespace jnd {

namespace {

// Square matrices by rows, of the cells of one participant: ln s of each condition, then k of each.
using Square = std::vector<double>;

Square product(const Square& a, const Square& b, std::size_t n) {
  Square out(n * n, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t j = 0; j < n; ++j) out[i * n + j] += a[i * n + k] * b[k * n + j];
  return out;
}

double trace_of_product(const Square& a, const Square& b, std::size_t n) {
  double trace = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) trace += a[i * n + j] * b[j * n + i];
  return trace;
}

Square inverse(const Square& a, std::size_t n) {
  Square out(n * n);
  for (std::size_t column = 0; column < n; ++column) {
    Square factor = a;
    std::vector<double> unit(n, 0);
    unit[column] = 1;
    solve_positive_definite(factor, unit);
    for (std::size_t row = 0; row < n; ++row) out[row * n + column] = unit[row];
  }
  return out;
}

// Covariances between the ln s of two conditions (and more within one), between their k, and between ln s and k.
Square blocks(std::size_t conditions, double s, double more_within, double k, double both) {
  const std::size_t n = 2 * conditions;
  Square out(n * n);
  for (std::size_t a = 0; a < conditions; ++a)
    for (std::size_t b = 0; b < conditions; ++b) {
      out[a * n + b] = s + (a == b ? more_within : 0);
      out[(conditions + a) * n + conditions + b] = k;
      out[a * n + conditions + b] = out[(conditions + a) * n + b] = both;
    }
  return out;
}

}  // namespace

std::vector<double> marginal_information(std::span<const CellInformation> cells, const HierarchicalPlace& place) {
  constexpr double kLeastShare = 1e-4;  // of a trial's information: cells without answers have a covariance too
  const std::size_t conditions = place.mu.size(), n = 2 * conditions, all = n + 4;
  double unit_s = 0, unit_k = 0;
  for (const CellInformation& one : cells) {
    unit_s = std::max(unit_s, one.s);
    unit_k = std::max(unit_k, one.k);
  }
  const auto& [mu, kappa, tu, tv, tw, rho] = place;
  const Square between = blocks(conditions, tu * tu, tv * tv, tw * tw, rho * tu * tw);
  // What a unit of tu^2, tv^2, tw^2 and rho adds.
  const std::vector<Square> by = {
      blocks(conditions, 1, 0, 0, tu > 0 ? rho * tw / (2 * tu) : 0), blocks(conditions, 0, 1, 0, 0),
      blocks(conditions, 0, 0, 1, tw > 0 ? rho * tu / (2 * tw) : 0), blocks(conditions, 0, 0, 0, tu * tw)};
  std::vector<double> information(all * all, 0);
  for (std::size_t first = 0; first < cells.size(); first += conditions) {
    Square v = between;
    for (std::size_t c = 0; c < conditions; ++c) {
      const CellInformation& cell = cells[first + c];
      const double s = cell.s + kLeastShare * unit_s, k = cell.k + kLeastShare * unit_k;
      const double determinant = s * k - cell.both * cell.both;
      const std::size_t other = conditions + c;
      v[c * n + c] += k / determinant;
      v[other * n + other] += s / determinant;
      v[c * n + other] -= cell.both / determinant;
      v[other * n + c] -= cell.both / determinant;
    }
    const Square weight = inverse(v, n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) information[i * all + j] += weight[i * n + j];
    std::vector<Square> through;
    for (const Square& one : by) through.push_back(product(weight, one, n));
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j)
        information[(n + i) * all + n + j] += trace_of_product(through[i], through[j], n) / 2;
  }
  return information;
}

std::vector<double> covariance_of_estimates(std::span<const CellInformation> cells, const HierarchicalPlace& place) {
  const std::size_t n = 2 * place.mu.size(), all = n + 4;
  const std::vector<double> full = marginal_information(cells, place);
  Square information(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) information[i * n + j] = full[i * all + j];
  return inverse(information, n);
}

}  // namespace jnd
