// No tick of the control loop allocates or frees: counted at malloc itself, below operator new and Eigen.
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "devices/loop/telemetry_ring.h"
#include "devices/participants/simulated_hand.h"
#include "devices/rigs/fingertip_rig.h"
#include "devices/rigs/rig_factory.h"
#include "devices/rrs3/rrs3_device.h"
#include "devices/trackers/pose_feed.h"
#include "devices/trackers/replay_tracker.h"
#include "protocols/rigs/rig_description.h"
#include "tests/catch.h"
#include "tests/counted_heap.h"
#include "tests/devices/tracker_fixtures.h"

using namespace jnd;

namespace {

bool skipped() {
  if (counts_heap_calls) return false;
  WARN("SKIPPED: allocations in the tick are not counted under AddressSanitizer or ThreadSanitizer, or without glibc");
  return true;
}

// The compiler may leave out an allocation that is not used; this one is.
template <typename T>
T* kept(T* pointer) noexcept {
  asm volatile("" : "+r"(pointer) : : "memory");
  return pointer;
}

std::string source(const char* relative) {
  return std::string(JND_SOURCE_DIR) + "/" + relative;
}

// Simulated time that remembers the count at the first and the last time the loop went to sleep: what is between them
// are whole ticks.
class CountingClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override { return now_; }
  std::int64_t utc_ns() const noexcept override { return now_; }
  void sleep_until_ns(std::int64_t deadline) noexcept override {
    if (sleeps++ == 0) at_first_sleep = heap_calls;
    at_last_sleep = heap_calls;
    now_ = std::max(now_, deadline);
  }
  std::int64_t sleeps = 0, at_first_sleep = 0, at_last_sleep = 0;

 private:
  std::int64_t now_ = 0;
};

// Counts from the first read to the last write of an interval; allocates on purpose in one tick where told to.
class CountingDevice final : public FingertipDevice {
 public:
  explicit CountingDevice(std::unique_ptr<FingertipDevice> device) : device_(std::move(device)) {}
  DeviceStatus engage(std::int64_t now_ns) noexcept override {
    reads = 0;
    return device_->engage(now_ns);
  }
  DeviceStatus read(std::int64_t now_ns, DeviceReading& reading) noexcept override {
    if (reads++ == 0) at_first_read = heap_calls;
    if (reads == stop_at) stop->latch(StopSource::program);
    if (reads == allocate_at) delete kept(new int(7));
    return device_->read(now_ns, reading);
  }
  DeviceStatus write(const DeviceCommand& command, std::int64_t now_ns) noexcept override {
    const DeviceStatus status = device_->write(command, now_ns);
    last_n = command.force_n;
    largest_n = std::max(largest_n, last_n);
    at_last_write = heap_calls;
    return status;
  }
  void neutral() noexcept override { device_->neutral(); }
  std::int64_t counted() const noexcept { return at_last_write - at_first_read; }

  std::int64_t reads = 0, at_first_read = 0, at_last_write = 0, allocate_at = -1, stop_at = -1;
  EmergencyStop* stop = nullptr;
  double largest_n = 0, last_n = 0;

 private:
  std::unique_ptr<FingertipDevice> device_;
};

// Two simulated 3RRS fingers around a sphere, with telemetry and watched, their devices counted.
struct CountedFingers {
  DeviceSpec spec = load_device_spec(source("devices/specs/rrs3.json"));
  CountingDevice thumb, index;
  SimulatedHand hand{HandHabits{}, 2, 1, 1};
  CountingClock clock;
  TelemetryRing telemetry{64}, live{64};  // soon full: dropping must not allocate either
  LatestSnapshot snapshot;
  LoopScene scene{.object = sphere_object({.radius_m = HandHabits{}.sphere_radius_m}), .joint = std::nullopt};
  ControlLoop loop;
  EmergencyStop stop;

  CountedFingers()
      : thumb(std::make_unique<Rrs3Device>(spec, Rrs3DeviceOptions{})),
        index(std::make_unique<Rrs3Device>(spec, Rrs3DeviceOptions{})),
        loop({device(thumb, 0), device(index, 1)}, hand, clock, scene, {&telemetry, &live, &snapshot}) {}

  LoopDevice device(CountingDevice& counted, int finger) const {
    LoopDevice one;
    one.device = &counted;
    one.spec = spec;
    one.finger = finger;
    return one;
  }
  Presentation run() {
    PresentRequest request;
    request.stimulus.stiffness = 700;
    request.stimulus.cues = {.force = true, .vibration = true};
    request.explore_s = 1;
    request.no_contact_time_out_s = 10;
    request.id.trial = 1;
    return loop.run(request, stop);
  }
};

}  // namespace

TEST_CASE("the counting sees every way to the heap") {
  if (skipped()) return;
  const auto counted = [](auto&& work) {
    const std::int64_t before = heap_calls;
    work();
    return heap_calls - before;
  };
  struct alignas(64) Wide {
    char bytes[64];
  };
  CHECK(counted([] {}) == 0);
  CHECK(counted([] { delete kept(new int(7)); }) == 2);
  CHECK(counted([] { delete kept(new std::string(100, 'x')); }) == 4);
  CHECK(counted([] { delete kept(new Wide); }) == 2);
  CHECK(counted([] { delete kept(new Eigen::VectorXd(100)); }) == 4);
  CHECK(counted([] { std::free(kept(std::malloc(5))); }) == 2);
  CHECK(counted([] { std::free(kept(std::calloc(3, 5))); }) == 2);
  CHECK(counted([] { std::free(kept(std::realloc(kept(std::malloc(5)), 5000))); }) == 3);
}

TEST_CASE("from the first read to the last write of an interval nothing is allocated or freed") {
  if (skipped()) return;
  CountedFingers fingers;
  for (int interval = 0; interval < 2; ++interval) {
    const Presentation given = fingers.run();
    REQUIRE(given.fault == Fault::none);
    REQUIRE(given.ticks > 1000);
    REQUIRE(fingers.thumb.reads == given.ticks);
    CHECK(fingers.thumb.largest_n > 1);  // it was felt
    CHECK(fingers.telemetry.take_dropped() > 1000);
    CHECK(fingers.snapshot.look().ticks > 1000);
    CHECK(fingers.thumb.counted() == 0);
    CHECK(fingers.index.counted() == 0);
  }
}

TEST_CASE("one allocation in one tick is found") {
  if (skipped()) return;
  CountedFingers fingers;
  fingers.thumb.allocate_at = 700;
  REQUIRE(fingers.run().fault == Fault::none);
  CHECK(fingers.thumb.counted() == 2);
}

TEST_CASE("the tick that stops an interval allocates nothing either") {
  if (skipped()) return;
  CountedFingers fingers;
  fingers.index.stop = &fingers.stop;
  fingers.index.stop_at = 900;
  const Presentation given = fingers.run();
  REQUIRE(given.fault == Fault::emergency_stop);
  REQUIRE(given.ticks == 901);
  // The last write is the one that takes the force away.
  CHECK(fingers.thumb.last_n == 0);
  CHECK(fingers.thumb.counted() == 0);
  CHECK(fingers.index.counted() == 0);
}

TEST_CASE("no tick of any rig that can be built allocates") {
  if (skipped()) return;
  struct Built {
    const char* spec;
    std::vector<std::string> fingers;
    const char* tracker;
    RenderingMode mode;
    Cues cues;
  };
  const Cues cutaneous{.force = true, .vibration = true};
  const Cues both{.force = true, .vibration = true, .kinaesthetic = true};
  const Cues joint{.force = false, .vibration = false, .kinaesthetic = true};
  for (const Built& built : {Built{"rrs3", {"thumb", "index"}, "hand", RenderingMode::wrench, cutaneous},
                             Built{"rrs3", {"thumb", "index"}, "hand", RenderingMode::pd, cutaneous},
                             Built{"rrs3", {"thumb", "index"}, "hand", RenderingMode::pd_literal, cutaneous},
                             Built{"mckibben", {"index"}, "encoder", RenderingMode::wrench, joint},
                             Built{"rrs3+mckibben", {"index"}, "encoder", RenderingMode::wrench, both}}) {
    CAPTURE(built.spec, static_cast<int>(built.mode));
    Protocol protocol;
    protocol.rig.device = built.spec;
    protocol.rig.fingers = built.fingers;
    protocol.rig.tracker = built.tracker;
    protocol.rig.mode = built.mode;
    protocol.rig.contact_flexion_rad = 0.3;
    protocol.stimulus.expected_press = 0.003;
    RigDescription description;
    description.spec = load_rig_spec(source("devices/specs") + "/" + built.spec + ".json");
    CountingClock clock;
    const auto rig =
        make_simulated_rig(protocol, description, load_profile(source("devices/profiles/chinello2017.json")), 1, 1,
                           clock, {.telemetry_ticks = 100, .realtime = std::nullopt});
    PresentRequest request;
    request.stimulus.stiffness = 500;
    request.stimulus.cues = built.cues;
    request.explore_s = 1;
    request.no_contact_time_out_s = 10;
    request.id.trial = 1;
    const Presentation given = rig->present(request);
    CHECK(given.fault == Fault::none);
    CHECK(given.first_contact_s > 0);
    CHECK(clock.sleeps > 1000);
    CHECK(clock.at_last_sleep - clock.at_first_sleep == 0);
  }
}

TEST_CASE("neither reading a tracker's poses nor taking them allocates") {
  if (skipped()) return;
  using namespace jnd::testing;
  PoseFeed feed(kTwoFingers, Eigen::Isometry3d::Identity());
  std::string file = "jnd-poses 1 units=m clock=source\n";
  for (int i = 0; i < 100; ++i)
    for (const int finger : {kThumb, kIndex}) file += text_of(pressing_pose(finger, i * 5 * kMillisecond_ns, 0.05));
  const ScratchFile poses("poses.txt", file);
  ReplayTracker replay(poses.path(), kTwoFingers, Eigen::Isometry3d::Identity());
  replay.begin({}, 0);
  FingerPose pose;
  const char* why = "";
  int read = 0;
  const std::int64_t before = heap_calls;
  for (int i = 1; i < 3'000; ++i) {
    const std::int64_t now = i * kMillisecond_ns;
    PoseLine line = parse_pose_line("index 1 0.05 0 0 1 0 0 0 0.2 n=7", why).value();
    line.time_ns = now;
    line.seen = i % 10 != 0;
    (void)feed.take(line, i % 2 == 0 ? PoseClock::source : PoseClock::monotonic, now);
    feed.refuse();
    read += feed.read(1, pose) ? 1 : 0;
    read += replay.read(0, now, pose) ? 1 : 0;
  }
  CHECK(heap_calls == before);
  CHECK(read == 2 * 2'999);
}
