#include "analysis/hierarchical/response_lattice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/lattice/fast_functions.h"
#include "analysis/lattice/lattice_sums.h"

namespace jnd {

namespace {

// Nodes that a table gets beyond those asked for, so that a search does not build it anew at every step; one that others
// are built from has as many again.
constexpr int kSpareNodes = 3;

// Beta-binomial answers: ln of the product over i < y of (p + i g) and over i < n - y of (1 - p + i g), less that over
// i < n of (1 + i g), which every node has. g = r/(1 - r) of the intra-class correlation r. The factors of i = 0 are the
// answers' own probabilities; the others lie between i g and 1 + i g, and are multiplied up, as many as make a number
// that is no underflow, before a logarithm is taken.
// Source: Griffiths 1973, Biometrics 29:637.
class AlikeAnswers {
 public:
  AlikeAnswers(double overdispersion, std::size_t nodes)
      : per_answer_(overdispersion / (1 - overdispersion)), product_(nodes, 1) {}

  // Adds to the sums what `count` answers, of these probabilities and their logarithms, have.
  void add(const double* rates, const double* log_rates, double count, double* sums) {
    if (count < 1) return;
    for (std::size_t s = 0; s < product_.size(); ++s) sums[s] += log_rates[s];
    for (int i = 1; i < count; ++i) {
      const double more = i * per_answer_;
      if (least_ * more < kLeastProduct || most_ * (1 + more) > 1 / kLeastProduct) finish(sums);
      least_ *= more;
      most_ *= 1 + more;
      for (std::size_t s = 0; s < product_.size(); ++s) product_[s] *= rates[s] + more;
    }
  }
  void finish(double* sums) {
    for (std::size_t s = 0; s < product_.size(); ++s) sums[s] += std::log(product_[s]);
    std::fill(product_.begin(), product_.end(), 1.0);
    least_ = most_ = 1;
  }
  double log_of_all(double count) const {
    double sum = 0;
    for (int i = 1; i < count; ++i) sum += std::log1p(i * per_answer_);
    return sum;
  }

 private:
  static constexpr double kLeastProduct = 1e-250;
  double per_answer_;
  std::vector<double> product_;
  double least_ = 1, most_ = 1;  // that the product can be
};

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
  for (auto* rates : {&positive_, &negative_, &sure_positive_, &sure_negative_, &positive_rates_, &negative_rates_})
    rates->resize(questions_.size());
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
  if (shared_.overdispersion == 0) return;
  positive_rates_[i] = positive_[i];
  negative_rates_[i] = negative_[i];
  exponentiate(positive_rates_[i], 0);
  exponentiate(negative_rates_[i], 0);
}

void CellLikelihood::cover(const LatticeRange& range, ResponseLattice& responses) {
  if (!range_.empty() && range_.holds(range)) return;
  range_ = range_.covering(range);
  responses.cover(range_);
  const std::size_t wide = range_.wide();
  const double overdispersion = responses.shared().overdispersion;
  AlikeAnswers alike(overdispersion, overdispersion > 0 ? wide : 0);
  values_.assign(wide * range_.high(), 0);
  for (int k = range_.k0; k <= range_.k1; ++k) {
    double* row = &values_[range_.place(range_.s0, k)];
    const std::size_t from = responses.range().place(range_.s0, k);
    for (const QuestionAnswers& answers : answers_) {
      const double *positive = &responses.positive(answers.question)[from],
                   *negative = &responses.negative(answers.question)[from];
      const auto [unsure, sure] = graded_counts(answers.counts, responses.shared());
      const double *sure_positive = sure.positive > 0 ? &responses.sure_positive(answers.question)[from] : nullptr,
                   *sure_negative = sure.negative > 0 ? &responses.sure_negative(answers.question)[from] : nullptr;
      if (overdispersion > 0) {
        alike.add(&responses.positive_rates(answers.question)[from], positive, unsure.positive, row);
        alike.add(&responses.negative_rates(answers.question)[from], negative, unsure.negative, row);
        const auto add_sure = [&](const double* log_rates, double count) {
          std::vector<double> rates(log_rates, log_rates + wide);
          exponentiate(rates, 0);
          alike.add(rates.data(), log_rates, count, row);
        };
        if (sure_positive) add_sure(sure_positive, sure.positive);
        if (sure_negative) add_sure(sure_negative, sure.negative);
        continue;
      }
      add_answers(unsure.positive, positive, unsure.negative, negative, wide, row);
      if (sure_positive) add_answers(sure.positive, sure_positive, 0, sure_positive, wide, row);
      if (sure_negative) add_answers(sure.negative, sure_negative, 0, sure_negative, wide, row);
    }
    if (overdispersion > 0) alike.finish(row);
  }
  if (overdispersion > 0) {
    double of_all = 0;
    for (const QuestionAnswers& answers : answers_) of_all += alike.log_of_all(answers.counts.trials());
    for (double& value : values_) value -= of_all;
  }
  largest_ = *std::max_element(values_.begin(), values_.end());
  if (!responses.smooth()) exponentiate(values_, largest_);
}

}  // namespace jnd
