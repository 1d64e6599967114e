#include "protocols/planning/planned_precision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "analysis/numerics/moments.h"
#include "analysis/numerics/sample_quantile.h"
#include "analysis/numerics/words.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/plan.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/random_stream.h"
#include "protocols/tasks/posterior_model.h"
#include "protocols/tasks/task.h"

namespace jnd {

namespace {

constexpr double kForceWeber = 0.315, kVibrationWeber = 0.39, kKinaestheticWeber = 0.23;

double weber_of(const Cues& cues) noexcept {
  double precision = 0;
  if (cues.force) precision += 1 / (kForceWeber * kForceWeber);
  if (cues.vibration) precision += 1 / (kVibrationWeber * kVibrationWeber);
  if (cues.kinaesthetic) precision += 1 / (kKinaestheticWeber * kKinaestheticWeber);
  return precision > 0 ? 1 / std::sqrt(precision) : kVibrationWeber;  // without any cue: as the worst
}

// Draws of a participant in one condition and series: some seconds. A larger study is drawn less often; what follows
// from the number of studies is printed with it.
constexpr double kMostDraws = 1e7;
constexpr int kFewestExperiments = 1000;

int experiments_of(const PrecisionQuestion& question) {
  const double draws = static_cast<double>(question.jnds.size() * question.design.differences.size()) *
                       static_cast<double>(question.participants);
  return std::clamp(static_cast<int>(kMostDraws / draws), kFewestExperiments, question.experiments);
}

const Cues* cues_of(const Protocol& protocol, std::string_view condition) noexcept {
  for (const Condition& one : protocol.conditions)
    if (one.name == condition) return &one.cues;
  return nullptr;
}

// A trial whose answers accept nothing after so many looks is left out, as in a session.
constexpr int kMostLooks = 200;

double noise_of(const Series& series, const TaskPrecisionQuestion& question) {
  if (question.noise) return *question.noise;
  const double of = series.standard != 0 ? series.standard : 0.5 * (series.pair[0] + series.pair[1]);
  return kAssumedWeber * std::abs(of);
}

// The participant's answer to a trial, whatever looks that takes.
std::optional<Answer> answer_to(const Trial& trial, const Protocol& protocol, double noise, RandomStream& stream) {
  const Task& task = task_of(protocol.task.kind);
  Intervals now = trial.stimuli;
  for (int look = 0; look < kMostLooks; ++look) {
    const Answer answer = task.unbiased_answer(now, trial, protocol, noise, stream);
    const std::optional<Intervals> moved = task.moved(now, answer, trial, protocol);
    if (!moved) return task.settled(answer, now);
    now = *moved;
  }
  return std::nullopt;
}

// What became of one participant in the first condition that they get, by series: an observer feels the same in all of them.
struct Simulated {
  std::vector<std::vector<AnsweredTrial>> answers;
  std::vector<std::vector<AdaptiveTrack>> tracks;  // of a procedure
};
Simulated simulated(const Protocol& protocol, int participant, const TaskPrecisionQuestion& question) {
  Simulated result{std::vector<std::vector<AnsweredTrial>>(protocol.series.size()),
                   std::vector<std::vector<AdaptiveTrack>>(protocol.series.size())};
  RandomStream stream(question.seed, static_cast<std::uint64_t>(participant), "precision");
  AdaptiveRun run(protocol);
  const Plan plan = make_plan(protocol, participant, question.seed);
  for (const Trial& planned : plan.trials) {
    if (planned.practice || planned.condition != plan.conditions.front() || run.over(planned)) continue;
    const Trial trial = run.resolved(planned);
    const auto series = static_cast<std::size_t>(trial.series);
    const auto answer = answer_to(trial, protocol, noise_of(protocol.series[series], question), stream);
    if (!answer) continue;
    run.answered(planned, *answer);
    result.answers[series].push_back({trial.stimuli, trial.standard, trial.target, answer->said, answer->sureness,
                                      answer->number, trial.standard_place});
  }
  for (AdaptiveTrack& track : run.tracks())
    if (track.condition == plan.conditions.front())
      result.tracks[static_cast<std::size_t>(track.series)].push_back(std::move(track));
  return result;
}

TaskEstimates estimates_of(const Simulated& participant, const Protocol& protocol, std::size_t series) {
  return measured_estimates(protocol, protocol.series[series], participant.answers[series], participant.tracks[series]);
}

void summarize(TaskPrecisionRow& row, const std::vector<double>& values, int participants) {
  row.undefined = 1 - static_cast<double>(values.size()) / participants;
  if (values.size() < 2) {
    row.median = row.low = row.high = row.cv = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  const SampleQuantiles quantiles(values);
  row.median = quantiles.at(0.5);
  row.low = quantiles.at(0.025);
  row.high = quantiles.at(0.975);
  const Moments of = moments(values);
  row.cv = of.sd / std::abs(of.mean);
}

}  // namespace

std::string_view to_string(JndSource source) noexcept {
  constexpr auto kWords = words<JndSource>(
      {{"published", JndSource::published}, {"assumed", JndSource::assumed}, {"asked", JndSource::asked}});
  return word_of(kWords, source);
}

PlannedJnd planned_jnd(const Protocol& protocol, std::string_view condition) {
  for (const PublishedValue& value : protocol.published)
    if (value.condition == condition && value.quantity == "jnd" && value.value > 0)
      return {value.value, JndSource::published};
  const Cues* const cues = cues_of(protocol, condition);
  return {weber_of(cues == nullptr ? Cues{} : *cues) * protocol.stimulus.reference, JndSource::assumed};
}

bool has_precision(const Protocol& protocol) noexcept {
  return !protocol.series.empty() && task_of(protocol.task.kind).evidence(protocol) == Evidence::counts;
}

CountsDesign counts_design(const Protocol& protocol) {
  CountsDesign design;
  for (const Series& series : protocol.series)
    design.differences.push_back(plain_distance(series.pair[0], series.pair[1]));
  design.trials = protocol.design.trials_per_cell;
  design.class_sizes = protocol.design.sampling == Sampling::balanced ? ClassSizes::balanced : ClassSizes::random;
  design.correction = correction_from(protocol.analysis.correction).value_or(Correction::loglinear);
  return design;
}

PrecisionQuestion precision_question(const Protocol& protocol) {
  PrecisionQuestion question;
  question.design = counts_design(protocol);
  for (const Condition& condition : protocol.conditions)
    question.jnds.push_back(planned_jnd(protocol, condition.name).value);
  for (const Contrast& contrast : protocol.analysis.contrasts) question.contrasts.push_back({contrast.a, contrast.b});
  if (question.contrasts.empty()) {
    const int conditions = static_cast<int>(protocol.conditions.size());
    for (int a = 0; a < conditions; ++a)
      for (int b = a + 1; b < conditions; ++b)
        if (anyone_has_both(protocol, a, b)) question.contrasts.push_back({a, b});
  }
  question.participants = protocol.design.participants;
  if (!everyone_has_all(protocol)) question.participants = std::max(1, question.participants / group_count(protocol));
  question.experiments = experiments_of(question);
  return question;
}

std::string precision_note(const Protocol& protocol) {
  const AnalysisPlan& analysis = protocol.analysis;
  std::string note;
  if (analysis.model != "yes-no" || analysis.jnd_method != "least_squares")
    note =
        fmt::format("the figures are for least-squares JNDs of yes-no d'; the protocol registers {} with the {} model",
                    analysis.jnd_method, analysis.model);
  if (analysis.by_delivered)
    note += fmt::format("{}the figures are for the nominal differences; the protocol registers the delivered ones",
                        note.empty() ? "" : "; ");
  if (analysis.hierarchical)
    note +=
        fmt::format("{}the figures are for separate JNDs; the protocol registers contrasts of the hierarchical model",
                    note.empty() ? "" : "; ");
  if (!everyone_has_all(protocol))
    note += fmt::format("{}groups get different conditions: the figures are for the participants of one",
                        note.empty() ? "" : "; ");
  return note;
}

std::vector<TaskPrecisionRow> task_precision(const Protocol& protocol, const TaskPrecisionQuestion& question,
                                             const std::function<void(int)>& progress) {
  const std::size_t outcomes = measured_outcomes(protocol).size(), all_series = protocol.series.size();
  std::vector<std::vector<double>> values(all_series * outcomes);
  std::vector<std::size_t> trials(all_series);
  for (int participant = 1; participant <= question.participants; ++participant) {
    const Simulated answered = simulated(protocol, participant, question);
    for (std::size_t series = 0; series < all_series; ++series) {
      trials[series] += answered.answers[series].size();
      const TaskEstimates estimates = estimates_of(answered, protocol, series);
      for (std::size_t outcome = 0; outcome < outcomes; ++outcome)
        if (const auto& value = estimates.values[outcome].value; value && std::isfinite(*value))
          values[series * outcomes + outcome].push_back(*value);
    }
    if (progress) progress(participant);
  }
  std::vector<TaskPrecisionRow> rows;
  for (std::size_t series = 0; series < all_series; ++series) {
    for (std::size_t outcome = 0; outcome < outcomes; ++outcome) {
      TaskPrecisionRow row;
      row.series = static_cast<int>(series);
      row.outcome = outcome;
      row.noise = noise_of(protocol.series[series], question);
      row.trials = static_cast<double>(trials[series]) / question.participants;
      summarize(row, values[series * outcomes + outcome], question.participants);
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace jnd
