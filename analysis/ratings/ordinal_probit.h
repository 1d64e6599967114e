// Answers in ordered categories as cuts of a normal variable, by maximum likelihood: what identification, rated
// detection and sureness of same-different share.
//
//   P(answer <= j | row i) = Phi((c_j - eta_i) / s_i),  c_1 < ... < c_(J-1),  eta_i = sum over k of design[i][k] beta_k
//
// s_i is 1, or sigma in the rows that say so. With s_i given, the log-likelihood (sum of n_ij ln P_ij, no constants) is
// concave in criteria and effects, so that a maximum is the maximum. It is finite and unique unless rows can be pulled
// apart: recedes() says so before anything is fitted.
//
// Source: McCullagh 1980, J R Stat Soc B 42:109; Burridge 1981, J R Stat Soc B 43:41 (concavity); Haberman 1980 (when
// it is finite). Checked against: R 4.2.2 (ordinal::clm 2022.11-16), and random searches that find nothing higher.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/numerics/box_newton.h"

namespace jnd {

// Counts of answers, rows by categories; all rows of equal size. A category that no row uses says nothing.
using CategoryCounts = std::vector<std::vector<double>>;

// Which categories somebody used, from 0, and the counts of those alone.
struct UsedCategories {
  std::vector<int> used;
  CategoryCounts counts;
};
UsedCategories used_categories(const CategoryCounts& counts);

// Sum of n_ij ln(n_ij / n_i), 0 ln 0 = 0: the highest log-likelihood that any model can have.
double saturated_log_likelihood(const CategoryCounts& counts);

// Whether the likelihood never falls as eta moves along direction (an entry a row) for ever, with criteria to suit: for
// no criterion does a row with answers below it move further than a row with answers above it. Rows without answers do
// not count. Every category is used, and direction is not the same in all rows.
bool recedes(const CategoryCounts& counts, const std::vector<double>& direction);

// A place is the J - 1 criteria, then the effects, then ln sigma (always there; 0 where no row is scaled).
class OrdinalProbit {
 public:
  // design: an entry a row, all of equal size. scaled: the rows whose s is sigma.
  OrdinalProbit(CategoryCounts counts, std::vector<std::vector<double>> design, std::vector<bool> scaled = {});

  std::size_t criteria() const noexcept { return criteria_; }
  std::size_t size() const noexcept { return criteria_ + effects_ + 1; }

  // For maximise_in_box. -inf where criteria are not in order.
  double value(const std::vector<double>& place) const;
  void derivatives(const std::vector<double>& place, NewtonDerivatives& out) const;

  // Effects and ln sigma 0, criteria from the answers of all rows together: finite where every category is used.
  std::vector<double> start() const;
  // Everything free but ln sigma, which is held at ln_sigma.
  NewtonBox box(double ln_sigma = 0) const;

 private:
  struct Cut;  // one bound of a cell, with what it depends on
  Cut cut(const std::vector<double>& place, std::size_t row, std::size_t category) const;

  CategoryCounts counts_;
  std::vector<std::vector<double>> design_;
  std::vector<bool> scaled_;
  std::size_t criteria_, effects_;
};

// A maximum and its covariance, the inverse of the observed information of what was free, by rows of a place; 0 in rows
// and columns of what was held, NaN everywhere where the information has no inverse.
struct OrdinalFit {
  std::vector<double> place;
  double log_likelihood = 0;
  std::vector<double> covariance;
  double variance(std::size_t i) const { return covariance[i * place.size() + i]; }
  double error(std::size_t i) const;  // square root of the variance
};
OrdinalFit fit_ordinal(const OrdinalProbit& model, const NewtonBox& box, std::vector<double> start);

// sigma free too. It is looked for within kLeastSigma and 1 / kLeastSigma, first on a grid of ln sigma, since the
// likelihood is not concave in it.
inline constexpr double kLeastSigma = 1e-6;
struct ScaledOrdinalFit {
  OrdinalFit fit;
  bool bounded = true;  // false: an end of the range is as likely as any sigma within; only the log-likelihood holds
};
ScaledOrdinalFit fit_scaled_ordinal(const OrdinalProbit& model, const std::vector<double>& start);

}  // namespace jnd
