// What each person may be, drawn given their answers and the estimates of the group.
//
// The integral over a row of equally spaced nodes does not depend on where the row begins (its error is that of the
// trapezoid rule, about 3e-9). So one of the nodes of a row that begins anywhere in a spacing, chosen by its share of the
// sum, is a draw from the density itself. First u and w of the person, by the nodes of HierarchicalLikelihood, then v
// of each condition, given these, by nodes along v.
//
// Draws share the beginnings of their rows of u and w in groups of kDrawsOfARow, which lie evenly over the spacing. Each
// draw is one of the posterior all the same.
//
// Source of the even places: Roberts 2018, "The unreasonable effectiveness of quasirandom sequences" (additive
// recurrence by the plastic number). Tests: moments and ranks against HierarchicalLikelihood::posteriors and the truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

inline constexpr std::size_t kDrawsOfARow = 25;

class PosteriorDraws {
 public:
  // cells: as of HierarchicalAnalysis; place: of the same model, whose answers are independent and do not drift; draws
  // >= 1. The same seed gives the same draws of a
  // participant on every machine. A spread of 0 has deviations of 0, and who has no answers is drawn from the group.
  PosteriorDraws(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                 const HierarchicalPlace& place, std::size_t draws, std::uint64_t seed);

  // Of a participant in a condition.
  double ln_s(std::size_t participant, std::size_t condition, std::size_t draw) const noexcept {
    return ln_s_[of(participant, condition, draw)];
  }
  double criterion(std::size_t participant, std::size_t condition, std::size_t draw) const noexcept {
    return criterion_[of(participant, condition, draw)];
  }

 private:
  std::size_t of(std::size_t participant, std::size_t condition, std::size_t draw) const noexcept {
    return (participant * conditions_ + condition) * draws_ + draw;
  }

  std::size_t draws_, conditions_;
  std::vector<double> ln_s_, criterion_;  // by participant, condition, draw
};

// Does the hierarchical model draw answers like those that were given? A posterior predictive check.
//
// Every draw takes for each person ln s and criterion from their posterior at the estimates of the group
// (as above), and from these answers to the same questions. Compared with the answers given, by condition and
// level: the share of positive answers, and the standard deviation between people of their shares. Of all answers
// together a discrepancy, the sum of (y - n p)^2/(n p (1 - p)) over people, conditions and levels, at the rates p of
// each draw: of the given answers against the drawn ones.
//
// What it finds: levels at which the curve is too steep, too flat or out of place (lapses that were left out, another
// observer), people who differ more or less than the model says, answers of one person that depend on each other or
// drift (they scatter more), or are too regular. What it cannot find: what the estimates take up, such as a JND or a
// criterion that is off for another reason; effects of order or time that even out within a level. The
// answers are used twice, for the estimates and for the comparison, so that bands are wide and p stays near 0.5 more
// often than a p value should: a small p speaks against the model, a large one hardly for it. With a handful of answers
// at a level bands are so wide that a seventh of guesses may go unnoticed.
//
// Sources: Gelman, Meng and Stern 1996, Statistica Sinica 6:733 (realised discrepancies); Gelman et al. 2013, Bayesian
// Data Analysis, 3rd ed., chapter 6. Tests: answers drawn from the model, and from others.
inline constexpr int kPredictiveDraws = 400;

enum class BandStatus {
  inside,
  below,      // the answers given lie below 95 % of the drawn ones
  above,      // above
  one_person  // nobody to differ from
};
inline constexpr auto kBandStatusWords = words<BandStatus>({{"inside", BandStatus::inside},
                                                            {"below", BandStatus::below},
                                                            {"above", BandStatus::above},
                                                            {"one_person", BandStatus::one_person}});

// The answers given, and what 95 % of the drawn ones have. NaN where there is one person.
struct PredictiveBand {
  double observed = kNaN, low = kNaN, high = kNaN;
  BandStatus status = BandStatus::one_person;
};

// In one condition at one level.
struct PredictiveRow {
  std::size_t condition = 0;
  double level = 0;
  int participants = 0;  // who answered there
  double trials = 0;
  PredictiveBand share;    // of positive answers, 0..1
  PredictiveBand between;  // standard deviation of people's shares
};

struct PredictiveCheck {
  int draws = 0;
  std::vector<PredictiveRow> rows;  // by condition, then level; those with trials
  double observed = kNaN;           // the discrepancy of the answers given, median over the draws
  double drawn = kNaN;              // of the drawn ones
  double p = kNaN;                  // (1 + draws in which the drawn one is as large)/(1 + draws)

  int bands() const noexcept;    // that compare something
  int outside() const noexcept;  // the answers given lie outside
  // So many of as many independent bands may lie outside: more do in at most 5 % of studies.
  int outside_by_chance() const;
  bool bands_fit() const { return outside() <= outside_by_chance(); }
  bool scatter_fits() const noexcept { return p >= 0.025 && p <= 0.975; }
};

// cells: as of HierarchicalAnalysis, with whole counts and at least one trial; place: the estimates of the same model;
// draws >= 1. The same seed gives the same check on every machine. Throws Stopped (numerics/stop_request.h).
PredictiveCheck predictive_check(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                                 const HierarchicalPlace& place, int draws, std::uint64_t seed);

// What everyone who reads a check is told.
inline constexpr std::string_view kPredictiveMeaning =
    "The answers are used for the estimates too, so that a small p speaks against the model, and a large one hardly for "
    "it.";

}  // namespace jnd
