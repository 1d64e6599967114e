// Free interaction: every object in every condition for its time, whatever interrupts it.
#include <functional>
#include <map>
#include <set>

#include "data/log/exploration_body.h"
#include "data/log/storage_error.h"
#include "protocols/condition_words.h"
#include "runner/session/exploration_block.h"
#include "runner/session/session_engine.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"

namespace jnd {
namespace {

using nlohmann::json;
using test::Bench;

// Two conditions, two objects of 20 s each; the second condition has no devices.
Protocol exploring(const json& changes = {}) {
  json whole = json::parse(R"({
    "format": 1, "title": "Free interaction", "source": {"citation": "none"},
    "rig": {"device": "rrs3", "fingers": ["thumb", "index"], "tracker": "hand", "separation_m": 0.13},
    "paradigm": "explore", "explore": {"duration_s": 40, "objects": ["baseball", "teddy-bear"]},
    "stimulus": {"quantity": "stiffness", "unit": "N/m", "reference": 900, "expected_press_m": 0.004},
    "conditions": [{"name": "C", "label": "devices", "cues": ["force"]}, {"name": "N", "label": "hands", "devices": false}],
    "design": {"participants": 4, "order": {"conditions": "fixed"}},
    "questions": [
      {"id": "Q1", "when": "after-condition", "kind": "rating", "text": "Easy", "min": 1, "max": 9, "low": "no", "high": "yes"},
      {"id": "Q2", "when": "after-session", "kind": "rating", "text": "Useful", "min": 1, "max": 9, "low": "no", "high": "yes"}],
    "analysis": {}
  })");
  if (!changes.is_null()) whole.merge_patch(changes);
  return parse_protocol(whole.dump(), "exploring.json");
}

// An operator who follows a script: by the n-th asking, from 1.
class ScriptedVisit final : public SessionView {
 public:
  OperatorRequest ready_to_explore(const ExplorationOutline& outline) override {
    outlines.push_back(outline);
    return at(before, static_cast<int>(outlines.size()));
  }
  bool exploring(double left_s) override {
    left.push_back(left_s);
    return !during.contains(static_cast<int>(left.size()));
  }
  OperatorRequest meanwhile() override { return at(during, static_cast<int>(left.size())); }
  OperatorRequest paused(const std::string&) override { return in_pause; }
  OperatorRequest recover(const std::string& stopped_by) override {
    stops.push_back(stopped_by);
    return in_recovery;
  }

  std::map<int, OperatorRequest> before, during;
  OperatorRequest in_pause{Request::go_on, {}}, in_recovery{Request::go_on, "all well"};
  std::vector<ExplorationOutline> outlines;
  std::vector<double> left;
  std::vector<std::string> stops;

 private:
  static OperatorRequest at(const std::map<int, OperatorRequest>& script, int asking) {
    const auto found = script.find(asking);
    return found == script.end() ? OperatorRequest{} : found->second;
  }
};

std::vector<json> bodies(const SessionLog& log, std::string_view kind) {
  std::vector<json> found;
  for (const Event& event : log.events())
    if (event.kind == kind) found.push_back(json::parse(event.body));
  return found;
}

// Every slot once, with its whole time; every question once.
void check_whole(const SessionLog& log) {
  std::set<int> slots;
  for (const json& body : bodies(log, event_kind::kExploration)) {
    CHECK(slots.insert(body.at("index").get<int>()).second);
    CHECK(body.at("duration_s").get<double>() == Approx(20));
  }
  CHECK(slots == std::set<int>{1, 2, 3, 4});
  CHECK(bodies(log, event_kind::kQuestionAnswered).size() == 3);
}

TEST_CASE("Every object is explored in every condition for its time, then come the condition's questions") {
  Bench bench(exploring());
  std::vector<PresentRequest> requests;
  bench.rig.fault = [&](const PresentRequest& request) {
    requests.push_back(request);
    return Fault::none;
  };
  ScriptedVisit view;
  REQUIRE(bench.run(view) == SessionEnd::completed);
  check_whole(bench.log);
  CHECK(bench.kinds() == std::vector<std::string>{"exploration.completed", "exploration.completed",
                                                  "questionnaire.answered", "exploration.completed",
                                                  "exploration.completed", "questionnaire.answered",
                                                  "questionnaire.answered"});
  CHECK(bench.responder.asked == std::vector<std::string>{"Q1/0", "Q1/1", "Q2/-1"});
  // With devices 10 s at a time; nothing is rendered for bare hands.
  REQUIRE(requests.size() == 4);
  const std::vector<json> done = bodies(bench.log, event_kind::kExploration);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    CHECK(requests[i].object == done[i / 2].at("object").get<std::string>());
    CHECK(requests[i].explore_s == Approx(10));
    CHECK(requests[i].id.interval == static_cast<int>(i % 2));
    CHECK(requests[i].stimulus.stiffness == 900);
    CHECK(requests[i].stimulus.cues.force);
  }
  CHECK(done[0].at("presentations").size() == 2);
  CHECK(done[0].at("devices") == true);
  CHECK(done[2].at("presentations").empty());
  CHECK(done[2].at("devices") == false);
  // The operator sees letters, never names.
  REQUIRE(view.outlines.size() == 4);
  CHECK(view.outlines[0].condition_code == condition_codes(bench.protocol, 1)[0]);
  CHECK(view.outlines[0].total == 4);
  CHECK(view.outlines[3].devices == false);
  CHECK(view.left.back() == Approx(0).margin(1e-6));
}

TEST_CASE("Leaving the object alone is no fault") {
  Bench bench(exploring());
  bench.rig.fault = [](const PresentRequest&) { return Fault::no_contact; };
  REQUIRE(bench.run() == SessionEnd::completed);
  check_whole(bench.log);
  CHECK(bodies(bench.log, event_kind::kExplorationVoided).empty());
}

TEST_CASE("An exploration that a fault ends comes again from its beginning") {
  Bench bench(exploring());
  bench.rig.fault = [](const PresentRequest& request) {
    return request.id.trial == 1 && request.id.attempt == 1 && request.id.interval == 1 ? Fault::device_lost
                                                                                        : Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  check_whole(bench.log);
  const std::vector<json> voided = bodies(bench.log, event_kind::kExplorationVoided);
  REQUIRE(voided.size() == 1);
  CHECK(voided[0].at("reason") == "device_lost");
  CHECK(voided[0].at("will_repeat") == true);
  CHECK(voided[0].at("last_presentation").at("fault") == "device_lost");
  CHECK(bodies(bench.log, event_kind::kExploration)[0].at("attempt") == 2);
}

TEST_CASE("What went missing is waited for before the next object is announced") {
  Bench bench(exploring());
  bench.rig.fault = [&](const PresentRequest& request) {
    if (request.id.trial != 1 || request.id.attempt != 1) return Fault::none;
    bench.rig.gone_until_ns = bench.clock.now_ns() + 5'000'000'000;
    return Fault::device_lost;
  };
  class Announced final : public SessionView {
   public:
    explicit Announced(Bench& bench) : bench_(bench) {}
    OperatorRequest ready_to_explore(const ExplorationOutline&) override {
      ++announced;
      if (!bench_.rig.missing().empty()) ++too_soon;
      return {};
    }
    int announced = 0, too_soon = 0;

   private:
    Bench& bench_;
  } view(bench);
  REQUIRE(bench.run(view) == SessionEnd::completed);
  check_whole(bench.log);
  CHECK(view.announced == 5);  // four objects, one of them twice
  CHECK(view.too_soon == 0);
}

TEST_CASE("Attempts that are used up give the exploration up, and the session goes on") {
  Bench bench(exploring());
  bench.rig.fault = [](const PresentRequest& request) {
    return request.id.trial == 2 ? Fault::stale_pose : Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  const std::vector<json> voided = bodies(bench.log, event_kind::kExplorationVoided);
  REQUIRE(static_cast<int>(voided.size()) == bench.protocol.timeline.max_attempts);
  CHECK(voided.back().at("will_repeat") == false);
  CHECK(bodies(bench.log, event_kind::kExploration).size() == 3);
  CHECK(bodies(bench.log, event_kind::kQuestionAnswered).size() == 3);
  REQUIRE(bench.run() == SessionEnd::completed);  // a session that goes on does not try again
  CHECK(bodies(bench.log, event_kind::kExplorationVoided).size() == voided.size());
}

TEST_CASE("After an emergency stop only the operator's word goes on") {
  Bench bench(exploring());
  bench.person = true;
  bench.rig.stopped_by = "key";
  bench.rig.fault = [](const PresentRequest& request) {
    return request.id.trial == 1 && request.id.attempt == 1 ? Fault::emergency_stop : Fault::none;
  };
  ScriptedVisit view;
  view.in_recovery = {Request::end_for_now, "call the engineer"};
  REQUIRE(bench.run(view) == SessionEnd::interrupted);
  CHECK(view.stops == std::vector<std::string>{"key"});
  CHECK(bodies(bench.log, event_kind::kExplorationVoided).size() == 1);
  CHECK(bodies(bench.log, event_kind::kStopCleared).empty());
  ScriptedVisit next;
  REQUIRE(bench.run(next) == SessionEnd::completed);
  CHECK(next.outlines[0].attempt == 2);
  check_whole(bench.log);
}

TEST_CASE("A stop before an exploration is cleared first, and uses no attempt up") {
  Bench bench(exploring());
  bench.person = true;
  class Pressing final : public SessionView {
   public:
    explicit Pressing(Bench& bench) : bench_(bench) {}
    OperatorRequest ready_to_explore(const ExplorationOutline&) override {
      if (++asked_ <= 3) bench_.rig.stop.latch(StopSource::key);
      return {};
    }
    OperatorRequest recover(const std::string& stopped_by) override {
      stops.push_back(stopped_by);
      return {Request::go_on, "all well"};
    }
    std::vector<std::string> stops;

   private:
    Bench& bench_;
    int asked_ = 0;
  } view(bench);
  bench.rig.fault = [&](const PresentRequest&) {
    return bench.rig.stop.latched() ? Fault::emergency_stop : Fault::none;
  };
  REQUIRE(bench.run(view) == SessionEnd::completed);
  CHECK(view.stops == std::vector<std::string>{"key", "key", "key"});
  CHECK(replay(bench.log.events()).explored.size() == 4);
  for (const Event& event : bench.log.events()) CHECK(event.kind != event_kind::kExplorationVoided);
}

TEST_CASE("The stop key counts with bare hands too") {
  Bench bench(exploring());
  ScriptedVisit view;
  view.before[3] = {Request::note, "bare hands now"};
  bool latched = false;
  bench.rig.fault = [](const PresentRequest&) { return Fault::none; };
  struct Stopping final : public SessionView {
    Stopping(Bench& with, bool& was) : bench(with), latched(was) {}
    bool exploring(double left_s) override {
      if (!latched && bench.rig.stop.source() == StopSource::none && left_s < 15 && devices_over) {
        latched = true;
        bench.rig.stop.latch(StopSource::key);
      }
      return true;
    }
    OperatorRequest ready_to_explore(const ExplorationOutline& outline) override {
      devices_over = !outline.devices;
      return {};
    }
    OperatorRequest recover(const std::string& by) override {
      stopped_by = by;
      return {Request::go_on, "fine again"};
    }
    Bench& bench;
    bool& latched;
    bool devices_over = false;
    std::string stopped_by;
  } stopping(bench, latched);
  REQUIRE(bench.run(stopping) == SessionEnd::completed);
  CHECK(stopping.stopped_by == "key");
  CHECK(bodies(bench.log, event_kind::kStopCleared)[0].at("reason") == "fine again");
  CHECK(bodies(bench.log, event_kind::kExplorationVoided)[0].at("reason") == "emergency_stop");
  check_whole(bench.log);
}

TEST_CASE("A pause takes nothing from the time") {
  Bench bench(exploring());
  bench.person = true;
  ScriptedVisit view;
  view.during[1] = {Request::pause, "drinks water"};
  view.during[40] = {Request::pause, "again"};  // bare hands
  REQUIRE(bench.run(view) == SessionEnd::completed);
  check_whole(bench.log);
  CHECK(bodies(bench.log, event_kind::kPaused).size() == 2);
  CHECK(bodies(bench.log, event_kind::kPaused)[0].at("reason") == "drinks water");
  CHECK(bodies(bench.log, event_kind::kExplorationVoided).empty());
}

TEST_CASE("What the operator repeats or ends is logged with the reason") {
  Bench bench(exploring());
  bench.person = true;
  ScriptedVisit view;
  view.during[1] = {Request::repeat_trial, "strap slipped"};
  view.during[2] = {Request::end_block, "has had enough"};  // of the second attempt, after one piece
  REQUIRE(bench.run(view) == SessionEnd::completed);
  const std::vector<json> voided = bodies(bench.log, event_kind::kExplorationVoided);
  REQUIRE(voided.size() == 1);
  CHECK(voided[0].at("reason") == "repeated");
  CHECK(voided[0].at("words") == "strap slipped");
  const std::vector<json> done = bodies(bench.log, event_kind::kExploration);
  REQUIRE(done.size() == 4);
  CHECK(done[0].at("ended_early") == true);
  CHECK(done[0].at("words") == "has had enough");
  CHECK(done[0].at("duration_s").get<double>() == Approx(10));
}

TEST_CASE("A block that the operator gives up is not explored, its questions come all the same") {
  Bench bench(exploring());
  bench.person = true;
  ScriptedVisit view;
  view.before[2] = {Request::end_block, "device broken"};
  REQUIRE(bench.run(view) == SessionEnd::completed);
  CHECK(bodies(bench.log, event_kind::kBlockEnded)[0].at("reason") == "device broken");
  CHECK(bodies(bench.log, event_kind::kExploration).size() == 3);
  CHECK(bodies(bench.log, event_kind::kExplorationVoided)[0].at("will_repeat") == false);
  CHECK(bodies(bench.log, event_kind::kQuestionAnswered).size() == 3);
}

TEST_CASE("An end in the middle voids what was felt, without using up an attempt") {
  Bench bench(exploring());
  bench.person = true;
  for (int times = 1; times <= 5; ++times) {
    ScriptedVisit view;
    view.during[1] = {Request::end_for_now, "later"};
    REQUIRE(bench.run(view) == SessionEnd::interrupted);
    CHECK(view.outlines[0].attempt == times);
  }
  ScriptedVisit view;
  REQUIRE(bench.run(view) == SessionEnd::completed);
  CHECK(view.outlines[0].attempt == 6);
  for (const json& body : bodies(bench.log, event_kind::kExplorationVoided)) CHECK(body.at("reason") == "interrupted");
  check_whole(bench.log);
}

// Dies after so many events.
class MortalLog final : public SessionLog {
 public:
  MortalLog(SessionLog& log, int life) : log_(log), life_(life) {}
  void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override {
    if (life_-- <= 0) throw StorageError("killed");
    log_.append(kind, body, stamp);
  }
  void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp,
              const std::vector<TelemetryBlob>& telemetry) override {
    if (life_-- <= 0) throw StorageError("killed");
    log_.append(kind, body, stamp, telemetry);
  }
  std::vector<Event> events() const override { return log_.events(); }

 private:
  SessionLog& log_;
  int life_;
};

TEST_CASE("Killed at any event, a session goes on, and loses and repeats nothing") {
  for (const bool person : {false, true}) {
    Bench whole(exploring());
    whole.person = person;
    REQUIRE(whole.run() == SessionEnd::completed);
    for (int life = 0;; ++life) {
      Bench bench(exploring());
      bench.person = person;
      MortalLog mortal(bench.log, life);
      ScriptedVisit view;
      const SessionParts parts = bench.parts_for(view, mortal);
      try {
        const SessionEnd end = SessionEngine(parts).run(replay(mortal.events()));
        CHECK(end == SessionEnd::completed);
        CHECK(life == static_cast<int>(whole.log.events().size()));  // each was one to die at
        break;
      } catch (const StorageError&) {
      }
      REQUIRE(bench.run() == SessionEnd::completed);
      check_whole(bench.log);
      const std::vector<json> voided = bodies(bench.log, event_kind::kExplorationVoided);
      for (const json& body : voided) {
        CHECK(body.at("reason") == "interrupted");
        CHECK(body.at("counts") == false);
      }
      // Without a person the log is the one of an undisturbed session.
      if (!person) CHECK(bench.kinds() == whole.kinds());
    }
  }
}

TEST_CASE("A signal ends the session where it stands") {
  Bench bench(exploring());
  bench.person = true;
  bench.rig.fault = [&](const PresentRequest& request) {
    if (request.id.trial == 1 && request.id.attempt == 1) bench.interrupts.end = true;
    return Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::interrupted);
  CHECK(bodies(bench.log, event_kind::kExplorationVoided)[0].at("reason") == "interrupted");
  bench.interrupts.end = false;
  REQUIRE(bench.run() == SessionEnd::completed);
  check_whole(bench.log);
}

}  // namespace
}  // namespace jnd
