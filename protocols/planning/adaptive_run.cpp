#include "protocols/planning/adaptive_run.h"

#include <algorithm>
#include <cmath>

#include "protocols/tasks/task.h"

namespace jnd {

struct AdaptiveRun::State {
  AdaptiveTrack track;
  std::optional<Staircase> staircase;
  std::optional<Quest> quest;
  bool over = false;

  void answer(const AdaptiveProcedure& procedure, bool correct) {
    track.levels.push_back(track.level);
    track.correct.push_back(correct);
    if (staircase) {
      staircase->answer(correct);
      track.level = staircase->level();
      track.reversals = staircase->reversals();
    } else {
      quest->answer(std::log10(track.level), correct);
      place(procedure);
    }
    over = procedure.reversals > 0 && static_cast<int>(track.reversals.size()) >= procedure.reversals;
    track.finished = over || static_cast<int>(track.levels.size()) >= procedure.trials;
  }

  // The mean of the posterior is presented: King-Smith et al. (1994), Vision Research 34, 885-912.
  void place(const AdaptiveProcedure& procedure) {
    track.quest = quest->estimate();
    track.level = quest_level(track.quest->mean, procedure.clamp);
  }
};

AdaptiveRun::AdaptiveRun(const Protocol& protocol) : procedure_(protocol.design.procedure) {
  if (!procedure_) return;
  const auto all_series = static_cast<int>(protocol.series.size());
  for (int place = 0; place < static_cast<int>(protocol.conditions.size()) * all_series; ++place) {
    const int condition = place / all_series, series = place % all_series;
    for (int track = 1; track <= static_cast<int>(procedure_->starts.size()); ++track) {
      auto state = std::make_unique<State>();
      state->track.condition = condition;
      state->track.series = series;
      state->track.track = track;
      if (procedure_->kind == AdaptiveProcedure::Kind::staircase) {
        state->staircase.emplace(staircase_of_track(*procedure_, track));
        state->track.level = state->staircase->level();
      } else {
        state->quest.emplace(quest_of_track(*procedure_, track));
        state->place(*procedure_);
      }
      states_.emplace(std::array{condition, series, track}, std::move(state));
    }
  }
}

AdaptiveRun::AdaptiveRun(AdaptiveRun&&) noexcept = default;
AdaptiveRun& AdaptiveRun::operator=(AdaptiveRun&&) noexcept = default;
AdaptiveRun::~AdaptiveRun() = default;

const AdaptiveRun::State& AdaptiveRun::state_of(const Trial& trial) const {
  return *states_.at({trial.condition, trial.series, trial.track});
}

Trial AdaptiveRun::resolved(Trial planned) const {
  if (planned.track == 0) return planned;
  const double comparison = planned.standard + planned.side * state_of(planned).track.level;
  for (double& stimulus : planned.stimuli)
    if (stimulus == set_by_answers(planned.standard)) stimulus = comparison;
  return planned;
}

bool AdaptiveRun::over(const Trial& planned) const {
  return planned.track != 0 && state_of(planned).over;
}

void AdaptiveRun::answered(const Trial& trial, const Answer& answer) {
  if (trial.track == 0) return;
  State& state = *states_.at({trial.condition, trial.series, trial.track});
  const bool correct = is_correct(trial, answer).value_or(false);
  if (is_catch(trial)) {
    ++state.track.catch_trials;
    state.track.false_alarms += correct ? 0 : 1;
  } else {
    state.answer(*procedure_, correct);
  }
}

std::vector<AdaptiveTrack> AdaptiveRun::tracks() const {
  std::vector<AdaptiveTrack> all;
  for (const auto& [key, state] : states_) all.push_back(state->track);
  return all;
}

StaircaseRule staircase_of_track(const AdaptiveProcedure& procedure, int track) {
  StaircaseRule rule = procedure.staircase;
  rule.start = procedure.starts.at(static_cast<std::size_t>(track - 1));
  rule.clamp = procedure.clamp;
  return rule;
}

QuestParameters quest_of_track(const AdaptiveProcedure& procedure, int track) {
  QuestParameters parameters = procedure.quest;
  parameters.t_guess = std::log10(procedure.starts.at(static_cast<std::size_t>(track - 1)));
  return parameters;
}

double quest_level(double log10_level, const std::array<double, 2>& clamp) {
  return std::clamp(std::round(1000 * std::pow(10, log10_level)) / 1000, clamp[0], clamp[1]);
}

}  // namespace jnd
