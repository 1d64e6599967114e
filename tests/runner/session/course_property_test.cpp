// The course of a session, held against itself: whatever happens in a session, the one that runs and a replay of its
// log stand at the same place after every event, and jnd verify, which tells the course a second time, finds nothing.
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <rapidcheck.h>

#include "data/log/replay.h"
#include "data/log/storage_error.h"
#include "data/study/study.h"
#include "data/verify/verify.h"
#include "data/verify/verify_deep.h"
#include "protocols/tasks/task.h"
#include "runner/session/session_engine.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"
#include "tests/temporary_folder.h"

namespace jnd {
namespace {

using nlohmann::json;
using test::IdealRig;
using test::RuleResponder;

// Draws of one example. They run out, and then nothing is out of the ordinary: so every history comes to an end.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : engine_(seed) {}
  int below(int n) { return left_-- > 0 ? static_cast<int>(engine_() % static_cast<unsigned>(n)) : 0; }
  bool one_in(int n) { return below(n) == n - 1; }

 private:
  std::mt19937_64 engine_;
  int left_ = 1500;
};

json rating(const std::string& id, const char* when, bool per_condition = false) {
  json question = {{"id", id}, {"when", when}, {"kind", "rating"}, {"text", "How?"},
                   {"min", 1}, {"max", 9},     {"low", "no"},      {"high", "yes"}};
  if (per_condition) question["per_condition"] = true;
  return question;
}

// What is common to trials and free interaction: checklist, instructions, consent, questions.
void add_people(Chance& chance, bool blocked, bool practice, bool explore, json& changes) {
  json& questions = changes["questions"] = json::array();
  if (chance.below(2) == 1) questions.push_back(rating("Q1", "before-session"));
  if (blocked && chance.below(2) == 1) questions.push_back(rating("Q2", "after-condition"));
  if (!explore && chance.below(2) == 1) questions.push_back(rating("Q3", "after-series"));
  if (chance.below(2) == 1) questions.push_back(rating("Q4", "after-session", chance.below(2) == 1));
  if (chance.below(2) == 1) questions.push_back(rating("Q5", "after-session"));
  if (chance.below(3) == 1) {
    changes["checklist"] = {{{"id", "mask"}, {"kind", "number"}, {"text", "Noise"}, {"min", 0}, {"max", 9}},
                            {{"id", "seat"}, {"kind", "text"}, {"text", "Seat"}}};
  }
  if (chance.below(3) == 1) changes["consent"] = "I agree.";
  json& pages = changes["instructions"] = json::array();
  if (chance.below(2) == 1) pages.push_back({{"id", "I1"}, {"when", "before-session"}, {"text", "Sit."}});
  if (practice && chance.below(2) == 1) pages.push_back({{"id", "I2"}, {"when", "before-practice"}, {"text", "Try."}});
  if (chance.below(2) == 1) pages.push_back({{"id", "I3"}, {"when", "before-main"}, {"text", "Go."}});
}

Protocol exploring_protocol(Chance& chance) {
  json whole = json::parse(R"({
    "format": 1, "title": "Free interaction", "source": {"citation": "none"},
    "rig": {"device": "rrs3", "fingers": ["thumb", "index"], "tracker": "hand", "separation_m": 0.13},
    "paradigm": "explore", "explore": {"duration_s": 40, "objects": ["baseball", "teddy-bear"]},
    "stimulus": {"quantity": "stiffness", "unit": "N/m", "reference": 900, "expected_press_m": 0.004},
    "conditions": [{"name": "C", "label": "devices", "cues": ["force"]}, {"name": "N", "label": "hands", "devices": false}],
    "design": {"participants": 4, "order": {"conditions": "random"}}, "analysis": {}})");
  if (chance.below(2) == 1) whole["breaks"] = {{{"after", "block"}, {"duration_s", 5}}};
  add_people(chance, true, false, true, whole);
  return parse_protocol(whole.dump(), "exploring.json");
}

Protocol random_protocol(Chance& chance) {
  if (chance.below(5) == 1) return exploring_protocol(chance);
  json changes = {{"trial", {{"max_attempts", 3 - chance.below(3)}}}};
  const bool adaptive = chance.below(4) == 1, mixed = chance.below(4) == 1;
  if (adaptive) {
    changes["series"] = nullptr;
    changes["design"] = json::parse(R"({"trials_per_cell": null, "sampling": null,
      "procedure": {"kind": "staircase", "starts": [500, 100], "clamp": [20, 800], "up": 1, "down": 1, "step_up": 80,
                    "step_down": 80, "averaged_reversals": 2, "stop": {"reversals": 2, "at_most": 4}, "catch_share": 0.5}})");
  } else if (chance.below(3) == 1) {
    changes["design"] = {{"sampling", "random"}, {"trials_per_cell", 2 + chance.below(3)}};
  }
  changes["design"]["conditions"] = mixed ? "mixed" : "blocked";
  if (!mixed) changes["design"]["order"]["conditions"] = "random";
  const bool practice = chance.below(3) == 1;
  if (practice) {
    changes["practice"] = {{"trials", 2 + chance.below(3)},
                           {"criterion_correct", 0.5 * chance.below(3)},
                           {"max_rounds", 1 + chance.below(3)}};
    if (adaptive)
      changes["practice"]["difference"] = 400;
    else
      changes["practice"]["series"] = "1";
  }
  json& breaks = changes["breaks"] = json::array();
  for (int i = 0; i < 2; ++i) {
    const int after = chance.below(4);
    if (after == 0) continue;
    breaks.push_back({{"after", std::array{"block", "series", "trials"}.at(static_cast<std::size_t>(after - 1))},
                      {"duration_s", 5}});
    if (after == 3) breaks.back()["trials"] = 1 + chance.below(5);
  }
  if (chance.below(3) == 1) changes["stimulus"]["on_saturation"] = "repeat";
  if (chance.below(2) == 1) changes["feedback"] = "correctness";
  add_people(chance, !mixed, practice, false, changes);
  return test::small_protocol(changes);
}

// The program dies: at an event, before or after it is on the disk.
struct Killed {};

// Where a running session stands, compared with what its log says.
std::string difference(const SessionState& a, const SessionState& b) {
  const auto same_answers = [](const TrialRecord& one, const TrialRecord& other) {
    return one.trial == other.trial && one.attempt == other.attempt && one.condition_name == other.condition_name &&
           one.series_name == other.series_name && one.answer.said == other.answer.said &&
           one.answer.entered_by == other.answer.entered_by && one.duration_s == other.duration_s &&
           one.answer.response_time_s == other.answer.response_time_s;
  };
  if (!std::equal(a.completed.begin(), a.completed.end(), b.completed.begin(), b.completed.end(), same_answers))
    return "answers";
  if (a.attempts != b.attempts) return "attempts";
  if (a.voided != b.voided) return "attempts used";
  if (a.abandoned != b.abandoned) return "trials given up";
  if (a.void_order != b.void_order) return "order of voided trials";
  if (a.pending != b.pending) return "trial under way";
  if (a.practice_ended != b.practice_ended || a.practice_due != b.practice_due) return "practice";
  if (a.redo_due != b.redo_due) return "block to be redone";
  if (a.taken_back != b.taken_back) return "answer taken back";
  if (a.checked != b.checked) return "checklist";
  if (a.answered != b.answered) return "questions";
  if (a.instructed != b.instructed || a.consented != b.consented) return "instructions or consent";
  if (a.breaks_after != b.breaks_after) return "breaks";
  if (a.explored != b.explored || a.exploration != b.exploration) return "free interaction";
  if (a.ended_for_good != b.ended_for_good) return "its end";
  return "";
}

// One session, over as many starts of the program as it takes.
class Story {
 public:
  explicit Story(std::uint64_t seed)
      : chance_(seed),
        protocol_(random_protocol(chance_)),
        participant_(1 + chance_.below(6)),
        plan_(make_plan(protocol_, participant_, kStudySeed)),
        person_(!chance_.one_in(4)) {}

  // Throws std::logic_error where engine and replay differ.
  void play() {
    log_.append(event_kind::kSessionOpened, {{"participant", "P01"}}, now());
    follow();
    for (bool first = true; !over_; first = false) {
      ResumeSteps steps;
      if (!first) {
        clock_.sleep_until_ns(clock_.now_ns() + 60'000'000'000);
        if (person_) steps = {chance_.one_in(3), chance_.one_in(3)};
        if (protocol_.task.kind == TaskKind::explore) steps.redo_block = false;
        log_.append(event_kind::kSessionResumed,
                    {{"cause", "killed"}, {"practice_again", steps.practice_again}, {"redo_block", steps.redo_block}},
                    now());
        follow();
      }
      sit(steps);
    }
  }

  // What verify and verify --deep say of the study that holds this session; empty: nothing.
  std::string problems_of_study() {
    const TemporaryFolder folder;
    const auto study = Study::create(folder / "study.sqlite", protocol_.name, protocol_.bytes, kStudySeed,
                                     {1'700'000'000'000'000'000, 1});
    NewSession session;
    session.id = "P01-simulated";
    session.participant = "P01";
    session.participant_number = participant_;
    session.responder = person_ ? "keyboard" : "profile test";
    session.rig = "rrs3";
    session.trials_total = main_trial_count(plan_);
    session.stamp = {1'700'000'000'000'000'001, 1};
    const auto log = study->open_session(session);
    for (const Event& event : log_.events())
      if (event.kind != event_kind::kSessionOpened)
        log->append(event.kind, nlohmann::ordered_json::parse(event.body), event.stamp);
    study->close_session(session.id, {clock_.utc_ns(), clock_.now_ns() + 1});
    for (const Problem& problem : verify(*study).problems) return problem.text;
    for (const Problem& problem : verify_deep(*study).problems) return problem.text;
    return "";
  }

  // The log, a word an event, for a counterexample.
  std::string told() const {
    std::string text;
    for (const Event& event : log_.events()) {
      const json body = json::parse(event.body);
      text += event.kind;
      for (const char* key : {"index", "attempt", "reason", "after_trial", "question", "trials"})
        if (body.contains(key)) text += " " + body.at(key).dump();
      text += "\n";
    }
    return text;
  }
  const Protocol& protocol() const { return protocol_; }
  bool completed() const { return completed_; }
  int kills() const { return kills_; }

 private:
  static constexpr std::uint64_t kStudySeed = 7;

  // Dies, or is full for a while, as it comes; compares what runs with what is written at every event.
  class Watched final : public SessionLog {
   public:
    explicit Watched(Story& story) : story_(story) {}
    void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override {
      // After trouble with the disk a pause is logged before the engine follows what had to wait.
      if (kind != event_kind::kPaused && kind != event_kind::kContinued) story_.compare();
      const int fate = story_.chance_.below(60);
      if (fate == 59) throw Killed{};
      if (fate == 58) throw StorageTrouble("the disk is full");
      story_.log_.append(kind, body, stamp);
      story_.follow();
      if (fate == 57) throw Killed{};
    }
    std::vector<Event> events() const override { return story_.log_.events(); }

   private:
    Story& story_;
  };

  // Asks for anything at any time.
  class Erratic final : public SessionView {
   public:
    explicit Erratic(Story& story) : story_(story) {}
    OperatorRequest ready(const TrialOutline&) override {
      story_.compare();
      return before(story_.chance_.below(40));
    }
    OperatorRequest ready_to_explore(const ExplorationOutline&) override {
      story_.compare();
      return before(story_.chance_.below(40));
    }
    OperatorRequest meanwhile() override {
      const int draw = story_.chance_.below(30);
      if (draw == 29) return {Request::repeat_trial, "not felt"};
      if (draw == 28) return {Request::end_for_now, ""};
      if (draw == 27) return {Request::note, "a noise"};
      if (draw == 26 && exploring_) return {Request::end_block, "enough"};
      return {};
    }
    OperatorRequest paused(const std::string&) override {
      story_.interrupts_.pause = false;
      return story_.chance_.one_in(6) ? OperatorRequest{Request::end_for_now, ""} : OperatorRequest{};
    }
    OperatorRequest recover(const std::string&) override { return {Request::go_on, "looked at it"}; }
    bool storage_trouble(const std::string&) override { return true; }
    bool exploring(double) override {
      exploring_ = story_.chance_.one_in(30);
      return !exploring_;
    }
    std::optional<bool> consent(const std::string&) override { return !story_.chance_.one_in(20); }

   private:
    OperatorRequest before(int draw) const {
      if (!story_.person_) return {};
      if (draw == 39) return {Request::void_last, "a slip"};
      if (draw == 38) return {Request::end_for_now, ""};
      if (draw == 37) return {Request::take_break, "tired"};
      if (draw == 36) return {Request::end_block, "tired"};
      if (draw == 35) return {Request::pause, ""};
      if (draw == 34) return {Request::note, "a note"};
      if (draw == 33) return {Request::void_last, "another slip"};
      return {};
    }
    Story& story_;
    bool exploring_ = false;
  };

  Stamp now() { return {clock_.utc_ns(), clock_.now_ns()}; }

  // What the last event of the log changes.
  void follow() {
    const Event event = log_.events().back();
    if (const auto change = course_event_from(event.kind, nlohmann::ordered_json::parse(event.body)))
      jnd::apply(*change, replayed_);
  }

  void compare() const {
    if (engine_ == nullptr) return;
    const std::string what = difference(engine_->course().state(), replayed_);
    if (!what.empty()) throw std::logic_error("engine and replay differ: " + what);
    if (engine_->course().next_step() != next_step(protocol_, plan_, replayed_, person_))
      throw std::logic_error("engine and replay do not go on with the same step");
  }

  // One start of the program.
  void sit(ResumeSteps steps) {
    Watched log(*this);
    Erratic view(*this);
    RuleResponder responder(clock_);
    responder.rule = [&](const TrialQuestion& question) -> std::optional<int> {
      if (chance_.one_in(15)) return std::nullopt;
      const bool right = chance_.below(3) != 1;
      return right == (question.trial.target == kClassSame) ? kClassSame : kClassDifferent;
    };
    IdealRig rig(clock_);
    rig.stopped_by = "key";
    rig.saturated_share = [&](const PresentRequest&) { return chance_.one_in(20) ? 0.2 : 0.0; };
    rig.fault = [&](const PresentRequest&) {
      const int draw = chance_.below(50);
      if (draw == 49) return Fault::device_lost;
      if (draw == 48 && person_) return Fault::emergency_stop;
      if (draw == 47) return Fault::no_contact;
      if (draw == 46 && person_) interrupts_.pause = true;
      if (draw == 45) interrupts_.end = true;
      return interrupts_.end ? Fault::interrupted : Fault::none;
    };
    const SessionParts parts{protocol_, plan_, rig, responder, log, clock_, view, interrupts_, RecordPolicy::events,
                             person_};
    SessionEngine engine(parts);
    const SessionState state = replay(log_.events());
    if (const std::string what = difference(state, replayed_); !what.empty())
      throw std::logic_error("a replay of the whole log differs from its events one by one: " + what);
    try {
      engine_ = &engine;
      const SessionEnd end = engine.run(state, steps);
      over_ = end != SessionEnd::interrupted;
      completed_ = end == SessionEnd::completed;
    } catch (const Killed&) {
      ++kills_;
    } catch (const StorageError&) {
      ++kills_;
    }
    engine_ = nullptr;
    interrupts_.end = interrupts_.pause = false;
  }

  Chance chance_;
  Protocol protocol_;
  int participant_;
  Plan plan_;
  bool person_;
  SimulatedClock clock_{1'700'000'000'000'000'000};
  Interrupts interrupts_;
  MemoryLog log_;
  SessionState replayed_;
  const SessionEngine* engine_ = nullptr;
  bool over_ = false, completed_ = false;
  int kills_ = 0;
};

bool engine_and_replay_agree(const char* what) {
  return rc::check(what, [] {
    // A smaller seed is no simpler story: what failed is told as it is.
    Story story(*rc::gen::noShrink(rc::gen::arbitrary<std::uint64_t>()));
    std::string problem;
    try {
      story.play();
      problem = story.problems_of_study();
    } catch (const std::logic_error& error) {
      problem = error.what();
    }
    if (!problem.empty()) RC_LOG(story.protocol().bytes + "\n" + story.told());
    RC_CLASSIFY(story.kills() > 0, "killed");
    RC_CLASSIFY(story.completed(), "completed");
    RC_ASSERT(problem == "");
  });
}

TEST_CASE("Whatever happens in a session, engine, replay and verify tell one course") {
  REQUIRE(engine_and_replay_agree("random protocols and histories"));
}

TEST_CASE("Whatever happens in many sessions, engine, replay and verify tell one course", "[.][course-campaign]") {
  for (int i = 0; i < 10; ++i) REQUIRE(engine_and_replay_agree("random protocols and histories, many of them"));
}

}  // namespace
}  // namespace jnd
