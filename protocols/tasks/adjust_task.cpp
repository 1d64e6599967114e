// "Make the second like the first", the method of adjustment: a standard, and beside it a value that keys move through
// the levels of the series, one at a time and to and fro, until the participant accepts it. The standard is presented
// again with every new value. No correct answer: what is accepted is the answer, a number.
//
// Half of the trials start below the standard, half above it. What is measured: the mean setting (PSE), the settings'
// scatter (JND = 0.6745 SD) and the effect of the starting side (analysis/scaling/adjustment.h).
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/scaling/adjustment.h"
#include "protocols/input/json_reader.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/task.h"
#include "protocols/tasks/task_estimates.h"

namespace jnd {
namespace {

constexpr int kLess = 0, kMore = 1, kAccept = 2;
constexpr std::size_t kStandard = 0, kAdjusted = 1;

std::vector<double> ascending(std::vector<double> levels) {
  std::sort(levels.begin(), levels.end());
  return levels;
}

// Where trials may start on a side (-1: below the standard): settings at least `start` of the way from the standard to
// the last one on that side. Ascending; empty where no setting lies there.
std::vector<double> starts_on(int side, const Series& series, double start) {
  const std::vector<double> levels = ascending(series.levels);
  if (levels.empty()) return {};
  const double end = side < 0 ? levels.front() : levels.back();
  const double furthest = side * (end - series.standard);
  std::vector<double> starts;
  for (const double level : levels) {
    const double away = side * (level - series.standard);
    if (away > 0 && away >= start * furthest) starts.push_back(level);
  }
  return starts;
}

class AdjustTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::adjust; }
  std::string_view summary() const noexcept override { return "a value is adjusted until it feels like the standard"; }
  TaskStart start() const override {
    return {.asks = "Less, more, or alike?",
            .keys = R"({"less": "1", "more": "2", "accept": "0"})",
            .levels = {0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.5},
            .trials_per_cell = 10,
            .analysis = R"({"outcome": "jnd"})"};
  }
  void read(JsonReader& section, TaskSpec& spec) const override {
    spec.together = section.one_of_or<bool>("presentation", {{"sequential", false}, {"side-by-side", true}}, false);
    spec.start = section.number_or("start", 0.5, {.min = 0, .max = 1});
    spec.classes = {"less", "more", "accept"};
  }
  std::vector<TaskProblem> problems(const Protocol& protocol) const override {
    std::vector<TaskProblem> problems = problems_of_places(protocol);
    for (const Series& series : protocol.series) {
      if (series.levels.empty()) continue;  // told already
      if (!starts_on(-1, series, 0).empty() && !starts_on(1, series, 0).empty()) continue;
      problems.push_back({"$.levels",
                          fmt::format("the settings lie on one side of the standard, {:g}", series.standard),
                          "half of the trials start below it, half above: give settings on both sides"});
    }
    return problems;
  }
  bool level_may_be_standard() const noexcept override { return true; }
  int balance_of(const TaskSpec&) const noexcept override { return 2; }
  int cells_in(const Series&) const noexcept override { return 1; }
  int intervals(const TaskSpec&) const noexcept override { return 2; }
  std::vector<DrawnTrial> draw(const CellDraw& cell, RandomStream& stream) const override {
    std::vector<DrawnTrial> trials;
    for (int i = 0; i < cell.trials; ++i) {
      const int side = cell.sampling == Sampling::random ? (stream.coin() ? 1 : -1) : i % 2 == 0 ? -1 : 1;
      const std::vector<double> starts = starts_on(side, cell.series, cell.protocol.task.start);
      const double start = starts[static_cast<std::size_t>(stream.below(starts.size()))];
      trials.push_back({{cell.series.standard, start}, -1, side});
    }
    stream.shuffle(trials);
    return trials;
  }
  std::string target_word(const Trial& trial, const TaskSpec&) const override {
    return trial.side < 0 ? "from below" : "from above";
  }
  bool adjusts() const noexcept override { return true; }
  std::optional<Intervals> moved(const Intervals& now, const Answer& answer, const Trial& trial,
                                 const Protocol& protocol) const override {
    if (answer.said == kAccept) return std::nullopt;
    const std::vector<double> levels = ascending(protocol.series[static_cast<std::size_t>(trial.series)].levels);
    const double setting = now[kAdjusted];
    Intervals next = now;
    if (answer.said == kMore) {
      const auto above = std::upper_bound(levels.begin(), levels.end(), setting);
      if (above != levels.end()) next[kAdjusted] = *above;
    } else {
      const auto here = std::lower_bound(levels.begin(), levels.end(), setting);
      if (here != levels.begin()) next[kAdjusted] = *std::prev(here);
    }
    return next;  // at an end it stays where it is
  }
  double expected_looks(const Protocol& protocol) const override {
    double looks = 0;
    int starts = 0;
    for (const Series& series : protocol.series) {
      for (const int side : {-1, 1}) {
        for (const double start : starts_on(side, series, protocol.task.start)) {
          ++starts;
          ++looks;  // at the start itself
          for (const double level : series.levels)
            looks += side * (level - series.standard) >= 0 && side * (start - level) > 0 ? 1 : 0;
        }
      }
    }
    return starts == 0 ? 1 : looks / starts;
  }
  Answer settled(Answer answer, const Intervals& presented) const noexcept override {
    answer.said = -1;
    answer.number = presented[kAdjusted];
    return answer;
  }
  // Who feels no difference beyond half of what blurs it accepts.
  Answer answer(std::span<const Felt> felt, const Trial&, const Protocol&, RandomStream&) const override {
    const double difference = felt[kAdjusted].value - felt[kStandard].value;
    Answer answer;
    if (std::abs(difference) <= 0.5 * felt[kStandard].sigma)
      answer.said = kAccept;
    else
      answer.said = difference < 0 ? kMore : kLess;
    return answer;
  }
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override {
    const std::string unit(to_string(protocol.stimulus.unit));
    return {
        {"jnd", "JND", unit, "0.6745 SD of the settings: half of them lie nearer to their mean", true},
        {"weber", "Weber fraction", "", "jnd / standard", true, true},
        {"pse", "PSE", unit, "mean setting", false},
        {"bias", "constant error", unit, "PSE less the standard", false},
        {"start_effect", "start effect", unit, "mean of the settings from above less that from below", false},
        {"variable_error", "variable error", unit, "SD of the settings about the mean of their starting side", true}};
  }
  TaskEstimates estimate(const Protocol& protocol, const Series& series,
                         std::span<const AnsweredTrial> trials) const override {
    std::vector<Setting> settings;
    for (const AnsweredTrial& trial : trials)
      if (trial.number)
        settings.push_back(
            {*trial.number, trial.stimuli[kAdjusted] < trial.standard ? StartSide::below : StartSide::above});
    if (settings.empty()) return {"no_trials", std::vector<TaskEstimate>(outcomes(protocol).size())};
    const double standard = series.standard;
    const Adjustment found = adjustment(settings, standard);
    const MeanInterval& mean = found.settings;
    const bool spread = settings.size() >= 2;
    const auto about = [&](double offset) {
      return std::isnan(mean.ci_low) ? std::nullopt
                                     : std::optional(ChoiceBounds{mean.ci_low - offset, mean.ci_high - offset});
    };
    TaskEstimates estimates;
    estimates.status = spread ? "ok" : "too_few";
    const auto scatter = [&](double unit) {
      return std::isnan(found.jnd_low) ? std::nullopt
                                       : std::optional(ChoiceBounds{found.jnd_low / unit, found.jnd_high / unit});
    };
    estimates.values = {
        task_estimate(defined(found.jnd), scatter(1)),
        standard != 0 ? task_estimate(defined(found.jnd / standard), scatter(std::abs(standard))) : TaskEstimate{},
        task_estimate(defined(mean.mean), about(0)),
        task_estimate(defined(mean.mean - standard), about(standard)),
        task_estimate(defined(found.start_effect)),
        task_estimate(defined(found.variable_error))};
    return estimates;
  }
  std::string arrangement(const Protocol& protocol) const override {
    return fmt::format("What was adjusted started below and above the standard {}. ", how_often(protocol));
  }
  std::string methods(const Protocol&) const override {
    return "The PSE is the mean of the settings that a participant accepted in a condition, with Student's 95 % interval, "
           "and the constant error its distance from the standard. The JND is 0.6745 times their standard deviation, the "
           "half-width that holds half of the settings of a normal distribution (Gescheider 1997); its 95 % interval is that of "
           "the standard deviation by the chi-square distribution. The Weber fraction is JND / standard. The start effect is the difference between the means of the settings that started above and "
           "below the standard; the variable error is the standard deviation within these. Status: too_few, fewer than "
           "two settings.";
  }
};

}  // namespace

const Task& adjust_task() noexcept {
  static const AdjustTask task;
  return task;
}

}  // namespace jnd
