#include "analysis/hierarchical/response_lattice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/hierarchical/lattice_sums.h"

namespace jnd {

namespace {

// Nodes that a table gets beyond those asked for, so that a search does not build it anew at every step; one that others
// are built from has as many again.
constexpr int kSpareNodes = 3;

}  // namespace

LatticeRange LatticeRange::united(const LatticeRange& other) const noexcept {
  if (empty()) return other;
  return {std::min(s0, other.s0), std::max(s1, other.s1), std::min(k0, other.k0), std::max(k1, other.k1)};
}

LatticeRange LatticeRange::covering(const LatticeRange& needed) const noexcept {
  constexpr std::size_t kMostWaste = 4;
  const LatticeRange both = united(needed);
  const bool near = both.wide() * both.high() <= kMostWaste * needed.wide() * needed.high();
  return (near ? both : needed).widened(kSpareNodes);
}

ResponseLattice::ResponseLattice(ResponseModel model, std::vector<LatticeQuestion> questions,
                                 const SharedParameters& shared, const LatticeSteps& steps)
    : model_(model), questions_(std::move(questions)), shared_(shared), steps_(steps) {
  positive_.resize(questions_.size());
  negative_.resize(questions_.size());
}

void ResponseLattice::cover(const LatticeRange& range) {
  if (!range_.empty() && range_.holds(range)) return;
  const LatticeRange wider = range_.covering(range).widened(kSpareNodes);
  for (std::size_t i = 0; i < questions_.size(); ++i) {
    const LatticeQuestion& question = questions_[i];
    const double side = question.second_half ? 0.5 : -0.5;
    const double shift_s = side * shared_.drift_ln_s, shift_k = side * shared_.drift_criterion;
    std::vector<double> slopes;
    for (int s = wider.s0; s <= wider.s1; ++s) slopes.push_back(std::exp(-(s * steps_.ln_s + shift_s)));
    const bool no_slope = model_ == ResponseModel::yes_no && question.level == 0;  // the same at every spread
    std::vector<double> positive(wider.wide() * wider.high()), negative(positive.size());
    for (int k = wider.k0; k <= wider.k1; ++k) {
      LogRates rates{};
      for (int s = wider.s0; s <= wider.s1; ++s) {
        const std::size_t to = wider.place(s, k);
        if (range_.holds({s, s, k, k}))
          rates = {positive_[i][range_.place(s, k)], negative_[i][range_.place(s, k)]};
        else if (s == wider.s0 || !no_slope)
          rates = log_rates_of_slope(model_, question.level, slopes[static_cast<std::size_t>(s - wider.s0)],
                                     k * steps_.criterion + shift_k, shared_.lapse);
        positive[to] = rates.positive;
        negative[to] = rates.negative;
      }
    }
    positive_[i] = std::move(positive);
    negative_[i] = std::move(negative);
  }
  range_ = wider;
}

void CellLikelihood::cover(const LatticeRange& range, ResponseLattice& responses) {
  if (!range_.empty() && range_.holds(range)) return;
  range_ = range_.covering(range);
  responses.cover(range_);
  const std::size_t wide = range_.wide();
  values_.assign(wide * range_.high(), 0);
  for (int k = range_.k0; k <= range_.k1; ++k) {
    double* row = &values_[range_.place(range_.s0, k)];
    const std::size_t from = responses.range().place(range_.s0, k);
    for (const QuestionAnswers& answers : answers_) {
      const double *positive = &responses.positive(answers.question)[from],
                   *negative = &responses.negative(answers.question)[from];
      add_answers(answers.positive, positive, answers.negative, negative, wide, row);
    }
  }
  largest_ = *std::max_element(values_.begin(), values_.end());
}

}  // namespace jnd
