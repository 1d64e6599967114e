// "Are the two the same?": two intervals with a pair of values, drawn independently or in balance.
//
// What it measures is in the d' of its three models (analysis/detection) and the JNDs of several differences
// (analysis/thresholds); data/task_results/pair_cells.h has both.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "protocols/input/json_reader.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/posterior_model.h"
#include "protocols/tasks/task.h"

namespace jnd {
namespace {

double assumed_criterion(const Protocol& protocol) {
  return posterior_model(protocol, protocol.series.front()).configuration.shift_prior.mean;
}

class SameDifferentTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::same_different; }
  std::string_view summary() const noexcept override { return "two intervals: are they the same or different?"; }
  void read(JsonReader& section, TaskSpec& spec) const override {
    spec.sureness_levels = section.integer_or("sureness", 0, {.min = 0, .max = 4});
    spec.classes = {"same", "different"};
  }
  std::vector<TaskProblem> problems(const Protocol& protocol) const override {
    if (protocol.task.sureness_levels == 0 || levels_given(protocol)) return {};
    return {{"$.task.sureness", "a procedure goes by same or different, however sure",
             "remove it, or give constant series"}};
  }
  bool has_procedures() const noexcept override { return true; }
  std::optional<PosteriorTask> posterior_task() const noexcept override { return PosteriorTask::same_different; }
  std::optional<AnswerModel> answer_model(const Protocol& protocol) const override {
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
  LevelAnswer level_answer(const AnsweredTrial& trial, const TaskSpec&) const override {
    return {plain_distance(trial.stimuli[0], trial.stimuli[1]), trial.said == kClassDifferent};
  }
  bool has_pairs() const noexcept override { return true; }
  std::string_view first_class_key() const noexcept override { return "same"; }
  std::string_view values_path() const noexcept override { return "$.series"; }
  TaskStart start() const override {
    return {.asks = "Same or different?",
            .keys = R"({"same": "s", "different": "d"})",
            .levels = {0.5, 0.7},
            .levels_are = "What the standard is paired with",
            .trials_per_cell = 24,
            .analysis = R"({"model": "yes-no", "correction": "loglinear", "jnd": "least_squares"})"};
  }
  std::string without_model(const Protocol& protocol) const override {
    return fmt::format("the model \"{}\"", protocol.analysis.model);
  }
  bool has_catch_trials() const noexcept override { return true; }
  int balance_of(const TaskSpec&) const noexcept override { return 4; }
  int trials_of_levels(const Protocol& protocol, const Series&) const override {
    return protocol.design.trials_per_cell;
  }
  Evidence evidence(const Protocol& protocol) const noexcept override {
    return levels_given(protocol) ? Evidence::counts : Evidence::tracks;
  }
  std::string cells_text(const Protocol& protocol) const override {
    return fmt::format("{} series x {} trials per cell", protocol.series.size(), protocol.design.trials_per_cell);
  }
  int intervals(const TaskSpec&) const noexcept override { return 2; }
  // Each of (a, a), (b, b), (a, b), (b, a) equally often; or each interval drawn on its own, so that P(same) = 1/2.
  std::vector<DrawnTrial> draw(const CellDraw& cell, RandomStream& stream) const override {
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
  std::vector<DrawnTrial> draw_track(const CellDraw& track, const AdaptiveProcedure& procedure,
                                     RandomStream& stream) const override {
    const CatchBlock catches = catch_block_of(procedure).value();
    std::vector<DrawnTrial> trials;
    for (const auto& [first, second] : draw_slots(catches, track.trials, track.protocol.stimulus.reference, stream))
      trials.push_back({{first, second}, first == second ? kClassSame : kClassDifferent});
    return trials;
  }
  // Of both classes, where there are two trials: where all are of one by chance, one of them is turned.
  std::vector<DrawnTrial> draw_practice(const CellDraw& round, RandomStream& stream) const override {
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
  int target_of(const Intervals& stimuli, double, const TaskSpec&) const noexcept override {
    return stimuli[0] == stimuli[1] ? kClassSame : kClassDifferent;
  }
  // By the response model of its thresholds.
  std::optional<double> jnd_of_noise(const Protocol&) const override { return 1; }
  // By the size of the felt difference: "different" above the noise of one interval.
  Answer answer(std::span<const Felt> felt, const Trial&, const Protocol&, RandomStream&) const override {
    return {.said = std::abs(felt[0].value - felt[1].value) > felt[0].sigma ? kClassDifferent : kClassSame};
  }
  bool compares_cues() const noexcept override { return true; }
  // By the response model of the Bayesian procedure, with the criterion that its prior expects: "different" where
  // difference / noise, plus normal noise of SD 1, is above it.
  Answer unbiased_answer(const Intervals& presented, const Trial&, const Protocol& protocol, double noise,
                         RandomStream& stream) const override {
    const double difference = std::abs(presented[0] - presented[1]);
    const bool different = difference / noise - assumed_criterion(protocol) + stream.normal() > 0;
    return {.said = different ? kClassDifferent : kClassSame};
  }
  std::string unbiased_words(const Protocol& protocol) const override {
    return fmt::format(
        "\"different\" is answered with probability Phi(difference / noise - {:.4g}), the criterion that the "
        "procedure's prior expects",
        assumed_criterion(protocol));
  }
  // A JND by the slope of d' on the difference; with a procedure the threshold of its tracks.
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override {
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
  TaskEstimates estimate(const Protocol&, const Series&, std::span<const AnsweredTrial>) const override { return {}; }
  std::string methods(const Protocol&) const override { return {}; }
};

}  // namespace

const Task& same_different_task() noexcept {
  static const SameDifferentTask task;
  return task;
}

}  // namespace jnd
