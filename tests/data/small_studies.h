// Small simulated studies of every task, with every procedure that sets its levels: two conditions, three participants.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "data/results/study_results.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/allotment.h"
#include "protocols/random_stream.h"
#include "tests/data/exploration_fixture.h"

namespace jnd {

struct SmallStudy {
  std::string name;  // "which, quest"
  Protocol protocol;
  StudyResults results;
};

// Of a file, in two conditions and at two standards at most.
inline Protocol small_protocol(const std::string& file) {
  Protocol protocol = load_protocol(std::string(JND_SOURCE_DIR) + "/" + file + ".json");
  if (protocol.conditions.size() < 2) {
    protocol.conditions.push_back(protocol.conditions.front());
    protocol.conditions.back().name = "other";
  }
  protocol.conditions.resize(2);
  protocol.series.resize(std::min<std::size_t>(protocol.series.size(), 2));
  protocol.practice.reset();
  protocol.questions.clear();
  protocol.design.participants = 3;
  protocol.design.condition_order = Order::fixed;
  protocol.design.trials_per_cell = std::min(protocol.design.trials_per_cell, 12);
  protocol.analysis.contrasts = {{0, 1}};
  return protocol;
}

// Levels up to `most`, with a grid and a prior of their own: a standard of 0 has no default.
inline void set_posterior(PosteriorConfiguration& posterior, PosteriorTask task, double most) {
  posterior.levels = {most / 10, most / 4, most / 2, most};
  for (int i = 0; i <= 30; ++i) posterior.ln_s.push_back(std::log(most / 30) + 0.15 * i);
  const double unit = task == PosteriorTask::which ? most / 4 : 1;  // of a PSE, or of a criterion
  for (int i = -4; i <= 8; ++i) posterior.shift.push_back(0.25 * i * unit);
  posterior.ln_s_prior = {std::log(most / 3), 1};
  posterior.shift_prior = {0.5 * unit, unit};
}

inline void set_procedure(Protocol& protocol, AdaptiveProcedure::Kind kind) {
  const Task& task = task_of(protocol.task.kind);
  const bool pairs = task.has_pairs();
  const double standard = pairs ? protocol.stimulus.reference : protocol.series.front().standard;
  const double most = standard > 0 ? 0.8 * standard : protocol.series.front().levels.back();
  AdaptiveProcedure& procedure = protocol.design.procedure.emplace();
  procedure.kind = kind;
  procedure.starts = {most / 2};
  procedure.clamp = {most / 100, most};
  procedure.staircase = {.up = 1, .down = 2, .step_up = 1.4, .step_down = 1.4, .multiplicative = true};
  procedure.quest.t_guess_sd = 0.5;
  procedure.quest.p_threshold = 0.75;
  procedure.quest.beta = 2;
  procedure.quest.gamma = 0.1;
  if (kind == AdaptiveProcedure::Kind::posterior) set_posterior(procedure.posterior, *task.posterior_task(), most);
  procedure.trials = 32;
  procedure.averaged_reversals = 4;
  procedure.catch_share = task.has_catch_trials() ? 0.5 : 0;
  procedure.sides = {pairs ? -1 : 1};
  if (kind == AdaptiveProcedure::Kind::posterior && task.posterior_task() == PosteriorTask::which)
    procedure.sides = {-1, 1};
  if (pairs) protocol.series = {{"adaptive", {}, standard}};
  for (Series& series : protocol.series) {
    series.pair = {series.standard - most, pairs ? series.standard : series.standard + most};
    series.levels.clear();
  }
  protocol.design.trials_per_cell = trials_of_cell(protocol, Series());
}

// Somebody who feels with a noise of a fifth of what is there, or of the range of the levels.
inline void run_simulated(Study& study, const Protocol& protocol, int number) {
  constexpr int kMostLooks = 200;
  const Task& task = task_of(protocol.task.kind);
  double largest = protocol.stimulus.reference;
  for (const Series& series : protocol.series) largest = std::max({largest, series.pair[0], series.pair[1]});
  NewSession session = new_session(number);
  const Plan plan = make_plan(protocol, number, kSeed);
  session.group = group_name(protocol, plan.group);
  const auto log = study.open_session(session);
  RandomStream random(kSeed, static_cast<std::uint64_t>(number), "small study");
  AdaptiveRun run(protocol);
  for (const Trial& planned : plan.trials) {
    if (planned.practice || run.over(planned)) continue;
    const Trial trial = run.resolved(planned);
    const double sigma = 0.15 * (trial.standard > 0 ? trial.standard : largest);
    Intervals now = trial.stimuli;
    Answer answer;
    for (int look = 0; look < kMostLooks; ++look) {
      std::vector<Felt> felt;
      for (const double stimulus : now) felt.push_back({stimulus + sigma * random.normal(), sigma});
      answer = task.answer(felt, trial, protocol, random);
      const std::optional<Intervals> moved = task.moved(now, answer, trial, protocol);
      if (!moved) break;
      now = *moved;
    }
    answer = task.settled(answer, now);
    run.answered(trial, answer);
    TrialRecord record = record_of(protocol, trial, answer.said);
    record.presentations.resize(trial.stimuli.size());
    record.answer.sureness = answer.sureness;
    record.answer.number = answer.number;
    if (answer.number) record.answer_word.clear();
    log->append(event_kind::kTrialCompleted, to_body(record), stamp_of(trial));
  }
  study.close_session(session.id, {1'700'000'900'000'000'000, 900});
}

inline SmallStudy small_study(const std::string& name, const Protocol& protocol, int participants = 3) {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd", protocol);
  for (int number = 1; number <= participants; ++number) {
    if (protocol.explore)
      run_exploration(*study, number, 5 + number, number, "bare hands");
    else
      run_simulated(*study, protocol, number);
  }
  return {name, protocol, results_of(*study, protocol, SessionKind::simulated, {.hierarchical = true})};
}

inline const std::vector<SmallStudy>& small_studies() {
  static const std::vector<SmallStudy> all = [] {
    std::vector<SmallStudy> studies;
    for (const char* file : {"protocols/chinello2017", "protocols/studies/maereg2017",
                             "protocols/studies/lee2007-delay", "protocols/studies/identify-stiffness2025",
                             "protocols/studies/carpenter2018-oddity", "protocols/abx-stiffness",
                             "protocols/studies/varadharajan2008-magnitude", "protocols/studies/jones-hunter1990"}) {
      const Protocol protocol = small_protocol(file);
      const Task& task = task_of(protocol.task.kind);
      const std::string name(to_string(protocol.task.kind));
      studies.push_back(small_study(name, protocol));
      using Kind = AdaptiveProcedure::Kind;
      for (const Kind kind : {Kind::staircase, Kind::quest, Kind::posterior}) {
        if (!task.has_procedures() || (kind == Kind::posterior && !task.posterior_task())) continue;
        Protocol adaptive = protocol;
        set_procedure(adaptive, kind);
        studies.push_back(small_study(name + ", " + std::string(to_string(kind)), adaptive));
      }
    }
    Protocol grouped = small_protocol("tests/protocols/corpus/good/task-same-different");
    grouped.groups = {{"young", "under 30", {0, 1}}, {"old", "over 60", {0, 1}}};
    grouped.analysis.tests.between = BetweenTest::mixed_anova;
    studies.push_back(small_study("same-different, sureness and groups", grouped, 6));
    studies.push_back(small_study("explore", experiment2()));
    return studies;
  }();
  return all;
}

}  // namespace jnd
