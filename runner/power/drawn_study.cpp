#include "runner/power/drawn_study.h"

#include <algorithm>
#include <cmath>

#include "analysis/group/group.h"
#include "analysis/group/p_adjust.h"
#include "analysis/group/post_hoc.h"
#include "analysis/group/signed_rank.h"
#include "analysis/hierarchical/rough_fit.h"
#include "analysis/numerics/binomial.h"
#include "analysis/numerics/moments.h"
#include "analysis/numerics/tail_probabilities.h"
#include "data/results/study_comparisons.h"
#include "data/results/study_contrasts.h"
#include "data/results/study_hierarchical.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/task.h"

namespace jnd {

namespace {

template <typename Row, typename Rows>
std::vector<Row> rows_of(std::span<const DrawnPerson> people, Rows rows) {
  std::vector<Row> all;
  for (const DrawnPerson& person : people)
    if (!person.dropped) all.insert(all.end(), (person.*rows).begin(), (person.*rows).end());
  return all;
}

// Order statistics that hold the median in at least 95 % of samples, whatever the distribution; all of n < 6 do not.
GroupJnd median_of_jnds(std::vector<double> jnds) {
  GroupJnd group;
  const auto n = static_cast<int>(jnds.size());
  if (n == 0) return group;
  std::sort(jnds.begin(), jnds.end());
  const double middle = 0.5 * (jnds[static_cast<std::size_t>((n - 1) / 2)] + jnds[static_cast<std::size_t>(n / 2)]);
  if (!std::isfinite(middle) || middle <= 0) return group;
  group.jnd = middle;
  const BinomialTable table = binomial_table(n, 0.5);
  double below = 0;
  int out = 0;  // at each end
  for (std::size_t i = 0; i < table.probability.size() && table.first + static_cast<int>(i) < n / 2; ++i) {
    below += table.probability[i];
    if (below > 0.025) break;
    out = table.first + static_cast<int>(i) + 1;
  }
  if (out < 1) return group;
  group.low = jnds[static_cast<std::size_t>(out - 1)];
  group.high = jnds[static_cast<std::size_t>(n - out)];
  return group;
}

// A procedure may have kept to one level, which tells no JND.
bool levels_differ(const std::vector<HierarchicalCell>& cells) {
  return std::any_of(cells.begin(), cells.end(),
                     [&](const HierarchicalCell& cell) { return cell.level != cells.front().level; });
}

void correct(std::vector<GroupContrast>& contrasts) {
  std::vector<double> p;
  for (const GroupContrast& one : contrasts) p.push_back(one.p);
  p = holm(p);
  for (std::size_t i = 0; i < p.size(); ++i) contrasts[i].p = p[i];
}

}  // namespace

StudyAnalyst::StudyAnalyst(const Protocol& protocol, const PowerQuestion& question, double effect)
    : protocol_(protocol),
      question_(question),
      truth_(truth_of(question, effect, protocol)),
      known_(!question.profile) {
  model_.response = response_model_of(protocol).value();
  model_.shared.lapse = question.people.lapse;
  task_ = !task_of(protocol.task.kind).has_own_results();
  if (!task_) return;
  const AnswerModel answers = task_of(protocol.task.kind).answer_model(protocol).value();
  of_noise_ = answers.jnd_of_s;
  model_.tw = !answers.pse_at_standard;
  compares_jnds_ = protocol.analysis.outcome == answers.jnd || protocol.analysis.outcome == "weber";
  const std::vector<TaskOutcome> outcomes = measured_outcomes(protocol);
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    if (outcomes[i].key == protocol.analysis.outcome) task_outcome_ = i;
}

StudyOutcome StudyAnalyst::analyse(PowerAnalysis analysis, std::span<const DrawnPerson> people) const {
  switch (analysis) {
    case PowerAnalysis::registered:
      return registered(people);
    case PowerAnalysis::median:
      return median(people);
    case PowerAnalysis::log_ml:
      return log_ml(people);
    case PowerAnalysis::hierarchical:
      break;
  }
  return hierarchical(people);
}

// Means of log-normal quantities: a person's JND is exp(mu + u + v).
double StudyAnalyst::true_jnd(PowerAnalysis analysis, std::size_t condition) const {
  // A staircase's threshold is a level, which depends on the criterion too.
  const bool level = protocol_.design.procedure && threshold_source(protocol_) != ThresholdSource::answers &&
                     (analysis == PowerAnalysis::registered || analysis == PowerAnalysis::median);
  const bool other = analysis == PowerAnalysis::registered && !compares_jnds_ && !protocol_.analysis.hierarchical;
  if (!known_ || level || other) return kNaN;
  const double half_variance = 0.5 * (truth_.tu * truth_.tu + truth_.tv * truth_.tv);
  return of_noise_ * std::exp(truth_.mu[condition] + (analysis == PowerAnalysis::registered ? half_variance : 0));
}

double StudyAnalyst::true_difference(PowerAnalysis analysis, std::size_t contrast) const {
  if (!known_) return kNaN;
  const auto a = static_cast<std::size_t>(question_.contrasts[contrast][0]),
             b = static_cast<std::size_t>(question_.contrasts[contrast][1]);
  const double half_variance = 0.5 * (truth_.tu * truth_.tu + truth_.tv * truth_.tv);
  const Outcome outcome = protocol_.analysis.tests.outcome;
  if (analysis == PowerAnalysis::registered && !compares_jnds_ && !protocol_.analysis.hierarchical) return kNaN;
  if (analysis != PowerAnalysis::registered || outcome == Outcome::log_jnd || protocol_.analysis.hierarchical)
    return truth_.mu[a] - truth_.mu[b];
  if (std::isnan(true_jnd(analysis, a))) return kNaN;
  if (outcome == Outcome::slope && !task_ && !protocol_.design.procedure)
    return std::exp(half_variance - truth_.mu[a]) - std::exp(half_variance - truth_.mu[b]);
  const double scale = protocol_.analysis.outcome == "weber" ? 1 / protocol_.series.front().standard : 1;
  return scale * (true_jnd(analysis, a) - true_jnd(analysis, b));
}

// By the rules of jnd analyze: whoever has no value is left out, or a test is refused, as registered.
StudyOutcome StudyAnalyst::registered(std::span<const DrawnPerson> people) const {
  StudyOutcome outcome;
  if (protocol_.analysis.hierarchical) {
    outcome.contrasts = hierarchical(people).contrasts;
    add_registered_group(outcome, people);
    return outcome;
  }
  OutcomeComparison values;
  if (task_) {
    TaskResults results;
    results.outcomes = measured_outcomes(protocol_);
    results.registered = task_outcome_;
    results.estimates = rows_of<TaskEstimateRow>(people, &DrawnPerson::estimates);
    values = compare_task(results, protocol_, Compared::contrasts);
  } else if (protocol_.design.procedure) {
    values = compare_adaptive(rows_of<AdaptiveRow>(people, &DrawnPerson::tracks), protocol_, Compared::contrasts);
  } else {
    values = compare_thresholds(rows_of<ThresholdResult>(people, &DrawnPerson::thresholds), protocol_,
                                protocol_.analysis.tests.outcome, Compared::contrasts);
  }
  for (const ContrastRow& row : contrast_rows({}, values, protocol_))
    outcome.contrasts.push_back({row.difference.mean, row.difference.ci_low, row.difference.ci_high, row.p});
  add_registered_group(outcome, people);
  return outcome;
}

void StudyAnalyst::add_registered_group(StudyOutcome& outcome, std::span<const DrawnPerson> people) const {
  std::vector<std::vector<double>> jnds(truth_.mu.size());
  const auto add = [&](int condition, double jnd) {
    if (!compares_jnds_)
      outcome.undefined = outcome.undefined || !std::isfinite(jnd);
    else if (std::isfinite(jnd) && jnd > 0)
      jnds[static_cast<std::size_t>(condition)].push_back(jnd);
    else
      outcome.undefined = true;
  };
  for (const DrawnPerson& person : people) {
    if (person.dropped) continue;
    for (const ThresholdResult& row : person.thresholds)
      add(row.condition, row.jnd.status == JndStatus::ok ? row.jnd.jnd : kNaN);
    for (const AdaptiveRow& row : person.tracks)
      add(row.condition, row.threshold.status == AdaptiveStatus::ok ? row.threshold.threshold : kNaN);
    for (const TaskEstimateRow& row : person.estimates) {
      if (row.series != 0) continue;
      const std::span<const TaskEstimateRow> series = {&row, protocol_.series.size()};
      const bool complete = &row + protocol_.series.size() <= person.estimates.data() + person.estimates.size();
      const double scale = protocol_.analysis.outcome == "weber" ? protocol_.series.front().standard : 1;
      add(row.condition, complete ? scale * outcome_value(series.front(), task_outcome_, protocol_) : kNaN);
    }
  }
  for (const std::vector<double>& of_condition : jnds) {
    const MeanEstimate mean = mean_with_ci(of_condition);
    outcome.group.push_back(mean.n > 0 ? GroupJnd{mean.mean, mean.ci_low, mean.ci_high} : GroupJnd{});
  }
}

StudyOutcome StudyAnalyst::median(std::span<const DrawnPerson> people) const {
  StudyOutcome outcome;
  std::vector<std::vector<double>> jnds(truth_.mu.size()), slopes(truth_.mu.size());
  for (const DrawnPerson& person : people) {
    if (person.dropped) continue;
    for (const ThresholdResult& row : person.thresholds) {
      const auto c = static_cast<std::size_t>(row.condition);
      // As in the median of jnd analyze: no sensitivity is the largest JND, a ceiling the smallest.
      if (row.jnd.status != JndStatus::no_information)
        jnds[c].push_back(row.jnd.status == JndStatus::no_sensitivity ? kInf : row.jnd.jnd);
      outcome.undefined = outcome.undefined || row.jnd.status != JndStatus::ok;
      slopes[c].push_back(std::isfinite(row.jnd.slope) ? row.jnd.slope : kNaN);
    }
  }
  for (const std::vector<double>& of_condition : jnds) outcome.group.push_back(median_of_jnds(of_condition));
  for (const auto& [a, b] : question_.contrasts) {
    const auto first = static_cast<std::size_t>(a), second = static_cast<std::size_t>(b);
    std::vector<double> x, y;
    for (std::size_t i = 0; i < slopes[first].size(); ++i) {
      if (std::isnan(slopes[first][i]) || std::isnan(slopes[second][i])) continue;
      x.push_back(slopes[first][i]);
      y.push_back(slopes[second][i]);
    }
    GroupContrast& one = outcome.contrasts.emplace_back();
    one.difference = std::log(outcome.group[first].jnd) - std::log(outcome.group[second].jnd);
    one.p = signed_rank(x, y).p;
  }
  correct(outcome.contrasts);
  return outcome;
}

void StudyAnalyst::add_cell(std::vector<HierarchicalCell>& cells, const HierarchicalCell& cell) const {
  if (model_.tw)
    cells.push_back(cell);
  else  // as the study's own analysis takes it
    add_without_bias(cells, cell);
}

StudyOutcome StudyAnalyst::log_ml(std::span<const DrawnPerson> people) const {
  StudyOutcome outcome;
  const std::size_t conditions = truth_.mu.size();
  std::vector<std::vector<double>> ln_jnds(conditions);  // by condition, then person
  std::optional<SearchRange> range;                      // that of the design's levels
  for (const DrawnPerson& person : people) {
    if (person.dropped) continue;
    for (std::size_t c = 0; c < conditions; ++c) {
      std::vector<HierarchicalCell> cells;
      for (const HierarchicalCell& cell : person.answers)
        if (cell.condition == static_cast<int>(c)) add_cell(cells, cell);
      double value = kNaN;
      if (levels_differ(cells)) {
        if (!range || protocol_.design.procedure) range = search_range(cells, model_.response);
        const double ln_s = pooled_maximum(cells, model_.response, model_.shared, range->start).ln_s;
        if (ln_s > range->least && ln_s < range->greatest) value = ln_s;
      }
      outcome.undefined = outcome.undefined || std::isnan(value);
      ln_jnds[c].push_back(value);
    }
  }
  for (std::size_t c = 0; c < conditions; ++c) {
    std::vector<double> values = ln_jnds[c];
    std::erase_if(values, [](double value) { return std::isnan(value); });
    const MeanEstimate mean = mean_with_ci(values);
    GroupJnd& group = outcome.group.emplace_back();
    if (mean.n > 0)
      group = {of_noise_ * std::exp(mean.mean), of_noise_ * std::exp(mean.ci_low), of_noise_ * std::exp(mean.ci_high)};
  }
  for (const auto& [a, b] : question_.contrasts) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < ln_jnds[static_cast<std::size_t>(a)].size(); ++i) {
      const double of_a = ln_jnds[static_cast<std::size_t>(a)][i], of_b = ln_jnds[static_cast<std::size_t>(b)][i];
      if (std::isnan(of_a) || std::isnan(of_b)) continue;
      x.push_back(of_a);
      y.push_back(of_b);
    }
    GroupContrast& one = outcome.contrasts.emplace_back();
    const PairedT t = paired_t(x, y);
    if (t.status != StatisticStatus::ok) continue;
    one = {t.mean_difference, t.ci_low, t.ci_high, t.p};
  }
  correct(outcome.contrasts);
  return outcome;
}

StudyOutcome StudyAnalyst::hierarchical(std::span<const DrawnPerson> people) const {
  StudyOutcome outcome;
  std::vector<HierarchicalCell> cells;
  int number = 0;
  for (const DrawnPerson& person : people) {
    if (person.dropped) continue;
    for (HierarchicalCell cell : person.answers) {
      cell.participant = number;
      add_cell(cells, cell);
    }
    ++number;
  }
  outcome.group.resize(truth_.mu.size());
  outcome.contrasts.resize(question_.contrasts.size());
  outcome.undefined = number < 2 || !levels_differ(cells);
  if (outcome.undefined) return outcome;
  const RoughFit fit = rough_fit(cells, model_, truth_, question_.contrasts);
  const double t = student_t_quantile_two_sided(0.05, number - 1);
  for (std::size_t c = 0; c < fit.means.size(); ++c) {
    const RoughMean& mean = fit.means[c];
    if (mean.status == SlopeStatus::ok)
      outcome.group[c] = {of_noise_ * std::exp(mean.mu), of_noise_ * std::exp(mean.mu - t * mean.error),
                          of_noise_ * std::exp(mean.mu + t * mean.error)};
    else
      outcome.undefined = true;
  }
  for (std::size_t i = 0; i < fit.differences.size(); ++i) {
    const RoughDifference& one = fit.differences[i];
    outcome.contrasts[i] = {one.difference, one.difference - t * one.error, one.difference + t * one.error, one.p};
  }
  correct(outcome.contrasts);
  return outcome;
}

std::string contrast_scale(PowerAnalysis analysis, const Protocol& protocol) {
  if (analysis != PowerAnalysis::registered || protocol.analysis.hierarchical) return "ln JND";
  const bool task = !task_of(protocol.task.kind).has_own_results();
  if (task || protocol.design.procedure) {
    const std::string name = task ? protocol.analysis.outcome : "threshold";
    return protocol.analysis.tests.outcome == Outcome::log_jnd && task ? "ln " + name : name;
  }
  const std::string unit(to_string(protocol.stimulus.unit));
  switch (protocol.analysis.tests.outcome) {
    case Outcome::slope:
      return "d' per " + unit;
    case Outcome::jnd:
      return "JND, " + unit;
    case Outcome::log_jnd:
      break;
  }
  return "ln JND";
}

std::string power_refusal(PowerAnalysis analysis, const Protocol& protocol) {
  const bool task = !task_of(protocol.task.kind).has_own_results();
  const std::string& compared = protocol.analysis.outcome;
  // These move with the JND, and are told from answers without degrees of sureness.
  if (analysis == PowerAnalysis::registered && task && compared != "jnd" && compared != "threshold" &&
      compared != "weber" && compared != "dprime" && compared != "correct")
    return "the protocol compares the " + compared + ", and what differs here is the JND";
  if (analysis != PowerAnalysis::registered && task && protocol.series.size() > 1)
    return "the protocol has several standards, and this analysis one JND of each condition";
  if (analysis == PowerAnalysis::median && (task || protocol.design.procedure))
    return "the median is of least-squares JNDs: of same-different with given levels";
  return "";
}

}  // namespace jnd
