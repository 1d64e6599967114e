#include "analysis/hierarchical/response_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include "analysis/lattice/fast_functions.h"
#include "analysis/lattice/lattice_sums.h"

namespace jnd {

namespace {

// Nodes that a table gets beyond those asked for on every side, so that a search does not build it anew at every step.
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

// Of the probabilities of both answers, or of all four.
double nanoseconds_of(ResponseModel model, bool graded) {
  return (model == ResponseModel::differencing ? 40 : 10) * (graded ? 3 : 1) + (graded ? 20 : 0);
}

}  // namespace

LatticeRange LatticeRange::united(const LatticeRange& other) const noexcept {
  if (empty()) return other;
  return {std::min(s0, other.s0), std::max(s1, other.s1), std::min(k0, other.k0), std::max(k1, other.k1)};
}

LatticeRange LatticeRange::covering(const LatticeRange& needed) const noexcept {
  constexpr std::size_t kMostWaste = 2;
  const LatticeRange both = united(needed);
  const bool near = both.wide() * both.high() <= kMostWaste * needed.wide() * needed.high();
  return (near ? both : needed).widened(kSpareNodes);
}

void AnswerTable::add_lapses(const SharedParameters& shared) {
  with_lapses.clear();
  rates.clear();
  if (shared.lapse > 0) {
    with_lapses = without_lapses;
    exponentiate(with_lapses, 0);
    for (double& rate : with_lapses) rate = shared.lapse * share + (1 - shared.lapse) * rate;
    if (shared.overdispersion > 0) rates = with_lapses;
    take_logarithms(with_lapses);
  } else if (shared.overdispersion > 0) {
    rates = without_lapses;
    exponentiate(rates, 0);
  }
}

ResponseLattice::ResponseLattice(ResponseModel model, std::vector<LatticeQuestion> questions,
                                 const SharedParameters& shared, const LatticeSteps& steps)
    : model_(model), questions_(std::move(questions)), shared_(shared), steps_(steps), tables_(questions_.size()) {}

void ResponseLattice::set_shared(const SharedParameters& shared) {
  SharedParameters less = shared;
  less.lapse = shared_.lapse;
  less.overdispersion = shared_.overdispersion;
  const bool elsewhere = less != shared_;
  shared_ = shared;
  if (elsewhere) {
    range_ = {};
    return;
  }
  for (QuestionTables& tables : tables_)
    for (AnswerTable* table : {&tables.positive, &tables.negative, &tables.sure_positive, &tables.sure_negative})
      table->add_lapses(shared_);
}

void ResponseLattice::cover(const LatticeRange& range) {
  if (!range_.empty() && range_.holds(range)) return;
  lay_out(range_.covering(range).widened(kSpareNodes));
}

void ResponseLattice::extend(const LatticeRange& range) {
  if (!range_.empty() && range_.holds(range)) return;
  lay_out(range_.united(range).widened(kSpareNodes));
}

void ResponseLattice::lay_out(const LatticeRange& range) {
  if (!range_.empty() && range_.holds(range)) return;
  const LatticeRange before = range_;
  range_ = range;
  for (std::size_t i = 0; i < questions_.size(); ++i) lay_out_question(i, before);
}

// What lay there before stays.
void ResponseLattice::lay_out_question(std::size_t i, const LatticeRange& before) {
  const LatticeQuestion& question = questions_[i];
  QuestionTables& tables = tables_[i];
  const double side = question.second_half ? 0.5 : -0.5;
  const double shift_s = side * shared_.drift_ln_s, shift_k = side * shared_.drift_criterion;
  const bool above = std::isfinite(shared_.sure_above), below = std::isfinite(shared_.sure_below);
  tables.positive.share = above ? 0.25 : 0.5;
  tables.negative.share = below ? 0.25 : 0.5;
  tables.sure_positive.share = above ? 0.25 : 0;
  tables.sure_negative.share = below ? 0.25 : 0;
  const std::array<AnswerTable*, 4> all = {&tables.positive, &tables.negative, &tables.sure_positive,
                                           &tables.sure_negative};
  std::array<std::vector<double>, 4> known;
  for (std::size_t t = 0; t < all.size(); ++t) {
    known[t] = std::move(all[t]->without_lapses);
    all[t]->without_lapses.resize(all[t]->share > 0 ? range_.wide() * range_.high() : 0);
  }
  std::vector<double> slopes, judged;
  for (int s = range_.s0; s <= range_.s1; ++s) {
    slopes.push_back(std::exp(-(s * steps_.ln_s + shift_s)));
    judged.push_back(model_ == ResponseModel::differencing ? 0 : judged_by(model_, question.level, slopes.back()));
  }
  std::vector<double> surely, hardly;  // the other answer: negative above the upper criterion, positive above the lower
  // Of this row the nodes between.
  const auto calculate = [&](int k, int from, int to) {
    if (from > to) return;
    const auto count = static_cast<std::size_t>(to - from) + 1, first = static_cast<std::size_t>(from - range_.s0);
    worked_ += static_cast<double>(count) * nanoseconds_of(model_, shared_.graded());
    const std::size_t at = range_.place(from, k);
    double *positive = &tables.positive.without_lapses[at], *negative = &tables.negative.without_lapses[at];
    const auto take = [&](double shift, double* to_positive, double* to_negative) {
      log_rates_of_slopes(model_, question.level, std::span(slopes).subspan(first, count),
                          std::span(judged).subspan(first, count),
                          steps_.origin + k * steps_.criterion + shift_k + shift, to_positive, to_negative);
    };
    take(0, positive, negative);
    if (!shared_.graded()) return;
    const std::vector<double> middle_positive(positive, positive + count), middle_negative(negative, negative + count);
    surely.resize(count);
    hardly.resize(count);
    if (above) {
      double* sure = &tables.sure_positive.without_lapses[at];
      take(shared_.sure_above, sure, surely.data());
      log_rates_between(middle_positive, middle_negative, {sure, count}, surely, positive);
    }
    if (below) {
      double* sure = &tables.sure_negative.without_lapses[at];
      take(-shared_.sure_below, hardly.data(), sure);
      log_rates_between(hardly, {sure, count}, middle_positive, middle_negative, negative);
    }
  };
  const int s0 = std::max(before.s0, range_.s0), s1 = std::min(before.s1, range_.s1);
  for (int k = range_.k0; k <= range_.k1; ++k) {
    if (before.empty() || k < before.k0 || k > before.k1 || s0 > s1) {
      calculate(k, range_.s0, range_.s1);
      continue;
    }
    calculate(k, range_.s0, s0 - 1);
    for (std::size_t t = 0; t < all.size(); ++t)
      if (all[t]->share > 0)
        std::copy_n(&known[t][before.place(s0, k)], s1 - s0 + 1, &all[t]->without_lapses[range_.place(s0, k)]);
    calculate(k, s1 + 1, range_.s1);
  }
  for (AnswerTable* table : all) table->add_lapses(shared_);
}

namespace {

// The log-likelihood of a cell's answers, row by row.
class AnswerRows {
 public:
  AnswerRows(std::span<const QuestionAnswers> answers, const ResponseLattice& responses, const LatticeRange& nodes)
      : answers_(answers),
        responses_(responses),
        nodes_(nodes),
        alike_(responses.shared().overdispersion, responses.shared().overdispersion > 0 ? nodes.wide() : 0) {
    if (responses.shared().overdispersion > 0)
      for (const QuestionAnswers& one : answers) of_all_ += alike_.log_of_all(one.counts.trials());
  }

  void write(int k, double* row) {
    const std::size_t from = responses_.range().place(nodes_.s0, k), wide = nodes_.wide();
    std::fill(row, row + wide, 0.0);
    for (const QuestionAnswers& one : answers_) {
      const auto [unsure, sure] = graded_counts(one.counts, responses_.shared());
      const auto& [positive, negative, sure_positive, sure_negative] = responses_.tables(one.question);
      add(unsure.positive, positive, unsure.negative, negative, from, row);
      if (sure.positive > 0) add(sure.positive, sure_positive, 0, sure_positive, from, row);
      if (sure.negative > 0) add(sure.negative, sure_negative, 0, sure_negative, from, row);
    }
    if (responses_.shared().overdispersion == 0) return;
    alike_.finish(row);
    for (std::size_t s = 0; s < wide; ++s) row[s] -= of_all_;
  }

 private:
  void add(double count, const AnswerTable& answer, double other_count, const AnswerTable& other, std::size_t from,
           double* row) {
    if (responses_.shared().overdispersion == 0) {
      add_answers(count, &answer.log_rates()[from], other_count, &other.log_rates()[from], nodes_.wide(), row);
      return;
    }
    alike_.add(&answer.rates[from], &answer.log_rates()[from], count, row);
    alike_.add(&other.rates[from], &other.log_rates()[from], other_count, row);
  }

  std::span<const QuestionAnswers> answers_;
  const ResponseLattice& responses_;
  LatticeRange nodes_;
  AlikeAnswers alike_;
  double of_all_ = 0;
};

}  // namespace

double CellLikelihood::cover(const LatticeRange& range, ResponseLattice& responses) {
  if (!range_.empty() && range_.holds(range)) return 0;
  range_ = range_.covering(range);
  responses.extend(range_);
  shared_ = responses.shared();
  values_.resize(range_.wide() * range_.high());
  AnswerRows rows(answers_, responses, range_);
  for (int k = range_.k0; k <= range_.k1; ++k) rows.write(k, &values_[range_.place(range_.s0, k)]);
  largest_ = *std::max_element(values_.begin(), values_.end());
  return static_cast<double>(values_.size() * answers_.size());
}

double CellLikelihood::take(const LatticeRange& range, const ResponseLattice& responses,
                            const ResponseLattice& beside) {
  if (!range_.empty() && range_.holds(range)) return 0;
  range_ = range;
  shared_ = responses.shared();
  values_.resize(range_.nodes());
  slopes_.resize(range_.nodes());
  AnswerRows rows(answers_, responses, range_), rows_beside(answers_, beside, range_);
  for (int k = range_.k0; k <= range_.k1; ++k) {
    const std::size_t at = range_.place(range_.s0, k);
    rows.write(k, &values_[at]);
    rows_beside.write(k, &slopes_[at]);
  }
  const double step = beside.steps().origin - responses.steps().origin;
  for (std::size_t i = 0; i < values_.size(); ++i) slopes_[i] = (slopes_[i] - values_[i]) / step;
  largest_ = *std::max_element(values_.begin(), values_.end());
  return static_cast<double>(2 * values_.size() * answers_.size());
}

double CellLikelihood::weighted_sum(const LatticeRange& nodes, const std::vector<double>& weights,
                                    const ResponseLattice& responses) const {
  double sum = 0;
  if (responses.shared() == shared_) {  // they lie here
    for (int k = nodes.k0; k <= nodes.k1; ++k)
      sum += dot(at(nodes.s0, k), &weights[nodes.place(nodes.s0, k)], nodes.wide());
    return sum;
  }
  AnswerRows rows(answers_, responses, nodes);
  std::vector<double> row(nodes.wide());
  for (int k = nodes.k0; k <= nodes.k1; ++k) {
    rows.write(k, row.data());
    sum += dot(row.data(), &weights[nodes.place(nodes.s0, k)], row.size());
  }
  return sum;
}

}  // namespace jnd
