// Every task, from its protocol to its estimates: what it draws is balanced, says which answer is correct, and is told
// apart by who feels it.
#include "protocols/tasks/task.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "protocols/planning/plan.h"
#include "protocols/random_stream.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

namespace {

const std::vector<std::string> kShipped = {"which/leib2015",
                                           "which/maereg2017",
                                           "which/bergmann-tiest2009",
                                           "which/zoeller2020",
                                           "yes-no/lee2007-delay",
                                           "yes-no/pang1991",
                                           "identify/identify-stiffness2025",
                                           "oddity/carpenter2018-oddity",
                                           "abx/abx-stiffness",
                                           "magnitude/dhong2019-magnitude",
                                           "adjust/jones-hunter1990",
                                           "same-different/gurari2017"};

Protocol shipped_task(const std::string& place) {
  return shipped_protocol(place.substr(place.find('/') + 1));
}

// What a trial is answered by somebody who feels it with that noise.
std::vector<AnsweredTrial> answered(const Protocol& protocol, const Plan& plan, double sigma, int condition) {
  const Task& task = task_of(protocol.task.kind);
  RandomStream noise(7, 1, "test/noise");
  std::vector<AnsweredTrial> trials;
  for (const Trial& trial : plan.trials) {
    if (trial.practice || trial.condition != condition) continue;
    std::vector<Felt> felt;
    for (const double stimulus : trial.stimuli) felt.push_back({stimulus + sigma * noise.normal(), sigma});
    const Answer answer = task.answer(felt, trial, protocol, noise);
    trials.push_back({trial.stimuli, trial.standard, trial.target, answer.said, answer.sureness, answer.number});
  }
  return trials;
}

const TaskEstimate& outcome(const TaskEstimates& estimates, const Protocol& protocol, std::string_view key) {
  const auto outcomes = task_of(protocol.task.kind).outcomes(protocol);
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    if (outcomes[i].key == key) return estimates.values.at(i);
  throw std::logic_error("no such outcome");
}

}  // namespace

TEST_CASE("every arrangement of a level comes equally often, and says which answer is correct") {
  for (const std::string& place : kShipped) {
    CAPTURE(place);
    const Protocol protocol = shipped_task(place);
    CHECK(to_string(protocol.task.kind) == place.substr(0, place.find('/')));
    const Task& task = task_of(protocol.task.kind);
    const Plan plan = make_plan(protocol, 1, 5);
    CHECK(plan.trials == make_plan(protocol, 1, 5).trials);
    std::map<std::pair<int, int>, std::map<std::vector<double>, int>> cells;
    for (const Trial& trial : plan.trials) {
      if (trial.practice) continue;
      CHECK(trial.task == protocol.task.kind);
      CHECK(static_cast<int>(trial.stimuli.size()) == task.intervals(protocol.task));
      CHECK(trial.target == task.target_of(trial.stimuli, trial.standard, protocol.task));
      ++cells[{trial.condition, trial.series}][{trial.stimuli.begin(), trial.stimuli.end()}];
    }
    CHECK(cells.size() == protocol.conditions.size() * protocol.series.size());
    for (const auto& [cell, arrangements] : cells) {
      int trials = 0, least = 1000000, most = 0;
      for (const auto& [stimuli, times] : arrangements) {
        trials += times;
        least = std::min(least, times);
        most = std::max(most, times);
      }
      CHECK(trials == trials_of_cell(protocol, cell.second));
      // Noise is as often as all signals together.
      // Where a trial starts is drawn.
      if (protocol.task.kind != TaskKind::yes_no && protocol.task.kind != TaskKind::adjust) CHECK(least == most);
    }
  }
}

TEST_CASE("who feels without noise is always right, and who feels nothing is not") {
  for (const std::string& place : kShipped) {
    CAPTURE(place);
    const Protocol protocol = shipped_task(place);
    // Nothing is right or wrong, or answered by the model of pairs.
    if (protocol.task.kind == TaskKind::magnitude || protocol.task.kind == TaskKind::adjust ||
        protocol.task.kind == TaskKind::same_different)
      continue;
    // Detection has a criterion half way between noise and the middle of the signals.
    const bool detection = protocol.task.kind == TaskKind::yes_no;
    const Plan plan = make_plan(protocol, 2, 9);
    const auto right = [](const std::vector<AnsweredTrial>& trials) {
      return static_cast<double>(
                 std::count_if(trials.begin(), trials.end(), [](const auto& one) { return one.correct(); })) /
             static_cast<double>(trials.size());
    };
    CHECK(right(answered(protocol, plan, 1e-9, 0)) > (detection ? 0.7 : 0.999));
    CHECK(right(answered(protocol, plan, 1e9, 0)) < 0.8);
  }
}

TEST_CASE("a value is moved level by level, stays at an end, and what is accepted is the answer") {
  const Protocol protocol = shipped_task("adjust/jones-hunter1990");
  const Task& task = task_of(TaskKind::adjust);
  const std::vector<double>& levels = protocol.series[0].levels;  // 100 to 900 in steps of 25
  REQUIRE(levels.size() == 33);
  CHECK(levels[1] == 125);
  const Trial trial{.stimuli = {500, 100}, .task = TaskKind::adjust, .target = -1, .standard = 500};
  const Answer less{.said = 0}, more{.said = 1}, accept{.said = 2};
  CHECK(*task.moved({500, 100}, less, trial, protocol) == Intervals{500, 100});
  CHECK(*task.moved({500, 100}, more, trial, protocol) == Intervals{500, 125});
  CHECK(*task.moved({500, 900}, more, trial, protocol) == Intervals{500, 900});
  CHECK(*task.moved({500, 900}, less, trial, protocol) == Intervals{500, 875});
  CHECK_FALSE(task.moved({500, 525}, accept, trial, protocol));
  CHECK(task.settled(accept, {500, 525}).number == 525);
  CHECK(task.settled(accept, {500, 525}).said == -1);
}

TEST_CASE("half of the adjustments start below the standard, half above, as far away as is asked for") {
  Protocol protocol = shipped_task("adjust/jones-hunter1990");
  for (const double start : {0.0, 0.5, 1.0}) {
    protocol.task.start = start;
    std::map<std::pair<int, int>, int> sides;
    for (const Trial& trial : make_plan(protocol, 3, 11).trials) {
      const double away = std::abs(trial.stimuli[1] - trial.standard) / (0.8 * trial.standard);
      CHECK(away >= start - 1e-12);
      CHECK(away > 0);
      CHECK((trial.stimuli[1] > trial.standard ? 1 : -1) == trial.side);
      ++sides[{trial.series, trial.side}];
    }
    CHECK(sides.size() == 2 * protocol.series.size());
    for (const auto& [side, trials] : sides) CHECK(trials == protocol.design.trials_per_cell / 2);
  }
  // From a last level, 16 steps away, to the standard.
  CHECK(task_of(TaskKind::adjust).expected_looks(protocol) == Approx(17));
}

TEST_CASE("adjustments say the mean setting, half the spread of half of them, and the effect of the start") {
  const Protocol protocol = shipped_task("adjust/jones-hunter1990");
  const std::vector<AnsweredTrial> trials = {{.stimuli = {500, 200}, .standard = 500, .number = 450},
                                             {.stimuli = {500, 200}, .standard = 500, .number = 470},
                                             {.stimuli = {500, 800}, .standard = 500, .number = 520},
                                             {.stimuli = {500, 800}, .standard = 500, .number = 560}};
  const TaskEstimates found = task_of(TaskKind::adjust).estimate(protocol, protocol.series[0], trials);
  CHECK(found.status == "ok");
  CHECK(*outcome(found, protocol, "pse").value == Approx(500));
  CHECK(*outcome(found, protocol, "bias").value == Approx(0).margin(1e-12));
  // SD of the four: sqrt((50^2 + 30^2 + 20^2 + 60^2) / 3).
  CHECK(*outcome(found, protocol, "jnd").value == Approx(0.6744897501960817 * std::sqrt(7400.0 / 3)));
  CHECK(*outcome(found, protocol, "weber").value == Approx(0.6744897501960817 * std::sqrt(7400.0 / 3) / 500));
  CHECK(*outcome(found, protocol, "start_effect").value == Approx(80));
  CHECK(*outcome(found, protocol, "variable_error").value == Approx(std::sqrt((200 + 800) / 2.0)));
  const std::vector<AnsweredTrial> one(trials.begin(), trials.begin() + 1);
  CHECK(task_of(TaskKind::adjust).estimate(protocol, protocol.series[0], one).status == "too_few");
}

TEST_CASE("the estimates of a task find what was put in") {
  Protocol which = shipped_task("which/maereg2017");
  which.design.trials_per_cell = 2000;
  const auto trials = answered(which, make_plan(which, 1, 3), 60 / std::sqrt(2.0), 0);
  const TaskEstimates estimates = task_of(TaskKind::which).estimate(which, which.series[0], trials);
  CHECK(estimates.status == "ok");
  CHECK(*outcome(estimates, which, "jnd").value == Approx(0.67449 * 60).epsilon(0.06));
  CHECK(*outcome(estimates, which, "pse").value == Approx(400).epsilon(0.01));
  CHECK(std::abs(*outcome(estimates, which, "order").value) < 0.1);
  CHECK(*outcome(estimates, which, "pse").low < 400);
  CHECK(*outcome(estimates, which, "pse").high > 400);

  Protocol oddity = shipped_task("oddity/carpenter2018-oddity");
  oddity.design.trials_per_cell = 1998;
  const TaskEstimates odd =
      task_of(TaskKind::oddity).estimate(oddity, oddity.series[0], answered(oddity, make_plan(oddity, 1, 3), 0.1, 0));
  CHECK(*outcome(odd, oddity, "jnd").value == Approx(0.1).epsilon(0.06));

  Protocol abx = shipped_task("abx/abx-stiffness");
  abx.design.trials_per_cell = 2000;
  const TaskEstimates like =
      task_of(TaskKind::abx).estimate(abx, abx.series[0], answered(abx, make_plan(abx, 1, 3), 120, 0));
  CHECK(*outcome(like, abx, "jnd").value == Approx(120).epsilon(0.06));

  Protocol detection = shipped_task("yes-no/lee2007-delay");
  detection.design.trials_per_cell = 2000;
  const TaskEstimates seen =
      task_of(TaskKind::yes_no)
          .estimate(detection, detection.series[0], answered(detection, make_plan(detection, 1, 3), 30, 0));
  CHECK(*outcome(seen, detection, "threshold").value == Approx(30).epsilon(0.06));

  Protocol magnitude = shipped_task("magnitude/dhong2019-magnitude");
  magnitude.task.number_max = 1e6;
  const TaskEstimates power =
      task_of(TaskKind::magnitude)
          .estimate(magnitude, magnitude.series[0], answered(magnitude, make_plan(magnitude, 1, 3), 0.1, 0));
  CHECK(*outcome(power, magnitude, "exponent").value == Approx(0.8).epsilon(0.05));

  const Protocol identify = shipped_task("identify/identify-stiffness2025");
  const TaskEstimates named =
      task_of(TaskKind::identify)
          .estimate(identify, identify.series[0], answered(identify, make_plan(identify, 1, 3), 1e-6, 0));
  CHECK(*outcome(named, identify, "information").value == Approx(2));
  CHECK(*outcome(named, identify, "correct").value == 1);
}

TEST_CASE("a task without an answer to give says so") {
  const Protocol which = shipped_task("which/maereg2017");
  std::vector<AnsweredTrial> same = answered(which, make_plan(which, 1, 3), 1, 0);
  for (AnsweredTrial& trial : same) trial.said = trial.stimuli[0] == trial.standard ? 1 : 0;  // always the comparison
  const TaskEstimates estimates = task_of(TaskKind::which).estimate(which, which.series[0], same);
  CHECK(estimates.status == "all_same");
  CHECK_FALSE(outcome(estimates, which, "jnd").value.has_value());
  // Told apart without an error: the JND is below what the levels show.
  const TaskEstimates sharp =
      task_of(TaskKind::which).estimate(which, which.series[0], answered(which, make_plan(which, 1, 3), 1e-6, 0));
  CHECK(sharp.status == "separated");
  CHECK_FALSE(outcome(sharp, which, "jnd").value.has_value());
  CHECK(outcome(sharp, which, "jnd").low == 0);
  CHECK(*outcome(sharp, which, "jnd").high > 0);
  CHECK_FALSE(outcome(sharp, which, "weber").value.has_value());
  const Protocol detection = shipped_task("yes-no/lee2007-delay");
  const TaskEstimates seen =
      task_of(TaskKind::yes_no)
          .estimate(detection, detection.series[0], answered(detection, make_plan(detection, 1, 3), 1e-6, 0));
  CHECK(seen.status == "separated");
  CHECK_FALSE(outcome(seen, detection, "threshold").value.has_value());
  CHECK(outcome(seen, detection, "dprime").value.has_value());
  const Protocol oddity = shipped_task("oddity/carpenter2018-oddity");
  const TaskEstimates odd =
      task_of(TaskKind::oddity).estimate(oddity, oddity.series[0], answered(oddity, make_plan(oddity, 1, 3), 1e-9, 0));
  CHECK(odd.status == "ceiling");
  CHECK_FALSE(outcome(odd, oddity, "jnd").value.has_value());
}

TEST_CASE("comparisons on one side of the standard have no PSE, and a JND that is not moved by that") {
  Protocol which = shipped_task("which/maereg2017");
  which.series[0].levels = {430, 460, 490, 520};
  which.design.trials_per_cell = 2000;
  const auto outcomes = task_of(TaskKind::which).outcomes(which);
  CHECK(std::none_of(outcomes.begin(), outcomes.end(),
                     [](const auto& one) { return one.key == "pse" || one.key == "bias"; }));
  const TaskEstimates estimates =
      task_of(TaskKind::which)
          .estimate(which, which.series[0], answered(which, make_plan(which, 1, 3), 60 / std::sqrt(2.0), 0));
  CHECK(estimates.values.size() == outcomes.size());
  CHECK(*outcome(estimates, which, "jnd").value == Approx(0.67449 * 60).epsilon(0.06));
  which.series[0].levels = {400, 460, 490, 520};  // one at the standard tells
  CHECK(task_of(TaskKind::which).outcomes(which).size() == outcomes.size() + 2);
}

TEST_CASE("of two equal stimuli the plan says which is the standard, and the order effect goes by that") {
  Protocol which = shipped_task("which/maereg2017");
  which.series[0].levels = {360, 400, 440};
  which.design.trials_per_cell = 40;
  const Plan plan = make_plan(which, 1, 3);
  std::map<int, int> places;
  std::vector<AnsweredTrial> trials;
  for (const Trial& trial : plan.trials) {
    if (trial.practice) continue;
    const bool equal = trial.stimuli[0] == trial.stimuli[1];
    CHECK((trial.standard_place >= 0) == equal);
    if (equal) ++places[trial.standard_place];
    CHECK(holds_standard(trial, trial.stimuli, 0) != holds_standard(trial, trial.stimuli, 1));
    CHECK(trial.stimuli[holds_standard(trial, trial.stimuli, 0) ? 0 : 1] == 400);
    if (!equal || trial.condition != 0) continue;
    // Who always says "second": all order, no preference.
    trials.push_back({.stimuli = trial.stimuli,
                      .standard = 400,
                      .target = trial.target,
                      .said = 1,
                      .number = {},
                      .standard_place = trial.standard_place});
  }
  CHECK(places[0] == places[1]);
  const TaskCurve curve = *task_of(TaskKind::which).curve(which, which.series[0], trials);
  REQUIRE(curve.points.size() == 1);
  CHECK(2 * curve.points[0].said == curve.points[0].n);
}

TEST_CASE("which of the three is stiffer: the odd one is directed, and judged as one of three") {
  Protocol three = shipped_task("oddity/carpenter2018-oddity");
  three.task.directed = true;
  const Task& task = task_of(TaskKind::oddity);
  three.series[0].levels = {three.series[0].standard + 0.1, three.series[0].standard + 0.2};
  CHECK(task.problems(three).empty());
  CHECK(task.balance_of(three.task) == 3);
  three.design.trials_per_cell = 1998;
  const Plan plan = make_plan(three, 1, 3);
  for (const Trial& trial : plan.trials) {
    if (trial.practice) continue;
    CHECK(trial.stimuli[static_cast<std::size_t>(trial.target)] ==
          *std::max_element(trial.stimuli.begin(), trial.stimuli.end()));
  }
  const TaskEstimates estimates = task.estimate(three, three.series[0], answered(three, plan, 0.1, 0));
  CHECK(*outcome(estimates, three, "jnd").value == Approx(0.1).epsilon(0.06));
  three.task.greater = false;
  CHECK(task.problems(three).size() == 2);
}

TEST_CASE("noise that makes a JND of one is measured as one") {
  for (const char* place :
       {"which/maereg2017", "oddity/carpenter2018-oddity", "abx/abx-stiffness", "yes-no/pang1991"}) {
    CAPTURE(place);
    Protocol protocol = shipped_task(place);
    protocol.design.trials_per_cell = protocol.design.trials_per_cell * 40;
    const Task& task = task_of(protocol.task.kind);
    const double jnd = 0.5 * std::abs(protocol.series[0].levels.back() - protocol.series[0].standard);
    const double noise = jnd / task.jnd_of_noise(protocol).value();
    const TaskEstimates estimates = task.estimate(
        protocol, protocol.series[0], answered(protocol, make_plan(protocol, 1, 3), noise / std::sqrt(2.0), 0));
    CHECK(*outcome(estimates, protocol, protocol.task.kind == TaskKind::yes_no ? "threshold" : "jnd").value ==
          Approx(jnd).epsilon(0.12));
  }
  CHECK_FALSE(task_of(TaskKind::magnitude).jnd_of_noise(shipped_task("magnitude/dhong2019-magnitude")).has_value());
}

TEST_CASE("a stimulus of 0 takes no part in the power law, and an answer of 0 leaves the arithmetic mean") {
  const Protocol magnitude = shipped_task("magnitude/dhong2019-magnitude");
  const auto trial = [](double stimulus, double number) {
    return AnsweredTrial{
        .stimuli = {stimulus}, .standard = 0, .target = -1, .said = -1, .sureness = 0, .number = number};
  };
  std::vector<AnsweredTrial> trials = {trial(0, 1), trial(1, 2), trial(2, 4), trial(4, 8), trial(4, 8)};
  const Task& task = task_of(TaskKind::magnitude);
  const TaskEstimates whole = task.estimate(magnitude, magnitude.series[0], trials);
  CHECK(whole.status == "ok");
  CHECK(*outcome(whole, magnitude, "exponent").value == Approx(1));
  CHECK(*outcome(whole, magnitude, "mean_answer").value == Approx(std::pow(64, 0.25)));
  CHECK(*outcome(whole, magnitude, "arithmetic_mean").value == Approx(3.75));
  trials.push_back(trial(1, 0));
  const TaskEstimates with_none = task.estimate(magnitude, magnitude.series[0], trials);
  CHECK(with_none.status == "not_positive");
  CHECK_FALSE(outcome(with_none, magnitude, "exponent").value.has_value());
  CHECK(*outcome(with_none, magnitude, "arithmetic_mean").value == Approx(3.5));
}
