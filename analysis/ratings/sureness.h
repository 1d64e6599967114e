// Same-different with sureness: "same, sure", "same, unsure", "different, unsure", "different, sure" (or any number of
// ordered categories), at several differences. The JND from all answers in one model.
//
//   P(answer <= j | delta) = Phi(c_j - delta / sigma),  c_1 < c_2 < ... common to all delta,  sigma > 0
//
// sigma is the difference that adds d' = 1: the JND. Maximum likelihood in 1/sigma, where the likelihood is concave;
// 95 % profile-likelihood interval. Categories that nobody used are left out.
//
// Source: McCullagh 1980, J R Stat Soc B 42:109; Macmillan and Creelman 2005, chapters 3 and 9. Checked against:
// R 4.2.2 (ordinal::clm), log-likelihood 1e-8, sigma and interval 1e-6 relative.
#pragma once

#include <string_view>
#include <vector>

namespace jnd {

enum class SurenessStatus {
  ok,
  flat,            // answers do not rise with delta: sigma is infinite; log-likelihood and criteria at 1/sigma = 0
  separated,       // answers to unequal deltas overlap in nothing that bounds 1/sigma: sigma is 0
  not_identified,  // trials at one delta only: it takes two to see a slope
  no_information,  // one category throughout
  missing          // no trial
};
std::string_view to_string(SurenessStatus status) noexcept;

struct SurenessLevel {
  double delta = 0;         // finite, >= 0; same trials: 0
  std::vector<int> counts;  // answers by category, from "same, sure" on; >= 0
};

// NaN, and criteria empty, where the status leaves a number undefined.
struct Sureness {
  SurenessStatus status = SurenessStatus::missing;
  std::vector<int> categories_used;    // from 1
  double log_likelihood_saturated;     // every delta with its own proportions
  double log_likelihood;               // under separated: what is approached
  double sigma;                        // unit of delta; inf under flat, 0 under separated
  std::vector<double> criteria;        // of the categories that are used; empty under separated
  double ln_sigma_se;                  // of ln sigma, by the observed information
  double deviance;                     // 2 (log_likelihood_saturated - log_likelihood)
  double sigma_low, sigma_high;        // 95 %; high inf where 1/sigma = 0 is inside, low 0 under separated
  double lr_zero_slope, p_zero_slope;  // likelihood ratio of 1/sigma = 0, chi-square(1), and its p value
};

// Levels of one delta count together; all have the same number of categories.
Sureness sureness(const std::vector<SurenessLevel>& levels);

}  // namespace jnd
