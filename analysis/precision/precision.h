// How precisely a planned design will measure JNDs, before the first participant: of one participant, of a group's mean,
// of differences between conditions. For the least-squares JND of the yes-no model (analysis/thresholds/jnd.h).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "analysis/precision/cell_distribution.h"
#include "analysis/precision/slope_distribution.h"

namespace jnd {

// enumeration: every possible outcome with its probability. simulation: seeded draws, with standard errors.
enum class PrecisionMethod { enumeration, simulation };
std::string_view to_string(PrecisionMethod method) noexcept;

struct PrecisionQuestion {
  CountsDesign design;
  std::vector<double> jnds;                   // the true one of each condition, > 0, in the differences' unit
  std::vector<std::array<int, 2>> contrasts;  // places in jnds: the first minus the second
  int participants = 1;
  double between_cv =
      0;  // spread of the true JNDs of the participants, as in analysis/precision/monte_carlo.h; for the group
  double wanted_cv = 0.10;  // of one participant's JND, > 0
  std::uint64_t seed = 1;
  int draws = 100'000;       // participants drawn, for intervals and where enumeration is not feasible; >= 100
  int experiments = 20'000;  // studies drawn, for the group; >= 100
};

// What makes a participant's d' doubtful in one condition. Exact, in closed form.
struct DesignRisks {
  double any_extreme = 0;       // P(a hit or false-alarm rate of 0 or 1, or an empty class, in some series)
  double any_not_positive = 0;  // P(d' <= 0 in some series)
  double any_missing = 0;       // P(an empty class in some series)
};
DesignRisks design_risks(const CountsDesign& design, double jnd);

// SE(JND) / JND for many trials: sqrt(sum(dK^2 V / n)) JND / sum(dK^2), V = n Var(d') (delta method). inf where a rate
// is 0 or 1 for certain.
double asymptotic_cv(const CountsDesign& design, double jnd);
// The trials a cell at which that is the wanted one, rounded up: to 4 for balanced classes. None above a million.
std::optional<int> trials_for_cv(const CountsDesign& design, double jnd, double wanted_cv);

// One participant in one condition. Shares are of all participants: undefined outcomes are counted, never left out.
struct ParticipantPrecision {
  double true_jnd = 0;

  DesignRisks risks;

  // The distribution of the estimates. Quantiles are of those with information: no_sensitivity is +inf, ceiling 0.
  PrecisionMethod method = PrecisionMethod::enumeration;
  int replicates = 0;  // draws of a simulation; 0 of an enumeration
  JndStatusShares status;
  double q025 = 0, q05 = 0, median = 0, q95 = 0, q975 = 0;
  double mean = 0;            // over status ok. It has no finite limit as trials shrink: slopes near 0 dominate it
  double bias_of_median = 0;  // median - true JND
  double bias_of_mean = 0;    // mean - true JND
  double outside_tested = 0;  // P(undefined, or outside the range of the tested differences)
  double median_se = 0;       // of the simulation's median; 0 of an enumeration
  double share_se = 0;        // the largest that a share of the simulation can have; 0 of an enumeration

  // The coefficient of variation, in two senses. cv: asymptotic_cv(), the standard error of the JND over the true JND.
  // spread: (q84.13 - q15.87) / (2 median) of the estimates themselves, which is the same for a normal distribution;
  // +inf where more than 15.87 % have no sensitivity.
  double cv = 0;
  double spread = 0;

  std::optional<int> proposed_trials;  // a cell, for the wanted cv

  // The 95 % interval that one participant's data will give: m +- 1.96 SE(m) with the variances of Gourevitch and
  // Galanter, inverted to bounds of the JND. From `interval_draws` draws.
  int interval_draws = 0;
  double interval_width = 0;      // median over all participants; +inf where half of them have no upper bound
  double interval_width_se = 0;   // NaN where the width is infinite
  double interval_unbounded = 0;  // share without an upper bound (slope not clearly above 0), or without any interval
};

// The mean of the JNDs (status ok) of a study's participants, over many such studies.
struct GroupPrecision {
  double median = 0, q05 = 0, q95 = 0;  // of the mean; NaN where no study had one
  double ci_width = 0;  // median width of the 95 % t interval; 1/m has no finite mean, nor has the width
  double ci_width_se = 0;
  double without_interval = 0;  // share of studies with fewer than two usable participants
  double with_undefined = 0;    // share of studies with a participant whose JND is undefined
  double mean_undefined = 0;    // participants with an undefined JND, a study
};

// A paired difference of two conditions, over the participants with both.
struct ContrastPrecision {
  int a = 0, b = 0;
  double true_difference = 0;  // of the true JNDs
  double median = 0;           // of the estimated mean difference
  double ci_width = 0;         // median width of the 95 % t interval
  double ci_width_se = 0;
  // Share of all studies whose 95 % t interval excludes 0, of the JNDs and of the slopes m. Where the true JNDs are
  // equal this is the rate of false findings.
  double power = 0, power_se = 0;
  double power_of_slopes = 0, power_of_slopes_se = 0;
  double without_interval = 0;  // share of studies with fewer than two participants with both JNDs
  double with_undefined = 0;    // share of studies with a participant who lacks one of the two
};

struct Precision {
  PrecisionQuestion question;
  std::vector<ParticipantPrecision> participant;  // a condition each
  std::vector<GroupPrecision> group;              // a condition each; by simulation of question.experiments studies
  std::vector<ContrastPrecision> contrasts;
};

// Throws std::invalid_argument where a number of the question is out of its range. progress hears how many of the
// question's experiments are drawn: after the participants' part, and then a few hundred times.
Precision precision(const PrecisionQuestion& question, const std::function<void(int)>& progress = {});

// Only one participant's part, of one true JND.
ParticipantPrecision participant_precision(const PrecisionQuestion& question, double jnd);

}  // namespace jnd
