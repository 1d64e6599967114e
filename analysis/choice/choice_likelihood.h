// The likelihood of two-interval choices with its derivatives, and the way to a peak of it. Of two_interval.h only.
//
// Variables: a, c, b, l, with eta = a + c (t - pivot) + b o, and t the level, shifted by the middle of the levels and
// divided by their range. c >= 0. What is profiled is a box with some variables held: s (c held), b, and the PSE (a held
// at 0, the pivot at the PSE).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "analysis/choice/two_interval.h"

namespace jnd {

inline constexpr double kSteepestChoice = 1e12;  // the largest c of a search: far beyond what doubles tell from a step

// Sorted by level; rows without trials left out.
struct ChoiceData {
  ChoiceLink link = ChoiceLink::probit;
  std::vector<double> t, o, n, k, level;
  double shift = 0, scale = 1;  // t = (level - shift)/scale
  double trials = 0, chosen = 0;
  double saturated = 0;  // log-likelihood of the rates themselves

  std::size_t rows() const noexcept { return t.size(); }
};
// with_order: keeps the orders; else o = 0. Throws std::invalid_argument as fit_two_interval.
ChoiceData choice_data(std::span<const ChoiceRow> rows, ChoiceLink link, bool with_order);

enum ChoiceVariable : std::size_t { kA, kC, kB, kL, kChoiceVariables };
using ChoicePlace = std::array<double, kChoiceVariables>;

struct ChoiceBox {
  ChoicePlace lower, upper;
  void hold(ChoiceVariable variable, double value) noexcept { lower[variable] = upper[variable] = value; }
  bool held(std::size_t variable) const noexcept { return lower[variable] == upper[variable]; }
};
// All that the options leave free. lapse: fixed, or none.
ChoiceBox choice_box(bool with_order, const std::optional<double>& lapse) noexcept;

double choice_log_likelihood(const ChoiceData& data, const ChoicePlace& place, double pivot) noexcept;

struct ChoicePeak {
  ChoicePlace place{};
  double value = -kInf;
};
// Damped Newton steps from start (within the box) to a local maximum; where the likelihood grows without end, as far as
// 1e-11 of its supremum. Concave without lapses, and then the global one.
ChoicePeak climb(const ChoiceData& data, const ChoicePlace& start, const ChoiceBox& box, double pivot) noexcept;

// The best of all, where there may be several peaks: from start, and from the best places of a survey of slopes and
// thresholds. Held variables keep their values.
ChoicePeak climb_from_survey(const ChoiceData& data, const ChoicePlace& start, const ChoiceBox& box, double pivot);

// The same with one climb, from the best of those places and start: enough where there is one peak, but start may be so
// far off that the likelihood is straight there.
ChoicePeak climb_from_best(const ChoiceData& data, const ChoicePlace& start, const ChoiceBox& box, double pivot);

// Weighted least squares on empirical logits, a start near the maximum; c >= 0.
ChoicePlace choice_start(const ChoiceData& data, const ChoiceBox& box) noexcept;

double choice_cdf(ChoiceLink link, double eta) noexcept;     // F
double choice_quantile(ChoiceLink link, double p) noexcept;  // F^-1; infinite at 0 and 1

// e ln p, 0 where e = 0.
double choice_count_log(double e, double p) noexcept;

}  // namespace jnd
