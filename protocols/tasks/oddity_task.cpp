// "Which is the odd one?", three intervals: two of them alike, a standard and a comparison in either role. Directed, "which of
// the three is stiffer?": the comparison is always the greater, or the lesser (3AFC).
//
// Its response model is the Thurstonian triangle, where the two that feel nearest to each other are taken for alike;
// directed, that of three alternatives, where the greatest is chosen (analysis/choice).
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"
#include "protocols/tasks/task_estimates.h"

namespace jnd {
namespace {

ChoiceTask model_of(const Protocol& protocol) {
  return protocol.task.directed ? ChoiceTask::three_afc : ChoiceTask::oddity;
}

class OddityTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::oddity; }
  std::string_view summary() const noexcept override { return "three intervals: which is the odd one?"; }
  TaskStart start() const override {
    return {.asks = "Which was the odd one?",
            .keys = R"({"first": "1", "second": "2", "third": "3"})",
            .levels = {1.2, 1.35, 1.5},
            .trials_per_cell = 24,
            .analysis = R"({"outcome": "jnd"})"};
  }
  void read(JsonReader& section, TaskSpec& spec) const override {
    enum class Odd { either, greater, lesser };
    const Odd odd = section.one_of_or<Odd>(
        "odd", {{"either", Odd::either}, {"greater", Odd::greater}, {"lesser", Odd::lesser}}, Odd::either);
    spec.directed = odd != Odd::either;
    spec.greater = odd != Odd::lesser;
    spec.classes = {"first", "second", "third"};
  }
  bool has_procedures() const noexcept override { return true; }
  std::vector<TaskProblem> problems(const Protocol& protocol) const override {
    if (!protocol.task.directed) return {};
    const std::string_view word = protocol.task.greater ? "greater" : "lesser",
                           side = protocol.task.greater ? "above" : "below";
    std::vector<TaskProblem> problems;
    for (const Series& series : protocol.series)
      for (const double level : series.levels)
        if ((level > series.standard) != protocol.task.greater)
          problems.push_back({"$.levels",
                              fmt::format("the odd one is to be the {}, and {:g} is not {} the standard, {:g}", word,
                                          level, side, series.standard),
                              fmt::format("give levels {} it, or \"odd\": \"either\"", side)});
    if (!levels_given(protocol))
      for (const int of : sides_of_comparisons(protocol, {}))
        if ((of > 0) != protocol.task.greater)
          problems.push_back({"$.design.procedure.side", fmt::format("the odd one is to be the {}", word),
                              fmt::format("write \"{}\", or \"odd\": \"either\" in the task", side)});
    return problems;
  }
  int balance_of(const TaskSpec& spec) const noexcept override { return spec.directed ? 3 : 6; }
  int intervals(const TaskSpec&) const noexcept override { return 3; }
  // In every place the comparison, or where the odd one is not directed either of the two.
  std::vector<DrawnTrial> arrangements(const CellDraw& cell, double comparison, int) const override {
    const double standard = cell.series.standard;
    std::vector<DrawnTrial> triads;
    for (const auto& [odd, others] : {std::pair(comparison, standard), std::pair(standard, comparison)}) {
      if (cell.protocol.task.directed && odd == standard) continue;
      for (std::size_t place = 0; place < 3; ++place) {
        Intervals stimuli{others, others, others};
        stimuli[place] = odd;
        triads.push_back({stimuli, static_cast<int>(place)});
      }
    }
    return triads;
  }
  int target_of(const Intervals& stimuli, double, const TaskSpec&) const noexcept override {
    if (stimuli[0] == stimuli[1]) return stimuli[1] == stimuli[2] ? -1 : 2;
    return stimuli[0] == stimuli[2] ? 1 : stimuli[1] == stimuli[2] ? 0 : -1;
  }
  // The two that feel nearest to each other are taken for alike: the third is odd. Directed, the greatest or the least is.
  Answer answer(std::span<const Felt> felt, const Trial&, const Protocol& protocol, RandomStream&) const override {
    if (protocol.task.directed) {
      const auto less = [](const Felt& a, const Felt& b) { return a.value < b.value; };
      const auto odd = protocol.task.greater ? std::max_element(felt.begin(), felt.end(), less)
                                             : std::min_element(felt.begin(), felt.end(), less);
      Answer answer;
      answer.said = static_cast<int>(odd - felt.begin());
      return answer;
    }
    const auto distance = [&](std::size_t a, std::size_t b) { return std::abs(felt[a].value - felt[b].value); };
    const double d01 = distance(0, 1), d02 = distance(0, 2), d12 = distance(1, 2);
    Answer answer;
    answer.said = d12 < d01 && d12 < d02 ? 0 : d02 < d01 ? 1 : 2;
    return answer;
  }
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override { return choice_outcomes(protocol); }
  TaskEstimates estimate(const Protocol& protocol, const Series& series,
                         std::span<const AnsweredTrial> trials) const override {
    return choice_estimates(model_of(protocol), series, trials);
  }
  std::optional<TaskCurve> curve(const Protocol& protocol, const Series&,
                                 std::span<const AnsweredTrial> trials) const override {
    return choice_curve(model_of(protocol), trials);
  }
  std::string arrangement(const Protocol& protocol) const override {
    return fmt::format("{} the odd one, in each of the three places, {}. ",
                       protocol.task.directed ? "The comparison was" : "Standard and comparison were",
                       how_often(protocol));
  }
  // At d' = 1, which is of one interval's noise.
  std::optional<double> jnd_of_noise(const Protocol&) const override { return 1 / std::sqrt(2.0); }
  std::string methods(const Protocol& protocol) const override {
    return fmt::format(
        "The JND is the difference at d' = 1, with d' in proportion to the difference, by maximum likelihood under {}; its "
        "interval is profile likelihood, 95 %. d' and the share of correct answers beside it are of all trials together. There "
        "is no JND where the status is ceiling (every answer was correct) or no_sensitivity (not better than chance): its "
        "interval is open on one side.",
        protocol.task.directed
            ? fmt::format("the model of three alternatives, of which the {} is chosen (Macmillan and Creelman 2005)",
                          protocol.task.greater ? "greatest" : "least")
            : std::string("the Thurstonian model of the triangle, comparison of distances (Ennis 1993)"));
  }
};

}  // namespace

const Task& oddity_task() noexcept {
  static const OddityTask task;
  return task;
}

}  // namespace jnd
