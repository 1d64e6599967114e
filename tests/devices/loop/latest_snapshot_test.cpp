// What an operator sees of the loop while it runs: whole values, the newest ones, at no cost to the loop.
#include <atomic>
#include <stdexcept>
#include <thread>

#include "devices/loop/control_loop.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// Every field tells the same number.
LoopSnapshot all(std::int64_t number) {
  const auto value = static_cast<double>(number);
  LoopSnapshot snapshot;
  snapshot.ticks = number;
  snapshot.elapsed_s = snapshot.lateness_max_us = value;
  snapshot.contact = number % 2 == 1;
  return snapshot;
}

bool whole(const LoopSnapshot& snapshot) {
  const auto value = static_cast<double>(snapshot.ticks);
  return snapshot.elapsed_s == value && snapshot.lateness_max_us == value &&
         snapshot.contact == (snapshot.ticks % 2 == 1);
}

// The loop on a simulated clock, with the shipped hand; what it showed last.
struct Watched {
  Presentation given;
  LoopSnapshot last;
};
Watched watch_loop(double stiffness, const Cues& cues, double explore_s) {
  const DeviceSpec spec = rrs3_spec();
  Rrs3Device thumb(spec, Rrs3DeviceOptions{}), index(spec, Rrs3DeviceOptions{});
  SimulatedHand hand(HandHabits{}, 2, 1, 1);
  SimulatedClock clock(0);
  LatestSnapshot snapshot;
  ControlLoop loop(on_fingers({&thumb, &index}, spec), hand, clock, sphere_scene(HandHabits{}.sphere_radius_m),
                   {.snapshot = &snapshot});
  PresentRequest asked = request(stiffness, cues);
  asked.explore_s = explore_s;
  const EmergencyStop stop;
  Watched watched;
  watched.given = loop.run(asked, stop);
  watched.last = snapshot.look();
  return watched;
}

}  // namespace

TEST_CASE("a look between puts is the last one, and nothing before the first") {
  LatestSnapshot snapshot;
  CHECK(snapshot.look().ticks == 0);
  CHECK(whole(snapshot.look()));
  for (const std::int64_t number : {7, 8, 1'000'000}) {
    snapshot.put(all(number));
    CHECK(snapshot.look().ticks == number);
    CHECK(whole(snapshot.look()));
  }
}

TEST_CASE("a look is whole and never older than the one before, however fast the other thread puts") {
  constexpr int kMostLooks = 5'000'000, kChanges = 2000;  // where the threads share a processor, few looks meet a put
  LatestSnapshot snapshot;
  std::atomic<bool> over{false};
  std::thread loop([&] {
    for (std::int64_t number = 1; !over.load(std::memory_order_relaxed); ++number) snapshot.put(all(number));
  });
  while (snapshot.look().ticks == 0) std::this_thread::yield();  // until the other thread is at it
  bool torn = false, older = false;
  std::int64_t before = 0;
  int changes = 0;
  for (int i = 0; i < kMostLooks && changes < kChanges; ++i) {
    const LoopSnapshot seen = snapshot.look();
    torn = torn || !whole(seen);
    older = older || seen.ticks < before;
    changes += seen.ticks != before ? 1 : 0;
    before = seen.ticks;
  }
  over = true;
  loop.join();
  CHECK_FALSE(torn);
  CHECK_FALSE(older);
}

TEST_CASE("the loop shows its ticks and whether a finger is in the object, the same whatever is rendered there") {
  for (const Cues& cues : {kForce, kVibration})
    for (const double stiffness : {300.0, 2000.0}) {  // the second one is beyond what the device can give
      const Watched whole = watch_loop(stiffness, cues, 2);
      CHECK(whole.last.ticks % 25 == 1);
      CHECK(whole.given.ticks - whole.last.ticks < 25);
      CHECK(whole.last.elapsed_s == Approx(1e-3 * static_cast<double>(whole.last.ticks)));
      CHECK_FALSE(whole.last.contact);  // between two presses
      CHECK(watch_loop(stiffness, cues, 0.6).last.contact);
    }
}

TEST_CASE("who watches a rig on the real clock is called while it presents, on the thread that asked") {
  SteadyClock clock;
  const auto rig = make_simulated_rig(small_protocol(), rrs3_rig(), shipped_profile("chinello2017"), 1, 1, clock,
                                      {.telemetry_ticks = 0, .realtime = RealtimePolicy::off});
  int looks = 0;
  const std::thread::id caller = std::this_thread::get_id();
  bool here = true, forward = true;
  LoopSnapshot last;
  rig->watch([&](const LoopSnapshot& snapshot) {
    here = here && std::this_thread::get_id() == caller;
    forward = forward && snapshot.ticks > 0 && snapshot.ticks >= last.ticks && snapshot.elapsed_s >= last.elapsed_s;
    last = snapshot;
    if (++looks == 3) rig->stop.latch(StopSource::program);
  });
  PresentRequest asked = request(500, kForce);
  asked.explore_s = asked.no_contact_time_out_s = 60;  // the watcher ends it
  Presentation given = rig->present(asked);
  // A machine that is busy with something else ends it as a gap between commands, before the watcher could.
  for (int again = 0; given.fault == Fault::command_gap && again < 50; ++again) {
    rig->stop.clear();
    looks = 0;
    last = {};
    given = rig->present(asked);
  }
  CHECK(given.fault == Fault::emergency_stop);
  CHECK(looks >= 3);
  CHECK(here);
  CHECK(forward);
  CHECK(given.ticks >= last.ticks);

  // Without a watcher; and nothing of the last presentation is shown in the next.
  rig->stop.clear();
  rig->watch({});
  const int before = looks;
  asked.explore_s = asked.no_contact_time_out_s = 0.1;
  (void)rig->present(asked);
  CHECK(looks == before);
}

TEST_CASE("a loop on a simulated clock is not watched") {
  SimulatedClock clock(0);
  const auto rig = make_simulated_rig(small_protocol(), rrs3_rig(), shipped_profile("chinello2017"), 1, 1, clock);
  int looks = 0;
  rig->watch([&](const LoopSnapshot&) { ++looks; });
  CHECK(rig->present(request(500, kForce)).fault == Fault::none);
  CHECK(looks == 0);
}

TEST_CASE("what a watcher throws comes out of the presentation, when the devices are at rest") {
  SteadyClock clock;
  const auto rig = make_simulated_rig(small_protocol(), rrs3_rig(), shipped_profile("chinello2017"), 1, 1, clock,
                                      {.telemetry_ticks = 0, .realtime = RealtimePolicy::off});
  rig->watch([&](const LoopSnapshot&) {
    rig->stop.latch(StopSource::program);
    throw std::runtime_error("of the watcher");
  });
  PresentRequest asked = request(500, kForce);
  asked.explore_s = asked.no_contact_time_out_s = 60;
  CHECK_THROWS_WITH(rig->present(asked), "of the watcher");
  rig->stop.clear();
  rig->watch({});
  asked.explore_s = asked.no_contact_time_out_s = 0.1;
  Presentation given = rig->present(asked);
  // A machine that is busy with something else ends it as a gap between commands.
  for (int again = 0; given.fault == Fault::command_gap && again < 50; ++again) given = rig->present(asked);
  CHECK(given.fault == Fault::no_contact);
}

TEST_CASE("ticks can be looked at live, the same as are kept, where a rig is asked for them") {
  SimulatedClock clock(0);
  const ParticipantProfile profile = shipped_profile("chinello2017");
  const auto blind = make_simulated_rig(small_protocol(), rrs3_rig(), profile, 1, 1, clock,
                                        {.telemetry_ticks = 20000, .realtime = std::nullopt});
  CHECK(blind->live() == nullptr);
  const auto rig = make_simulated_rig(small_protocol(), rrs3_rig(), profile, 1, 1, clock,
                                      {.telemetry_ticks = 20000, .live_ticks = 20000, .realtime = std::nullopt});
  REQUIRE(rig->live() != nullptr);
  const Presentation given = rig->present(request(500, kForce));
  REQUIRE(given.fault == Fault::none);
  std::vector<TickRecord> kept, live;
  rig->telemetry()->drain(kept);
  rig->live()->drain(live);
  REQUIRE(live.size() == kept.size());
  CHECK(live.size() >= static_cast<std::size_t>(given.ticks));
  for (std::size_t i = 0; i < live.size(); ++i) {
    CHECK(live[i].time_ns == kept[i].time_ns);
    CHECK(live[i].measured_n == kept[i].measured_n);
    CHECK(live[i].channel == kept[i].channel);
  }
  rig->present(request(500, kForce));
  CHECK(rig->live()->drain(live) > 0);  // of the next one too
}
