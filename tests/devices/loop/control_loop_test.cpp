// The loop with clocks, trackers and devices that misbehave on demand.
#include "devices/loop/control_loop.h"

#include <cmath>
#include <limits>

#include "analysis/numerics/special_values.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// Wakes late when told to: the nth sleep by so many nanoseconds.
class LateClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override { return now_; }
  std::int64_t utc_ns() const noexcept override { return now_; }
  void sleep_until_ns(std::int64_t deadline) noexcept override {
    ++sleeps_;
    if (deadline > now_) now_ = deadline;
    if (sleeps_ == late_at)
      now_ += late_ns;
    else
      now_ += always_late_ns;
  }
  int late_at = -1;
  std::int64_t late_ns = 0, always_late_ns = 0;

 private:
  std::int64_t now_ = 0;
  int sleeps_ = 0;
};

// A finger that enters a sphere of 40 mm at 400 ms, down to a constant depth, and does what a test wants.
class ScriptedTracker final : public Tracker {
 public:
  void begin(const PresentRequest&, std::int64_t start_ns) override { start_ = start_ns; }
  bool read(int, std::int64_t now_ns, FingerPose& pose) noexcept override {
    const double t = 1e-6 * static_cast<double>(now_ns - start_);
    if (t >= silent_from_ms) return false;
    const double depth = std::min((t - 400) * 2e-5, 0.004);  // 20 mm/s
    pose.position_m = Eigen::Vector3d(0, 0, 0.040 - depth);
    if (t >= nan_from_ms) pose.position_m.x() = std::nan("");
    pose.time_ns = now_ns;
    return true;
  }
  double silent_from_ms = kInf;
  double nan_from_ms = kInf;

 private:
  std::int64_t start_ = 0;
};

// Remembers every command; breaks, or sets a latch, at a time.
class SpyDevice final : public FingertipDevice {
 public:
  DeviceStatus engage(std::int64_t now_ns) noexcept override {
    start_ = now_ns;
    return engages ? DeviceStatus::ok : DeviceStatus::lost;
  }
  DeviceStatus read(std::int64_t now_ns, DeviceReading& reading) noexcept override {
    if (now_ns - start_ >= lost_from_ns) return DeviceStatus::lost;
    reading.force_n = last.force_n;
    reading.vibration_g = last.vibration_g;
    reading.time_ns = now_ns;
    reading.travel = reading.platform.pz_m = -0.02;
    return DeviceStatus::ok;
  }
  DeviceStatus write(const DeviceCommand& command, std::int64_t now_ns) noexcept override {
    last = command;
    largest = std::max(largest, command.force_n);
    if (command.force_n > 0) last_force_ns = now_ns;
    if (latch && now_ns - start_ >= latch_at_ns && !latched_ns) {
      latch->latch(StopSource::button);
      latched_ns = now_ns;
    }
    ++writes;
    return DeviceStatus::ok;
  }
  void neutral() noexcept override { ++neutrals; }

  bool engages = true;
  std::int64_t lost_from_ns = std::numeric_limits<std::int64_t>::max();
  EmergencyStop* latch = nullptr;
  std::int64_t latch_at_ns = 0, latched_ns = 0, last_force_ns = 0;
  DeviceCommand last;
  double largest = 0;
  int writes = 0, neutrals = 0;

 private:
  std::int64_t start_ = 0;
};

struct LoopSetup {
  LateClock clock;
  ScriptedTracker tracker;
  SpyDevice a, b;
  EmergencyStop stop;
  ControlLoop loop{on_fingers({&a, &b}, rrs3_spec()), tracker, clock, sphere_scene()};

  Presentation run(double explore_s = 1) {
    PresentRequest asked = request(500, kForce);
    asked.explore_s = explore_s;
    return loop.run(asked, stop);
  }
  void check_stopped(const Presentation& given, Fault fault) {
    CHECK(given.fault == fault);
    for (SpyDevice* device : {&a, &b}) {
      CHECK(device->last.force_n == 0);
      CHECK(device->last.vibration_g == 0);
      CHECK(device->neutrals >= 1);
    }
  }
};

}  // namespace

TEST_CASE("an undisturbed interval ends at rest after the exploration") {
  LoopSetup setup;
  const Presentation given = setup.run();
  setup.check_stopped(given, Fault::none);
  CHECK(given.first_contact_s == Approx(0.401));
  CHECK(given.duration_s == Approx(1.401));
  CHECK(given.ticks == 1401);
  CHECK(given.overruns == 0);
  CHECK(setup.a.largest == Approx(2.0));
  CHECK(*given.fingers[0].stiffness == Approx(500).epsilon(0.01));
}

TEST_CASE("late ticks skip whole periods and are counted, never caught up") {
  LoopSetup setup;
  setup.clock.late_at = 700;
  setup.clock.late_ns = 5 * kMs + 300'000;
  const Presentation given = setup.run();
  CHECK(given.fault == Fault::none);
  CHECK(given.overruns == 5);
  CHECK(given.ticks == 1401 - 5);
  CHECK(given.duration_s == Approx(1.401).margin(1e-9));
  CHECK(given.fingers[0].dwell_s == Approx(1.0).margin(1e-9));
  CHECK(given.lateness_max_us == Approx(5300));
  CHECK(given.lateness_p99_us == 0);
}

TEST_CASE("constant lateness below a period costs no tick") {
  LoopSetup setup;
  setup.clock.always_late_ns = 250'000;
  const Presentation given = setup.run();
  CHECK(given.overruns == 0);
  CHECK(given.lateness_p50_us == 250);
  CHECK(given.lateness_p99_us == 250);
  CHECK(given.lateness_max_us == Approx(250));
}

TEST_CASE("a loop that was held up for more than 20 ms stops with a fault") {
  LoopSetup setup;
  setup.clock.late_at = 700;
  setup.clock.late_ns = 25 * kMs;
  setup.check_stopped(setup.run(), Fault::command_gap);
}

TEST_CASE("also where it was held up past the end of the interval") {
  LoopSetup undisturbed;
  const Presentation whole = undisturbed.run();
  REQUIRE(whole.fault == Fault::none);
  LoopSetup setup;
  setup.clock.late_at = static_cast<int>(whole.ticks);  // the sleep after the last tick
  setup.clock.late_ns = 1000 * kMs;
  const Presentation given = setup.run();
  CHECK(given.fault == Fault::command_gap);
  CHECK(given.ticks == whole.ticks);
}

TEST_CASE("a silent tracker stops the device 20 ms later") {
  LoopSetup setup;
  setup.tracker.silent_from_ms = 800;
  const Presentation given = setup.run();
  setup.check_stopped(given, Fault::stale_pose);
  CHECK(given.duration_s == Approx(0.820));
  CHECK(setup.a.last_force_ns == 819 * kMs);
}

TEST_CASE("a tracker that never spoke is stale, not at the origin") {
  LoopSetup setup;
  setup.tracker.silent_from_ms = 0;
  setup.check_stopped(setup.run(), Fault::stale_pose);
  CHECK(setup.a.largest == 0);
}

TEST_CASE("a pose that is no number stops the device in the same tick") {
  LoopSetup setup;
  setup.tracker.nan_from_ms = 800;
  setup.check_stopped(setup.run(), Fault::non_finite);
  CHECK(setup.a.last_force_ns == 799 * kMs);
}

TEST_CASE("a lost device stops both fingers") {
  LoopSetup setup;
  setup.b.lost_from_ns = 600 * kMs;
  setup.check_stopped(setup.run(), Fault::device_lost);
  LoopSetup absent;
  absent.a.engages = false;
  absent.check_stopped(absent.run(), Fault::device_lost);
  CHECK(absent.b.largest == 0);
}

TEST_CASE("force is zero within two ticks of the latch") {
  LoopSetup setup;
  setup.b.latch = &setup.stop;
  setup.b.latch_at_ns = 700 * kMs;
  const Presentation given = setup.run();
  setup.check_stopped(given, Fault::emergency_stop);
  REQUIRE(setup.b.latched_ns == 700 * kMs);
  CHECK(setup.a.last_force_ns <= setup.b.latched_ns + 1 * kMs);
  CHECK(setup.b.last_force_ns <= setup.b.latched_ns + 1 * kMs);
  CHECK(given.duration_s <= 0.702);
  // What led to the stop is kept, oldest first.
  CHECK(given.stopped_by == "button");
  const std::vector<TickRecord>& last = given.last_ticks;
  REQUIRE(last.size() == 2 * kTicksBeforeStop);
  CHECK(last.back().time_ns == 700 * kMs);
  CHECK(last.front().time_ns == 601 * kMs);
  CHECK(last.back().given_n == Approx(2.0));
}

TEST_CASE("the loop can be used again after a fault") {
  LoopSetup setup;
  setup.tracker.nan_from_ms = 500;
  REQUIRE(setup.run().fault == Fault::non_finite);
  setup.tracker.nan_from_ms = kInf;
  const Presentation given = setup.run();
  CHECK(given.fault == Fault::none);
  CHECK(*given.fingers[1].stiffness == Approx(500).epsilon(0.01));
}

TEST_CASE("exploring for no time at all, or without end of patience, is well defined") {
  LoopSetup setup;
  const Presentation none = setup.run(0);
  CHECK(none.fault == Fault::none);
  CHECK(none.duration_s == Approx(0.402));
  CHECK(none.ticks == 402);
}
