#include "runner/power/drawn_study.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/group/between_groups.h"
#include "analysis/group/group.h"
#include "analysis/group/p_adjust.h"
#include "analysis/group/post_hoc.h"
#include "analysis/group/rank_tests.h"
#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/numerics/binomial.h"
#include "analysis/numerics/moments.h"
#include "analysis/numerics/tail_probabilities.h"
#include "data/results/study_comparisons.h"
#include "data/results/study_contrasts.h"
#include "data/results/study_hierarchical.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/level_source.h"
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

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// As in the median of jnd analyze: no sensitivity is the largest JND, a ceiling the smallest; NaN of neither.
double ranked_value(const TaskEstimate& jnd) {
  if (jnd.beyond == Beyond::above) return kInf;
  return jnd.beyond == Beyond::below ? 0 : jnd.value.value_or(kNaN);
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
      effect_(effect),
      truth_(truth_of(question, effect, protocol)),
      known_(!question.profile),
      evidence_(task_of(protocol.task.kind).evidence(protocol)) {
  model_.response = response_model_of(protocol).value();
  model_.shared.lapse = question.people.lapse;
  model_.own_tv = protocol.analysis.own_spreads;
  measured_ = empty_task_results(protocol);
  jnd_ = measured_.registered;
  const AnswerModel answers = task_of(protocol.task.kind).answer_model(protocol).value();
  if (evidence_ == Evidence::counts) jnd_ = 1;  // beside the slope, which may be what is compared
  if (evidence_ != Evidence::answers) return;
  of_noise_ = answers.jnd_of_s;
  model_.tw = !answers.pse_at_standard;
  compares_jnds_ = protocol.analysis.outcome == answers.jnd || protocol.analysis.outcome == "weber";
}

// of: of a group, or of everybody where there are none; NaN of those that do not count. Groups are of one size.
template <typename Of>
double StudyAnalyst::mean_over_groups(const Of& of) const {
  if (protocol_.groups.empty()) return of(std::nullopt);
  double sum = 0;
  int n = 0;
  for (int group = 0; group < group_count(protocol_); ++group) {
    const double value = of(std::optional(group));
    if (std::isnan(value)) continue;
    sum += value;
    ++n;
  }
  return n > 0 ? sum / n : kNaN;
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

// Means of log-normal quantities: a person's JND is exp(mu + u + v), in a group moved by its factor. On the scale of what
// the analysis compares; of the registered analysis the mean over people, of the others that of the median person.
double StudyAnalyst::truth(PowerAnalysis analysis, std::size_t condition, std::optional<int> group,
                           bool of_groups) const {
  const double mu = truth_.mu[condition] + group_shift(question_, effect_, group, condition);
  // Groups are compared by separate values, also where one model of all answers is registered for the conditions.
  const bool model = protocol_.analysis.hierarchical && !of_groups;
  const Outcome outcome = protocol_.analysis.tests.outcome;
  if (analysis != PowerAnalysis::registered || model || (outcome == Outcome::log_jnd && compares_jnds_)) return mu;
  if (!compares_jnds_ || is_level(analysis)) return kNaN;
  const double half_variance = 0.5 * (truth_.tu * truth_.tu + truth_.tv * truth_.tv);
  if (outcome == Outcome::slope && evidence_ == Evidence::counts) return std::exp(half_variance - mu);
  const double scale = protocol_.analysis.outcome == "weber" ? 1 / protocol_.series.front().standard : 1;
  return scale * of_noise_ * std::exp(mu + half_variance);
}

// A staircase's threshold is a level, which depends on the criterion too.
bool StudyAnalyst::is_level(PowerAnalysis analysis) const {
  return !levels_given(protocol_) && threshold_source(protocol_) != ThresholdSource::answers &&
         (analysis == PowerAnalysis::registered || analysis == PowerAnalysis::median);
}

double StudyAnalyst::true_jnd(PowerAnalysis analysis, std::size_t condition) const {
  const bool registered = analysis == PowerAnalysis::registered;
  const bool other = registered && !compares_jnds_ && !protocol_.analysis.hierarchical;
  if (!known_ || is_level(analysis) || other) return kNaN;
  const double half_variance = 0.5 * (truth_.tu * truth_.tu + truth_.tv * truth_.tv);
  const double mu = truth_.mu[condition];
  const double mean = mean_over_groups([&](std::optional<int> group) {
    if (!has_condition(protocol_, group, static_cast<int>(condition))) return kNaN;
    const double shift = group_shift(question_, effect_, group, condition);
    return registered ? std::exp(mu + shift + half_variance) : mu + shift;
  });
  return of_noise_ * (registered ? mean : std::exp(mean));
}

double StudyAnalyst::true_difference(PowerAnalysis analysis, std::size_t test) const {
  if (!known_) return kNaN;
  const std::size_t contrasts = question_.contrasts.size();
  if (test >= contrasts) {
    const GroupTest& groups = question_.group_tests[test - contrasts];
    if (groups.kind != GroupTest::Kind::pair) return kNaN;
    const auto mean = [&](int group) {
      const std::vector<int> own = conditions_of(protocol_, group);
      double sum = 0;
      for (const int c : own) sum += truth(analysis, static_cast<std::size_t>(c), group, true);
      return sum / static_cast<double>(own.size());
    };
    return mean(groups.a) - mean(groups.b);
  }
  const int a = question_.contrasts[test][0], b = question_.contrasts[test][1];
  return mean_over_groups([&](std::optional<int> group) {
    if (!has_condition(protocol_, group, a) || !has_condition(protocol_, group, b)) return kNaN;
    return truth(analysis, static_cast<std::size_t>(a), group, false) -
           truth(analysis, static_cast<std::size_t>(b), group, false);
  });
}

bool StudyAnalyst::has_test(PowerAnalysis analysis, std::size_t test) const {
  if (test < question_.contrasts.size()) return true;
  switch (analysis) {
    case PowerAnalysis::registered:
    case PowerAnalysis::log_ml:
      return true;
    case PowerAnalysis::median:
      return group_kind(test) == GroupTest::Kind::pair;
    case PowerAnalysis::hierarchical:
      break;
  }
  return false;
}

bool StudyAnalyst::has_estimate(PowerAnalysis analysis, std::size_t test) const {
  return has_test(analysis, test) && (test < question_.contrasts.size() || group_kind(test) == GroupTest::Kind::pair);
}

GroupTest::Kind StudyAnalyst::group_kind(std::size_t test) const {
  return question_.group_tests[test - question_.contrasts.size()].kind;
}

// By the rules of jnd analyze: whoever has no value is left out, or a test is refused, as registered.
StudyOutcome StudyAnalyst::registered(std::span<const DrawnPerson> people) const {
  StudyOutcome outcome;
  const bool one_model = protocol_.analysis.hierarchical;
  OutcomeComparison values;
  if (!one_model || !question_.group_tests.empty()) values = compared(people);
  if (one_model) {
    outcome.contrasts = hierarchical(people).contrasts;
    outcome.contrasts.resize(question_.contrasts.size());
  } else {
    for (const ContrastRow& row : contrast_rows(values, protocol_))
      outcome.contrasts.push_back(
          {row.difference.mean, row.difference.ci_low, row.difference.ci_high, row.p_registered});
  }
  if (!question_.group_tests.empty())
    add_group_tests(outcome, compare_groups(values, protocol_).comparison, protocol_.analysis.tests.between);
  add_registered_group(outcome, people);
  return outcome;
}

OutcomeComparison StudyAnalyst::compared(std::span<const DrawnPerson> people) const {
  TaskResults results = measured_;
  results.estimates = rows_of<TaskEstimateRow>(people, &DrawnPerson::estimates);
  return compare_task(results, protocol_, Compared::contrasts);
}

// comparison: empty where there is none. test: what its pairs are tested by.
void StudyAnalyst::add_group_tests(StudyOutcome& outcome, const GroupComparison& comparison, BetweenTest test) const {
  for (const GroupTest& asked : question_.group_tests) {
    GroupContrast& one = outcome.contrasts.emplace_back();
    if (comparison.cells.empty()) continue;
    if (asked.kind == GroupTest::Kind::groups) one.p = comparison.anova.group.p;
    if (asked.kind == GroupTest::Kind::interaction) one.p = comparison.anova.interaction.p_gg;
    if (asked.kind != GroupTest::Kind::pair) continue;
    for (const GroupPair& pair : comparison.pairs) {
      if (static_cast<int>(pair.a) != asked.a || static_cast<int>(pair.b) != asked.b) continue;
      one = {pair.welch.mean_difference, pair.welch.ci_low, pair.welch.ci_high,
             test == BetweenTest::mann_whitney ? pair.ranks_p_holm : pair.welch_p_holm};
    }
  }
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
    const std::size_t standards = judged_standard_count(protocol_);
    for (const TaskEstimateRow& row : person.estimates) {
      if (row.standard != 0) continue;
      const bool complete = &row + standards <= person.estimates.data() + person.estimates.size();
      const double scale = evidence_ == Evidence::answers && protocol_.analysis.outcome == "weber"
                               ? protocol_.series.front().standard
                               : 1;
      add(row.condition, complete ? scale * outcome_value(row, jnd_, protocol_) : kNaN);
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
    for (std::vector<double>& of_condition : slopes) of_condition.push_back(kNaN);
    for (const TaskEstimateRow& row : person.estimates) {
      const auto c = static_cast<std::size_t>(row.condition);
      const TaskEstimate& jnd = row.estimates.values[jnd_];
      if (const double ranked = ranked_value(jnd); !std::isnan(ranked)) jnds[c].push_back(ranked);
      outcome.undefined = outcome.undefined || !jnd.value;
      const double slope = row.estimates.values.front().value.value_or(kNaN);
      slopes[c].back() = std::isfinite(slope) ? slope : kNaN;
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
  if (!question_.group_tests.empty()) add_median_groups(outcome, people);
  return outcome;
}

// Mann and Whitney's test of the means of the slopes over a person's conditions; the medians of the JNDs beside it.
void StudyAnalyst::add_median_groups(StudyOutcome& outcome, std::span<const DrawnPerson> people) const {
  const std::size_t groups = protocol_.groups.size(), conditions = truth_.mu.size();
  std::vector<std::vector<double>> slopes(groups), ln_medians(groups);
  for (std::size_t g = 0; g < groups; ++g) {
    std::vector<std::vector<double>> jnds(conditions);
    for (const DrawnPerson& person : people) {
      if (person.dropped || person.group != static_cast<int>(g)) continue;
      double sum = 0;
      for (const TaskEstimateRow& row : person.estimates) {
        sum += row.estimates.values.front().value.value_or(kNaN);
        if (const double ranked = ranked_value(row.estimates.values[jnd_]); !std::isnan(ranked))
          jnds[static_cast<std::size_t>(row.condition)].push_back(ranked);
      }
      if (std::isfinite(sum)) slopes[g].push_back(sum / static_cast<double>(person.estimates.size()));
    }
    for (const int c : conditions_of(protocol_, static_cast<int>(g)))
      ln_medians[g].push_back(std::log(median_of_jnds(jnds[static_cast<std::size_t>(c)]).jnd));
  }
  std::vector<GroupContrast> found;
  for (const GroupTest& asked : question_.group_tests) {
    GroupContrast& one = found.emplace_back();
    if (asked.kind != GroupTest::Kind::pair) continue;
    const auto a = static_cast<std::size_t>(asked.a), b = static_cast<std::size_t>(asked.b);
    one.difference = mean_of(ln_medians[a]) - mean_of(ln_medians[b]);
    one.p = mann_whitney(slopes[a], slopes[b]).p;
  }
  correct(found);
  outcome.contrasts.insert(outcome.contrasts.end(), found.begin(), found.end());
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
      const bool gets_it = has_condition(protocol_, person.group, static_cast<int>(c));
      if (gets_it && levels_differ(cells)) {
        if (!range || !levels_given(protocol_)) range = search_range(cells, model_.response);
        const double ln_s = pooled_maximum(cells, model_.response, model_.shared, *range).ln_s;
        if (ln_s > range->least && ln_s < range->greatest) value = ln_s;
      }
      outcome.undefined = outcome.undefined || (gets_it && std::isnan(value));
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
  if (question_.group_tests.empty()) return outcome;
  GroupedTable table;
  table.groups = protocol_.groups.size();
  const bool mixed = protocol_.analysis.tests.between == BetweenTest::mixed_anova;
  table.values.k = mixed ? conditions_of(protocol_, 0).size() : 1;
  std::size_t place = 0;  // of the person in ln_jnds
  for (const DrawnPerson& person : people) {
    if (person.dropped) continue;
    std::vector<double> own;
    for (const int c : conditions_of(protocol_, person.group))
      own.push_back(ln_jnds[static_cast<std::size_t>(c)][place]);
    ++place;
    if (std::any_of(own.begin(), own.end(), [](double value) { return std::isnan(value); })) continue;
    if (!mixed) own = {mean_of(own)};
    table.values.values.insert(table.values.values.end(), own.begin(), own.end());
    table.group.push_back(static_cast<std::size_t>(person.group.value()));
    ++table.values.n;
  }
  const std::set<std::size_t> there(table.group.begin(), table.group.end());
  add_group_tests(outcome, there.size() < 2 ? GroupComparison{} : compare_groups(table), BetweenTest::welch);
  return outcome;
}

// Groups are no part of the model.
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
  outcome.contrasts.resize(question_.tests());  // none of groups
  std::set<int> there;                          // conditions: a group may have dropped out
  for (const HierarchicalCell& cell : cells) there.insert(cell.condition);
  outcome.undefined = number < 2 || there.size() < truth_.mu.size() || !levels_differ(cells);
  if (outcome.undefined) return outcome;
  HierarchicalAnalysis analysis(cells, model_, SearchEffort::drawn, &truth_);
  const HierarchicalFit& fit = analysis.fit();
  const std::vector<double> covariance = analysis.covariance();
  outcome.undefined = !fit.maximum.converged || covariance.empty();
  if (outcome.undefined) return outcome;
  const double t = student_t_quantile_two_sided(0.05, number - 1);
  const std::size_t conditions = fit.conditions.size();
  for (std::size_t c = 0; c < conditions; ++c) {
    const double mu = fit.conditions[c].mu, error = std::sqrt(covariance[c * conditions + c]);
    if (fit.conditions[c].status == SlopeStatus::ok)
      outcome.group[c] = {of_noise_ * std::exp(mu), of_noise_ * std::exp(mu - t * error),
                          of_noise_ * std::exp(mu + t * error)};
    else
      outcome.undefined = true;
  }
  for (std::size_t i = 0; i < question_.contrasts.size(); ++i) {
    const auto a = static_cast<std::size_t>(question_.contrasts[i][0]),
               b = static_cast<std::size_t>(question_.contrasts[i][1]);
    const double difference = fit.conditions[a].mu - fit.conditions[b].mu;
    const double error = std::sqrt(std::max(
        0.0, covariance[a * (conditions + 1)] + covariance[b * (conditions + 1)] - 2 * covariance[a * conditions + b]));
    const double drop = analysis.drop_of_difference(a, b, 0);
    outcome.contrasts[i] = {difference, difference - t * error, difference + t * error,
                            std::isnan(drop) ? kNaN : chi2_upper(2 * drop, 1)};
  }
  correct(outcome.contrasts);
  return outcome;
}

std::string contrast_scale(PowerAnalysis analysis, const Protocol& protocol, bool of_groups) {
  if (analysis != PowerAnalysis::registered || (protocol.analysis.hierarchical && !of_groups)) return "ln JND";
  const Evidence evidence = task_of(protocol.task.kind).evidence(protocol);
  if (evidence != Evidence::counts) {
    const bool task = evidence == Evidence::answers;
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
  const Evidence evidence = task_of(protocol.task.kind).evidence(protocol);
  const bool task = evidence == Evidence::answers;
  const std::string& compared = protocol.analysis.outcome;
  // These move with the JND, and are told from answers without degrees of sureness.
  if (analysis == PowerAnalysis::registered && task && compared != "jnd" && compared != "threshold" &&
      compared != "weber" && compared != "dprime" && compared != "correct")
    return "the protocol compares the " + compared + ", and what differs here is the JND";
  if (analysis != PowerAnalysis::registered && task && protocol.series.size() > 1)
    return "the protocol has several standards, and this analysis one JND of each condition";
  if (analysis == PowerAnalysis::median && evidence != Evidence::counts)
    return "the median is of least-squares JNDs: of same-different with given levels";
  return "";
}

}  // namespace jnd
