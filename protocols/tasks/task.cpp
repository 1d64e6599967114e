#include "protocols/tasks/task.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "protocols/tasks/arrangements.h"

namespace jnd {

// Each in its own file.
const Task& same_different_task() noexcept;
const Task& which_task() noexcept;
const Task& yes_no_task() noexcept;
const Task& identify_task() noexcept;
const Task& oddity_task() noexcept;
const Task& abx_task() noexcept;
const Task& magnitude_task() noexcept;
const Task& adjust_task() noexcept;

namespace {

// Free interaction: objects are handled for a set time in each condition, then a questionnaire asks.
class ExploreTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::explore; }
  std::string_view summary() const noexcept override { return "free interaction, then a questionnaire"; }
  bool has_trials() const noexcept override { return false; }
  std::string_view values_path() const noexcept override { return "$.stimulus.reference"; }
  void read(JsonReader&, TaskSpec&) const override {}
  int intervals(const TaskSpec&) const noexcept override { return 0; }
  std::vector<TaskOutcome> outcomes(const Protocol&) const override { return {}; }
  TaskEstimates estimate(const Protocol&, const Series&, std::span<const AnsweredTrial>) const override {
    return {"no_trials", {}};
  }
};

}  // namespace

std::string Task::without_model(const Protocol&) const {
  return fmt::format("the task \"{}\"", to_string(kind()));
}

std::vector<DrawnTrial> Task::draw(const CellDraw& cell, RandomStream& stream) const {
  std::vector<DrawnTrial> trials;
  const double standard = cell.series.standard;
  for (const double level : cell.series.levels)
    add_level(trials,
              arrangements(cell, level,
                           level < standard   ? -1
                           : level > standard ? 1
                                              : 0),
              cell.trials, cell.sampling, stream);
  stream.shuffle(trials);
  return trials;
}

std::vector<DrawnTrial> Task::draw_track(const CellDraw& track, const AdaptiveProcedure& procedure,
                                         RandomStream& stream) const {
  std::vector<DrawnTrial> block;
  for (const int side : procedure.sides)
    for (DrawnTrial& slot : arrangements(track, set_by_answers(track.series.standard), side)) {
      slot.side = side;
      block.push_back(slot);
    }
  if (block.empty()) throw std::logic_error("a task without procedures has no tracks");
  return track_of(block, track.trials, stream);
}

std::vector<DrawnTrial> Task::draw_practice(const CellDraw& round, RandomStream& stream) const {
  const int levels = std::max(cells_in(round.series), 1);
  std::vector<DrawnTrial> trials =
      draw({round.protocol, round.series, (round.trials + levels - 1) / levels, Sampling::balanced}, stream);
  trials.resize(std::min(trials.size(), static_cast<std::size_t>(round.trials)));
  return trials;
}

int Task::trials_of_levels(const Protocol& protocol, const Series& series) const {
  return protocol.design.trials_per_cell * cells_in(series);
}

std::string Task::cells_text(const Protocol& protocol) const {
  const int each = protocol.design.trials_per_cell, cells = cells_in(protocol.series.front());
  std::string text;
  if (has_standard()) text += counted_words(protocol.series.size(), "standard") + " x ";
  bool alike = true;
  int of_cells = 0, all = 0;
  for (const Series& series : protocol.series) {
    alike = alike && cells_in(series) == cells;
    of_cells += cells_in(series) * each;
    all += trials_of_levels(protocol, series);
  }
  if (!alike)
    text += "their levels x ";
  else if (cells > 1)
    text += fmt::format("{} {} x ", cells, protocol.task.class_values.empty() ? "levels" : "classes");
  text += fmt::format("{} trials per cell", each);
  return all > of_cells ? text + fmt::format(" and {} without a signal per condition", all - of_cells) : text;
}

Answer Task::unbiased_answer(const Intervals& presented, const Trial& trial, const Protocol& protocol, double noise,
                             RandomStream& stream) const {
  const double sigma = noise / std::sqrt(2.0);
  std::vector<Felt> felt;
  for (const double stimulus : presented) felt.push_back({stimulus + sigma * stream.normal(), sigma});
  return answer(felt, trial, protocol, stream);
}

std::string Task::unbiased_words(const Protocol&) const {
  return "what is felt is the value plus normal noise, and the answer follows from what is felt, without bias";
}

std::string Task::target_word(const Trial& trial, const TaskSpec& spec) const {
  return std::string(said_word(spec, trial.target));
}

std::span<const Task* const> all_tasks() noexcept {
  static const ExploreTask explore;
  static const std::array<const Task*, 9> all = {&same_different_task(), &which_task(),  &yes_no_task(),
                                                 &identify_task(),       &oddity_task(), &abx_task(),
                                                 &magnitude_task(),      &adjust_task(), &explore};
  return all;
}

const Task& task_of(TaskKind kind) {
  for (const Task* task : all_tasks())
    if (task->kind() == kind) return *task;
  throw std::invalid_argument("there is no such task");
}

bool holds_standard(const Trial& trial, const Intervals& stimuli, std::size_t interval) noexcept {
  if (trial.standard_place >= 0) return interval == static_cast<std::size_t>(trial.standard_place);
  return std::find(stimuli.begin(), stimuli.end(), trial.standard) == stimuli.begin() + interval;
}

int felt_intervals(const TaskSpec& spec) {
  return spec.together ? 1 : task_of(spec.kind).intervals(spec);
}

std::string_view said_word(const TaskSpec& spec, int said) noexcept {
  const bool known = said >= 0 && static_cast<std::size_t>(said) < spec.classes.size();
  return known ? std::string_view(spec.classes[static_cast<std::size_t>(said)]) : std::string_view();
}

bool is_sure(int sureness, const TaskSpec& spec) noexcept {
  return spec.sureness_levels > 1 && 2 * sureness > spec.sureness_levels + 1;
}

std::vector<LevelCount> level_counts(std::span<const AnsweredTrial> trials, const Protocol& protocol) {
  const Task& task = task_of(protocol.task.kind);
  if (!task.answer_model(protocol)) return {};
  std::map<std::pair<double, bool>, LevelCount> by_level;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const auto [level, positive] = task.level_answer(trials[i], protocol.task);
    const bool second_half = in_second_half(i, trials.size());
    LevelCount& one = by_level[{level, second_half}];
    one.level = level;
    one.second_half = second_half;
    ++(positive ? one.positive : one.negative);
    if (is_sure(trials[i].sureness, protocol.task)) ++(positive ? one.sure_positive : one.sure_negative);
  }
  std::vector<LevelCount> counts;
  for (const auto& [where, one] : by_level) counts.push_back(one);
  return counts;
}

std::optional<bool> is_correct(const Trial& trial, const Answer& answer) noexcept {
  return trial.target < 0 ? std::nullopt : std::optional(answer.said == trial.target);
}

std::size_t judged_standard_count(const Protocol& protocol) {
  return task_of(protocol.task.kind).has_pairs() ? 1 : protocol.series.size();
}

std::vector<JudgedStandard> judged_standards(const Protocol& protocol) {
  if (task_of(protocol.task.kind).has_pairs()) return {{"all", protocol.stimulus.reference}};
  std::vector<JudgedStandard> standards;
  for (const Series& series : protocol.series) standards.push_back({series.name, series.standard});
  return standards;
}

int trials_of_cell(const Protocol& protocol, const Series& series) {
  if (const auto& procedure = protocol.design.procedure) return trials_with_catches(*procedure);
  return task_of(protocol.task.kind).trials_of_levels(protocol, series);
}

int trials_of_cell(const Protocol& protocol, int series) {
  return trials_of_cell(protocol, protocol.series[static_cast<std::size_t>(series)]);
}

bool is_catch(const Trial& trial) {
  return trial.target == 0 && task_of(trial.task).has_catch_trials();
}

std::string counted_words(std::size_t count, std::string_view word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

int sureness_of(double distance, double sigma, const TaskSpec& spec) noexcept {
  if (spec.sureness_levels == 0) return 0;
  const double steps = sigma > 0 ? distance / sigma : spec.sureness_levels;
  return 1 + static_cast<int>(std::min<double>(spec.sureness_levels - 1, std::floor(steps)));
}

}  // namespace jnd
