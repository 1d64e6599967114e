#include "protocols/planning/plan.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/order.h"
#include "protocols/random_stream.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"

namespace jnd {
namespace {

// Draws the stimuli of one participant. Every stream is named after what it is for, so that another condition, series
// or participant never changes it. The names are part of every plan: they never change.
class Draws {
 public:
  Draws(const Protocol& protocol, const Plan& plan)
      : protocol_(protocol),
        task_(task_of(protocol.task.kind)),
        seed_(plan.seed),
        participant_(static_cast<std::uint64_t>(plan.participant)),
        session_(plan.session),
        conditions_(plan.conditions) {}

  // The trials of one condition in one series, in order.
  std::vector<DrawnTrial> cell(int series, int condition) const {
    RandomStream stimuli = stream("stimuli/" + series_name(series) + "/" + condition_name(protocol_, condition));
    return task_.draw({protocol_, series_at(series), protocol_.design.trials_per_cell, protocol_.design.sampling},
                      stimuli);
  }

  // A block of one condition: the cell, its classes rearranged where runs are limited.
  std::vector<DrawnTrial> block_of_condition(int series, int condition) const {
    std::vector<DrawnTrial> trials = cell(series, condition);
    if (!protocol_.design.run_limit) return trials;
    const Classes classes(trials);
    RandomStream classes_of = stream("classes/" + series_name(series) + "/" + condition_name(protocol_, condition));
    std::size_t next_one = 0, next_other = 0;
    std::size_t at = 0;
    for (const bool one : limited(classes.one.size(), classes.other.size(), classes_of))
      trials[at++] = one ? classes.one[next_one++] : classes.other[next_other++];
    return trials;
  }

  // A trial of a block. track: of a procedure, from 1.
  struct Slot {
    DrawnTrial trial;
    int condition = 0, track = 0;
  };

  // All conditions where mixed, else the one given.
  std::vector<Slot> block(int series, std::optional<int> only) const {
    if (const auto& procedure = protocol_.design.procedure) return block_of_tracks(*procedure, series, only);
    if (!only) return mixed_block(series);
    std::vector<Slot> slots;
    for (const DrawnTrial& drawn : block_of_condition(series, *only)) slots.push_back({drawn, *only});
    return slots;
  }

  // One round of practice: as many trials of every class as can be, and where there are two trials two classes.
  std::vector<DrawnTrial> practice(const Practice& practice, int round) const {
    RandomStream draws = stream("practice/" + series_name(practice.series), round);
    const Series series = practice_series(practice, protocol_);
    return task_.draw_practice({protocol_, series, practice.trials}, draws);
  }

 private:
  // A block in which the conditions of a series take turns at random. Each condition keeps its own cell's draws.
  std::vector<Slot> mixed_block(int series) const {
    RandomStream interleave = stream("interleave/" + series_name(series));
    std::vector<Slot> block;
    if (!protocol_.design.run_limit) {
      std::vector<int> turns;
      std::vector<std::vector<DrawnTrial>> cells;
      for (int c = 0; c < static_cast<int>(conditions_.size()); ++c) {
        cells.push_back(cell(series, condition_at(c)));
        turns.insert(turns.end(), cells.back().size(), c);
      }
      interleave.shuffle(turns);
      std::vector<std::size_t> next(cells.size(), 0);
      for (const int c : turns)
        block.push_back({cells[static_cast<std::size_t>(c)][next[static_cast<std::size_t>(c)]++], condition_at(c)});
      return block;
    }
    std::vector<Classes> cells;
    std::vector<int> one_turns, other_turns;
    for (int c = 0; c < static_cast<int>(conditions_.size()); ++c) {
      cells.emplace_back(cell(series, condition_at(c)));
      one_turns.insert(one_turns.end(), cells.back().one.size(), c);
      other_turns.insert(other_turns.end(), cells.back().other.size(), c);
    }
    interleave.shuffle(one_turns);
    interleave.shuffle(other_turns);
    RandomStream classes = stream("classes/" + series_name(series));
    std::vector<std::size_t> next_one(cells.size(), 0), next_other(cells.size(), 0);
    std::size_t one_turn = 0, other_turn = 0;
    for (const bool one : limited(one_turns.size(), other_turns.size(), classes)) {
      const int turn = one ? one_turns[one_turn++] : other_turns[other_turn++];
      const auto c = static_cast<std::size_t>(turn);
      block.push_back({one ? cells[c].one[next_one[c]++] : cells[c].other[next_other[c]++], condition_at(turn)});
    }
    return block;
  }

  // The slots of an adaptive procedure's tracks, in rounds: each has one slot of every track, in any order, so that no
  // track runs ahead and none can be told from its place.
  std::vector<Slot> block_of_tracks(const AdaptiveProcedure& procedure, int series, std::optional<int> only) const {
    // Where there is one series the streams are named without it.
    std::string of_series;
    if (protocol_.series.size() > 1) of_series = fmt::format("{}/", series_name(series));
    std::vector<std::vector<Slot>> tracks;
    for (const int condition : conditions_) {
      if (only && condition != *only) continue;
      for (int track = 1; track <= static_cast<int>(procedure.starts.size()); ++track) {
        RandomStream slots = stream(fmt::format("slots/{}{}", of_series, condition_name(protocol_, condition)), track);
        tracks.emplace_back();
        for (const DrawnTrial& drawn :
             task_.draw_track({protocol_, series_at(series), procedure.trials}, procedure, slots))
          tracks.back().push_back({drawn, condition, track});
      }
    }
    RandomStream turns = stream(only ? fmt::format("tracks/{}{}", of_series, condition_name(protocol_, *only))
                                     : fmt::format("tracks{}", of_series));
    std::vector<std::size_t> round(tracks.size());
    std::vector<Slot> block;
    for (std::size_t i = 0; i < tracks.front().size(); ++i) {
      std::iota(round.begin(), round.end(), 0);
      turns.shuffle(round);
      for (const std::size_t track : round) block.push_back(tracks[track][i]);
    }
    return block;
  }

  // The trials of the task's first class, and the others.
  struct Classes {
    explicit Classes(const std::vector<DrawnTrial>& trials) {
      for (const DrawnTrial& trial : trials) (trial.target == 0 ? one : other).push_back(trial);
    }
    std::vector<DrawnTrial> one, other;
  };

  RandomStream stream(const std::string& purpose, int part = 0) const {
    return RandomStream(seed_, participant_, session_purpose(session_, purpose), static_cast<std::uint64_t>(part));
  }
  std::vector<bool> limited(std::size_t one, std::size_t other, RandomStream& stream) const {
    return draw_limited_sequence(static_cast<int>(one), static_cast<int>(other), *protocol_.design.run_limit, stream);
  }
  int condition_at(int place) const { return conditions_[static_cast<std::size_t>(place)]; }
  const Series& series_at(int series) const { return protocol_.series[static_cast<std::size_t>(series)]; }
  const std::string& series_name(int series) const { return series_at(series).name; }

  const Protocol& protocol_;
  const Task& task_;
  std::uint64_t seed_;
  std::uint64_t participant_;
  int session_;
  std::vector<int> conditions_;  // of the participant, places in the protocol
};

// Numbers the trials as they are added.
void add(Trial trial, const DrawnTrial& drawn, const Protocol& protocol, Plan& plan) {
  trial.index = static_cast<int>(plan.trials.size()) + 1;
  trial.task = protocol.task.kind;
  trial.stimuli = drawn.stimuli;
  trial.unit = protocol.stimulus.unit;
  trial.target = drawn.target;
  trial.standard = protocol.series[static_cast<std::size_t>(trial.series)].standard;
  trial.side = drawn.side;
  trial.standard_place = drawn.standard_place;
  plan.trials.push_back(trial);
}

// Conditions that the participant does not get are not practised.
void add_practice(const Practice& practice, const Draws& draws, const Protocol& protocol, Plan& plan) {
  std::vector<int> conditions = practice.conditions;
  const std::vector<int>& own = plan.conditions;
  std::erase_if(conditions, [&](int one) { return std::find(own.begin(), own.end(), one) == own.end(); });
  for (int round = 1; round <= practice.max_rounds; ++round) {
    std::size_t turn = 0;
    for (const DrawnTrial& drawn : draws.practice(practice, round)) {
      Trial trial;
      trial.practice = true;
      trial.round = round;
      trial.series = practice.series;
      trial.condition = conditions[turn++ % conditions.size()];
      add(trial, drawn, protocol, plan);
    }
  }
}

// Blocks of conditions, in each the objects for equal parts of the duration.
void add_explorations(const std::vector<int>& conditions, const std::vector<std::vector<int>>& objects,
                      const Protocol& protocol, Plan& plan) {
  const double duration_s = protocol.explore->duration_s / static_cast<double>(protocol.explore->objects.size());
  for (std::size_t turn = 0; turn < conditions.size(); ++turn)
    for (const int object : objects[turn])
      plan.explorations.push_back({static_cast<int>(plan.explorations.size()) + 1, static_cast<int>(turn) + 1,
                                   conditions[turn], object, duration_s});
}

}  // namespace

Series practice_series(const Practice& practice, const Protocol& protocol) {
  Series series = protocol.series[static_cast<std::size_t>(practice.series)];
  if (!practice.difference) return series;
  series.pair = {plain_sum(protocol.stimulus.reference, -*practice.difference), protocol.stimulus.reference};
  series.levels.clear();
  for (const int side : sides_of_comparisons(protocol, series))
    series.levels.push_back(plain_sum(series.standard, side * *practice.difference));
  return series;
}

Plan make_plan(const Protocol& protocol, int participant, std::uint64_t seed, int session) {
  if (participant < 1) throw std::invalid_argument("participants are numbered from 1");
  if (session < 1) throw std::invalid_argument("sessions are numbered from 1");
  Plan plan;
  plan.session = session;
  plan.participant = participant;
  plan.seed = seed;
  plan.group = group_of(protocol, participant, seed);
  plan.conditions = conditions_of(protocol, plan.group);
  const OrderAssignment assignment(protocol, seed, session, plan.group);
  const std::vector<int> outer = assignment.outer_order(participant);
  if (!task_of(protocol.task.kind).has_trials()) {
    add_explorations(outer, assignment.inner_orders(participant, outer), protocol, plan);
    return plan;
  }
  const Draws draws(protocol, plan);
  plan.series_order = outer;
  plan.condition_orders = assignment.inner_orders(participant, outer);

  if (protocol.practice) add_practice(*protocol.practice, draws, protocol, plan);
  int block = 0;
  for (std::size_t j = 0; j < plan.series_order.size(); ++j) {
    Trial trial;
    trial.series = plan.series_order[j];
    std::vector<std::optional<int>> turns = {std::nullopt};
    if (protocol.design.arrangement == Arrangement::blocked)
      turns.assign(plan.condition_orders[j].begin(), plan.condition_orders[j].end());
    for (const std::optional<int> turn : turns) {
      trial.block = ++block;
      for (const Draws::Slot& slot : draws.block(trial.series, turn)) {
        trial.condition = slot.condition;
        trial.track = slot.track;
        add(trial, slot.trial, protocol, plan);
      }
    }
  }
  return plan;
}

int main_trial_count(const Plan& plan) noexcept {
  return static_cast<int>(
      std::count_if(plan.trials.begin(), plan.trials.end(), [](const Trial& trial) { return !trial.practice; }));
}

}  // namespace jnd
