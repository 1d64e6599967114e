#include "analysis/precision/monte_carlo.h"

#include <cmath>
#include <utility>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {

namespace {

// The estimated variance of z of k answers out of n.
double z_variance(double rate, double z, int n) noexcept {
  const double density = normal_density(z);
  return std::isfinite(z) ? rate * (1 - rate) / (n * density * density) : kNaN;
}

}  // namespace

CellSampler::CellSampler(const CellProbabilities& cell, double difference) {
  const double square = difference * difference;
  if (counts_of_cell(cell.trials, cell.class_sizes) > kMostTabulated) {
    Counts counts{cell,
                  difference,
                  binomial_table(cell.trials, 0.5),
                  {},
                  {cell.trials, cell.hit},
                  {cell.trials, cell.false_alarm}};
    counts.same_table = AliasTable(counts.same.probability);
    counts_ = std::make_shared<const Counts>(std::move(counts));
    return;
  }
  const CellDistribution distribution = cell_distribution(cell);
  std::vector<double> probability;
  const auto add = [&](double share, const SeriesDraw& draw) {
    if (share <= 0) return;
    probability.push_back(share);
    draws_.push_back(draw);
  };
  for (const CellState& state : distribution.states)
    add(state.probability, {difference * state.dprime, square, square * state.variance, state.informative ? 1.0 : 0.0});
  add(distribution.missing, {});
  add(distribution.plus_infinity, {kInf, square, kNaN, 1});
  add(distribution.minus_infinity, {-kInf, square, kNaN, 1});
  add(distribution.undefined, {kNaN, square, kNaN, 0});
  table_ = AliasTable(probability);
}

SeriesDraw CellSampler::from_counts(ExperimentStream& stream) const noexcept {
  const CellProbabilities& cell = counts_->cell;
  const int n_same = cell.class_sizes == ClassSizes::balanced
                         ? cell.trials / 2
                         : counts_->same.first + static_cast<int>(counts_->same_table.draw(stream.next()));
  const int n_diff = cell.trials - n_same;
  if (n_same == 0 || n_diff == 0) return {};
  const int hits = counts_->hits.draw(n_diff, stream);
  const int false_alarms = counts_->false_alarms.draw(n_same, stream);
  const double hit = corrected_rate(hits, n_diff, cell.correction);
  const double false_alarm = corrected_rate(false_alarms, n_same, cell.correction);
  const double z_hit = normal_quantile(hit), z_false_alarm = normal_quantile(false_alarm);
  const double difference = counts_->difference, square = difference * difference;
  const bool one_answer = hits + false_alarms == 0 || hits + false_alarms == cell.trials;
  return {difference * (z_hit - z_false_alarm), square,
          square * (z_variance(hit, z_hit, n_diff) + z_variance(false_alarm, z_false_alarm, n_same)),
          one_answer ? 0.0 : 1.0};
}

CellSampler::Answers::Answers(int most, double p) {
  for (int n = 1; n <= most; n *= 2) {
    const BinomialTable table = binomial_table(n, p);
    powers_.push_back({table.first, AliasTable(table.probability)});
  }
}

int CellSampler::Answers::draw(int n, ExperimentStream& stream) const noexcept {
  int sum = 0;
  for (std::size_t power = 0; n >> power != 0; ++power)
    if ((n >> power & 1) != 0) sum += powers_[power].first + static_cast<int>(powers_[power].table.draw(stream.next()));
  return sum;
}

namespace {

constexpr std::size_t kStrata = 32;
constexpr std::uint64_t kStudyPurpose = 0x6a6e6420'73747564;  // keeps these numbers apart from other uses of a seed

// Factors of the participants' JNDs: a log-normal distribution in equally likely steps, with its standard deviation.
std::vector<double> factors(double cv) {
  if (!(cv > 0)) return {1};
  std::vector<double> z;
  double squares = 0;
  for (std::size_t i = 0; i < kStrata; ++i) {
    z.push_back(normal_quantile((static_cast<double>(i) + 0.5) / kStrata));
    squares += z.back() * z.back();
  }
  const double scale = std::sqrt(std::log1p(cv * cv) * kStrata / squares);
  for (double& value : z) value = std::exp(scale * value);
  return z;
}

}  // namespace

JndStatus status_of_slope(double slope) noexcept {
  if (std::isnan(slope)) return JndStatus::no_information;
  if (slope == kInf) return JndStatus::ceiling;
  return slope <= kLeastSlope ? JndStatus::no_sensitivity : JndStatus::ok;
}

StudySimulator::StudySimulator(StudyModel model) : model_(std::move(model)) {
  const std::vector<double> factor = factors(model_.between_cv);
  strata_ = factor.size();
  cells_.reserve(strata_ * conditions() * model_.design.differences.size());
  for (const double one : factor)
    for (const double jnd : model_.jnds)
      for (const double difference : model_.design.differences)
        cells_.emplace_back(cell_probabilities(model_.design, difference, jnd * one), difference);
}

// Calls with condition, participant and slope, condition by condition.
template <typename Call>
void StudySimulator::for_slopes(std::uint64_t seed, std::uint64_t experiment, Call call) const noexcept {
  for (std::size_t participant = 0; participant < participants(); ++participant) {
    ExperimentStream stream(seed, kStudyPurpose, experiment, participant);
    const std::size_t stratum = strata_ == 1 ? 0 : static_cast<std::size_t>(stream.next() % kStrata);
    for (std::size_t condition = 0; condition < conditions(); ++condition) {
      const SeriesDraw sums = draw(stratum, condition, stream);
      call(condition, participant, sums);
    }
  }
}

void StudySimulator::slopes(std::uint64_t seed, std::uint64_t experiment, std::span<double> slopes) const noexcept {
  for_slopes(seed, experiment, [&](std::size_t condition, std::size_t participant, const SeriesDraw& sums) {
    slopes[condition * participants() + participant] = sums.informative > 0 ? sums.product / sums.square : kNaN;
  });
}

void StudySimulator::means(std::uint64_t seed, std::uint64_t experiment, std::span<MeanJnd> means) const noexcept {
  for (MeanJnd& mean : means) mean = {};
  for_slopes(seed, experiment, [&](std::size_t condition, std::size_t, const SeriesDraw& sums) {
    MeanJnd& mean = means[condition];
    if (sums.informative > 0 && sums.product > kLeastSlope * sums.square && sums.product < kInf) {
      ++mean.n;
      mean.mean += sums.square / sums.product;
      return;
    }
    switch (status_of_slope(sums.informative > 0 ? sums.product / sums.square : kNaN)) {
      case JndStatus::ceiling:
        ++mean.ceiling;
        break;
      case JndStatus::no_information:
        ++mean.no_information;
        break;
      case JndStatus::no_sensitivity:
      case JndStatus::ok:  // not reached: counted above
        ++mean.no_sensitivity;
        break;
    }
  });
  for (MeanJnd& mean : means) mean.mean = mean.n > 0 ? mean.mean / mean.n : kNaN;
}

}  // namespace jnd
