// What else the same-different trials of a person tell: bias, the order of the stimuli, drift over the session.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "analysis/detection/counts.h"
#include "analysis/detection/yes_no.h"

namespace jnd {

struct JudgedTrial {
  bool same = false;            // the two stimuli were equal
  bool first_stiffer = false;   // of different stimuli, the stiffer came in the first interval; unused where same
  bool said_different = false;  // the answer
  double difference = 0;        // between the stimuli, N/m; 0 where same
  double time_fraction = 0;     // place in the session, 0 (first trial) .. 1 (last)

  bool correct() const noexcept { return said_different != same; }
};

// The four numbers of a cell, over all of the trials.
Counts counts_of(std::span<const JudgedTrial> trials) noexcept;

// k of n as a share with its Wilson score interval, 95 % (Wilson 1927, J Am Stat Assoc 22:209).
struct Share {
  int k = 0, n = 0;
  double value = 0;                // k / n; NaN for n = 0
  double ci_low = 0, ci_high = 0;  // in 0..1; NaN for n = 0
};
Share share_of(int k, int n) noexcept;  // 0 <= k <= n

// Does the participant lean towards one answer? Over all trials together, whatever their difference.
struct ResponseBias {
  // ok; missing (no different or no equal pair: criterion NaN); no_information (one answer throughout: the criterion is
  // the arithmetic of the log-linear rates).
  RateStatus status = RateStatus::missing;
  Counts counts;
  // c = -(zH + zF)/2 of the log-linear rates; positive: tends to say "same". Wald interval, 95 %, from the variance of
  // Gourevitch and Galanter (Var c = Var d' / 4). Pooled over differences it is a summary, not the criterion of one
  // series.
  double criterion = 0, se = 0, ci_low = 0, ci_high = 0;
  // How often "different" was said, and how often it would have been true by the plan.
  Share said_different;  // with Clopper and Pearson's interval, to which p belongs
  double planned_share = 0;
  double p = 0;  // two-sided exact binomial test of said_different against planned_share; NaN without trials
};

// planned_share: of different pairs among all trials, 0 < planned_share < 1 (0.5 in Chinello 2017).
ResponseBias response_bias(const Counts& counts, double planned_share);
ResponseBias response_bias(std::span<const JudgedTrial> trials, double planned_share);

// Does it matter which interval holds the stiffer object? Among different pairs, how often "different" was said with
// the stiffer one first and with the stiffer one second (the time-order error: Hellstrom 1985, Psychol Bull 97:35).
enum class OrderStatus {
  ok,
  no_stiffer_first,   // no different pair had the stiffer object first: nothing to compare
  no_stiffer_second,  // or second
  no_different_trials
};
std::string_view to_string(OrderStatus status) noexcept;

struct OrderEffect {
  OrderStatus status = OrderStatus::no_different_trials;
  Share stiffer_first, stiffer_second;  // said "different", of the different pairs with that order
  // First minus second, and the two-sided p of no difference, by one score test: the 95 % interval holds the differences that it
  // does not reject (Miettinen and Nurminen 1985, Stat Med 4:213). NaN unless ok.
  double difference = 0, ci_low = 0, ci_high = 0, p = 0;
};

// Pools all differences: balanced designs have each order equally often at each.
OrderEffect order_effect(std::span<const JudgedTrial> trials);

// The same from counts: said "different" of so many.
OrderEffect order_effect(int first_said, int first_n, int second_said, int second_n);

// Does performance change over the session? d' and criterion of its first and second half.

// A quantity in both halves. Log-linear rates, yes-no model, all differences pooled.
struct HalfDifference {
  double first = 0, second = 0;
  // second - first, with its Wald interval, 95 %, and the two-sided p that belongs to it (variances of Gourevitch and Galanter
  // 1967, added). p is NaN where a half has one answer throughout.
  double difference = 0, se = 0, ci_low = 0, ci_high = 0, p = 0;
};

struct Drift {
  // ok; missing where a half lacks a class of trials (everything is NaN); no_information where one answer was given
  // throughout a half (the differences are the arithmetic of the log-linear rates).
  RateStatus status = RateStatus::missing;
  Counts first, second;
  HalfDifference dprime, criterion;
};

Drift drift(const Counts& first, const Counts& second);
// The first half: time_fraction < 0.5.
Drift drift(std::span<const JudgedTrial> trials);

// The change of d' over several strata, such as the series of a study, each with trials in both halves: a stratum that
// happened to come early is compared with itself only.
struct StratifiedDrift {
  int strata = 0;  // with both classes in both halves
  // Mean over the strata, weighted by 1/variance, with its Wald interval, 95 %, and two-sided p. NaN for no stratum.
  double difference = 0, se = 0, ci_low = 0, ci_high = 0, p = 0;
};
StratifiedDrift stratified_drift(std::span<const Drift> strata);

}  // namespace jnd
