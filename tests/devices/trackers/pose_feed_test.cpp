// The stream of poses: numbers exact on made-up streams, times that cannot be are refused, and silence ends the force.
#include "devices/trackers/pose_feed.h"

#include <atomic>
#include <thread>

#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/devices/tracker_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

TrackerReport numbers(const PoseFeed& feed) {
  TrackerReport report;
  feed.add_to(report);
  return report;
}

// A source that tells both fingers every 5 ms what a press would be, until it falls silent.
class FedTracker final : public Tracker {
 public:
  explicit FedTracker(std::int64_t silent_ns, bool loses_thumb = false) : silent_ns_(silent_ns), loses_(loses_thumb) {}
  void begin(const PresentRequest& /*request*/, std::int64_t start_ns) override { next_ns_ = start_ns_ = start_ns; }
  bool read(int finger, std::int64_t now_ns, FingerPose& pose) noexcept override {
    for (; next_ns_ <= now_ns; next_ns_ += 5 * kMs) {
      const bool silent = next_ns_ - start_ns_ > silent_ns_;
      if (silent && !loses_) continue;
      // From 50 mm into the sphere of 40 mm within 0.1 s, and there to stay.
      const double x = std::max(0.036, 0.050 - 0.14 * 1e-9 * static_cast<double>(next_ns_ - start_ns_));
      PoseLine thumb = pressing_pose(kThumb, next_ns_, -x);
      thumb.seen = !silent;
      (void)feed_.take(thumb, PoseClock::monotonic, next_ns_);
      (void)feed_.take(pressing_pose(kIndex, next_ns_, x), PoseClock::monotonic, next_ns_);
      if (!silent) last_ns = next_ns_;
    }
    return feed_.read(finger, pose);
  }
  std::int64_t last_ns = 0;

 private:
  PoseFeed feed_{kTwoFingers, kHere};
  std::int64_t silent_ns_, start_ns_ = 0, next_ns_ = 0;
  bool loses_;
};

}  // namespace

TEST_CASE("delays become percentiles of steps, the largest exactly") {
  DelayHistogram delays;
  CHECK(delays.percentile_ms(0.5) == 0);
  for (int i = 1; i <= 100; ++i) delays.add(i * 100'000);  // 0.1 to 10 ms
  CHECK(delays.percentile_ms(0.5) == Approx(5.0));
  CHECK(delays.percentile_ms(0.99) == Approx(9.9));
  CHECK(delays.percentile_ms(1) == Approx(10.0));
  CHECK(delays.largest_ms() == Approx(10.0));
  delays.add(-5);
  delays.add(123'456'789);
  CHECK(delays.percentile_ms(1) == Approx(123.456789));
}

TEST_CASE("a steady stream has its rate, its latency and no gap") {
  PoseFeed feed(kTwoFingers, kHere);
  for (int i = 0; i <= 200; ++i) {
    const std::int64_t time = 1'000 * kMs + i * 5 * kMs;
    REQUIRE(feed.take(pose_at(kThumb, time), PoseClock::monotonic, time + 2 * kMs));
    REQUIRE(feed.take(pose_at(kIndex, time), PoseClock::monotonic, time + 3 * kMs));
  }
  const TrackerReport report = numbers(feed);
  CHECK(report.poses == 402);
  CHECK(report.gaps == 0);
  CHECK(report.refused == 0);
  CHECK(report.rate_hz == Approx(200));
  CHECK(report.latency_p50_ms == Approx(2));
  CHECK(report.latency_p99_ms == Approx(3));
  CHECK(report.latency_max_ms == Approx(3));
  CHECK(report.longest_wait_ms == Approx(5));
}

TEST_CASE("the rate is the slower finger's, while its poses came") {
  PoseFeed feed(kTwoFingers, kHere);
  for (int i = 0; i <= 100; ++i) {
    const std::int64_t time = i * 10 * kMs + (i > 50 ? 5'000 * kMs : 0);  // an outage of 5 s in the middle
    if (i % 2 == 0) (void)feed.take(pose_at(kThumb, time), PoseClock::monotonic, time);
    (void)feed.take(pose_at(kIndex, time), PoseClock::monotonic, time);
  }
  const TrackerReport report = numbers(feed);
  CHECK(report.rate_hz == Approx(50));
  CHECK(report.longest_wait_ms == Approx(5'020));
  CHECK(report.gaps == 2);  // the outage, of each finger
}

TEST_CASE("gaps are counted by the source's numbers where it has any") {
  PoseFeed feed({"index"}, kHere);
  const auto take = [&](std::uint32_t number, std::int64_t time_ms, bool seen = true) {
    PoseLine line = pose_at(kIndex, time_ms * kMs);
    line.sequence = number;
    line.seen = seen;
    (void)feed.take(line, PoseClock::monotonic, time_ms * kMs);
  };
  take(0xFFFF'FFFE, 0);
  take(0xFFFF'FFFF, 5);
  take(0, 10);  // it wraps
  CHECK(numbers(feed).gaps == 0);
  take(4, 30);  // 1, 2 and 3 are missing
  CHECK(numbers(feed).gaps == 3);
  take(5, 80);  // slow, and none missing
  CHECK(numbers(feed).gaps == 3);
  take(7, 85, false);  // 6 is missing, whatever this one says
  CHECK(numbers(feed).gaps == 4);
  take(2, 90);  // back: the source has begun anew
  CHECK(numbers(feed).gaps == 4);
  feed.begin();
  take(1000, 95);
  CHECK(numbers(feed).gaps == 4);
  take(1001, 100);
  CHECK(numbers(feed).gaps == 4);
}

TEST_CASE("without numbers a wait above 20 ms is a gap, but not one for a finger that is lost") {
  PoseFeed feed({"index"}, kHere);
  std::int64_t time = 0;
  const auto take_after = [&](std::int64_t wait_ns, bool seen = true) {
    time += wait_ns;
    PoseLine line = pose_at(kIndex, time);
    line.seen = seen;
    (void)feed.take(line, PoseClock::monotonic, time);
  };
  take_after(0);
  take_after(20 * kMs);
  CHECK(numbers(feed).gaps == 0);
  take_after(20 * kMs + 1);
  CHECK(numbers(feed).gaps == 1);
  take_after(10 * kMs, false);
  take_after(900 * kMs);
  CHECK(numbers(feed).gaps == 1);
  CHECK(numbers(feed).longest_wait_ms == Approx(20.000001));
}

TEST_CASE("times that cannot be are refused, and no pose is newer than its arrival") {
  PoseFeed feed({"index"}, kHere);
  FingerPose pose;
  CHECK_FALSE(feed.read(0, pose));
  CHECK_FALSE(feed.read(-1, pose));
  CHECK_FALSE(feed.read(1, pose));
  CHECK_FALSE(feed.take(pose_at(kIndex, 120 * kMs + 1, 0.1), PoseClock::monotonic, 100 * kMs));
  CHECK_FALSE(feed.read(0, pose));
  CHECK(feed.take(pose_at(kIndex, 120 * kMs, 0.2), PoseClock::monotonic, 100 * kMs));
  REQUIRE(feed.read(0, pose));
  CHECK(pose.time_ns == 100 * kMs);
  CHECK(pose.position_m.x() == 0.2);
  CHECK_FALSE(feed.take(pose_at(kIndex, 120 * kMs, 0.3), PoseClock::monotonic, 121 * kMs));  // nothing new
  CHECK_FALSE(feed.take(pose_at(kIndex, 110 * kMs, 0.3), PoseClock::monotonic, 121 * kMs));  // out of order
  CHECK(feed.take(pose_at(kIndex, 121 * kMs, 0.4), PoseClock::monotonic, 122 * kMs));
  REQUIRE(feed.read(0, pose));
  CHECK(pose.time_ns == 121 * kMs);
  CHECK(pose.position_m.x() == 0.4);
  const TrackerReport report = numbers(feed);
  CHECK(report.poses == 2);
  CHECK(report.refused == 3);
}

TEST_CASE("poses go from the tracker's frame to the world's") {
  Eigen::Isometry3d to_world = Eigen::Isometry3d::Identity();
  to_world.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  to_world.translation() = Eigen::Vector3d(0.1, 0.2, 0.3);
  PoseFeed feed({"middle", "thumb"}, to_world);
  PoseLine line = pose_at(2, 5);
  line.position_m = {0.01, 0.02, 0.03};
  line.orientation = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX());
  line.flexion_rad = 0.4;
  REQUIRE(feed.take(line, PoseClock::monotonic, 10));
  REQUIRE(feed.take(pose_at(kIndex, 5), PoseClock::monotonic, 10));  // no device is on this finger
  FingerPose pose;
  CHECK_FALSE(feed.read(1, pose));
  REQUIRE(feed.read(0, pose));
  CHECK((pose.position_m - Eigen::Vector3d(0.08, 0.21, 0.33)).norm() < 1e-15);
  const Eigen::Matrix3d expected = to_world.linear() * line.orientation.toRotationMatrix();
  CHECK((pose.device_axes - expected).norm() < 1e-15);
  CHECK((pose.device_axes.col(2) - Eigen::Vector3d(1, 0, 0)).norm() < 1e-15);  // z to -y, and that to x
  CHECK(pose.flexion_rad == 0.4);
  CHECK(pose.time_ns == 5);
  CHECK(numbers(feed).poses == 1);
}

TEST_CASE("a lost finger keeps its last pose, which grows old, and is missing") {
  PoseFeed feed(kTwoFingers, kHere);
  CHECK(feed.missing(0) == "no pose of the thumb has come yet");
  (void)feed.take(pose_at(kThumb, 1'000 * kMs, -0.05), PoseClock::monotonic, 1'000 * kMs);
  CHECK(feed.missing(1'000 * kMs) == "no pose of the index finger has come yet");
  (void)feed.take(pose_at(kIndex, 1'001 * kMs, 0.05), PoseClock::monotonic, 1'001 * kMs);
  CHECK(feed.missing(1'020 * kMs).empty());
  CHECK(feed.missing(1'021 * kMs) == "the newest pose of the thumb is 21 ms old (at most 20 ms)");
  PoseLine lost = pose_at(kIndex, 1'010 * kMs);
  lost.seen = false;
  CHECK(feed.take(lost, PoseClock::monotonic, 1'010 * kMs));
  CHECK(feed.missing(1'011 * kMs) == "the tracker does not see the index finger");
  FingerPose pose;
  REQUIRE(feed.read(1, pose));
  CHECK(pose.time_ns == 1'001 * kMs);
  CHECK(pose.position_m.x() == 0.05);
  (void)feed.take(pose_at(kIndex, 1'015 * kMs), PoseClock::monotonic, 1'015 * kMs);
  CHECK(feed.missing(1'016 * kMs).empty());
  feed.begin();
  CHECK(feed.missing(1'016 * kMs) == "no pose of the thumb has come yet");
}

TEST_CASE("a source with a clock of its own is mapped by its shortest delay") {
  PoseFeed feed({"index"}, kHere);
  constexpr std::int64_t kOffset_ns = -777'000'000'000'000;  // the source's clock less ours
  std::uint64_t state = 1;
  std::int64_t worst_ns = 0, latest_ns = 0;
  for (int i = 0; i < 10'000; ++i) {  // 50 s at 200 Hz, 30 ppm apart
    const std::int64_t truly_ns = 5'000'000'000 + i * 5 * kMs;
    state = state * 6364136223846793005U + 1442695040888963407U;
    // Every tenth comes at once, the others up to 4 ms late.
    const std::int64_t delay_ns = i % 10 == 0 ? 0 : static_cast<std::int64_t>((state >> 33U) % 4'000'000);
    const std::int64_t source_ns = truly_ns + kOffset_ns + (truly_ns - 5'000'000'000) * 30 / 1'000'000;
    REQUIRE(feed.take(pose_at(kIndex, source_ns), PoseClock::source, truly_ns + delay_ns));
    FingerPose pose;
    REQUIRE(feed.read(0, pose));
    CHECK(pose.time_ns <= truly_ns + delay_ns);
    worst_ns = std::max(worst_ns, std::abs(pose.time_ns - truly_ns));
    latest_ns = truly_ns;
  }
  CHECK(worst_ns < 500'000);
  const TrackerReport report = numbers(feed);
  CHECK(report.refused == 0);
  CHECK(report.rate_hz == Approx(200).epsilon(1e-3));
  CHECK(report.latency_max_ms < 4.5);
  CHECK(report.latency_p50_ms > 1);
  CHECK(report.latency_p50_ms < 2.5);
  // It is started again, and its clock with it.
  feed.begin();
  REQUIRE(feed.take(pose_at(kIndex, 0), PoseClock::source, latest_ns + 1'000 * kMs));
  FingerPose pose;
  REQUIRE(feed.read(0, pose));
  CHECK(std::abs(pose.time_ns - latest_ns - 1'000 * kMs) < 10'000);
}

TEST_CASE("a reader never meets half a pose") {
  PoseFeed feed({"index"}, kHere);
  std::atomic<bool> over{false};
  std::thread source([&] {
    for (int i = 1; i <= 200'000; ++i) {
      PoseLine line = pose_at(kIndex, i);
      line.position_m.setConstant(1e-6 * i);
      line.flexion_rad = 1e-6 * i;
      (void)feed.take(line, PoseClock::monotonic, i);
    }
    over = true;
  });
  std::int64_t last = 0, looks = 0;
  bool whole = true;
  while (!over) {
    FingerPose pose;
    if (!feed.read(0, pose)) continue;
    const double expected = 1e-6 * static_cast<double>(pose.time_ns);
    whole = whole && pose.position_m == Eigen::Vector3d::Constant(expected) && pose.flexion_rad == expected &&
            pose.time_ns >= last;
    last = pose.time_ns;
    ++looks;
  }
  source.join();
  CHECK(whole);
  CHECK(looks > 0);
  CHECK(numbers(feed).poses == 200'000);
}

TEST_CASE("a stream that falls silent, or loses a finger, takes the force away within 20 ms") {
  for (const bool loses_thumb : {false, true}) {
    FedTracker tracker(600 * kMs, loses_thumb);
    const Presentation given = present_on(tracker, 5'000 * kMs);
    CHECK(given.fault == Fault::stale_pose);
    const ForceEnd end = force_end(given);
    CHECK(end.largest_n > 1);
    CHECK(end.last_given_n == 0);
    CHECK(end.last_force_ns > tracker.last_ns);
    CHECK(end.last_force_ns <= tracker.last_ns + 20 * kMs);
    CHECK(end.last_tick_ns <= tracker.last_ns + 21 * kMs);
  }
}
