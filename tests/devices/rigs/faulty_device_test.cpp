// Whatever goes wrong at whatever tick: no force above the cap, none outside an active interval, zero within two ticks
// of the latch, and a recorded cause. Cases come from a fixed seed; there are 10,000, times JND_CAMPAIGN.
#include "tests/devices/rigs/faulty_device.h"

#include <string>

#include "devices/mckibben/mckibben_device.h"
#include "devices/rigs/fingertip_rig.h"
#include "devices/rrs3/rrs3_device.h"
#include "devices/trackers/encoder_tracker.h"
#include "protocols/random_stream.h"
#include "tests/campaign.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

int cases_wanted() {
  return test::campaign(10'000);
}

// Wakes late now and then, and latches the stop at a time, as another thread would between two ticks.
class TroubledClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override { return now_; }
  std::int64_t utc_ns() const noexcept override { return now_; }
  void sleep_until_ns(std::int64_t deadline) noexcept override {
    if (deadline > now_) now_ = deadline;
    if (now_ >= hiccup_at_ns && hiccup_ns > 0) {
      now_ += hiccup_ns;
      hiccup_ns = 0;
    }
    if (stop != nullptr && now_ >= latch_at_ns && !stop->latched()) {
      stop->latch(StopSource::key);
      latched_ns = now_;
    }
  }
  std::int64_t hiccup_at_ns = 0, hiccup_ns = 0, latch_at_ns = 0, latched_ns = -1;
  EmergencyStop* stop = nullptr;

 private:
  std::int64_t now_ = 0;
};

struct Case {
  DeviceFault device = DeviceFault::none;
  TrackerFault tracker = TrackerFault::none;
  int which = 0;  // of the two devices
  std::int64_t from_ms = 0, for_ms = 0;
  std::int64_t hiccup_ms = 0;
  std::int64_t latch_ms = -1;
  double stiffness = 500;
  Cues cues;
};

Case draw(RandomStream& random) {
  Case one;
  if (random.uniform() < 0.75) one.device = static_cast<DeviceFault>(random.below(8));
  if (random.uniform() < 0.35) one.tracker = static_cast<TrackerFault>(random.below(5));
  one.which = static_cast<int>(random.below(2));
  one.from_ms = static_cast<std::int64_t>(random.below(1500));
  one.for_ms = random.coin() ? 100'000 : 1 + static_cast<std::int64_t>(random.below(60));
  if (random.uniform() < 0.2) one.hiccup_ms = 1 + static_cast<std::int64_t>(random.below(50));
  if (random.uniform() < 0.5) one.latch_ms = static_cast<std::int64_t>(random.below(1500));
  one.stiffness = 300 + 1500 * random.uniform();
  one.cues = {.force = random.uniform() < 0.9, .vibration = random.coin(), .kinaesthetic = true};
  return one;
}

// stop must outlive the clock.
TroubledClock clock_of(const Case& one, EmergencyStop& stop) {
  TroubledClock clock;
  clock.hiccup_at_ns = one.from_ms * kMs;
  clock.hiccup_ns = one.hiccup_ms * kMs;
  if (one.latch_ms >= 0) {
    clock.stop = &stop;
    clock.latch_at_ns = one.latch_ms * kMs;
  }
  return clock;
}

// Of an interval of a second, two at most until the contact.
PresentRequest request_of(const Case& one, int trial) {
  PresentRequest asked = request(one.stiffness, one.cues, {.trial = trial});
  asked.explore_s = 1;
  asked.no_contact_time_out_s = 2;
  return asked;
}

std::string text_of(const Case& one, int number) {
  return "case " + std::to_string(number) + ": device fault " + std::to_string(static_cast<int>(one.device)) +
         ", tracker fault " + std::to_string(static_cast<int>(one.tracker)) + ", device " + std::to_string(one.which) +
         ", from " + std::to_string(one.from_ms) + " ms for " + std::to_string(one.for_ms) + " ms, hiccup " +
         std::to_string(one.hiccup_ms) + " ms, latch at " + std::to_string(one.latch_ms) + " ms";
}

struct Tally {
  int by_fault[16] = {};
};

void check(const Case& one, const Presentation& given, const TroubledClock& clock,
           const std::vector<FaultyDevice*>& devices, const std::vector<double>& caps, Tally& tally) {
  ++tally.by_fault[static_cast<int>(given.fault)];
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const FaultyDevice& device = *devices[i];
    REQUIRE_FALSE(device.told_nonsense);
    REQUIRE(device.largest_n <= caps[i]);
    // After the interval, and after a stop, nothing acts.
    REQUIRE(device.told.force_n == 0);
    REQUIRE(device.told.vibration_g == 0);
    REQUIRE(device.neutrals >= 1);
    if (clock.latched_ns >= 0) REQUIRE(device.last_action_ns <= clock.latched_ns + 2 * kMs);
  }
  if (given.fault == Fault::emergency_stop) {
    REQUIRE(given.stopped_by == "key");
    REQUIRE(clock.latched_ns >= 0);
  }
  // A stop leaves what led to it.
  if (given.fault != Fault::none && given.fault != Fault::no_contact && given.ticks > 1)
    REQUIRE_FALSE(given.last_ticks.empty());
  // What cannot be overlooked is not: lasting faults that matter end the interval with their own cause.
  const double ended_ms = 1e3 * given.duration_s;
  const bool undisturbed = one.tracker == TrackerFault::none && one.hiccup_ms == 0 && one.latch_ms < 0;
  if (!undisturbed || one.for_ms < 1000 || ended_ms < static_cast<double>(one.from_ms) - 1) return;
  if (one.device == DeviceFault::disconnect) REQUIRE(given.fault == Fault::device_lost);
  if (one.device == DeviceFault::not_a_number) REQUIRE(given.fault == Fault::non_finite);
  if (one.device == DeviceFault::late_reading && ended_ms > static_cast<double>(one.from_ms) + 25)
    REQUIRE(given.fault == Fault::stale_reading);
  if (one.device == DeviceFault::none) REQUIRE(given.fault == Fault::none);
}

}  // namespace

TEST_CASE("two fingers: no fault brings force where there should be none, and each is named") {
  const DeviceSpec spec = rrs3_spec();
  const int cases = cases_wanted();
  RandomStream random(20'170'917, 1, "faults of fingertips");
  Tally tally;
  Rrs3Device left(spec, 1000), right(spec, 1000);
  SimulatedHand hand(HandHabits{}, 2, 1, 1);
  for (int number = 0; number < cases; ++number) {
    const Case one = draw(random);
    INFO(text_of(one, number));
    FaultyDevice a(left, one.which == 0 ? one.device : DeviceFault::none, one.from_ms, one.for_ms);
    FaultyDevice b(right, one.which == 1 ? one.device : DeviceFault::none, one.from_ms, one.for_ms);
    FaultyTracker tracker(hand, one.tracker, one.from_ms * kMs, one.for_ms * kMs);
    EmergencyStop stop;
    TroubledClock clock = clock_of(one, stop);
    ControlLoop loop(on_fingers({&a, &b}, spec), tracker, clock, sphere_scene());
    const Presentation given = loop.run(request_of(one, number + 1), stop);
    check(one, given, clock, {&a, &b}, {spec.max_force_n, spec.max_force_n}, tally);
  }
  // The campaign did meet what it is for.
  for (const Fault fault : {Fault::none, Fault::stale_pose, Fault::stale_reading, Fault::command_gap, Fault::non_finite,
                            Fault::sensor_stuck, Fault::device_lost, Fault::emergency_stop}) {
    INFO(to_string(fault));
    if (cases >= 1000) CHECK(tally.by_fault[static_cast<int>(fault)] > 0);
  }
}

TEST_CASE("one finger with both devices: one's fault stops the other") {
  const RigSpec rig = shipped_rig("rrs3+mckibben").spec;
  const DeviceSpec &pulp = *rig.cutaneous(), &joint = *rig.kinaesthetic();
  RandomStream random(20'170'918, 1, "faults of a finger and its joint");
  Tally tally;
  for (int number = 0; number < cases_wanted() / 10; ++number) {
    const Case one = draw(random);
    INFO(text_of(one, number));
    SimulatedFlexion finger(FlexionHabits{.straight_rad = joint.lowest_travel,
                                          .range_rad = joint.highest_travel - joint.lowest_travel,
                                          .contact_flexion_rad = 0.1,
                                          .press_depth_rad = 0.06,
                                          .press_depth_sd_rad = 0.01},
                            1, 1);
    Rrs3Device platform(pulp, 1000);
    MckibbenDevice muscle(MckibbenOptions{}, finger);
    EncoderTracker encoder(muscle, finger, joint.lowest_travel, rig.lever_arm_m);
    FaultyDevice a(platform, one.which == 0 ? one.device : DeviceFault::none, one.from_ms, one.for_ms);
    FaultyDevice b(muscle, one.which == 1 ? one.device : DeviceFault::none, one.from_ms, one.for_ms);
    FaultyTracker tracker(encoder, one.tracker, one.from_ms * kMs, one.for_ms * kMs);
    EmergencyStop stop;
    TroubledClock clock = clock_of(one, stop);
    const std::vector<LoopDevice> devices = {
        {.device = &a, .spec = pulp, .finger = 0, .channel = Channel::cutaneous},
        {.device = &b, .spec = joint, .finger = 0, .channel = Channel::kinaesthetic, .force_gain = 0.6}};
    const LoopScene scene{.object = {}, .joint = JointObject{.contact_flexion_rad = 0.1, .penetration_per_rad = 0.08}};
    ControlLoop loop(devices, tracker, clock, scene);
    const Presentation given = loop.run(request_of(one, number + 1), stop);
    check(one, given, clock, {&a, &b}, {pulp.max_force_n, joint.max_force_n}, tally);
  }
}
