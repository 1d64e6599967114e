// Whether the hierarchical model keeps what its intervals, tests and posteriors promise, on studies of the published
// design that are drawn from a known population.
//
// Two kinds of studies. `published`: the published JNDs (208.5, 283.5, 351); here the intervals must hold the truth. `equal`:
// one JND for all conditions; here the tests must reject as often as they say, and the observed statistic must have
// any rank among those of the bootstrap equally often.
//
// Of every person of a published study the true ln s has a rank among draws from their posterior. At the group's true values
// ranks are uniform if the posterior is right (simulation-based calibration); at its estimates, where the posterior does
// not know how uncertain they are, a little too many are at the ends.
//
// Sources: Talts et al. 2018, arXiv:1804.06788 (ranks); Cook, Gelman and Rubin 2006, J Comput Graph Stat 15:675.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/hierarchical/hierarchical_bootstrap.h"
#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/hierarchical/predictive_check.h"
#include "analysis/numerics/binomial.h"
#include "analysis/numerics/experiment_stream.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/tail_probabilities.h"
#include "tests/analysis/hierarchical/hierarchical_fixtures.h"

namespace jnd::testing {

// A share with its Monte-Carlo error.
struct CountedShare {
  int hits = 0, of = 0;

  void add(bool hit) noexcept {
    hits += hit ? 1 : 0;
    ++of;
  }
  CountedShare& operator+=(const CountedShare& other) noexcept {
    hits += other.hits;
    of += other.of;
    return *this;
  }
  double rate() const noexcept { return static_cast<double>(hits) / of; }
  double error() const noexcept { return std::sqrt(rate() * (1 - rate()) / of); }
};

struct CountedMoments {
  double sum = 0, squares = 0;
  int of = 0;

  void add(double value) noexcept {
    sum += value;
    squares += value * value;
    ++of;
  }
  CountedMoments& operator+=(const CountedMoments& other) noexcept {
    sum += other.sum;
    squares += other.squares;
    of += other.of;
    return *this;
  }
  double mean() const noexcept { return sum / of; }
  double error() const noexcept { return std::sqrt(std::max(0.0, squares / of - mean() * mean()) / of); }
  double root_mean_square() const noexcept { return std::sqrt(squares / of); }
};

// Ranks 0..last, in kBins bins of as many; last + 1 is a multiple of kBins.
struct RankHistogram {
  static constexpr std::size_t kBins = 20;
  std::array<int, kBins> bins{};
  int of = 0;

  void add(int rank, int last) noexcept {
    ++bins[static_cast<std::size_t>(rank) * kBins / (static_cast<std::size_t>(last) + 1)];
    ++of;
  }
  RankHistogram& operator+=(const RankHistogram& other) noexcept {
    for (std::size_t i = 0; i < kBins; ++i) bins[i] += other.bins[i];
    of += other.of;
    return *this;
  }
  double chi_square() const noexcept {
    const double expected = static_cast<double>(of) / kBins;
    double sum = 0;
    for (const int one : bins) sum += (one - expected) * (one - expected) / expected;
    return sum;
  }
  // Of as uneven a histogram, where ranks are uniform and independent.
  double p() const noexcept { return chi2_upper(chi_square(), kBins - 1); }
};

// The population that jnd plan --power draws by default: coefficients of variation of 30 % between people and of 15 %
// from one condition to another, criteria of 0.75 with a standard deviation of 0.3.
inline HierarchicalPlace drawn_population(const std::vector<double>& jnds) {
  HierarchicalPlace truth;
  for (const double jnd : jnds) truth.mu.push_back(std::log(jnd));
  truth.kappa.assign(jnds.size(), 0.75);
  truth.tu = std::sqrt(std::log1p(0.3 * 0.3));
  truth.tv = std::sqrt(std::log1p(0.15 * 0.15));
  truth.tw = 0.3;
  return truth;
}

// A study whose people are known.
struct KnownStudy {
  std::vector<HierarchicalCell> cells;
  std::vector<std::vector<double>> ln_s;  // by participant and condition
};

// tv: by condition, in place of the truth's; empty: the truth's in all.
inline KnownStudy known_study(int participants, const HierarchicalPlace& truth, std::uint64_t seed, std::uint64_t study,
                              std::span<const double> tv = {}) {
  KnownStudy known;
  known.cells = published_questions(participants, static_cast<int>(truth.mu.size()));
  std::vector<double> criteria;
  std::vector<ExperimentStream> streams;
  const auto normal = [](ExperimentStream& stream) { return normal_quantile(open_uniform(stream.next())); };
  for (int p = 0; p < participants; ++p) {
    ExperimentStream& stream = streams.emplace_back(seed, 0x63616c69'62726174, study, static_cast<std::uint64_t>(p));
    const double u = truth.tu * normal(stream);
    criteria.push_back(truth.kappa.front() + truth.tw * normal(stream));
    std::vector<double>& ln_s = known.ln_s.emplace_back();
    for (std::size_t c = 0; c < truth.mu.size(); ++c)
      ln_s.push_back(truth.mu[c] + u + (tv.empty() ? truth.tv : tv[c]) * normal(stream));
  }
  for (HierarchicalCell& cell : known.cells) {
    const auto p = static_cast<std::size_t>(cell.participant);
    const double rate =
        normal_cdf(cell.level * std::exp(-known.ln_s[p][static_cast<std::size_t>(cell.condition)]) - criteria[p]);
    const int trials = static_cast<int>(cell.positive + cell.negative);
    cell.positive = BinomialSampler(trials, rate).at(open_uniform(streams[p].next()));
    cell.negative = trials - cell.positive;
  }
  return known;
}

// What is counted of drawn studies of one size. Tallies of several threads add up.
struct HierarchicalCalibration {
  static constexpr double kAlpha = 0.05;
  static constexpr int kLastRank = 99;

  int participants = 0;
  int undefined = 0;          // published studies with a condition without a JND, or that did not settle
  int open_ends = 0;          // intervals with an end at infinity
  CountedMoments error_of_s;  // of ln JND of S
  std::array<CountedShare, 3> means,
      differences;  // profile intervals that hold the truth: SV, S, V; SV : S, SV : V, S : V
  std::array<CountedMoments, 3> lr_means, lr_differences;  // statistics of the truth, 1 on average if chi-square
  CountedShare wider_means, wider_differences;  // that would hold it with Student's t of participants - 1 squared
  RankHistogram people_at_truth, people_at_estimates;
  CountedShare people_inside;                    // of mean -+ 1.96 sd at the estimates
  CountedShare rejected, rejected_by_bootstrap;  // of one JND for all
  std::array<CountedShare, 3> rejected_pairs;
  CountedShare rejected_pairs_wider;  // by t squared
  CountedMoments lr_equal;            // 2 on average if chi-square
  RankHistogram statistic;

  static std::vector<double> published_jnds() { return {208.5, 283.5, 351.0}; }

  void add_published(std::uint64_t seed, std::uint64_t study) {
    const HierarchicalPlace truth = drawn_population(published_jnds());
    const KnownStudy known = known_study(participants, truth, seed, study);
    HierarchicalAnalysis analysis(known.cells, {});
    const HierarchicalFit& fit = analysis.add_intervals();
    const std::vector<ConditionDifference> pairs = analysis.differences();
    const bool defined = fit.maximum.converged && fit.common.converged &&
                         std::all_of(fit.conditions.begin(), fit.conditions.end(),
                                     [](const ConditionMean& one) { return one.status == SlopeStatus::ok; });
    add_people(known, truth, fit, study);
    if (!defined) {
      ++undefined;
      return;
    }
    error_of_s.add(fit.conditions[1].mu - truth.mu[1]);
    HierarchicalLikelihood likelihood(known.cells, ResponseModel::yes_no, {});
    const auto statistic_of = [&](const HierarchicalForm& form) {
      const double held = maximise(likelihood, form, fit.maximum.place).log_likelihood;
      return std::max(0.0, 2 * (fit.maximum.log_likelihood - held));
    };
    const double wider = wider_quantile();
    const HierarchicalForm form = free_form(fit);
    for (std::size_t c = 0; c < 3; ++c) {
      add_interval(fit.conditions[c].ends, truth.mu[c], means[c]);
      const double lr = statistic_of(form.with_mean(c, truth.mu[c]));
      lr_means[c].add(lr);
      wider_means.add(lr <= wider);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const double difference = truth.mu[pairs[i].a] - truth.mu[pairs[i].b];
      add_interval(pairs[i].ends, difference, differences[i]);
      const double lr = statistic_of(form.with_difference(pairs[i].a, pairs[i].b, difference));
      lr_differences[i].add(lr);
      wider_differences.add(lr <= wider);
    }
  }

  void add_equal(std::uint64_t seed, std::uint64_t study, int replicates) {
    const HierarchicalPlace truth = drawn_population({283.5, 283.5, 283.5});
    const KnownStudy known = known_study(participants, truth, seed, study);
    HierarchicalAnalysis analysis(known.cells, {});
    const HierarchicalFit& fit = analysis.fit();
    rejected.add(fit.p < kAlpha);
    lr_equal.add(fit.lr);
    HierarchicalLikelihood likelihood(known.cells, ResponseModel::yes_no, {});
    const HierarchicalForm form = free_form(fit);
    std::size_t pair = 0;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = a + 1; b < 3; ++b, ++pair) {
        const double held = maximise(likelihood, form.with_difference(a, b, 0), fit.maximum.place).log_likelihood;
        const double lr = std::max(0.0, 2 * (fit.maximum.log_likelihood - held));
        rejected_pairs[pair].add(chi2_upper(lr, 1) < kAlpha);
        rejected_pairs_wider.add(lr > wider_quantile());
      }
    if (replicates == 0) return;
    const EqualityBootstrap drawn = equality_bootstrap(known.cells, {}, fit, replicates, seed + study, 1);
    statistic.add(drawn.as_large, replicates);
    rejected_by_bootstrap.add(drawn.p <= kAlpha);
  }

  // Ranks of people alone, at the truth.
  void add_ranks_at_truth(std::uint64_t seed, std::uint64_t study) {
    const HierarchicalPlace truth = drawn_population(published_jnds());
    add_ranks(known_study(participants, truth, seed, study), truth, study, people_at_truth, false);
  }

  HierarchicalCalibration& operator+=(const HierarchicalCalibration& other) noexcept {
    undefined += other.undefined;
    open_ends += other.open_ends;
    error_of_s += other.error_of_s;
    for (std::size_t i = 0; i < 3; ++i) {
      means[i] += other.means[i];
      differences[i] += other.differences[i];
      lr_means[i] += other.lr_means[i];
      lr_differences[i] += other.lr_differences[i];
      rejected_pairs[i] += other.rejected_pairs[i];
    }
    wider_means += other.wider_means;
    wider_differences += other.wider_differences;
    people_at_truth += other.people_at_truth;
    people_at_estimates += other.people_at_estimates;
    people_inside += other.people_inside;
    rejected += other.rejected;
    rejected_by_bootstrap += other.rejected_by_bootstrap;
    rejected_pairs_wider += other.rejected_pairs_wider;
    lr_equal += other.lr_equal;
    statistic += other.statistic;
    return *this;
  }

 private:
  double wider_quantile() const noexcept {
    const double t = student_t_quantile_two_sided(kAlpha, participants - 1);
    return t * t;
  }

  static HierarchicalForm free_form(const HierarchicalFit& fit) {
    const SearchRange range = search_range(published_questions(1), ResponseModel::yes_no);
    HierarchicalForm form = HierarchicalForm::separate(fit.conditions.size());
    form.lowest = range.lowest();
    form.highest = range.highest();
    return form;
  }

  void add_interval(const ProfileEnds& ends, double truth, CountedShare& held) noexcept {
    held.add(ends.low <= truth && truth <= ends.high);
    open_ends += std::isinf(ends.low) || std::isinf(ends.high) ? 1 : 0;
  }

  void add_people(const KnownStudy& known, const HierarchicalPlace& truth, const HierarchicalFit& fit,
                  std::uint64_t study) {
    add_ranks(known, truth, study, people_at_truth, false);
    add_ranks(known, fit.maximum.place, study, people_at_estimates, true);
    HierarchicalLikelihood likelihood(known.cells, ResponseModel::yes_no, {});
    const std::vector<PersonPosterior> posteriors = likelihood.posteriors(fit.maximum.place);
    for (std::size_t p = 0; p < posteriors.size(); ++p)
      for (std::size_t c = 0; c < 3; ++c)
        people_inside.add(std::abs(known.ln_s[p][c] - posteriors[p].mean[c]) <=
                          normal_quantile(1 - kAlpha / 2) * posteriors[p].sd[c]);
  }

  // People of one study share its estimates and conditions of one person their criterion, so that ranks are taken of one
  // condition of each, and where the study has estimates of one person.
  void add_ranks(const KnownStudy& known, const HierarchicalPlace& place, std::uint64_t study, RankHistogram& ranks,
                 bool of_one) const {
    const PosteriorDraws draws(known.cells, {}, place, kLastRank, study + 1);
    for (std::size_t p = 0; p < known.ln_s.size(); ++p) {
      if (of_one && p != study % known.ln_s.size()) continue;
      const std::size_t c = (p + study) % 3;
      int rank = 0;
      for (std::size_t i = 0; i < kLastRank; ++i) rank += draws.ln_s(p, c, i) < known.ln_s[p][c] ? 1 : 0;
      ranks.add(rank, kLastRank);
    }
  }
};

}  // namespace jnd::testing
