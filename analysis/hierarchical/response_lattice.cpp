#include "analysis/hierarchical/response_lattice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/hierarchical/fast_functions.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

// Nodes that a table gets beyond those asked for, so that a search does not build it anew at every step.
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
  const LatticeRange wider = range_.covering(range);
  for (std::size_t i = 0; i < questions_.size(); ++i) {
    const LatticeQuestion& question = questions_[i];
    const double side = question.second_half ? 0.5 : -0.5;
    const double shift_s = side * shared_.drift_ln_s, shift_k = side * shared_.drift_criterion;
    const std::vector<double> known_positive = std::move(positive_[i]), known_negative = std::move(negative_[i]);
    positive_[i].assign(wider.wide() * wider.high(), 0);
    negative_[i].assign(wider.wide() * wider.high(), 0);
    for (int k = wider.k0; k <= wider.k1; ++k)
      for (int s = wider.s0; s <= wider.s1; ++s) {
        const bool known = range_.holds({s, s, k, k});
        const std::size_t from = known ? range_.place(s, k) : 0, to = wider.place(s, k);
        const LogRates rates = known ? LogRates{known_positive[from], known_negative[from]}
                                     : log_rates(model_, question.level, s * steps_.ln_s + shift_s,
                                                 k * steps_.criterion + shift_k, shared_.lapse);
        positive_[i][to] = rates.positive;
        negative_[i][to] = rates.negative;
      }
  }
  range_ = wider;
}

void CellLikelihood::cover(const LatticeRange& range, ResponseLattice& responses) {
  if (!range_.empty() && range_.holds(range)) return;
  range_ = range_.covering(range);
  responses.cover(range_);
  const std::size_t wide = range_.wide();
  values_.assign(wide * range_.high(), 0);
  log_scale_ = -kInf;
  for (int k = range_.k0; k <= range_.k1; ++k) {
    double* row = &values_[range_.place(range_.s0, k)];
    const std::size_t from = responses.range().place(range_.s0, k);
    for (const QuestionAnswers& answers : answers_) {
      const double *positive = &responses.positive(answers.question)[from],
                   *negative = &responses.negative(answers.question)[from];
      for (std::size_t s = 0; s < wide; ++s) row[s] += answers.positive * positive[s] + answers.negative * negative[s];
    }
    log_scale_ = std::max(log_scale_, *std::max_element(row, row + wide));
  }
  exponentiate(values_, log_scale_);
}

}  // namespace jnd
