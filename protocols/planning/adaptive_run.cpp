#include "protocols/planning/adaptive_run.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "analysis/numerics/words.h"
#include "protocols/tasks/posterior_model.h"
#include "protocols/tasks/task.h"

namespace jnd {

namespace {

constexpr auto kProcedureWords = words<AdaptiveProcedure::Kind>({{"staircase", AdaptiveProcedure::Kind::staircase},
                                                                 {"quest", AdaptiveProcedure::Kind::quest},
                                                                 {"posterior", AdaptiveProcedure::Kind::posterior}});

}  // namespace

struct AdaptiveRun::State {
  // The Bayesian procedure of a track, with what its levels are away from the standard.
  struct Posterior {
    PosteriorProcedure procedure;
    std::vector<double> distances;  // PosteriorModel::distances
  };
  // Of every series before any answer: the tables are computed once, and copied.
  static std::vector<Posterior> posteriors(const Protocol& protocol) {
    std::vector<Posterior> all;
    if (protocol.design.procedure->kind != AdaptiveProcedure::Kind::posterior) return all;
    for (const Series& series : protocol.series) {
      PosteriorModel model = posterior_model(protocol, series);
      all.push_back({PosteriorProcedure(model.configuration), std::move(model.distances)});
    }
    return all;
  }

  AdaptiveTrack track;
  std::optional<Staircase> staircase;
  std::optional<Quest> quest;
  std::optional<Posterior> posterior;
  bool which = false;                       // the posterior's levels lie on sides of a standard
  std::array<std::size_t, 2> next_place{};  // of the posterior's next level below and above the standard
  bool over = false;

  std::size_t place_on(int side) const { return next_place[side > 0 ? 1 : 0]; }
  double level_on(int side) const { return posterior ? posterior->distances[place_on(side)] : track.level; }

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

  // The posterior learns from trials without a difference too, which lie at its first level.
  void answer_posterior(const AdaptiveProcedure& procedure, int side, bool equal, bool correct) {
    if (!equal) {
      track.levels.push_back(level_on(side));
      track.correct.push_back(correct);
    }
    const bool positive = which ? correct == (side > 0) : correct != equal;
    posterior->procedure.update(equal ? 0 : place_on(side), positive);
    note_posterior(equal);
    choose(procedure);
    over = procedure.precision && *track.sd_ln_s <= *procedure.precision;
    track.finished = over || static_cast<int>(track.levels.size()) >= procedure.trials;
  }

  void note_posterior(bool equal) {
    constexpr double kLow = 0.025, kHigh = 0.975;
    const PosteriorProcedure& run = posterior->procedure;
    const TrackPosterior now{std::exp(run.estimate().mean_ln_s), std::exp(run.ln_s_quantile(kLow)),
                             std::exp(run.ln_s_quantile(kHigh))};
    if (!equal)
      track.course.push_back(now);
    else if (!track.course.empty())
      track.course.back() = now;
  }

  void choose(const AdaptiveProcedure& procedure) {
    PosteriorProcedure& run = posterior->procedure;
    track.sd_ln_s = run.estimate().sd_ln_s;
    if (!which) {
      next_place.fill(run.choose(PosteriorSlot::different).level);
    } else {
      for (const int side : procedure.sides)
        next_place[side > 0 ? 1 : 0] = run.choose(side > 0 ? PosteriorSlot::above : PosteriorSlot::below).level;
    }
    track.level = level_on(procedure.sides.front());
  }
};

namespace {

// Whether the comparison was said to have more of the quantity, of two intervals.
bool says_more(const Trial& trial, const Answer& answer, const TaskSpec& task) noexcept {
  return (answer.said != trial.standard_place) == task.greater;
}

}  // namespace

AdaptiveRun::AdaptiveRun(const Protocol& protocol) : procedure_(protocol.design.procedure), task_(protocol.task) {
  if (!procedure_) return;
  const std::vector<State::Posterior> posteriors = State::posteriors(protocol);
  const auto all_series = static_cast<int>(protocol.series.size());
  for (int place = 0; place < static_cast<int>(protocol.conditions.size()) * all_series; ++place) {
    const int condition = place / all_series, series = place % all_series;
    for (int track = 1; track <= static_cast<int>(procedure_->starts.size()); ++track) {
      auto state = std::make_unique<State>();
      state->track.condition = condition;
      state->track.series = series;
      state->track.track = track;
      switch (procedure_->kind) {
        case AdaptiveProcedure::Kind::staircase:
          state->staircase.emplace(staircase_of_track(*procedure_, track));
          state->track.level = state->staircase->level();
          break;
        case AdaptiveProcedure::Kind::quest:
          state->quest.emplace(quest_of_track(*procedure_, track));
          state->place(*procedure_);
          break;
        case AdaptiveProcedure::Kind::posterior:
          state->posterior = posteriors[static_cast<std::size_t>(series)];
          state->which = task_of(protocol.task.kind).posterior_task() == PosteriorTask::which;
          state->choose(*procedure_);
          break;
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
  const double level = state_of(planned).level_on(planned.side);
  const double comparison =
      planned.side == 0 ? plain_decimal(level) : plain_sum(planned.standard, planned.side * level);
  for (double& stimulus : planned.stimuli)
    if (stimulus == set_by_answers(planned.standard)) stimulus = comparison;
  // Only now it is known on which side of the standard it lies.
  if (planned.side == 0) planned.target = task_of(planned.task).target_of(planned.stimuli, planned.standard, task_);
  return planned;
}

bool AdaptiveRun::over(const Trial& planned) const {
  return planned.track != 0 && state_of(planned).over;
}

void AdaptiveRun::answered(const Trial& trial, const Answer& answer) {
  if (trial.track == 0) return;
  State& state = *states_.at({trial.condition, trial.series, trial.track});
  const bool correct = is_correct(trial, answer).value_or(false);
  const bool equal = is_catch(trial);
  if (equal) {
    ++state.track.catch_trials;
    state.track.false_alarms += correct ? 0 : 1;
  }
  if (state.posterior)
    state.answer_posterior(*procedure_, trial.side, equal, correct);
  else if (trial.side == 0)
    state.answer(*procedure_, says_more(trial, answer, task_));
  else if (!equal)
    state.answer(*procedure_, correct);
}

std::vector<AdaptiveTrack> AdaptiveRun::tracks() const {
  std::vector<AdaptiveTrack> all;
  for (const auto& [key, state] : states_) all.push_back(state->track);
  return all;
}

bool can_end_early(const AdaptiveProcedure& procedure) noexcept {
  return procedure.reversals > 0 || procedure.precision.has_value();
}

bool can_end_early(const Protocol& protocol) noexcept {
  const auto& procedure = protocol.design.procedure;
  return procedure && can_end_early(*procedure);
}

std::string early_end_of(const AdaptiveProcedure& procedure) {
  if (procedure.precision)
    return fmt::format("a posterior standard deviation of ln JND of at most {:g}", *procedure.precision);
  if (procedure.reversals > 0)
    return fmt::format("{} reversal{}", procedure.reversals, procedure.reversals == 1 ? "" : "s");
  return {};
}

std::string early_end_note(const Protocol& protocol) {
  if (!can_end_early(protocol)) return {};
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  const bool reversals = procedure.reversals > 0;
  return fmt::format("A track that has {}{} leaves the trials that are planned for it after {}.\n",
                     reversals ? "its " : "", early_end_of(procedure), reversals ? "them" : "that");
}

std::string_view to_string(AdaptiveProcedure::Kind kind) noexcept {
  return word_of(kProcedureWords, kind);
}

std::span<const std::pair<std::string_view, AdaptiveProcedure::Kind>> procedure_words() noexcept {
  return kProcedureWords;
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
