// "Which of these was it?", one interval: one of N values, each with a name. No standard.
//
// What it measures is a confusion matrix: information transmitted in bits, with and without the correction of its bias,
// the share of correct answers, and d' between neighbours (analysis/ratings).
#include <algorithm>
#include <cmath>

#include "analysis/ratings/identification.h"
#include "protocols/input/json_reader.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/task.h"
#include "protocols/tasks/task_estimates.h"

namespace jnd {
namespace {

class IdentifyTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::identify; }
  std::string_view summary() const noexcept override { return "one interval: which of N named values was it?"; }
  std::string_view values_path() const noexcept override { return "$.classes"; }
  TaskStart start() const override {
    return {.asks = "Which one was it?",
            .levels = {0.5, 0.8, 1.15, 1.5},
            .levels_are = "Values of the classes",
            .trials_per_cell = 15,
            .analysis = R"({"outcome": "information"})"};
  }
  // Its classes are read with the levels: each has a name and a value.
  void read(JsonReader&, TaskSpec&) const override {}
  bool has_standard() const noexcept override { return false; }
  int intervals(const TaskSpec&) const noexcept override { return 1; }
  std::vector<DrawnTrial> arrangements(const CellDraw& cell, double comparison, int) const override {
    return {{{comparison}, target_of({comparison}, 0, cell.protocol.task)}};
  }
  int target_of(const Intervals& stimuli, double, const TaskSpec& spec) const noexcept override {
    const auto& values = spec.class_values;
    const auto found = std::find(values.begin(), values.end(), stimuli[0]);
    return found == values.end() ? -1 : static_cast<int>(found - values.begin());
  }
  // The class whose value is nearest to what was felt.
  Answer answer(std::span<const Felt> felt, const Trial&, const Protocol& protocol, RandomStream&) const override {
    const auto& values = protocol.task.class_values;
    const auto nearer = [&](double a, double b) { return std::abs(a - felt[0].value) < std::abs(b - felt[0].value); };
    Answer answer;
    answer.said = static_cast<int>(std::min_element(values.begin(), values.end(), nearer) - values.begin());
    return answer;
  }
  std::vector<TaskOutcome> outcomes(const Protocol&) const override {
    return {
        {"information", "information", "bit", "transmitted, from the counts as they are (biased upwards)", true},
        {"information_corrected", "corrected", "bit",
         "information corrected for its bias by the jackknife: N I - (N - 1) times the mean information without one trial",
         false},
        {"classes", "equivalent classes", "", "2 to the power of the information", true},
        share_of_correct(),
        {"total_dprime", "total d'", "", "sum of d' between neighbours, maximum likelihood", false, false, false, false,
         true}};
  }
  TaskEstimates estimate(const Protocol& protocol, const Series&,
                         std::span<const AnsweredTrial> trials) const override {
    const std::size_t classes = protocol.task.classes.size();
    std::vector<std::vector<int>> confusion(classes, std::vector<int>(classes));
    for (const AnsweredTrial& trial : trials)
      if (trial.target >= 0 && trial.said >= 0 && static_cast<std::size_t>(trial.said) < classes)
        ++confusion[static_cast<std::size_t>(trial.target)][static_cast<std::size_t>(trial.said)];
    const Identification found = identification(confusion);
    TaskEstimates estimates;
    estimates.status = found.trials > 0 ? "ok" : "no_trials";
    estimates.values = {
        task_estimate(found.information_bits), task_estimate(found.jackknife_bits),
        task_estimate(found.equivalent_classes), share_correct(trials),
        found.ml.status == IdentificationStatus::ok ? task_estimate(found.ml.total_dprime) : TaskEstimate{}};
    if (found.ml.status != IdentificationStatus::ok) estimates.values.back().why = to_string(found.ml.status);
    return estimates;
  }
  std::string methods(const Protocol&) const override {
    return "Information is that of the confusion matrix of each participant and condition, in bits, as it is and "
           "corrected for its bias by the jackknife, N I - (N - 1) times the mean information without one trial (Zahl "
           "1977); equivalent classes are 2 to the power of the uncorrected information. The share of correct answers has "
           "the interval of Clopper and Pearson 1934. Total d' is the sum of d' between neighbouring classes under common "
           "criteria, maximum likelihood; it is left out where a class is never confused with another.";
  }
};

}  // namespace

const Task& identify_task() noexcept {
  static const IdentifyTask task;
  return task;
}

}  // namespace jnd
