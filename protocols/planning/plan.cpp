#include "protocols/planning/plan.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>

#include "protocols/planning/catch_trials.h"
#include "protocols/planning/exploration_assignment.h"
#include "protocols/planning/order.h"
#include "protocols/planning/random_stream.h"
#include "protocols/planning/run_limit.h"

namespace jnd {
namespace {

using Pair = std::array<double, 2>;  // the stiffnesses of the two intervals, in presented order

// Draws the stimuli of one participant. Every stream is named after what it is for, so that another condition, series
// or participant never changes it. The names are part of every plan: they never change.
class Draws {
 public:
  Draws(const Protocol& protocol, std::uint64_t seed, int participant, int session)
      : protocol_(protocol), seed_(seed), participant_(static_cast<std::uint64_t>(participant)), session_(session) {}

  // The trials of one condition in one series, in order.
  std::vector<Pair> cell(int series, int condition) const {
    const std::string name = series_name(series) + "/" + condition_name(condition);
    RandomStream stimuli = stream("stimuli/" + name);
    const Pair& pair = pair_of(series);
    const int trials = protocol_.design.trials_per_cell;
    if (protocol_.design.sampling == Sampling::random) return independent(pair, trials, stimuli);
    return balanced(pair, trials, stimuli);
  }

  // A block of one condition: the cell, its classes rearranged where runs are limited.
  std::vector<Pair> block(int series, int condition) const {
    std::vector<Pair> pairs = cell(series, condition);
    if (!protocol_.design.run_limit) return pairs;
    const Classes classes(pairs);
    RandomStream classes_of = stream("classes/" + series_name(series) + "/" + condition_name(condition));
    std::size_t next_same = 0, next_different = 0;
    std::size_t at = 0;
    for (const bool same : limited(classes.same.size(), classes.different.size(), classes_of))
      pairs[at++] = same ? classes.same[next_same++] : classes.different[next_different++];
    return pairs;
  }

  struct Drawn {
    int condition = 0;
    Pair pair{};
  };

  // A block in which the conditions of a series take turns at random. Each condition keeps its own cell's draws.
  std::vector<Drawn> mixed_block(int series) const {
    const auto conditions = static_cast<int>(protocol_.conditions.size());
    const int trials = protocol_.design.trials_per_cell;
    RandomStream interleave = stream("interleave/" + series_name(series));
    std::vector<Drawn> block;
    if (!protocol_.design.run_limit) {
      std::vector<int> turns;
      for (int c = 0; c < conditions; ++c) turns.insert(turns.end(), static_cast<std::size_t>(trials), c);
      interleave.shuffle(turns);
      std::vector<std::vector<Pair>> cells;
      for (int c = 0; c < conditions; ++c) cells.push_back(cell(series, c));
      std::vector<std::size_t> next(cells.size(), 0);
      for (const int c : turns)
        block.push_back({c, cells[static_cast<std::size_t>(c)][next[static_cast<std::size_t>(c)]++]});
      return block;
    }
    std::vector<Classes> cells;
    std::vector<int> same_turns, different_turns;
    for (int c = 0; c < conditions; ++c) {
      cells.emplace_back(cell(series, c));
      same_turns.insert(same_turns.end(), cells.back().same.size(), c);
      different_turns.insert(different_turns.end(), cells.back().different.size(), c);
    }
    interleave.shuffle(same_turns);
    interleave.shuffle(different_turns);
    RandomStream classes = stream("classes/" + series_name(series));
    std::vector<std::size_t> next_same(cells.size(), 0), next_different(cells.size(), 0);
    std::size_t same_turn = 0, different_turn = 0;
    for (const bool same : limited(same_turns.size(), different_turns.size(), classes)) {
      const int condition = same ? same_turns[same_turn++] : different_turns[different_turn++];
      const auto c = static_cast<std::size_t>(condition);
      block.push_back({condition, same ? cells[c].same[next_same[c]++] : cells[c].different[next_different[c]++]});
    }
    return block;
  }

  struct Slot {
    int condition = 0, track = 0;
    Pair pair{};
  };

  // The slots of an adaptive procedure's tracks, in rounds: each has one slot of every track, in any order, so that no
  // track runs ahead and none can be told from its place. All conditions where mixed, else the one given.
  std::vector<Slot> adaptive_block(std::optional<int> only) const {
    const AdaptiveProcedure& procedure = *protocol_.design.procedure;
    const CatchBlock catches = catch_block(procedure.catch_share).value();
    std::vector<std::vector<Slot>> tracks;
    for (int condition = 0; condition < static_cast<int>(protocol_.conditions.size()); ++condition) {
      if (only && condition != *only) continue;
      for (int track = 1; track <= static_cast<int>(procedure.starts.size()); ++track) {
        RandomStream slots = stream("slots/" + condition_name(condition), track);
        tracks.emplace_back();
        for (const Pair& pair : draw_slots(catches, procedure.trials, protocol_.stimulus.reference, slots))
          tracks.back().push_back({condition, track, pair});
      }
    }
    RandomStream turns = stream(only ? "tracks/" + condition_name(*only) : "tracks");
    std::vector<std::size_t> round(tracks.size());
    std::vector<Slot> block;
    for (std::size_t i = 0; i < tracks.front().size(); ++i) {
      std::iota(round.begin(), round.end(), 0);
      turns.shuffle(round);
      for (const std::size_t track : round) block.push_back(tracks[track][i]);
    }
    return block;
  }

  // One round of practice: about half of the trials are "same"; both classes occur where there are two trials.
  std::vector<Pair> practice(const Practice& practice, int round) const {
    RandomStream draws = stream("practice/" + series_name(practice.series), round);
    const double reference = protocol_.stimulus.reference;
    const Pair pair =
        practice.difference ? Pair{reference - *practice.difference, reference} : pair_of(practice.series);
    if (practice.trials % 4 == 0) return balanced(pair, practice.trials, draws);
    std::vector<Pair> pairs = independent(pair, practice.trials, draws);
    const auto is_same = [](const Pair& drawn) { return drawn[0] == drawn[1]; };
    const auto same = std::count_if(pairs.begin(), pairs.end(), is_same);
    if (practice.trials >= 2 && (same == 0 || same == practice.trials)) {
      Pair& turned = pairs[static_cast<std::size_t>(draws.below(pairs.size()))];
      turned[1] = turned[1] == pair[0] ? pair[1] : pair[0];
    }
    return pairs;
  }

 private:
  struct Classes {
    explicit Classes(const std::vector<Pair>& pairs) {
      for (const Pair& pair : pairs) (pair[0] == pair[1] ? same : different).push_back(pair);
    }
    std::vector<Pair> same, different;
  };

  // Each sphere is drawn on its own, so that P(same) = 1/2.
  static std::vector<Pair> independent(const Pair& pair, int trials, RandomStream& stream) {
    std::vector<Pair> pairs;
    for (int i = 0; i < trials; ++i) {
      const double first = pair[stream.coin() ? 1 : 0];
      const double second = pair[stream.coin() ? 1 : 0];
      pairs.push_back({first, second});
    }
    return pairs;
  }

  // Each of (a, a), (b, b), (a, b), (b, a) equally often, in any order.
  static std::vector<Pair> balanced(const Pair& pair, int trials, RandomStream& stream) {
    std::vector<Pair> pairs;
    for (int i = 0; i < trials / 4; ++i) {
      pairs.push_back({pair[0], pair[0]});
      pairs.push_back({pair[1], pair[1]});
      pairs.push_back({pair[0], pair[1]});
      pairs.push_back({pair[1], pair[0]});
    }
    stream.shuffle(pairs);
    return pairs;
  }

  RandomStream stream(const std::string& purpose, int part = 0) const {
    return RandomStream(seed_, participant_, session_purpose(session_, purpose), static_cast<std::uint64_t>(part));
  }
  std::vector<bool> limited(std::size_t same, std::size_t different, RandomStream& stream) const {
    return draw_limited_sequence(static_cast<int>(same), static_cast<int>(different), *protocol_.design.run_limit,
                                 stream);
  }
  const Pair& pair_of(int series) const { return protocol_.series[static_cast<std::size_t>(series)].pair; }
  const std::string& series_name(int series) const { return protocol_.series[static_cast<std::size_t>(series)].name; }
  const std::string& condition_name(int c) const { return protocol_.conditions[static_cast<std::size_t>(c)].name; }

  const Protocol& protocol_;
  std::uint64_t seed_;
  std::uint64_t participant_;
  int session_;
};

// Numbers the trials as they are added.
class TrialList {
 public:
  explicit TrialList(StiffnessUnit unit) noexcept : unit_(unit) {}
  void add(Trial trial, const Pair& pair) {
    trial.index = static_cast<int>(trials.size()) + 1;
    trial.stimuli = pair;
    trial.unit = unit_;
    trial.same = pair[0] == pair[1];
    trials.push_back(trial);
  }
  std::vector<Trial> trials;

 private:
  StiffnessUnit unit_;
};

void add_practice(const Practice& practice, const Draws& draws, TrialList& list) {
  for (int round = 1; round <= practice.max_rounds; ++round) {
    std::size_t turn = 0;
    for (const Pair& pair : draws.practice(practice, round)) {
      Trial trial;
      trial.practice = true;
      trial.round = round;
      trial.series = practice.series;
      trial.condition = practice.conditions[turn++ % practice.conditions.size()];
      list.add(trial, pair);
    }
  }
}

void add_slots(const std::vector<Draws::Slot>& slots, Trial trial, TrialList& list) {
  for (const Draws::Slot& slot : slots) {
    trial.condition = slot.condition;
    trial.track = slot.track;
    list.add(trial, slot.pair);
  }
}

}  // namespace

Plan make_plan(const Protocol& protocol, int participant, std::uint64_t seed, int session) {
  if (participant < 1) throw std::invalid_argument("participants are numbered from 1");
  if (session < 1) throw std::invalid_argument("sessions are numbered from 1");
  Plan plan;
  plan.session = session;
  plan.participant = participant;
  plan.seed = seed;
  if (protocol.paradigm == Paradigm::explore) {
    plan.explorations = ExplorationAssignment(protocol, seed, session).slots(participant);
    return plan;
  }
  const OrderAssignment assignment(protocol, seed, session);
  const Draws draws(protocol, seed, participant, session);
  plan.series_order = assignment.series_order(participant);
  plan.condition_orders = assignment.condition_orders(participant, plan.series_order);

  TrialList list(protocol.stimulus.unit);
  if (protocol.practice) add_practice(*protocol.practice, draws, list);
  int block = 0;
  for (std::size_t j = 0; j < plan.series_order.size(); ++j) {
    Trial trial;
    trial.series = plan.series_order[j];
    if (protocol.design.arrangement == Arrangement::mixed) {
      trial.block = ++block;
      if (protocol.design.procedure) {
        add_slots(draws.adaptive_block(std::nullopt), trial, list);
        continue;
      }
      for (const auto& drawn : draws.mixed_block(trial.series)) {
        trial.condition = drawn.condition;
        list.add(trial, drawn.pair);
      }
      continue;
    }
    for (const int condition : plan.condition_orders[j]) {
      trial.block = ++block;
      trial.condition = condition;
      if (protocol.design.procedure) {
        add_slots(draws.adaptive_block(condition), trial, list);
        continue;
      }
      for (const Pair& pair : draws.block(trial.series, condition)) list.add(trial, pair);
    }
  }
  plan.trials = std::move(list.trials);
  return plan;
}

int main_trial_count(const Plan& plan) noexcept {
  return static_cast<int>(
      std::count_if(plan.trials.begin(), plan.trials.end(), [](const Trial& trial) { return !trial.practice; }));
}

}  // namespace jnd
