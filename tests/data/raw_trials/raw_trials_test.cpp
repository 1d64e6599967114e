// What figures of single trials are made of: every answer in its order, and force against depth of a few trials.
#include "data/log/event_body.h"
#include "data/log/telemetry.h"
#include "data/raw_trials/answer_raster.h"
#include "data/raw_trials/press_traces.h"
#include "data/results/attendance.h"
#include "protocols/planning/plan.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

CountedTrial counted(int session, int condition, int said, int target, double response_time_s = 1) {
  CountedTrial trial;
  trial.session = session;
  trial.condition = condition;
  trial.said = said;
  trial.target = target;
  trial.response_time_s = response_time_s;
  return trial;
}

SessionInfo session_of(const std::string& participant, int number) {
  SessionInfo info;
  info.participant = participant;
  info.number = number;
  info.id = participant + std::to_string(number);
  return info;
}

TEST_CASE("answers stand by participant, in the order of their sessions, also where those ran side by side", "[data]") {
  Protocol protocol;
  protocol.analysis.exclude.response_time_below_s = 0.2;
  const std::vector<SessionInfo> sessions = {session_of("P01", 1), session_of("P01", 2), session_of("P02", 1),
                                             session_of("P03", 1)};
  const std::vector<CountedTrial> trials = {counted(2, 0, 1, 1), counted(0, 0, 1, 0), counted(1, 1, 0, 0),
                                            counted(0, 2, 0, 0, 0.1), counted(2, 1, -1, -1)};
  const std::vector<AnswersOf> raster = answer_raster(protocol, sessions, trials);
  REQUIRE(raster.size() == 3);
  CHECK(raster[0].participant == "P01");
  REQUIRE(raster[0].answers.size() == 3);
  CHECK(raster[0].sessions_end == std::vector<std::size_t>{2, 3});
  CHECK_FALSE(raster[0].answers[0].correct());
  CHECK(raster[0].answers[1].excluded);  // too fast
  CHECK(raster[0].answers[1].condition == 2);
  CHECK(raster[0].answers[2].correct());
  CHECK(raster[1].answers[0].correct());
  CHECK_FALSE(raster[1].answers[1].judged());  // a number, or a trial without a correct answer
  CHECK(raster[2].answers.empty());
}

// A press of 10 ms at a stiffness, out of the object at its ends.
Telemetry press(double stiffness) {
  Telemetry telemetry;
  telemetry.channels = {{0, Channel::cutaneous}, {1, Channel::cutaneous}};
  for (int i = 0; i <= 40; ++i)
    for (int channel = 0; channel < 2; ++channel) {
      TickRecord tick;
      tick.time_ns = 1'000'000 * i;
      tick.channel = channel;
      tick.penetration = 1e-4 * i * (channel + 1);
      tick.asked_n = stiffness * tick.penetration;
      tick.measured_n = 0.9 * tick.asked_n;
      telemetry.ticks.push_back(tick);
    }
  return telemetry;
}

void answer_with_ticks(SessionLog& log, const Protocol& protocol, const Trial& trial, std::int64_t at) {
  TrialRecord record;
  record.trial = trial;
  record.condition_name = protocol.conditions[static_cast<std::size_t>(trial.condition)].name;
  record.series_name = protocol.series[static_cast<std::size_t>(trial.series)].name;
  record.presentations.resize(2);
  FingerPresentation finger;
  finger.stiffness = 0.9 * trial.stimuli[0];
  finger.saturated_share = 0.25;
  record.presentations[0].fingers = {finger};
  const std::vector<TelemetryBlob> blobs = {encode_telemetry(0, press(trial.stimuli[0])),
                                            encode_telemetry(1, press(trial.stimuli[1]))};
  nlohmann::ordered_json body = to_body(record);
  body["telemetry"] = telemetry_body(blobs);
  log.append(event_kind::kTrialCompleted, body, {at, at}, blobs);
}

TEST_CASE("force against depth is read of one trial of each condition, of different objects where there is one",
          "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "s.sqlite");
  const Protocol protocol = tutorial();
  study->open_session(new_session(1));  // kept nothing
  const std::vector<Trial> trials = make_plan(protocol, 2, kSeed).trials;
  std::vector<int> first(protocol.conditions.size(), 0);
  {
    const auto log = study->open_session(new_session(2));
    std::int64_t at = 10;
    for (const Trial& trial : trials) {
      answer_with_ticks(*log, protocol, trial, ++at);
      int& of_condition = first[static_cast<std::size_t>(trial.condition)];
      if (of_condition == 0 && !trial.practice && trial.stimuli[0] != trial.stimuli[1]) of_condition = trial.index;
    }
  }
  const std::vector<PressedTrial> pressed =
      pressed_trials(*study, protocol, sessions_of(*study, SessionKind::simulated));
  REQUIRE(pressed.size() == protocol.conditions.size());
  for (std::size_t i = 0; i < pressed.size(); ++i) {
    CHECK(pressed[i].participant == "P02");
    CHECK(pressed[i].condition == static_cast<int>(i));
    CHECK(pressed[i].trial == first[i]);
    REQUIRE(pressed[i].intervals.size() == 2);
    const PressTrace& trace = pressed[i].intervals[0];
    CHECK(trace.delivered == 0.9 * trace.stimulus);
    CHECK(trace.limited);
    CHECK_FALSE(pressed[i].intervals[1].delivered.has_value());
    CHECK(pressed[i].intervals[1].stimulus != trace.stimulus);
    REQUIRE(trace.points.size() == 9);  // of the first device, every 5 ms
    CHECK(trace.points[8].depth == 1e-4 * 40);
    CHECK(trace.points[8].measured_n == 0.9 * (trace.stimulus * (1e-4 * 40)));
  }
  // One that is asked for.
  const std::vector<SessionInfo> sessions = sessions_of(*study, SessionKind::simulated);
  const std::optional<PressedTrial> chosen = pressed_trial(*study, protocol, sessions, "P02", pressed[0].trial + 1);
  REQUIRE(chosen);
  CHECK(chosen->trial == pressed[0].trial + 1);
  CHECK(chosen->intervals.size() == 2);
  CHECK_FALSE(pressed_trial(*study, protocol, sessions, "P02", 10'000));
  CHECK_FALSE(pressed_trial(*study, protocol, sessions, "P01", pressed[0].trial));
  // None that a rule leaves out: here all of them.
  Protocol strict = protocol;
  strict.analysis.exclude.saturated_share_above = 0.1;
  CHECK(pressed_trials(*study, strict, sessions).empty());
  // Without ticks there is nothing.
  const auto bare = new_study(folder / "bare.sqlite");
  bare->open_session(new_session(1));
  CHECK(pressed_trials(*bare, protocol, sessions_of(*bare, SessionKind::simulated)).empty());
}

}  // namespace
}  // namespace jnd
