#include "analysis/precision/monte_carlo.h"

#include <cmath>
#include <utility>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/thresholds/jnd_series.h"

namespace jnd {

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
