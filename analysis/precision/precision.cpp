#include "analysis/precision/precision.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include <boost/math/distributions/students_t.hpp>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/sample_quantile.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "analysis/precision/monte_carlo.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {

namespace {

// ---- a group, and its contrasts

// Mean and 95 % t interval without calling for the t quantile each time.
class Intervals {
 public:
  explicit Intervals(int most) {
    for (int n = 2; n <= most; ++n)
      factors_.push_back(boost::math::quantile(boost::math::students_t(n - 1), 0.975) / std::sqrt(n));
  }
  struct Interval {
    double mean = 0, half_width = 0;
  };
  Interval of(std::span<const double> values) const {  // at least one; half_width NaN for one
    const auto n = static_cast<double>(values.size());
    double sum = 0, squares = 0;
    for (const double value : values) sum += value;
    const double mean = sum / n;
    if (values.size() < 2) return {mean, kNaN};
    for (const double value : values) squares += (value - mean) * (value - mean);
    return {mean, factors_[values.size() - 2] * std::sqrt(squares / (n - 1))};
  }

 private:
  std::vector<double> factors_;  // t / sqrt(n) for n = 2, 3, ...
};

// What the studies of one condition, or of one contrast, came to.
struct Tally {
  std::vector<double> means, widths;
  int without_interval = 0, with_undefined = 0, excluding_zero = 0, slopes_excluding_zero = 0;
  double undefined = 0;
};

bool excludes_zero(const Intervals::Interval& interval) {
  return std::abs(interval.mean) > interval.half_width;  // false for NaN
}

void add(Tally& tally, std::span<const double> values, std::size_t participants, const Intervals& intervals) {
  if (values.size() < participants) ++tally.with_undefined;
  tally.undefined += static_cast<double>(participants - values.size());
  if (values.empty()) {
    ++tally.without_interval;
    return;
  }
  const Intervals::Interval interval = intervals.of(values);
  tally.means.push_back(interval.mean);
  if (values.size() < 2) {
    ++tally.without_interval;
    return;
  }
  tally.widths.push_back(2 * interval.half_width);
  if (excludes_zero(interval)) ++tally.excluding_zero;
}

void add_condition(Tally& tally, std::span<const double> slopes, const Intervals& intervals,
                   std::vector<double>& work) {
  work.clear();
  for (const double slope : slopes)
    if (status_of_slope(slope) == JndStatus::ok) work.push_back(1 / slope);
  add(tally, work, slopes.size(), intervals);
}

void add_contrast(Tally& tally, std::span<const double> a, std::span<const double> b, const Intervals& intervals,
                  std::vector<double>& work) {
  work.clear();
  for (std::size_t i = 0; i < a.size(); ++i)
    if (status_of_slope(a[i]) == JndStatus::ok && status_of_slope(b[i]) == JndStatus::ok)
      work.push_back(1 / a[i] - 1 / b[i]);
  add(tally, work, a.size(), intervals);
  work.clear();
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::isfinite(a[i]) && std::isfinite(b[i])) work.push_back(a[i] - b[i]);
  if (work.size() >= 2 && excludes_zero(intervals.of(work))) ++tally.slopes_excluding_zero;
}

double share_se(double share, double n) {
  return std::sqrt(share * (1 - share) / n);
}

GroupPrecision group_of(Tally tally, double experiments) {
  const SampleQuantiles means(std::move(tally.means)), widths(std::move(tally.widths));
  GroupPrecision group;
  group.median = means.at(0.5);
  group.q05 = means.at(0.05);
  group.q95 = means.at(0.95);
  group.ci_width = widths.at(0.5);
  group.ci_width_se = widths.standard_error(0.5);
  group.without_interval = tally.without_interval / experiments;
  group.with_undefined = tally.with_undefined / experiments;
  group.mean_undefined = tally.undefined / experiments;
  return group;
}

ContrastPrecision contrast_of(Tally tally, double experiments) {
  const SampleQuantiles means(std::move(tally.means)), widths(std::move(tally.widths));
  ContrastPrecision contrast;
  contrast.median = means.at(0.5);
  contrast.ci_width = widths.at(0.5);
  contrast.ci_width_se = widths.standard_error(0.5);
  contrast.power = tally.excluding_zero / experiments;
  contrast.power_se = share_se(contrast.power, experiments);
  contrast.power_of_slopes = tally.slopes_excluding_zero / experiments;
  contrast.power_of_slopes_se = share_se(contrast.power_of_slopes, experiments);
  contrast.without_interval = tally.without_interval / experiments;
  contrast.with_undefined = tally.with_undefined / experiments;
  return contrast;
}

// Simulates result.question.experiments studies; fills result.group and result.contrasts.
void set_group_precision(Precision& result, const std::function<void(int)>& progress) {
  constexpr int kReports = 500;
  const PrecisionQuestion& question = result.question;
  StudyModel model;
  model.design = question.design;
  model.jnds = question.jnds;
  model.participants = question.participants;
  model.between_cv = question.between_cv;
  const StudySimulator simulator(model);
  const Intervals intervals(question.participants);
  const std::size_t participants = simulator.participants();
  std::vector<double> slopes(simulator.conditions() * participants), work;
  const auto of_condition = [&](std::size_t condition) {
    return std::span<const double>(slopes).subspan(condition * participants, participants);
  };
  std::vector<Tally> conditions(simulator.conditions()), contrasts(question.contrasts.size());
  for (int experiment = 0; experiment < question.experiments; ++experiment) {
    if (progress && experiment % (1 + question.experiments / kReports) == 0) progress(experiment);
    simulator.slopes(question.seed, static_cast<std::uint64_t>(experiment), slopes);
    for (std::size_t i = 0; i < conditions.size(); ++i) add_condition(conditions[i], of_condition(i), intervals, work);
    for (std::size_t i = 0; i < contrasts.size(); ++i)
      add_contrast(contrasts[i], of_condition(static_cast<std::size_t>(question.contrasts[i][0])),
                   of_condition(static_cast<std::size_t>(question.contrasts[i][1])), intervals, work);
  }
  for (Tally& tally : conditions) result.group.push_back(group_of(std::move(tally), question.experiments));
  for (std::size_t i = 0; i < contrasts.size(); ++i) {
    const auto [a, b] = question.contrasts[i];
    ContrastPrecision contrast = contrast_of(std::move(contrasts[i]), question.experiments);
    contrast.a = a;
    contrast.b = b;
    contrast.true_difference = question.jnds[static_cast<std::size_t>(a)] - question.jnds[static_cast<std::size_t>(b)];
    result.contrasts.push_back(contrast);
  }
}

// ---- one participant

constexpr double kMostProposed = 1e6;
constexpr double kOneSigmaBelow = 0.15865525393145705;            // Phi(-1)
constexpr std::uint64_t kPrecisionPurpose = 0x6a6e6420'70617274;  // keeps these numbers apart from other uses of a seed

void require(bool fine, const char* what) {
  if (!fine) throw std::invalid_argument(what);
}

void require_sound(const PrecisionQuestion& question) {
  const CountsDesign& design = question.design;
  require(!design.differences.empty() && !question.jnds.empty(), "precision: at least one series and one condition");
  for (const double difference : design.differences)
    require(difference > 0 && std::isfinite(difference), "precision: differences above 0");
  for (const double jnd : question.jnds) require(jnd > 0 && std::isfinite(jnd), "precision: JNDs above 0");
  require(design.trials >= 1 && question.participants >= 1, "precision: at least one trial and one participant");
  require(question.wanted_cv > 0 && question.between_cv >= 0, "precision: a wanted CV above 0");
  require(question.draws >= 100 && question.experiments >= 100, "precision: at least 100 draws and experiments");
  const int conditions = static_cast<int>(question.jnds.size());
  for (const auto& [a, b] : question.contrasts)
    require(a >= 0 && b >= 0 && a < conditions && b < conditions, "precision: contrasts of conditions");
}

bool set_by_enumeration(ParticipantPrecision& result, const CountsDesign& design) {
  if (counts_of_cell(design.trials, design.class_sizes) > CellSampler::kMostTabulated) return false;
  std::vector<CellDistribution> cells;
  for (const double difference : design.differences)
    cells.push_back(cell_distribution(cell_probabilities(design, difference, result.true_jnd)));
  if (!SlopeDistribution::feasible(cells)) return false;
  const SlopeDistribution slopes(cells, design.differences);
  result.method = PrecisionMethod::enumeration;
  result.status = slopes.status();
  result.q025 = slopes.jnd_quantile(0.025);
  result.q05 = slopes.jnd_quantile(0.05);
  result.median = slopes.jnd_quantile(0.5);
  result.q95 = slopes.jnd_quantile(0.95);
  result.q975 = slopes.jnd_quantile(0.975);
  result.spread = (slopes.jnd_quantile(1 - kOneSigmaBelow) - slopes.jnd_quantile(kOneSigmaBelow)) / (2 * result.median);
  result.mean = slopes.mean_jnd();
  const auto [low, high] = std::minmax_element(design.differences.begin(), design.differences.end());
  result.outside_tested = std::clamp(1 - slopes.jnd_within(*low, *high), 0.0, 1.0);
  return true;
}

// What a number of simulated participants estimated.
struct Drawn {
  std::vector<double> jnds;  // of those with information: ceiling 0, no_sensitivity +inf
  int ok = 0, no_sensitivity = 0, ceiling = 0, no_information = 0;
  int within = 0;              // ok, and within the tested differences
  double sum = 0;              // over ok
  std::vector<double> widths;  // of the 95 % interval, +inf without an upper bound
  int unbounded = 0;
};

double interval_width(const SeriesDraw& sums) {
  const double slope = sums.product / sums.square;
  const double half_width = normal_quantile(0.975) * std::sqrt(sums.variance) / sums.square;
  if (!(sums.informative > 0) || !(slope - half_width > kLeastSlope)) return kInf;
  return 1 / (slope - half_width) - 1 / (slope + half_width);
}

void count(Drawn& drawn, const SeriesDraw& sums, double low, double high) {
  const double slope = sums.informative > 0 ? sums.product / sums.square : kNaN;
  switch (status_of_slope(slope)) {
    case JndStatus::ok:
      ++drawn.ok;
      drawn.jnds.push_back(1 / slope);
      drawn.sum += 1 / slope;
      if (1 / slope >= low && 1 / slope <= high) ++drawn.within;
      break;
    case JndStatus::no_sensitivity:
      ++drawn.no_sensitivity;
      drawn.jnds.push_back(kInf);
      break;
    case JndStatus::ceiling:
      ++drawn.ceiling;
      drawn.jnds.push_back(0);
      break;
    case JndStatus::no_information:
      ++drawn.no_information;
      break;
  }
  drawn.widths.push_back(interval_width(sums));
  if (std::isinf(drawn.widths.back())) ++drawn.unbounded;
}

Drawn draw_participants(const PrecisionQuestion& question, double jnd) {
  StudyModel model;
  model.design = question.design;
  model.jnds = {jnd};
  const StudySimulator simulator(model);
  const auto [low, high] = std::minmax_element(question.design.differences.begin(), question.design.differences.end());
  Drawn drawn;
  for (int i = 0; i < question.draws; ++i) {
    ExperimentStream stream(question.seed, kPrecisionPurpose, static_cast<std::uint64_t>(i));
    count(drawn, simulator.draw(0, 0, stream), *low, *high);
  }
  return drawn;
}

void set_by_simulation(ParticipantPrecision& result, Drawn& drawn, int draws) {
  const double n = draws;
  result.method = PrecisionMethod::simulation;
  result.replicates = draws;
  result.status = {drawn.ok / n, drawn.no_sensitivity / n, drawn.ceiling / n, drawn.no_information / n};
  const SampleQuantiles jnds(std::move(drawn.jnds));
  result.q025 = jnds.at(0.025);
  result.q05 = jnds.at(0.05);
  result.median = jnds.at(0.5);
  result.q95 = jnds.at(0.95);
  result.q975 = jnds.at(0.975);
  result.median_se = jnds.standard_error(0.5);
  result.share_se = 0.5 / std::sqrt(n);
  result.spread = (jnds.at(1 - kOneSigmaBelow) - jnds.at(kOneSigmaBelow)) / (2 * result.median);
  result.mean = drawn.ok > 0 ? drawn.sum / drawn.ok : kNaN;
  result.outside_tested = 1 - drawn.within / n;
}

constexpr auto kMethodWords = words<PrecisionMethod>(
    {{"enumeration", PrecisionMethod::enumeration}, {"simulation", PrecisionMethod::simulation}});

}  // namespace

std::string_view to_string(PrecisionMethod method) noexcept {
  return word_of(kMethodWords, method);
}

DesignRisks design_risks(const CountsDesign& design, double jnd) {
  double no_extreme = 1, all_positive = 1, none_missing = 1;
  for (const double difference : design.differences) {
    const CellRisks risks = cell_risks(cell_probabilities(design, difference, jnd));
    no_extreme *= 1 - risks.extreme;
    all_positive *= 1 - risks.not_positive;
    none_missing *= 1 - risks.missing;
  }
  return {std::clamp(1 - no_extreme, 0.0, 1.0), std::clamp(1 - all_positive, 0.0, 1.0),
          std::clamp(1 - none_missing, 0.0, 1.0)};
}

double asymptotic_cv(const CountsDesign& design, double jnd) {
  double variances = 0, squares = 0;
  for (const double difference : design.differences) {
    variances +=
        difference * difference * asymptotic_variance(cell_probabilities(design, difference, jnd)) / design.trials;
    squares += difference * difference;
  }
  return std::sqrt(variances) * jnd / squares;
}

std::optional<int> trials_for_cv(const CountsDesign& design, double jnd, double wanted_cv) {
  const double ratio = asymptotic_cv(design, jnd) / wanted_cv;
  const double exact = design.trials * ratio * ratio;
  if (!(exact <= kMostProposed)) return std::nullopt;
  const int step = design.class_sizes == ClassSizes::balanced ? 4 : 1;
  const int trials = std::max(2, static_cast<int>(std::ceil(exact - 1e-9)));
  return (trials + step - 1) / step * step;
}

ParticipantPrecision participant_precision(const PrecisionQuestion& question, double jnd) {
  ParticipantPrecision result;
  result.true_jnd = jnd;
  result.risks = design_risks(question.design, jnd);
  result.cv = asymptotic_cv(question.design, jnd);
  result.proposed_trials = trials_for_cv(question.design, jnd, question.wanted_cv);
  Drawn drawn = draw_participants(question, jnd);
  const SampleQuantiles widths(std::move(drawn.widths));
  result.interval_draws = question.draws;
  result.interval_width = widths.at(0.5);
  result.interval_width_se = widths.standard_error(0.5);
  result.interval_unbounded = static_cast<double>(drawn.unbounded) / question.draws;
  if (!set_by_enumeration(result, question.design)) set_by_simulation(result, drawn, question.draws);
  result.bias_of_median = result.median - jnd;
  result.bias_of_mean = result.mean - jnd;
  return result;
}

Precision precision(const PrecisionQuestion& question, const std::function<void(int)>& progress) {
  require_sound(question);
  Precision result;
  result.question = question;
  for (const double jnd : question.jnds) {
    const auto same = std::find_if(result.participant.begin(), result.participant.end(),
                                   [&](const ParticipantPrecision& other) { return other.true_jnd == jnd; });
    result.participant.push_back(same != result.participant.end() ? ParticipantPrecision(*same)
                                                                  : participant_precision(question, jnd));
  }
  set_group_precision(result, progress);
  return result;
}

}  // namespace jnd
