// Cues to the participant: which come from the devices, and that they are the same whatever is presented.
#include <array>
#include <optional>

#include "runner/session/session_engine.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"

namespace jnd {
namespace {

using test::Bench;
using test::small_protocol;

Protocol with_taps() {
  return small_protocol(
      {{"trial",
        {{"cues", {{"first", {{"kind", "tap"}}}, {"second", {{"kind", "tap"}}}, {"question", {{"kind", "none"}}}}}}}});
}

TEST_CASE("A tap is presented by the devices before each interval, the same for every stimulus and condition") {
  Bench bench(with_taps());
  std::vector<PresentRequest> asked;
  bench.rig.fault = [&](const PresentRequest& request) {
    asked.push_back(request);
    return Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  REQUIRE(asked.size() == 16 * 4);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const bool tap = i % 2 == 0;
    CHECK((asked[i].tap_g > 0) == tap);
    if (!tap) continue;
    CHECK(asked[i].tap_g == asked[0].tap_g);
    CHECK(asked[i].explore_s == asked[0].explore_s);
    CHECK(asked[i].stimulus == Stimulus{});
    CHECK(asked[i].object.empty());
  }
}

TEST_CASE("A device that fails in a tap voids the attempt, and nothing is presented after it") {
  Bench bench(with_taps());
  int after_failure = 0;
  bench.rig.fault = [&](const PresentRequest& request) {
    const bool fails = request.id.trial == 2 && request.id.attempt == 1;
    if (fails && request.tap_g == 0) ++after_failure;
    return fails && request.tap_g > 0 ? Fault::device_lost : Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  CHECK(after_failure == 0);
  CHECK(replay(bench.log.events()).voided.at(2) == 1);
  CHECK(bench.completed().size() == 16);
}

// When what happened.
class TimedView final : public SessionView {
 public:
  explicit TimedView(Clock& clock) : clock_(clock) {}
  OperatorRequest ready(const TrialOutline&) override {
    ready_ns = clock_.now_ns();
    clock_.sleep_until_ns(ready_ns + 3'000'000'000);
    return {};
  }
  void cue(CuePlace place, const CueSignal&) override { cues_ns[static_cast<std::size_t>(place)] = clock_.now_ns(); }
  std::int64_t ready_ns = 0;
  std::array<std::int64_t, 4> cues_ns{};

 private:
  Clock& clock_;
};

TEST_CASE("A rig gets ready before READY and at the beginning of the gap, and the cue waits for it, whatever comes") {
  Bench bench(small_protocol());
  bench.person = true;
  TimedView view(bench.clock);
  constexpr std::int64_t kReady_ns = 800'000'000;  // longer than gap_s and between_trials_s
  std::optional<IntervalId> held;
  std::int64_t due_ns = 0, ended_ns = 0;
  int presented = 0;
  bench.rig.ready = [&](const PresentRequest& request) {
    if (held == request.id) return due_ns;  // it is ready, and stays so
    CHECK_FALSE(held);
    held = request.id;
    if (request.id.interval == 1) CHECK(bench.clock.now_ns() == ended_ns);
    due_ns = bench.clock.now_ns() + kReady_ns;
    return due_ns;
  };
  bench.rig.fault = [&](const PresentRequest& request) {
    const std::int64_t began_ns = bench.clock.now_ns() - 1'000'000'000;  // explore_s
    REQUIRE(held == request.id);
    held.reset();
    ++presented;
    if (request.id.interval == 0) {
      CHECK(view.ready_ns >= due_ns);
      CHECK(view.cues_ns[0] == began_ns);
    } else {
      CHECK(view.cues_ns[1] == due_ns);
      CHECK(began_ns == due_ns);
    }
    ended_ns = bench.clock.now_ns();
    return Fault::none;
  };
  REQUIRE(bench.run(view) == SessionEnd::completed);
  CHECK(presented == 16 * 2);
}

}  // namespace
}  // namespace jnd
