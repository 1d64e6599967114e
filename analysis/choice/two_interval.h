// "Which is stiffer?": two intervals, a standard and a comparison, and the answer which of them has more of the quantity
// (2IFC, method of constant stimuli).
//
//   P(comparison chosen) = l/2 + (1 - l) F(eta),   eta = (x - PSE)/s [+ b o]
//
//   F   Phi (probit) or 1/(1 + exp(-eta)) (logit)
//   s   > 0, in units of the level; 1/s is the slope
//   l   lapse rate: on that share of trials the answer is a guess, so that it takes half of it from either end
//   o   +1 where the comparison came second, -1 where it came first; b > 0: the second interval is favoured
//
// Sources: Ulrich and Vorberg 2009, Atten Percept Psychophys 71:1219 (order); Wichmann and Hill 2001, Percept Psychophys
// 63:1293 (lapses, deviance); Venzon and Moolgavkar 1988, Appl Statist 37:87 (profile intervals); Silvapulle 1981,
// J R Stat Soc B 43:310 (when a maximum exists).
// Tests: R 4.2.2 (glm, and its own likelihood with lapses) and an independent Python search, analysis/selftest; a slow
// search over all functions of the family, tests/analysis/choice.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

enum class ChoiceLink { probit, logit };
inline constexpr auto kChoiceLinkWords =
    words<ChoiceLink>({{"probit", ChoiceLink::probit}, {"logit", ChoiceLink::logit}});

// The trials of one level, and of one order where that is told apart.
struct ChoiceRow {
  double level = 0;      // of the comparison; finite, any unit
  long long n = 0;       // trials, >= 0
  long long chosen = 0;  // times the comparison was chosen, 0..n
  int order = 0;         // 1: the comparison came second, -1: first; 0 only where order_term is off
};

struct TwoIntervalOptions {
  ChoiceLink link = ChoiceLink::probit;
  std::optional<double> lapse = 0.0;  // fixed, 0 <= lapse < 1; none: free in 0..kLargestChoiceLapse
  bool order_term = false;            // estimate b; else b = 0
  // Fixed; none: estimated. Comparisons on one side of a standard do not tell the PSE from s, so that there it is the
  // standard.
  std::optional<double> pse = std::nullopt;
};
inline constexpr double kLargestChoiceLapse = 0.1;

enum class TwoIntervalStatus {
  ok,              // finite positive slope
  separated,       // the likelihood grows all the way to s -> 0: s and the JNDs are 0, the PSE is a range
  not_identified,  // one level only, and a PSE to estimate: any slope goes through its rate
  flat,            // the best slope is <= 0: s and the JNDs are infinite, no PSE
  all_same,        // one and the same answer throughout: neither s nor PSE
  missing          // no trials
};
inline constexpr auto kTwoIntervalStatusWords =
    words<TwoIntervalStatus>({{"ok", TwoIntervalStatus::ok},
                              {"separated", TwoIntervalStatus::separated},
                              {"not_identified", TwoIntervalStatus::not_identified},
                              {"flat", TwoIntervalStatus::flat},
                              {"all_same", TwoIntervalStatus::all_same},
                              {"missing", TwoIntervalStatus::missing}});

struct ChoiceBounds {
  double low = 0, high = 0;  // infinite where open
};

// Just noticeable differences: quantiles of F, above the PSE, without the lapses. In units of s unless scaled.
struct ChoiceJnds {
  double jnd_75 = 0;       // 75 % chosen: F^-1(0.75); probit 0.6745 s
  double jnd_84 = 0;       // 84.13 %: F^-1(Phi(1)); probit s
  double jnd_dprime1 = 0;  // d' = 1 of the two-interval task: F^-1(Phi(1/sqrt 2)); probit s/sqrt 2
};
ChoiceJnds choice_jnds(ChoiceLink link, double s) noexcept;  // s >= 0, may be infinite

struct TwoIntervalFit {
  TwoIntervalStatus status = TwoIntervalStatus::missing;
  // PSE and s in units of the level. s: 0 under separated, infinite under flat. pse: the middle of pse_range under
  // separated; infinite where all answers of one order are the same, and its range open.
  std::optional<double> pse, s;
  std::optional<ChoiceBounds>
      pse_range;                  // separated: every PSE that reaches the supremum; an open interval, or one level
  std::optional<double> lapse;    // none under flat where it is free: not identified
  std::optional<double> order_b;  // none without order_term, where only one order has trials, or any b does
  std::optional<double> log_likelihood;  // supremum, without binomial constants; none under missing
  std::optional<double> deviance;        // 2 (log-likelihood of the rates themselves - this one)
  long long trials = 0;
};

// Maximum likelihood. Microseconds: without lapses one concave climb, with lapses from the peaks of a survey of steps
// and slopes. Throws std::invalid_argument where a row or an option breaks its range. Thread-safe.
TwoIntervalFit fit_two_interval(std::span<const ChoiceRow> rows, const TwoIntervalOptions& options = {});

// 95 % profile-likelihood intervals: the connected set about the estimate that is not rejected at 5 %, the other
// parameters at their best. Open ends are infinite.
struct TwoIntervalIntervals {
  // Empty under missing and not_identified; pse has no meaning where it is fixed; order_b as in the fit, also where any b
  // does.
  std::optional<ChoiceBounds> pse, s, order_b;
};
TwoIntervalIntervals two_interval_intervals(std::span<const ChoiceRow> rows, const TwoIntervalOptions& options = {});

// Likelihood-ratio test of b = 0, by chi-squared with 1 degree of freedom. p: NaN without trials of both orders.
struct OrderTermTest {
  double log_likelihood_without = kNaN;
  double lr = kNaN;
  double p = kNaN;
};
// fit: of the same rows and options, with order_term.
OrderTermTest test_order_term(std::span<const ChoiceRow> rows, const TwoIntervalOptions& options,
                              const TwoIntervalFit& fit);

// The sum of ln choose(n, chosen), which R's logLik(glm) adds.
double log_binomial_constants(std::span<const ChoiceRow> rows);

}  // namespace jnd
