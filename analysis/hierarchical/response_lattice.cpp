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
  for (auto* rates : {&positive_, &negative_, &sure_positive_, &sure_negative_}) rates->resize(questions_.size());
}

void ResponseLattice::cover(const LatticeRange& range) {
  if (!range_.empty() && range_.holds(range)) return;
  range_ = range_.covering(range).widened(kSpareNodes);
  for (std::size_t i = 0; i < questions_.size(); ++i) lay_out(i);
}

void ResponseLattice::lay_out(std::size_t i) {
  const LatticeQuestion& question = questions_[i];
  const double side = question.second_half ? 0.5 : -0.5;
  const double shift_s = side * shared_.drift_ln_s, shift_k = side * shared_.drift_criterion;
  const std::size_t nodes = range_.wide() * range_.high(), sure_nodes = shared_.graded() ? nodes : 0;
  for (std::vector<double>* of_unsure : {&positive_[i], &negative_[i]}) of_unsure->resize(nodes);
  for (std::vector<double>* of_sure : {&sure_positive_[i], &sure_negative_[i]}) of_sure->resize(sure_nodes);
  std::vector<double> slopes;
  for (int s = range_.s0; s <= range_.s1; ++s) slopes.push_back(std::exp(-(s * steps_.ln_s + shift_s)));
  const bool no_slope = model_ == ResponseModel::yes_no && question.level == 0;  // the same at every spread
  for (int k = range_.k0; k <= range_.k1; ++k) {
    const double criterion = k * steps_.criterion + shift_k;
    GradedLogRates rates{};
    for (std::size_t s = 0, to = range_.place(range_.s0, k); s < slopes.size(); ++s, ++to) {
      if (s == 0 || !no_slope) {
        if (shared_.graded())
          rates = graded_log_rates(model_, question.level, -std::log(slopes[s]), criterion, shared_);
        else
          rates.unsure = log_rates_of_slope(model_, question.level, slopes[s], criterion, shared_.lapse);
      }
      positive_[i][to] = rates.unsure.positive;
      negative_[i][to] = rates.unsure.negative;
      if (!shared_.graded()) continue;
      sure_positive_[i][to] = rates.sure.positive;
      sure_negative_[i][to] = rates.sure.negative;
    }
  }
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
      const auto [unsure, sure] = graded_counts(answers.counts, responses.shared());
      add_answers(unsure.positive, positive, unsure.negative, negative, wide, row);
      if (responses.shared().graded())
        add_answers(sure.positive, &responses.sure_positive(answers.question)[from], sure.negative,
                    &responses.sure_negative(answers.question)[from], wide, row);
    }
  }
  largest_ = *std::max_element(values_.begin(), values_.end());
}

}  // namespace jnd
