// A small protocol, a rig that delivers exactly what is asked, and a responder that follows a rule: the engine's
// outside world, under the test's control.
#pragma once

#include <atomic>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/log/event_body.h"
#include "data/log/replay.h"
#include "data/log/session_log.h"
#include "devices/clock.h"
#include "devices/responder.h"
#include "devices/rig.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/tasks/task.h"
#include "runner/session/session_engine.h"

namespace jnd::test {

// Two conditions, two series, 4 balanced trials a cell; `changes` is merged into it (RFC 7396).
inline Protocol small_protocol(const nlohmann::json& changes = {}) {
  nlohmann::json json = nlohmann::json::parse(R"({
    "format": 1, "title": "A small study", "source": {"citation": "none"},
    "rig": {"device": "rrs3", "fingers": ["thumb", "index"], "tracker": "hand", "separation_m": 0.13, "sphere_radius_m": 0.04},
    "paradigm": "same-different",
    "trial": {"explore_s": 1, "no_contact_time_out_s": 5, "gap_s": 0.5, "between_trials_s": 0.5, "answer_time_out_s": 20,
              "max_attempts": 3,
              "cues": {"first": {"kind": "sound"}, "second": {"kind": "sound"}, "question": {"kind": "sound"}},
              "keys": {"same": "s", "different": "d"}},
    "stimulus": {"quantity": "stiffness", "unit": "N/m", "reference": 900, "expected_press_m": 0.004, "on_saturation": "flag"},
    "conditions": [{"name": "S", "label": "servo", "cues": ["force"]}, {"name": "V", "label": "vibration", "cues": ["vibration"]}],
    "series": [{"name": "1", "pair": [500, 900]}, {"name": "2", "pair": [700, 900]}],
    "design": {"participants": 4, "trials_per_cell": 4, "sampling": "balanced", "conditions": "blocked",
               "order": {"series": "fixed", "conditions": "fixed"}},
    "feedback": "none",
    "analysis": {"model": "yes-no", "correction": "loglinear", "jnd": "least_squares"}
  })");
  if (!changes.is_null()) json.merge_patch(changes);
  return parse_protocol(json.dump(), "small.json");
}

// Delivers what is asked, unless `fault` says otherwise for an interval.
class IdealRig final : public Rig {
 public:
  explicit IdealRig(Clock& clock) : clock_(clock) {}
  const RigInfo& info() const noexcept override { return info_; }
  void watch(const std::function<void(const LoopSnapshot&)>& look) override { look_ = look; }
  Presentation present(const PresentRequest& request) override {
    const auto explore_ns = static_cast<std::int64_t>(request.explore_s * 1e9);
    const std::int64_t over_ns = clock_.now_ns() + explore_ns;
    for (const int quarters_left : {3, 2, 1}) {
      if (!looks || !look_) break;
      clock_.sleep_until_ns(over_ns - quarters_left * explore_ns / 4);
      const double elapsed_s = (4 - quarters_left) * request.explore_s / 4;
      look_({.ticks = std::llround(1000 * elapsed_s),
             .elapsed_s = elapsed_s,
             .lateness_max_us = 90,
             .contact = quarters_left == 2});
    }
    clock_.sleep_until_ns(over_ns);
    Presentation presentation;
    presentation.fault = fault(request);
    if (presentation.fault == Fault::emergency_stop) presentation.stopped_by = stopped_by;
    presentation.duration_s = request.explore_s;
    for (int finger = 0; finger < 2; ++finger) {
      FingerPresentation delivered;
      if (request.stimulus.cues.force) delivered.stiffness = request.stimulus.stiffness;
      if (request.stimulus.cues.vibration) delivered.vibration_g = request.stimulus.stiffness / 1500 + 0.4;
      delivered.saturated_share = saturated_share(request);
      delivered.contacts = contacts(request);
      presentation.fingers.push_back(delivered);
    }
    return presentation;
  }
  std::int64_t prepare(const PresentRequest& request) override { return ready(request); }
  void neutral() noexcept override { ++neutral_calls; }
  std::string missing() override { return missing_sealed().empty() ? "" : missing_sealed() + said; }
  std::string missing_sealed() override {
    return clock_.now_ns() < gone_until_ns ? "device RRS3-0001 is not there" : "";
  }

  std::int64_t gone_until_ns = 0;
  std::string said;  // by a program behind it, last
  std::function<Fault(const PresentRequest&)> fault = [](const PresentRequest&) { return Fault::none; };
  std::function<double(const PresentRequest&)> saturated_share = [](const PresentRequest&) { return 0.0; };
  std::function<int(const PresentRequest&)> contacts = [](const PresentRequest&) { return 0; };
  std::function<std::int64_t(const PresentRequest&)> ready = [](const PresentRequest&) { return std::int64_t{0}; };
  bool looks = false;  // tells how an interval goes on
  int neutral_calls = 0;
  std::string stopped_by;  // with an emergency stop

 private:
  Clock& clock_;
  std::function<void(const LoopSnapshot&)> look_;
  RigInfo info_{.name = "ideal", .mode = "ideal", .tracker = "none", .sha256 = "", .simulated = true};
};

// Right on odd trials, "different" on even ones, unless `rule` is replaced; asks nothing twice.
class RuleResponder final : public Responder {
 public:
  explicit RuleResponder(Clock& clock) : clock_(clock) {}
  std::optional<Answer> judge(const TrialQuestion& question) override {
    clock_.sleep_until_ns(clock_.now_ns() + 1'000'000'000);
    const std::optional<int> judgement = rule(question);
    if (!judgement) return std::nullopt;
    Answer answer{.said = *judgement, .entered_by = EnteredBy::participant, .response_time_s = 1.0};
    if (by_number) answer.number = *judgement;
    return answer;
  }
  std::optional<std::string> reply(const Question& question, int condition) override {
    asked.push_back(question.id + "/" + std::to_string(condition));
    return "5";
  }
  std::function<std::optional<int>(const TrialQuestion&)> rule = [](const TrialQuestion& question) {
    return std::optional(question.trial.index % 2 == 0 || (question.trial.target != kClassSame) ? kClassDifferent
                                                                                                : kClassSame);
  };
  std::vector<std::string> asked;
  bool by_number = false;  // what the rule says is the number that is answered

 private:
  Clock& clock_;
};

// Everything an engine needs, for one session.
struct Bench {
  explicit Bench(Protocol chosen, int participant = 1)
      : protocol(std::move(chosen)), plan(make_plan(protocol, participant, 1)) {}

  SessionEnd run(SessionView& with_view) {
    const SessionParts parts = parts_for(with_view, log);
    return SessionEngine(parts).run(replay(log.events()), steps);
  }
  SessionParts parts_for(SessionView& view, SessionLog& with_log) {
    return {protocol, plan, rig, responder, with_log, clock, view, interrupts, RecordPolicy::events, person};
  }
  SessionEnd run() {
    SessionView quiet;
    return run(quiet);
  }
  std::vector<TrialRecord> completed() const { return replay(log.events()).completed; }
  std::vector<std::string> kinds() const {
    std::vector<std::string> kinds;
    for (const Event& event : log.events()) kinds.push_back(event.kind);
    return kinds;
  }

  Protocol protocol;
  Plan plan;
  SimulatedClock clock{0};
  IdealRig rig{clock};
  RuleResponder responder{clock};
  MemoryLog log;
  Interrupts interrupts;
  std::atomic<bool>& stop = interrupts.end;
  bool person = false;  // a person feels the stimuli
  ResumeSteps steps;
};

}  // namespace jnd::test
