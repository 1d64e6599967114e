// Detection with a rating: "is there a signal?" answered in J ordered categories, from 1 (surely not) to J (surely).
// d' and the area under the ROC by maximum likelihood, of equal and of unequal variances, and the area of the
// trapezoids, which needs no model.
//
//   P(R <= j | noise) = Phi(c_j);  equal variances:    P(R <= j | signal) = Phi(c_j - d'),      A_z = Phi(d'/sqrt 2)
//                                  unequal variances:  P(R <= j | signal) = Phi((c_j - mu)/sigma)
//   slope of the z-ROC 1/sigma;  d_a = mu sqrt(2 / (1 + sigma^2));  A_z = Phi(d_a/sqrt 2)
//
// Standard errors: inverse observed information in (c, mu, ln sigma), delta method. Categories that neither row uses are
// left out. Unequal variances need three categories that are used.
//
// Source: Dorfman and Alf 1969, J Math Psychol 6:487; Macmillan and Creelman 2005, chapter 3; Simpson and Fitter 1973
// (d_a); DeLong, DeLong and Clarke-Pearson 1988, Biometrics 44:837. Checked against: R 4.2.2 (ordinal::clm, glm),
// log-likelihood 1e-8, estimates 1e-6.
#pragma once

#include <string_view>
#include <vector>

namespace jnd {

enum class RatingStatus {
  ok,
  separated,  // no rating of one class lies on the wrong side of any of the other (they share one category at most):
              // d' is infinite
  unbounded,  // unequal variances only: the likelihood is highest where sigma, and mu with it, has no bound
  not_applicable,  // unequal variances only: fewer than three categories, or separated classes
  no_information,  // one category throughout
  missing          // no trial of one class
};
std::string_view to_string(RatingStatus status) noexcept;

struct RatingEstimate {
  double value, se;  // NaN where undefined
};

// Numbers are NaN, and criteria empty, where the status leaves them undefined. Under `separated` d' is +-inf,
// A_z 1 or 0 unless the classes share a category, and the log-likelihood the one that is approached; under `unbounded`
// that at the end of the range of sigma (ordinal_probit.h), which is short of it by less than 1e-5 of the trials.
struct EqualVarianceRoc {
  RatingStatus status = RatingStatus::missing;
  double log_likelihood;
  std::vector<RatingEstimate> criteria;  // c_1 .. of the categories that are used
  RatingEstimate dprime, area;
  double deviance;  // against rows of their own proportions
};

struct UnequalVarianceRoc {
  RatingStatus status = RatingStatus::missing;
  double log_likelihood;
  std::vector<RatingEstimate> criteria;
  RatingEstimate mu, ln_sigma, sigma, zroc_slope, d_a, area;
  double deviance;
  double lr_equal_variance, p_equal_variance;  // likelihood ratio of equal variances, chi-square(1), and its p value
};

struct RatingRoc {
  std::vector<int> categories_used;  // from 1
  EqualVarianceRoc equal;
  UnequalVarianceRoc unequal;
  // P(S > N) + P(S = N) / 2, and DeLong's standard error, NaN with fewer than two trials of a class.
  RatingEstimate area_trapezoid;
};

// noise[j], signal[j]: how often category j + 1 was answered; of equal size, >= 0.
RatingRoc rating_roc(const std::vector<int>& noise, const std::vector<int>& signal);

}  // namespace jnd
