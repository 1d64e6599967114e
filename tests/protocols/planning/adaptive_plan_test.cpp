// Plans of adaptive protocols: which slots there are is fixed, which levels they get follows from the answers.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <nlohmann/json.hpp>
#include <rapidcheck.h>

#include "analysis/numerics/moments.h"
#include "protocols/course/duration.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/cohort.h"
#include "protocols/planning/plan.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/rigs/device_lint.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/posterior_model.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"
#include "tests/protocols/rigs.h"

using namespace jnd;
using namespace jnd::test;
using nlohmann::json;

namespace {

Answer said(int which) {
  return {.said = which};
}

json good(const std::string& name) {
  return json::parse(read_text(corpus_folder() / "good" / (name + ".json")));
}
Protocol parsed(const json& document) {
  return parse_protocol(document.dump(1), "p.json");
}
Protocol staircase(const json& procedure = {}) {
  json document = good("staircase");
  if (!procedure.is_null()) document["design"]["procedure"].merge_patch(procedure);
  return parsed(document);
}

std::vector<Trial> slots_of(const Plan& plan, int condition, int track) {
  std::vector<Trial> slots;
  std::copy_if(plan.trials.begin(), plan.trials.end(), std::back_inserter(slots), [&](const Trial& trial) {
    return !trial.practice && trial.condition == condition && trial.track == track;
  });
  return slots;
}

}  // namespace

TEST_CASE("catch trials are kept in blocks of eight or more") {
  CHECK(catch_block(0.5)->trials == 8);
  CHECK(catch_block(0.5)->catches == 4);
  CHECK(catch_block(0.25)->catches == 2);
  CHECK(catch_block(0.2)->trials == 10);
  CHECK(catch_block(0.2)->catches == 2);
  CHECK(catch_block(0.333)->trials == 9);
  CHECK(catch_block(0.333)->catches == 3);
  CHECK(catch_block(0.05)->trials == 20);
  CHECK(catch_block(0)->catches == 0);
  CHECK_FALSE(catch_block(0.37));
  CHECK_FALSE(catch_block(1));
  CHECK_FALSE(catch_block(NAN));
  CHECK(slots_of_track(*catch_block(0.5), 8) == 16);
  CHECK(slots_of_track(*catch_block(0.5), 9) == 18);
  CHECK(slots_of_track(*catch_block(0.25), 7) == 9);  // a block of 6 + 2, then 1 with a third of a catch trial
  CHECK(slots_of_track(*catch_block(0), 11) == 11);
}

TEST_CASE("every block of a track holds its share, both orders and both kinds of catch trial") {
  CHECK(rc::check("slots", [] {
    const double share = *rc::gen::element(0.0, 0.1, 0.2, 0.25, 1.0 / 3, 0.4, 0.5, 0.75);
    const int different = *rc::gen::inRange(1, 80);
    RandomStream stream(*rc::gen::arbitrary<std::uint64_t>(), 1, "slots");
    const CatchBlock block = *catch_block(share);
    const auto slots = draw_slots(block, different, 900, stream);
    RC_ASSERT(static_cast<int>(slots.size()) == slots_of_track(block, different));
    int found = 0;
    for (std::size_t first = 0; first < slots.size(); first += static_cast<std::size_t>(block.trials)) {
      const std::size_t end = std::min(slots.size(), first + static_cast<std::size_t>(block.trials));
      int reference_first = 0, reference_second = 0, references = 0, comparisons = 0;
      for (std::size_t i = first; i < end; ++i) {
        const auto& [one, two] = slots[i];
        RC_ASSERT((one == 900 || one == set_by_answers(900)) && (two == 900 || two == set_by_answers(900)));
        ++(one == two ? (one == 900 ? references : comparisons) : (one == 900 ? reference_first : reference_second));
      }
      found += reference_first + reference_second;
      RC_ASSERT(std::abs(reference_first - reference_second) <= 1);
      RC_ASSERT(std::abs(references - comparisons) <= 1);
      if (end - first == static_cast<std::size_t>(block.trials))
        RC_ASSERT(references + comparisons == block.catches);
      else
        RC_ASSERT(std::abs((references + comparisons) - share / (1 - share) * (reference_first + reference_second)) <=
                  0.51);
    }
    RC_ASSERT(found == different);
  }));
}

TEST_CASE("the plan fixes conditions, tracks and catch trials, and leaves the levels open") {
  const Protocol protocol = staircase();
  REQUIRE(protocol.design.procedure);
  CHECK(protocol.series.size() == 1);
  CHECK(protocol.series[0].name == "adaptive");
  CHECK(protocol.series[0].pair == Intervals{100, 900});
  const Plan plan = make_plan(protocol, 3, 7);
  // 40 with a difference and a third of all: 6 whole blocks of 6 + 3, then 4 + 2.
  CHECK(main_trial_count(plan) == 3 * 2 * 60);
  CHECK(protocol.design.trials_per_cell == 120);
  for (int condition = 0; condition < 3; ++condition) {
    for (int track = 1; track <= 2; ++track) {
      const std::vector<Trial> slots = slots_of(plan, condition, track);
      REQUIRE(slots.size() == 60);
      CHECK(std::count_if(slots.begin(), slots.end(), [](const Trial& t) { return (t.target == kClassSame); }) == 20);
      const std::set<int> blocks = [&] {
        std::set<int> all;
        for (const Trial& slot : slots) all.insert(slot.block);
        return all;
      }();
      CHECK(blocks.size() == 1);
    }
  }
  for (const Trial& trial : plan.trials) {
    CHECK((trial.target == kClassSame) == (trial.stimuli[0] == trial.stimuli[1]));
    if (trial.practice) {
      CHECK(trial.track == 0);
      CHECK((trial.stimuli[0] == 500 || trial.stimuli[0] == 900));
      CHECK((trial.stimuli[1] == 500 || trial.stimuli[1] == 900));
    }
  }
  CHECK(make_plan(protocol, 3, 7).trials == plan.trials);
  CHECK(make_plan(protocol, 4, 7).trials != plan.trials);
  CHECK(make_plan(protocol, 3, 8).trials != plan.trials);
}

TEST_CASE("tracks take turns: each round has every one of them, in changing order") {
  const Plan blocked = make_plan(staircase(), 1, 1);
  const Plan mixed = make_plan(parsed(good("quest")), 1, 1);
  for (const auto& [plan, size] : {std::pair(&blocked, std::size_t{2}), std::pair(&mixed, std::size_t{3})}) {
    std::vector<Trial> trials;
    std::copy_if(plan->trials.begin(), plan->trials.end(), std::back_inserter(trials),
                 [](const Trial& t) { return !t.practice; });
    std::set<std::vector<std::pair<int, int>>> orders;
    for (std::size_t first = 0; first < trials.size(); first += size) {
      std::vector<std::pair<int, int>> round;
      for (std::size_t i = 0; i < size; ++i) round.emplace_back(trials[first + i].condition, trials[first + i].track);
      orders.insert(round);
      CHECK(std::set<std::pair<int, int>>(round.begin(), round.end()).size() == size);
    }
    CHECK(orders.size() == 6);  // 3 conditions x 2 orders of two tracks; 3! orders of three conditions
  }
}

TEST_CASE("a condition's slots do not depend on the others, nor on the procedure's numbers") {
  const Protocol protocol = staircase();
  json fewer = good("staircase");
  fewer["conditions"].erase(1);
  fewer["design"]["order"]["conditions"] = "fixed";
  fewer["design"]["procedure"]["up"] = 2;
  fewer["design"]["procedure"]["step_up"] = 33;
  const Plan all = make_plan(protocol, 2, 5), two = make_plan(parsed(fewer), 2, 5);
  const auto stimuli = [](const std::vector<Trial>& slots) {
    std::vector<Intervals> pairs;
    for (const Trial& slot : slots) pairs.push_back(slot.stimuli);
    return pairs;
  };
  CHECK(stimuli(slots_of(all, 2, 1)) == stimuli(slots_of(two, 1, 1)));
  CHECK(stimuli(slots_of(all, 0, 2)) == stimuli(slots_of(two, 0, 2)));
  CHECK(stimuli(slots_of(all, 0, 1)) != stimuli(slots_of(all, 0, 2)));
}

TEST_CASE("levels follow the answers of their own track; catch trials move nothing") {
  const Protocol protocol = staircase({{"halve_after", json::array()}, {"step_down", 80}});
  const Plan plan = make_plan(protocol, 1, 1);
  AdaptiveRun run(protocol);
  Staircase first(staircase_of_track(*protocol.design.procedure, 1));
  Staircase second(staircase_of_track(*protocol.design.procedure, 2));
  int catches = 0;
  for (const Trial& slot : plan.trials) {
    if (slot.practice || slot.condition != 0) continue;
    if (run.over(slot)) continue;
    Staircase& mine = slot.track == 1 ? first : second;
    const Trial trial = run.resolved(slot);
    for (std::size_t i = 0; i < 2; ++i)
      CHECK(trial.stimuli[i] == (slot.stimuli[i] == set_by_answers(900) ? 900 - mine.level() : 900));
    CHECK((trial.target == kClassSame) == (trial.stimuli[0] == trial.stimuli[1]));
    const int judgement = slot.index % 3 == 0 ? kClassSame : kClassDifferent;
    run.answered(trial, said(judgement));
    if ((slot.target == kClassSame))
      ++catches;
    else
      mine.answer(judgement == kClassDifferent);
  }
  const std::vector<AdaptiveTrack> tracks = run.tracks();
  REQUIRE(tracks.size() == 6);
  CHECK(tracks[0].reversals == first.reversals());
  CHECK(tracks[1].reversals == second.reversals());
  CHECK(tracks[0].catch_trials + tracks[1].catch_trials == catches);
  CHECK(tracks[2].levels.empty());
  CHECK(tracks[2].level == 500);
  CHECK(tracks[3].level == 100);
}

TEST_CASE("levels are the decimals that they stand for, whoever sets them") {
  json document = json::parse(read_text(protocols_folder() / "studies" / "lee2007-delay.json"));
  document["standards"][0]["value"] = 0.1 + 0.2;
  document["levels"] = {{"difference", {-0.2, -0.1}}};
  CHECK(parsed(document).series[0].levels == std::vector<double>{0.1, 0.2});
  document["levels"] = {{"difference", {{"from", 0.1}, {"to", 0.4}, {"step", 0.1}}}};
  CHECK(parsed(document).series[0].levels == std::vector<double>{0.4, 0.5, 0.6, 0.7});
  document["levels"] = {{"ratio", {3}}};
  CHECK(parsed(document).series[0].levels == std::vector<double>{0.9});
  for (const char* of_levels : {"levels", "assumed"}) document.erase(of_levels);
  for (const char* of_levels : {"trials_per_cell", "sampling"}) document["design"].erase(of_levels);
  document["design"]["order"]["series"] = "fixed";
  document["design"]["procedure"] = {
      {"kind", "staircase"}, {"starts", {1}},  {"clamp", {0.1, 2}}, {"up", 1},
      {"down", 1},           {"step_up", 0.1}, {"step_down", 0.1},  {"stop", {{"trials", 20}}},
      {"catch_share", 0.25}, {"side", "below"}};
  document["standards"][0]["value"] = 1.1;
  const Protocol protocol = parsed(document);
  AdaptiveRun run(protocol);
  std::vector<double> presented;
  for (const Trial& planned : make_plan(protocol, 1, 1).trials) {
    if (planned.condition != 0) continue;
    const Trial trial = run.resolved(planned);
    if (trial.target == 1 && presented.size() < 10) presented.push_back(trial.stimuli[0]);
    run.answered(planned, said(trial.target));
  }
  CHECK(presented == std::vector<double>{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1});
}

TEST_CASE("a track ends with its reversals, or with its trials") {
  const Protocol protocol = staircase();
  AdaptiveRun run(protocol);
  Trial slot;
  slot.track = 1;
  slot.target = kClassDifferent;
  int answers = 0;
  while (!run.over(slot)) {  // wrong and right in pairs: a reversal at every turn
    run.answered(slot, said(answers % 4 < 2 ? kClassSame : kClassDifferent));
    ++answers;
  }
  CHECK(run.tracks()[0].reversals.size() == 8);
  CHECK(answers < 40);
  slot.track = 2;
  answers = 0;
  while (!run.tracks()[1].finished) {
    run.answered(slot, said(kClassDifferent));
    ++answers;
  }
  CHECK(answers == 40);
  CHECK_FALSE(run.over(slot));  // the catch trials that are left keep their share
  CHECK(run.tracks()[1].reversals.empty());
  CHECK(run.tracks()[1].level == 20);
}

TEST_CASE("QUEST presents the mean of its posterior, within the clamp") {
  const Protocol protocol = parsed(good("quest"));
  AdaptiveRun run(protocol);
  Quest quest(quest_of_track(*protocol.design.procedure, 1));
  Trial slot;
  slot.track = 1;
  slot.target = kClassDifferent;
  slot.stimuli = {900, set_by_answers(900)};
  slot.standard = 900;
  CHECK(run.resolved(slot).stimuli[1] == Approx(600));
  for (int i = 0; i < 24; ++i) {
    const double level = 900 - run.resolved(slot).stimuli[1];
    CHECK(level == Approx(std::clamp(std::pow(10, quest.estimate().mean), 20.0, 800.0)).margin(0.001));
    const bool different = i % 5 != 0;
    run.answered(slot, said(different ? kClassDifferent : kClassSame));
    quest.answer(std::log10(level), different);
  }
  CHECK(run.tracks()[0].finished);
  CHECK(run.tracks()[0].quest->mean == Approx(quest.estimate().mean).margin(1e-9));
  CHECK(quest_level(9, {20, 800}) == 800);
  CHECK(quest_level(-9, {20, 800}) == 20);
  CHECK(quest_level(2, {20, 800}) == 100);
}

TEST_CASE("the Bayesian procedure presents the levels of the reference sequences") {
  // The slots of sessions have a kind, or a side: where a sequence is free to take any, the one that it took, among whose
  // levels the best of all is the best too.
  const json reference = json::parse(read_text(JND_SOURCE_DIR "/analysis/selftest/posterior_reference.json"));
  int compared = 0;
  for (const json& one : reference.at("cases")) {
    const json &input = one.at("input"), &trials = one.at("expected").at("trials");
    const bool which = input.at("definition") != "same_different";
    json document = good(which ? "task-posterior" : "posterior-plain");
    json& procedure = document["design"]["procedure"];
    procedure["utility"] = input.at("utility");
    procedure["stop"]["trials"] = 100;
    if (which) {
      document["standards"] = json::parse(R"([{"name": "s", "value": 900}])");
      procedure["levels"] = {{"from", 50}, {"to", 500}, {"step", 50}};
      document["design"]["order"]["series"] = "fixed";
      procedure.erase("grid");
      procedure.erase("prior");
    } else {
      procedure["levels"] = {{"from", 25}, {"to", 600}, {"step", 25}};
    }
    const Protocol protocol = parsed(document);
    AdaptiveRun run(protocol);
    for (std::size_t t = 0; t < trials.size(); ++t) {
      CAPTURE(one.at("name").get<std::string>(), t);
      const bool positive = input.at("responses").at(t) == 1;
      const double level = trials.at(t).at("level").get<double>();
      Trial slot;
      slot.task = protocol.task.kind;
      slot.track = 1;
      slot.standard = 900;
      slot.side = which && level > 900 ? 1 : -1;
      const bool same = !which && level == 0;
      slot.stimuli = {900, same ? 900 : set_by_answers(900)};
      // Of which the second interval has more where the comparison, which is second, lies above.
      slot.target = which ? (slot.side > 0 ? 1 : 0) : (same ? kClassSame : kClassDifferent);
      const double presented = run.resolved(slot).stimuli[1];
      CHECK(presented == (which ? level : 900 - level));
      run.answered(slot, said(positive ? 1 : 0));
      ++compared;
    }
  }
  CHECK(compared >= 96);
}

TEST_CASE("a track of the Bayesian procedure has blocks of six, and ends with its precision") {
  const Protocol plain = parsed(good("posterior-plain"));
  const Plan plan = make_plan(plain, 1, 1);
  const std::vector<Trial> slots = slots_of(plan, 0, 1);
  REQUIRE(slots.size() == 36);  // 24 with a difference
  for (std::size_t first = 0; first < slots.size(); first += 6) {
    int references = 0, comparisons = 0, reference_first = 0;
    for (std::size_t i = first; i < first + 6; ++i) {
      const Trial& slot = slots[i];
      if (slot.target != kClassSame)
        reference_first += slot.stimuli[0] == 900 ? 1 : 0;
      else
        ++(slot.stimuli[0] == 900 ? references : comparisons);
    }
    CHECK(references == 1);
    CHECK(comparisons == 1);
    CHECK(reference_first == 2);
  }
  const Protocol protocol = parsed(good("posterior"));
  CHECK(can_end_early(*protocol.design.procedure));
  CHECK_FALSE(can_end_early(*plain.design.procedure));
  AdaptiveRun run(protocol);
  Trial different, same;
  different.track = same.track = 1;
  different.standard = same.standard = 900;
  different.stimuli = {900, set_by_answers(900)};
  different.target = kClassDifferent;
  same.stimuli = {set_by_answers(900), set_by_answers(900)};
  same.target = kClassSame;
  const Answer yes = said(kClassDifferent), no = said(kClassSame);
  double before = *run.tracks()[0].sd_ln_s;
  int answers = 0;
  while (!run.over(different) && answers < 200) {
    const double level = 900 - run.resolved(different).stimuli[1];
    CHECK(run.resolved(same).stimuli == Intervals{900 - level, 900 - level});
    const bool equal = answers++ % 3 == 2;
    run.answered(equal ? same : different, !equal && level > 250 ? yes : no);
  }
  const AdaptiveTrack track = run.tracks()[0];
  CHECK(track.finished);
  CHECK(answers < 100);
  CHECK(*track.sd_ln_s <= 0.25);
  CHECK(*track.sd_ln_s < before);
  CHECK(track.catch_trials == answers / 3);
  CHECK(static_cast<int>(track.levels.size()) == answers - answers / 3);
  CHECK_FALSE(run.tracks()[1].finished);  // another condition's

  // After each answer what the posterior of all answers so far says, catch trials included.
  REQUIRE(track.course.size() == track.levels.size());
  PosteriorConfiguration configuration = posterior_model(protocol, protocol.series[0]).configuration;
  std::vector<double>& levels = configuration.levels;
  levels = {0};
  for (const double level : track.levels)
    if (std::find(levels.begin(), levels.end(), level) == levels.end()) levels.push_back(level);
  PosteriorProcedure again(configuration);
  for (std::size_t i = 0; i < track.levels.size(); ++i) {
    const auto place = std::find(levels.begin(), levels.end(), track.levels[i]) - levels.begin();
    again.update(static_cast<std::size_t>(place), track.correct[i]);
    if (i % 2 == 1) again.update(0, false);  // every third answer was of a pair without a difference
    if (i + 1 == track.levels.size() && answers % 3 != 0) break;
    CHECK(track.course[i].jnd == Approx(std::exp(again.estimate().mean_ln_s)).epsilon(1e-9));
    CHECK(track.course[i].low == Approx(std::exp(again.ln_s_quantile(0.025))).epsilon(1e-9));
    CHECK(track.course[i].high == Approx(std::exp(again.ln_s_quantile(0.975))).epsilon(1e-9));
  }
}

TEST_CASE("the posterior of all answers is what updates one by one lead to") {
  const Protocol protocol = shipped_protocol("adaptive-posterior");
  const PosteriorModel model = posterior_model(protocol, protocol.series[0]);
  CHECK(model.distances.size() == 25);
  PosteriorProcedure procedure(model.configuration);
  const double prior_sd = procedure.estimate().sd_ln_s;
  std::vector<AnsweredTrial> trials;
  for (int i = 0; i < 60; ++i) {
    const std::size_t place = i % 3 == 2 ? 0 : procedure.choose(PosteriorSlot::different).level;
    const double level = procedure.level(place);
    const bool different = i % 6 == 5 || level > 300;
    procedure.update(place, different);
    trials.push_back({{900, 900 - level}, 900, level > 0 ? 1 : 0, different ? 1 : 0});
  }
  std::reverse(trials.begin(), trials.end());
  const PosteriorOfAnswers of = posterior_of_trials(protocol, protocol.series[0], trials);
  CHECK(of.threshold.status == AdaptiveStatus::ok);
  CHECK(of.threshold.n == 60);
  CHECK(of.threshold.threshold == Approx(std::exp(procedure.estimate().mean_ln_s)).epsilon(1e-10));
  CHECK(of.threshold.sd == Approx(procedure.estimate().sd_ln_s).epsilon(1e-10));
  CHECK(of.threshold.sd * of.threshold.sd < prior_sd * prior_sd / 2);
  CHECK(of.threshold.low == Approx(std::exp(procedure.ln_s_quantile(0.025))).epsilon(1e-9));
  CHECK(of.threshold.low < of.threshold.threshold);
  CHECK(of.threshold.threshold < of.threshold.high);
  // No value without answers, with hardly any, and of somebody to whom all is alike.
  CHECK(posterior_of_trials(protocol, protocol.series[0], {}).threshold.status == AdaptiveStatus::no_trials);
  trials.resize(3);
  const AdaptiveThreshold few = posterior_of_trials(protocol, protocol.series[0], trials).threshold;
  CHECK(few.status == AdaptiveStatus::too_few_answers);
  CHECK(std::isnan(few.threshold));
  for (int i = 0; i < 80; ++i)
    trials.push_back({{900, i % 2 == 0 ? 300.0 : 900.0}, 900, i % 2 == 0 ? 1 : 0, i % 4 / 2});
  CHECK(posterior_of_trials(protocol, protocol.series[0], trials).threshold.status == AdaptiveStatus::pinned_at_grid);
}

TEST_CASE("a session's length is the most that it can be") {
  const Protocol protocol = staircase();
  CHECK(expected_duration_s(protocol) == Approx((360 + 6) * expected_trial_s(protocol)));
  const CohortBalance balance = balance_of_cohort(protocol, 6, 1);
  CHECK(balance.same == 6 * 3 * 2 * 20);
  CHECK(balance.different == 6 * 3 * 2 * 40);
  for (const CellBalance& cell : balance.cells) {
    CHECK(std::abs(cell.pairs[0] - cell.pairs[1]) <= 2 * 6 * 7);  // one coin a block
    CHECK(cell.pairs[2] == cell.pairs[3]);
  }
}

namespace {
std::vector<Diagnostic> warnings(const std::string& name, const json& procedure) {
  json document = good(name);
  if (!procedure.is_null()) document["design"]["procedure"].merge_patch(procedure);
  const ProtocolCheck check = check_protocol(document.dump(1), "p.json");
  INFO((check.errors.empty() ? std::string() : to_text(check.errors.front())));
  REQUIRE(check.errors.empty());
  return check.warnings;
}
int found(const std::vector<Diagnostic>& warnings, const std::string& path, const std::string& part) {
  return static_cast<int>(std::count_if(warnings.begin(), warnings.end(), [&](const Diagnostic& warning) {
    return warning.path == "$.design.procedure." + path && warning.message.find(part) != std::string::npos &&
           warning.line > 1 && !warning.suggestion.empty();
  }));
}
}  // namespace

TEST_CASE("what can hardly move is told at load") {
  const std::vector<Diagnostic> quiet = warnings("staircase", {});
  CHECK(std::none_of(quiet.begin(), quiet.end(),
                     [](const Diagnostic& warning) { return warning.path.find("procedure") != std::string::npos; }));
  CHECK(found(warnings("staircase", {{"step_up", 900}}), "step_up", "larger than the clamp") == 1);
  CHECK(found(warnings("staircase", {{"step_down", 900}}), "step_down", "larger than the clamp") == 1);
  CHECK(found(warnings("staircase", {{"multiplicative", true}, {"step_up", 50}, {"step_down", 2}}), "step_up",
              "larger than the clamp") == 1);
  CHECK(found(warnings("staircase", {{"starts", {800, 100}}}), "starts[0]", "cannot raise it") == 1);
  CHECK(found(warnings("staircase", {{"starts", {500, 20}}}), "starts[1]", "cannot lower it") == 1);
  CHECK(found(warnings("staircase", {{"averaged_reversals", 10}}), "stop.reversals", "10 are to be averaged") == 1);
  CHECK(found(warnings("staircase", {{"halve_after", {6}}}), "halve_after", "still halves") == 1);
  CHECK(found(warnings("staircase", {{"stop", {{"at_most", 12}}}}), "stop.at_most", "are few") == 1);
  CHECK(found(warnings("staircase", {{"catch_share", 0}}), "catch_share", "no false-alarm rate") == 1);
  CHECK(found(warnings("quest", {{"grain", 0.4}, {"range", 0.8}}), "grain", "can hardly move") == 1);
  CHECK(found(warnings("quest", {{"range", 0.5}}), "range", "only; the clamp allows") == 1);
  CHECK(found(warnings("quest", {{"stop", {{"trials", 10}}}}), "stop.trials", "are few") == 1);
  CHECK(found(warnings("posterior-plain", {{"levels", {25, 50}}}), "levels", "below the JND that the prior expects") ==
        1);
  CHECK(found(warnings("posterior", {{"stop", {{"at_most", 10}}}}), "stop.at_most", "are few") == 1);
  CHECK(found(warnings("task-across", {{"side", "below"}, {"clamp", {100, 600}}, {"starts", {350}}}), "clamp",
              "is below 0") == 1);
  CHECK(found(warnings("task-across", {{"side", "below"}, {"clamp", {100, 500}}, {"starts", {350}}}), "clamp",
              "is below 0") == 0);
  CHECK(found(warnings("staircase-joint", {{"clamp", {20, 200}}, {"starts", {100}}}), "clamp",
              "that the prior expects") == 1);
}

TEST_CASE("parameters that a condition lacks, or has of another kind, are told at load") {
  json document = good("task-across");
  document["conditions"] = {{{"name", "a"}, {"label", "a"}, {"parameters", {{"gain", 1}, {"hand", "left"}}}},
                            {{"name", "b"}, {"label", "b"}, {"parameters", {{"gain", "high"}}}}};
  const ProtocolCheck check = check_protocol(document.dump(1), "p.json");
  REQUIRE(check.errors.empty());
  const auto told = [&](std::string_view path, std::string_view part) {
    return std::count_if(check.warnings.begin(), check.warnings.end(), [&](const Diagnostic& warning) {
      return warning.path == path && warning.message.find(part) != std::string::npos;
    });
  };
  CHECK(told("$.conditions[1].parameters", "\"gain\" is of another kind here") == 1);
  CHECK(told("$.conditions[1].parameters", "\"hand\" is a parameter of other conditions") == 1);
  CHECK(told("$.conditions[0].parameters", "") == 0);
}

TEST_CASE("levels that a device renders alike, or not at all, are told with the place of the clamp") {
  const auto lint_with = [](double reference, const json& clamp, const json& starts) {
    json document = good("staircase");
    document["stimulus"]["reference"] = reference;
    document["design"]["procedure"]["clamp"] = clamp;
    document["design"]["procedure"]["starts"] = starts;
    return lint_against_device(parsed(document), rig_named("rrs3"), "p.json");
  };
  const auto told = [](const std::vector<Diagnostic>& all, const std::string& path, const std::string& part) {
    return std::count_if(all.begin(), all.end(), [&](const Diagnostic& one) {
      return one.path == path && one.line > 1 && one.message.find(part) != std::string::npos;
    });
  };
  const DeviceLint usual = lint_with(900, {20, 800}, {500, 100});
  CHECK(usual.errors.empty());
  CHECK(told(usual.warnings, "$.design.procedure.clamp[0]", "") == 0);
  // Vibrations clamp at 900 N/m, so that in V the levels below 300 feel like none.
  const DeviceLint stiffer = lint_with(1200, {20, 800}, {500, 100});
  CHECK(stiffer.errors.empty());
  CHECK(told(stiffer.warnings, "$.design.procedure.clamp[0]", "a difference of 20 N/m cannot be felt") == 1);
  CHECK(told(stiffer.warnings, "$.design.procedure.starts[1]", "a difference of 100 N/m cannot be felt") == 1);
  CHECK(told(stiffer.warnings, "$.design.procedure.starts[0]", "") == 0);
  const DeviceLint never = lint_with(1200, {20, 200}, {100});
  CHECK(told(never.errors, "$.design.procedure.clamp", "in condition V both spheres vibrate") == 1);
  const DeviceLint beyond = lint_with(2500, {20, 800}, {500});
  CHECK(told(beyond.errors, "$.stimulus.reference", "2500 N/m is more than") == 1);
}

TEST_CASE("a staircase across the standard settles at the PSE, whatever is correct") {
  const Protocol protocol = load_protocol(corpus_folder() / "good" / "task-across.json");
  constexpr double kBias = 40, kNoise = 30;  // the comparison feels so much more than it is
  const Task& task = task_of(TaskKind::which);
  std::vector<double> levels;
  for (int participant = 1; participant <= 40; ++participant) {
    RandomStream stream(3, static_cast<std::uint64_t>(participant), "test/across");
    AdaptiveRun run(protocol);
    for (const Trial& planned : make_plan(protocol, participant, 3).trials) {
      if (planned.practice) continue;
      CHECK(planned.side == 0);
      CHECK(planned.standard_place >= 0);
      const Trial trial = run.resolved(planned);
      CHECK(trial.target == task.target_of(trial.stimuli, 500, protocol.task));
      std::vector<Felt> felt;
      for (std::size_t i = 0; i < 2; ++i)
        felt.push_back(
            {trial.stimuli[i] + (holds_standard(trial, trial.stimuli, i) ? 0 : kBias) + kNoise * stream.normal(),
             kNoise});
      // As planned and as logged it moves the level alike.
      run.answered(participant % 2 == 0 ? planned : trial, task.answer(felt, trial, protocol, stream));
    }
    const AdaptiveThreshold found = condition_threshold(run.tracks(), protocol);
    if (found.status == AdaptiveStatus::ok) levels.push_back(found.threshold);
  }
  REQUIRE(levels.size() > 35);
  CHECK(moments(levels).mean == Approx(500 - kBias).margin(8));
  CHECK(measured_outcomes(protocol).back().title == "PSE by reversals");
}
