// Sessions answered by pedals, with an operator at the keys and everything of the engine between.
#include "data/log/event_body.h"
#include "data/log/replay.h"
#include "protocols/tasks/task.h"
#include "runner/opening/readiness_buttons.h"
#include "runner/session/session_engine.h"
#include "tests/catch.h"
#include "tests/runner/button_fixture.h"
#include "tests/runner/engine_fixture.h"

namespace jnd {
namespace {

using namespace test;

struct Session {
  Session() {
    bench.display.prompt = [this](const std::string& heading) { operate(heading); };
    bench.display.typing = [this] { go_on(); };
    rig.fault = [this](const PresentRequest&) { return present(); };
  }
  // Space and Enter in turn: a key that came a moment ago may be held down still.
  void go_on() { bench.keys.press(std::exchange(key, key == " " ? "\r" : " ")); }
  void operate(const std::string& heading) {
    if (heading.find("STOPPED (button)") == 0) {
      ++stops;
      bench.keys.press("c");
      key = "\r";  // ends the reason's line
    } else {
      go_on();
    }
  }
  Fault present() {
    if (++presented == stop_at) {
      bench.pedals(kStopPedal);
      CHECK(wait_until([this] { return rig.stop.latched(); }));
      bench.pedals(kNone);
      rig.stopped_by = to_string(rig.stop.source());
    }
    return rig.stop.latched() ? Fault::emergency_stop : Fault::none;
  }
  SessionEnd run() {
    const StopOnButton stopping(&bench.box, rig.stop);
    const SessionParts parts{protocol,
                             plan,
                             rig,
                             bench.console.responder(),
                             log,
                             bench.clock,
                             bench.console,
                             bench.interrupted,
                             RecordPolicy::events,
                             true};
    return SessionEngine(parts).run(replay(log.events()), {});
  }
  std::vector<nlohmann::json> bodies(std::string_view kind) const {
    std::vector<nlohmann::json> found;
    for (const Event& event : log.events())
      if (event.kind == kind) found.push_back(nlohmann::json::parse(event.body));
    return found;
  }

  Protocol protocol = small_protocol();
  Plan plan = make_plan(protocol, 1, 1);
  ButtonBench bench;
  IdealRig rig{bench.clock};
  MemoryLog log;
  std::string key = " ";
  int stops = 0, presented = 0, stop_at = 0;
};

TEST_CASE("A session is answered with pedals: every answer by the participant, with its response time") {
  Session session;
  int asked = 0;
  session.bench.display.question = [&] {
    session.bench.wait_ms(20);
    session.bench.pedals(++asked % 3 == 0 ? kSame : kDifferent);
    session.bench.wait_ms(40);
    session.bench.pedals(kNone);
  };
  const std::int64_t began_ns = session.bench.clock_of_machine.now_ns();
  REQUIRE(session.run() == SessionEnd::completed);
  const std::int64_t took_ns = session.bench.clock_of_machine.now_ns() - began_ns;
  const std::vector<TrialRecord> completed = replay(session.log.events()).completed;
  REQUIRE(completed.size() == 16);
  CHECK(asked == 16);
  for (std::size_t i = 0; i < completed.size(); ++i) {
    const Answer& answer = completed[i].answer;
    CHECK(answer.said == ((i + 1) % 3 == 0 ? kClassSame : kClassDifferent));
    CHECK(answer.entered_by == EnteredBy::participant);
    CHECK(answer.response_time_s >= 0.02);
    CHECK(answer.response_time_s < 1e-9 * static_cast<double>(took_ns));
  }
  CHECK(session.bodies(event_kind::kTrialVoided).empty());
}

TEST_CASE("The stop pedal during a presentation voids its trial, which comes again once the operator clears the stop") {
  Session session;
  session.stop_at = 3;  // the second trial's first interval
  session.bench.display.question = [&] {
    session.bench.pedals(kDifferent);
    session.bench.wait_ms(40);
    session.bench.pedals(kNone);
  };
  REQUIRE(session.run() == SessionEnd::completed);
  CHECK(session.stops == 1);
  const auto faults = session.bodies(event_kind::kDeviceFault);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].at("cause") == "emergency_stop");
  CHECK(faults[0].at("stopped_by") == "button");
  const auto voids = session.bodies(event_kind::kTrialVoided);
  REQUIRE(voids.size() == 1);
  CHECK(voids[0].at("reason") == "emergency_stop");
  CHECK(session.bodies(event_kind::kStopCleared).size() == 1);
  CHECK(replay(session.log.events()).completed.size() == 16);
}

TEST_CASE("The stop pedal at the question voids the trial too") {
  Session session;
  int asked = 0;
  session.bench.display.question = [&] {
    session.bench.pedals(++asked == 4 ? kStopPedal : kSame);
    session.bench.wait_ms(40);
    session.bench.pedals(kNone);
  };
  REQUIRE(session.run() == SessionEnd::completed);
  CHECK(session.stops == 1);
  CHECK(asked == 17);
  const auto voids = session.bodies(event_kind::kTrialVoided);
  REQUIRE(voids.size() == 1);
  CHECK(voids[0].at("reason") == "emergency_stop");
  CHECK(session.bodies(event_kind::kStopCleared).size() == 1);
}

TEST_CASE("Readiness names the box that answers, and is bad where it has gone") {
  ButtonBench bench;
  const Check fine = check_buttons(bench.box);
  CHECK(fine.what == "buttons");
  CHECK(fine.verdict == Verdict::ok);
  CHECK(fine.found.find("Foot pedal (05f3:00ff), same, different and stop") != std::string::npos);
  bench.bus.unplug();
  CHECK(wait_until([&] { return !bench.box.there(); }));
  const Check gone = check_buttons(bench.box);
  CHECK(gone.verdict == Verdict::bad);
  CHECK_FALSE(gone.what_to_do.empty());
}

}  // namespace
}  // namespace jnd
