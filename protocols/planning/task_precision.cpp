#include "protocols/planning/task_precision.h"

#include <cmath>
#include <limits>
#include <utility>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/sample_quantile.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/plan.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/random_stream.h"
#include "protocols/tasks/posterior_model.h"
#include "protocols/tasks/task.h"

namespace jnd {
namespace {

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
