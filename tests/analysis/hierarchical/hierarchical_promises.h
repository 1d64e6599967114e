// Random studies, and what is promised of every fit of the hierarchical model.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/hierarchical/hierarchical_bootstrap.h"
#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/numerics/binomial.h"
#include "analysis/numerics/experiment_stream.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd::testing {

struct RandomStudy {
  std::vector<HierarchicalCell> cells;
  HierarchicalModel model;
};

// 2 to 18 people, 1 to 12 conditions, JNDs of 50 to 2000 where levels are 200 to 400 (of choices 100 to 300 about the
// standard), 4 to 200 trials a cell, spreads from 0 to 0.6, every observer and both tasks, a fifth with lapses; in half of
// the studies some people, cells or conditions give one answer, step, or are missing.
inline RandomStudy random_study(std::uint64_t number) {
  ExperimentStream stream{20'000, 0x50726f6d69736573, number, 0};
  const auto uniform = [&] { return open_uniform(stream.next()); };
  const auto whole = [&](int from, int to) { return from + static_cast<int>(uniform() * (to - from + 1)); };
  const auto any = [&](double share) { return uniform() < share; };
  RandomStudy study;
  study.model.response = std::array{
      ResponseModel::yes_no,      ResponseModel::yes_no, ResponseModel::differencing,
      ResponseModel::independent, ResponseModel::choice, ResponseModel::choice}[static_cast<std::size_t>(whole(0, 5))];
  const ResponseModel response = study.model.response;
  const bool choice = response == ResponseModel::choice;
  const int people = any(0.5) ? whole(2, 6) : whole(2, 18), conditions = any(0.7) ? whole(1, 4) : whole(1, 12);
  const int trials = static_cast<int>(4 * std::pow(50, uniform()));
  const double lapse = any(0.2) ? 0.05 : 0;
  const double jnd = 50 * std::pow(40, uniform());
  HierarchicalPlace truth;
  truth.tu = any(0.2) ? 0 : 0.6 * uniform();
  truth.tv = any(0.3) ? 0 : 0.4 * uniform();
  truth.tw = any(0.2) ? 0 : 0.6 * uniform() * (choice ? 100 : 1);
  for (int c = 0; c < conditions; ++c) {
    truth.mu.push_back(std::log(jnd) + 0.6 * (uniform() - 0.5));
    truth.kappa.push_back(choice                                   ? 100 * (uniform() - 0.5)
                          : response == ResponseModel::independent ? uniform() - 0.5
                                                                   : 0.4 + 0.8 * uniform());
  }
  const std::vector<double> levels =
      choice ? std::vector<double>{-200, -100, -50, 50, 100, 200} : std::vector<double>{200, 300, 400};
  for (int p = 0; p < people; ++p)
    for (int c = 0; c < conditions; ++c) {
      const int each = std::max(1, trials / (2 * static_cast<int>(levels.size())));
      if (!choice && response != ResponseModel::independent)
        study.cells.push_back({p, c, 0, 0, static_cast<double>(std::max(1, trials / 2))});
      for (const double level : levels) {
        study.cells.push_back({p, c, level, 0, static_cast<double>(each)});
        if (response == ResponseModel::independent) study.cells.push_back({p, c, -level, 0, static_cast<double>(each)});
      }
    }
  HierarchicalModel drawn = study.model;
  drawn.shared.lapse = lapse;
  study.cells = drawn_answers(study.cells, drawn, truth, 20'000, number);
  study.model.shared.lapse = any(0.5) ? lapse : 0;
  if (!any(0.5)) return study;
  const int kind = whole(0, 3), of_people = whole(0, people - 1), of_conditions = whole(0, conditions - 1);
  for (HierarchicalCell& cell : study.cells) {
    const bool here = kind == 0   ? cell.participant == of_people
                      : kind == 1 ? cell.condition == of_conditions
                      : kind == 2 ? cell.participant == of_people && cell.condition == of_conditions
                                  : cell.condition == of_conditions && cell.participant <= of_people;
    if (!here) continue;
    const double n = cell.positive + cell.negative;
    const int how = (of_people + of_conditions + kind) % 5;
    const bool positive = how == 0 || (how == 1 && cell.level > (choice ? 0 : 100)) || (how == 2 && cell.level < 100);
    cell.positive = how == 4 ? 0 : how == 3 ? std::round(n / 2) : positive ? n : 0;
    cell.negative = how == 4 && kind != 0 ? 0 : n - cell.positive;
  }
  return study;
}

// What a fit did not keep; empty: everything.
struct Kept {
  std::vector<std::string> broken;
  int intervals = 0, tests = 0, out_of_work = 0, not_converged = 0;
  bool unsettled = false, inexact = false, off = false, submodel = false;
};

inline Kept kept_promises(const RandomStudy& study, bool denser = true) {
  Kept kept;
  const auto say = [&](std::string what) { kept.broken.push_back(std::move(what)); };
  HierarchicalAnalysis analysis(study.cells, study.model);
  HierarchicalWish wish{.intervals = true, .shared = true, .pairs = analysis.pairs()};
  if (wish.pairs.size() > 6) wish.pairs.resize(6);
  const HierarchicalFit& fit = analysis.complete(wish, 1);
  kept.unsettled = !fit.maximum.converged;
  kept.inexact = !fit.exact;
  const auto look = [&](const std::string& name, double estimate, bool stated, const ProfileEnds& ends,
                        auto&& drop_at) {
    if (ends.status == EndsStatus::not_computed) return;
    if (ends.status == EndsStatus::out_of_work) ++kept.out_of_work;
    if (ends.status == EndsStatus::not_converged) ++kept.not_converged;
    if (ends.status != EndsStatus::ok) return;
    ++kept.intervals;
    if (!stated && !(ends.low < estimate && estimate < ends.high))
      say(fmt::format("{}: {} not within {} and {}", name, estimate, ends.low, ends.high));
    if (std::isnan(ends.low) || std::isnan(ends.high)) say(name + ": no number");
    for (const double at : {-0.7, -0.15, 0.1, 0.4}) {
      const double value = estimate + at;
      const double drop = drop_at(value);
      if (std::isnan(drop)) continue;
      ++kept.tests;
      const double p = chi2_upper(2 * drop, 1);
      if (std::abs(p - 0.05) < 0.001) continue;
      if ((p < 0.05) != (value < ends.low || value > ends.high))
        say(fmt::format("{}: {} has p {:.4f} and the interval is {} to {}", name, value, p, ends.low, ends.high));
    }
  };
  std::size_t looked = 0;
  for (std::size_t c = 0; c < fit.conditions.size(); ++c) {
    const ConditionMean& one = fit.conditions[c];
    if (one.ends.status == EndsStatus::not_computed) continue;
    const double estimate = fit.maximum.place.mu[c];
    const bool stated = one.status != SlopeStatus::ok;
    const bool test = looked++ < 1;
    look(fmt::format("mean {}", c), estimate, stated, one.ends,
         [&](double value) { return test && !stated ? analysis.drop_of_mean(c, value) : kNaN; });
    if (stated && !(one.ends.low <= estimate && estimate <= one.ends.high) && one.ends.status == EndsStatus::ok)
      say(fmt::format("mean {} ({}): {} not within {} and {}", c, word_of(kSlopeStatusWords, one.status), estimate,
                      one.ends.low, one.ends.high));
    look(fmt::format("criterion {}", c), fit.maximum.place.kappa[c], false, one.criterion_ends,
         [](double) { return kNaN; });
  }
  looked = 0;
  for (const ConditionDifference& one : fit.differences) {
    if (one.ends.status != EndsStatus::ok || std::isnan(one.difference)) continue;
    if (!std::isnan(one.p) && std::abs(one.p - 0.05) > 0.001 &&
        (one.p < 0.05) != (one.ends.low > 0 || one.ends.high < 0))
      say(fmt::format("difference {} {}: p {:.4f} and the interval is {} to {}", one.a, one.b, one.p, one.ends.low,
                      one.ends.high));
    const bool test = looked++ < 1;
    look(fmt::format("difference {} {}", one.a, one.b), one.difference, false, one.ends,
         [&](double value) { return test ? analysis.drop_of_difference(one.a, one.b, value) : kNaN; });
  }
  if (fit.df > 0 && fit.common.log_likelihood > fit.maximum.log_likelihood + kTold)
    say("one mean is better than several");
  for (int i = 0; i < 3; ++i) {
    HierarchicalModel less = study.model;
    bool& spread = i == 0 ? less.tu : i == 1 ? less.tv : less.tw;
    if (!spread) continue;
    spread = false;
    if (HierarchicalAnalysis(study.cells, less).fit().maximum.log_likelihood > fit.maximum.log_likelihood + 1e-4)
      kept.submodel = true;
  }
  if (denser && fit.maximum.converged) {
    HierarchicalLikelihood dense(analysis.cells(), study.model.response, fit.maximum.shared, 3);
    kept.off = std::abs(dense.at(fit.maximum.place).log_likelihood - fit.maximum.log_likelihood) > 1e-4;
  }
  return kept;
}

}  // namespace jnd::testing
