// What comes while a session waits: a stop, Ctrl-C and the operator's keys reach the operator at once, and the time
// that the protocol sets passes all the same.
#include <functional>
#include <vector>

#include "tests/catch.h"
#include "tests/runner/session/scripted_operator.h"

namespace jnd {
namespace {

using nlohmann::json;
using test::Bench;
using test::bodies;
using test::small_protocol;
using test::with_person;

constexpr double kAtOnce_s = 0.11;  // two looks

// Acts once for each act, the second time that it is looked whether a wait goes on, or where else it is told to; keeps
// what it was asked, and when.
class Acting final : public SessionView {
 public:
  explicit Acting(Bench& bench) : bench_(bench) {}
  bool waiting(double, double) override {
    if (++looks_ % 2 == 0 && in_wait) act(in_wait);
    return !wants_something;
  }
  OperatorRequest meanwhile() override {
    if (after_interval) act(after_interval);
    return {};
  }
  OperatorRequest break_over(const Break&) override {
    if (in_break) act(in_break);
    return {};
  }
  OperatorRequest ready(const TrialOutline&) override {
    if (wants_something) note("ready");
    wants_something = false;
    return {};
  }
  OperatorRequest paused(const std::string& cause) override {
    note("paused by " + cause);
    bench_.interrupts.pause = false;
    return {};
  }
  OperatorRequest recover(const std::string& by) override {
    note("stopped by " + by);
    return {};
  }
  void cue(CuePlace place, const CueSignal&) override { cues.push_back(place); }

  void stop() { bench_.rig.stop.latch(StopSource::key); }
  void press_ctrl_c() {
    bench_.interrupts.pause = true;  // as the signal's handler does
    bench_.rig.stop.latch(StopSource::signal);
  }
  // What followed the act, within kAtOnce_s of it.
  bool at_once(const std::string& what) const {
    return asked.size() == 1 && asked.front() == what && asked_s.front() - acted_s <= kAtOnce_s;
  }

  std::function<void()> in_wait, after_interval, in_break;
  bool wants_something = false;
  double acted_s = 0;
  std::vector<std::string> asked;
  std::vector<double> asked_s;
  std::vector<CuePlace> cues;

 private:
  double now_s() const { return static_cast<double>(bench_.clock.now_ns()) * 1e-9; }
  void act(std::function<void()>& once) {
    const std::function<void()> what = std::exchange(once, {});
    acted_s = now_s();
    what();
  }
  void note(const std::string& what) {
    asked.push_back(what);
    asked_s.push_back(now_s());
  }
  Bench& bench_;
  int looks_ = 0;
};

// When each presentation began.
std::vector<double> starts_of(Bench& bench, Acting& view) {
  std::vector<double> starts_s;
  bench.rig.fault = [&](const PresentRequest& request) {
    starts_s.push_back(static_cast<double>(bench.clock.now_ns()) * 1e-9 - request.explore_s);
    return Fault::none;
  };
  REQUIRE(with_person(bench).run(view) == SessionEnd::completed);
  CHECK_FALSE(bench.rig.stop.latched());
  return starts_s;
}

const json kLongWait = {{"trial", {{"between_trials_s", 120}}}};

TEST_CASE("A stop between trials is seen to at once, however long the wait, and the wait is kept all the same") {
  Bench bench(small_protocol(kLongWait));
  Acting view(bench);
  view.in_wait = [&] { view.stop(); };
  const std::vector<double> starts_s = starts_of(bench, view);
  CHECK(view.at_once("stopped by key"));
  CHECK(bodies(bench, event_kind::kTrialVoided).empty());
  REQUIRE(starts_s.size() == 32);
  CHECK(starts_s[2] - starts_s[1] >= 1 + 1 + 120);  // the second interval, the answer, and the wait
}

TEST_CASE("Ctrl-C between trials pauses at once, and is no stop of the devices") {
  Bench bench(small_protocol(kLongWait));
  Acting view(bench);
  view.in_wait = [&] { view.press_ctrl_c(); };
  (void)starts_of(bench, view);
  CHECK(view.at_once("paused by ctrl-c"));
  CHECK(bodies(bench, event_kind::kDeviceFault).empty());
  CHECK(bodies(bench, event_kind::kTrialVoided).empty());
}

TEST_CASE("What the operator wants between trials is asked at once, and the wait is kept") {
  Bench bench(small_protocol(kLongWait));
  Acting view(bench);
  view.in_wait = [&] { view.wants_something = true; };
  const std::vector<double> starts_s = starts_of(bench, view);
  CHECK(view.at_once("ready"));
  REQUIRE(starts_s.size() == 32);
  CHECK(starts_s[2] - starts_s[1] >= 1 + 1 + 120);
}

TEST_CASE("While the rest of the wait passes the operator is heard, and shown that it does") {
  for (const bool stopped : {false, true}) {  // what came first
    Bench bench(small_protocol(kLongWait));
    Acting view(bench);
    view.in_wait = [&] {
      if (stopped)
        view.stop();
      else
        view.wants_something = true;
      view.in_wait = [&] { view.wants_something = true; };
    };
    const std::vector<double> starts_s = starts_of(bench, view);
    REQUIRE(view.asked.size() == 2);
    CHECK(view.asked[1] == "ready");
    REQUIRE(starts_s.size() == 32);
    CHECK(view.acted_s < starts_s[1] + 1 + 1 + 1);  // before the wait after the first trial had passed
    CHECK(view.asked_s[1] - view.acted_s <= kAtOnce_s);
    CHECK(starts_s[2] - starts_s[1] >= 1 + 1 + 120);
  }
}

TEST_CASE("A stop between the two intervals voids the trial at once: the second one is not announced") {
  Bench bench(small_protocol({{"trial", {{"gap_s", 10}}}}));
  Acting view(bench);
  view.after_interval = [&] { view.stop(); };
  (void)starts_of(bench, view);
  CHECK(view.at_once("stopped by key"));
  REQUIRE(bodies(bench, event_kind::kTrialVoided).size() == 1);
  CHECK(bodies(bench, event_kind::kTrialVoided)[0].at("reason") == "emergency_stop");
  REQUIRE(view.cues.size() > 2);
  CHECK(view.cues[0] == CuePlace::first);
  CHECK(view.cues[1] == CuePlace::first);  // of the next trial
}

TEST_CASE("A stop in a break is seen to at once, and the rest of the break follows") {
  Bench bench(small_protocol({{"breaks", {{{"after", "trials"}, {"trials", 4}, {"duration_s", 300}}}}}));
  Acting view(bench);
  view.in_break = [&] { view.stop(); };
  const std::vector<double> starts_s = starts_of(bench, view);
  CHECK(view.at_once("stopped by key"));
  REQUIRE(starts_s.size() == 32);
  CHECK(starts_s[8] - starts_s[7] >= 300);
}

TEST_CASE("Consent that a pause or a stop came before is asked again, and is neither given nor refused meanwhile") {
  class Undecided final : public SessionView {
   public:
    explicit Undecided(Bench& bench) : bench_(bench) {}
    std::optional<bool> consent(const std::string&) override {
      ++asked;
      if (asked == 1) bench_.rig.stop.latch(StopSource::button);
      if (asked == 2) bench_.interrupts.pause = true;
      return asked < 3 ? std::nullopt : std::optional(true);
    }
    OperatorRequest recover(const std::string&) override {
      ++recovered;
      return {};
    }
    OperatorRequest paused(const std::string&) override {
      ++pauses;
      bench_.interrupts.pause = false;
      return {};
    }
    int asked = 0, recovered = 0, pauses = 0;

   private:
    Bench& bench_;
  };
  Bench bench(small_protocol({{"consent", "I agree to take part."}}));
  Undecided view(bench);
  REQUIRE(with_person(bench).run(view) == SessionEnd::completed);
  CHECK(view.asked == 3);
  CHECK(view.recovered == 1);
  CHECK(view.pauses == 1);
  CHECK(bodies(bench, event_kind::kConsent).size() == 1);
}

}  // namespace
}  // namespace jnd
