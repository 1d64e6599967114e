// "How stiff is it?", one interval, answered with a number; beside a modulus, two: first a standard that is given its
// number, then the value to be judged. No correct answer.
//
// What it measures is the exponent of a power law, after the participants' moduli are made equal (analysis/scaling).
#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/scaling/magnitude.h"
#include "protocols/input/json_reader.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/task.h"
#include "protocols/tasks/task_estimates.h"

namespace jnd {
namespace {

// How a simulated participant's numbers grow with what is felt: the exponent of stiffness by active touch (Varadharajan
// et al. 2008 and others report 0.5 to 1).
constexpr double kExponent = 0.8;
constexpr double kFreeModulus = 10;  // said of the middle of the levels where no modulus is given

double rounded_to_two_digits(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::round(value / unit) * unit;
}

class MagnitudeTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::magnitude; }
  std::string_view summary() const noexcept override { return "one interval: a number for how much it was"; }
  TaskStart start() const override {
    return {.asks = "How stiff was it?",
            .asks_of_other = "How much {} was it?",
            .levels = {0.5, 0.7, 0.85, 1.15, 1.3, 1.5},
            .trials_per_cell = 6,
            .analysis = R"({"outcome": "exponent"})"};
  }
  void read(JsonReader& section, TaskSpec& spec) const override {
    spec.modulus = section.optional_number("modulus", {.min = 0.001, .max = 1e6});
    spec.number_min = section.number_or("lowest", 0, {.min = 0, .max = 1e6});
    spec.number_max = section.number_or("highest", 1e6, {.min = 0, .max = 1e9, .above = true});
  }
  bool has_standard() const noexcept override { return false; }
  int intervals(const TaskSpec& spec) const noexcept override { return spec.modulus ? 2 : 1; }
  std::vector<DrawnTrial> arrangements(const CellDraw& cell, double comparison, int) const override {
    return {
        {.stimuli = cell.protocol.task.modulus ? Intervals{cell.series.standard, comparison} : Intervals{comparison}}};
  }
  Answer answer(std::span<const Felt> felt, const Trial& trial, const Protocol& protocol,
                RandomStream&) const override {
    const std::vector<double>& levels = protocol.series[static_cast<std::size_t>(trial.series)].levels;
    const bool modulus = protocol.task.modulus.has_value();
    const double base = modulus ? felt[0].value : 0.5 * (levels.front() + levels.back());
    const double said = modulus ? *protocol.task.modulus : kFreeModulus;
    const double ratio = std::max(felt.back().value / base, 0.01);
    Answer answer;
    answer.said = -1;
    answer.number = std::clamp(rounded_to_two_digits(said * std::pow(ratio, kExponent)),
                               std::max(protocol.task.number_min, 0.001), protocol.task.number_max);
    return answer;
  }
  std::vector<TaskOutcome> outcomes(const Protocol&) const override {
    return {{"exponent", "exponent", "", "of the power law: slope of ln answer on ln stimulus", true},
            {"intercept", "intercept", "", "ln answer at ln stimulus = 0", false},
            {"r2", "r2", "", "share of the variance of ln answer that the line explains", false, false, false, true},
            {"mean_answer", "mean answer", "", "geometric mean of the answers, every stimulus weighing the same", true},
            {"arithmetic_mean", "arithmetic mean", "", "mean of the answers, every stimulus weighing the same", false}};
  }
  // Every stimulus weighs the same, whatever its repeats. A stimulus of 0 has no place on the line of the power law; an answer
  // of 0 has no logarithm, and leaving it out would be a bias.
  TaskEstimates estimate(const Protocol&, const Series&, std::span<const AnsweredTrial> trials) const override {
    struct Cell {
      double sum = 0, sum_of_logarithms = 0;
      int n = 0;
    };
    std::map<double, Cell> cells;
    bool positive = true;
    for (const AnsweredTrial& trial : trials) {
      if (!trial.number) continue;
      Cell& cell = cells[trial.stimuli[trial.stimuli.size() - 1]];
      positive = positive && *trial.number > 0;
      cell.sum += *trial.number;
      cell.sum_of_logarithms += std::log(*trial.number);
      ++cell.n;
    }
    TaskEstimates estimates{"no_trials", std::vector<TaskEstimate>(5)};
    if (cells.empty()) return estimates;
    const auto all = static_cast<double>(cells.size());
    double mean = 0, mean_of_logarithms = 0;
    std::vector<double> ln_stimulus, ln_answer;
    for (const auto& [stimulus, cell] : cells) {
      mean += cell.sum / cell.n / all;
      mean_of_logarithms += cell.sum_of_logarithms / cell.n / all;
      if (!(stimulus > 0)) continue;
      ln_stimulus.push_back(std::log(stimulus));
      ln_answer.push_back(cell.sum_of_logarithms / cell.n);
    }
    estimates.status = "not_positive";
    estimates.values[4] = task_estimate(mean);
    if (!positive) return estimates;
    const PowerLaw law = power_law(ln_stimulus, ln_answer);
    estimates.status = law.status == StatisticStatus::ok ? "ok" : "too_few";
    estimates.values[0] = task_estimate(law.exponent, ChoiceBounds{law.ci_low, law.ci_high});
    estimates.values[1] = task_estimate(law.intercept);
    estimates.values[2] = task_estimate(law.r2);
    estimates.values[3] = task_estimate(std::exp(mean_of_logarithms));
    return estimates;
  }
  std::string methods(const Protocol& protocol) const override {
    return std::string(protocol.task.modulus ? "Numbers were given in relation to a modulus. "
                                             : "Numbers were free: participants chose their own modulus. ") +
           "The exponent of the power law is the least-squares slope of the mean ln answer on ln stimulus, of each "
           "participant and condition, every stimulus weighing the same; its interval is Student's, 95 %. A stimulus of 0, which "
           "has no logarithm, takes no part in it. Status: not_positive, an answer of 0 has no logarithm, so that there is "
           "the arithmetic mean only; too_few, fewer than two stimuli above 0.";
  }
};

}  // namespace

const Task& magnitude_task() noexcept {
  static const MagnitudeTask task;
  return task;
}

}  // namespace jnd
