#include "protocols/tasks/same_different_task.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "protocols/input/json_reader.h"
#include "protocols/tasks/catch_trials.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/posterior_model.h"

namespace jnd {
namespace {

double assumed_criterion(const Protocol& protocol) {
  return posterior_model(protocol, protocol.series.front()).configuration.shift_prior.mean;
}

}  // namespace

TaskStart SameDifferentTask::start() const {
  return {.asks = "Same or different?",
          .keys = R"({"same": "s", "different": "d"})",
          .levels = {0.5, 0.7},
          .levels_are = "What the standard is paired with",
          .trials_per_cell = 24,
          .analysis = R"({"model": "yes-no", "correction": "loglinear", "jnd": "least_squares"})"};
}

void SameDifferentTask::read(JsonReader& section, TaskSpec& spec) const {
  spec.sureness_levels = section.integer_or("sureness", 0, {.min = 0, .max = 4});
  spec.classes = {"same", "different"};
}

std::vector<TaskProblem> SameDifferentTask::problems(const Protocol& protocol) const {
  if (protocol.task.sureness_levels == 0 || levels_given(protocol)) return {};
  return {
      {"$.task.sureness", "a procedure goes by same or different, however sure", "remove it, or give constant series"}};
}

Evidence SameDifferentTask::evidence(const Protocol& protocol) const noexcept {
  return levels_given(protocol) ? Evidence::counts : Evidence::tracks;
}

std::string SameDifferentTask::cells_text(const Protocol& protocol) const {
  return fmt::format("{} series x {} trials per cell", protocol.series.size(), protocol.design.trials_per_cell);
}

std::vector<DrawnTrial> SameDifferentTask::draw(const CellDraw& cell, RandomStream& stream) const {
  const std::array<double, 2>& pair = cell.series.pair;
  std::vector<Intervals> drawn;
  if (cell.sampling == Sampling::random) {
    for (int i = 0; i < cell.trials; ++i) {
      const double first = pair[stream.coin() ? 1 : 0];
      const double second = pair[stream.coin() ? 1 : 0];
      drawn.push_back({first, second});
    }
  } else {
    for (int i = 0; i < cell.trials / 4; ++i)
      drawn.insert(drawn.end(), {{pair[0], pair[0]}, {pair[1], pair[1]}, {pair[0], pair[1]}, {pair[1], pair[0]}});
    stream.shuffle(drawn);
  }
  std::vector<DrawnTrial> trials;
  for (const Intervals& stimuli : drawn) trials.push_back({stimuli, target_of(stimuli, 0, cell.protocol.task)});
  return trials;
}

std::vector<DrawnTrial> SameDifferentTask::draw_track(const CellDraw& track, const AdaptiveProcedure& procedure,
                                                      RandomStream& stream) const {
  const CatchBlock catches = catch_block_of(procedure).value();
  std::vector<DrawnTrial> trials;
  for (const auto& [first, second] : draw_slots(catches, track.trials, track.protocol.stimulus.reference, stream))
    trials.push_back({{first, second}, first == second ? kClassSame : kClassDifferent});
  return trials;
}

// Where all are of one class by chance, one of them is turned.
std::vector<DrawnTrial> SameDifferentTask::draw_practice(const CellDraw& round, RandomStream& stream) const {
  const auto& [protocol, series, count, sampling] = round;
  const bool whole = count % balance_of(protocol.task) == 0;
  std::vector<DrawnTrial> trials =
      draw({protocol, series, count, whole ? Sampling::balanced : Sampling::random}, stream);
  const auto of_first_class = [&](const DrawnTrial& trial) { return trial.target == trials.front().target; };
  if (trials.size() < 2 || !std::all_of(trials.begin(), trials.end(), of_first_class)) return trials;
  DrawnTrial& turned = trials[static_cast<std::size_t>(stream.below(trials.size()))];
  turned.stimuli[1] = turned.stimuli[1] == series.pair[0] ? series.pair[1] : series.pair[0];
  turned.target = target_of(turned.stimuli, series.standard, protocol.task);
  return trials;
}

std::string SameDifferentTask::without_model(const Protocol& protocol) const {
  return fmt::format("the model \"{}\"", protocol.analysis.model);
}

std::optional<AnswerModel> SameDifferentTask::answer_model(const Protocol& protocol) const {
  // A threshold of reversals or QUEST is none of d' = 1.
  const std::string_view jnd = levels_given(protocol) ? "jnd" : has_posterior_threshold(protocol) ? "threshold" : "";
  if (protocol.analysis.model == "yes-no") return AnswerModel{.response = ResponseModel::yes_no, .jnd = jnd};
  if (protocol.analysis.model == "differencing")
    return AnswerModel{.response = ResponseModel::differencing, .jnd = jnd};
  // Of equal stimuli this observer needs to know how far apart the others of their series are.
  if (protocol.analysis.model == "independent-observation" && levels_given(protocol))
    return AnswerModel{.response = ResponseModel::independent, .jnd = jnd};
  return std::nullopt;
}

LevelAnswer SameDifferentTask::level_answer(const AnsweredTrial& trial, const TaskSpec&) const {
  return {plain_distance(trial.stimuli[0], trial.stimuli[1]), trial.said == kClassDifferent};
}

std::vector<TaskOutcome> SameDifferentTask::outcomes(const Protocol& protocol) const {
  const std::string unit(to_string(protocol.stimulus.unit));
  if (levels_given(protocol))
    return {{"slope", "slope of d' on the stiffness difference", "per " + unit,
             "slope of d' on the stiffness difference, through the origin", false, false, true},
            {"jnd", "JND", unit, "just-noticeable difference: 1 / slope", true},
            {"weber", "Weber fraction", "", "JND / reference", true, true}};
  return {{"threshold", "threshold", unit,
           has_posterior_threshold(protocol) ? "JND, the difference at d' = 1: exp of the posterior mean of ln JND"
                                             : "difference at the procedure's target rate",
           true},
          {"weber", "Weber fraction", "", "threshold / reference", true, true}};
}

// Thresholds follow from the tracks (track_threshold.h), and JNDs from the counts of answers.
TaskEstimates SameDifferentTask::estimate(const Protocol&, const Series&, std::span<const AnsweredTrial>) const {
  return {};
}

int SameDifferentTask::target_of(const Intervals& stimuli, double, const TaskSpec&) const noexcept {
  return stimuli[0] == stimuli[1] ? kClassSame : kClassDifferent;
}

// By the size of the felt difference: "different" above the noise of one interval.
Answer SameDifferentTask::answer(std::span<const Felt> felt, const Trial&, const Protocol&, RandomStream&) const {
  return {.said = std::abs(felt[0].value - felt[1].value) > felt[0].sigma ? kClassDifferent : kClassSame};
}

Answer SameDifferentTask::unbiased_answer(const Intervals& presented, const Trial&, const Protocol& protocol,
                                          double noise, RandomStream& stream) const {
  const double difference = std::abs(presented[0] - presented[1]);
  const bool different = difference / noise - assumed_criterion(protocol) + stream.normal() > 0;
  return {.said = different ? kClassDifferent : kClassSame};
}

std::string SameDifferentTask::unbiased_words(const Protocol& protocol) const {
  return fmt::format(
      "\"different\" is answered with probability Phi(difference / noise - {:.4g}), the criterion that the "
      "procedure's prior expects",
      assumed_criterion(protocol));
}

}  // namespace jnd
