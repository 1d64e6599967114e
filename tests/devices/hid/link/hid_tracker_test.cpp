// A tracker over HID: its reports become poses, gaps are counted exactly, and what is unplugged is missing until it is
// back.
#include "devices/hid/link/hid_tracker.h"

#include <array>
#include <atomic>
#include <cmath>

#include "devices/clock.h"
#include "devices/device_error.h"
#include "devices/hid/firmware/jnd_report.h"
#include "protocols/input/input_error.h"
#include "protocols/rigs/rig_description.h"
#include "tests/catch.h"
#include "tests/devices/hid/buttons/made_up_box.h"
#include "tests/devices/tracker_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

const Eigen::Isometry3d kHere = Eigen::Isometry3d::Identity();

// Stands still until it is set.
class SetClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override { return now.load(); }
  std::int64_t utc_ns() const noexcept override { return now.load(); }
  void sleep_until_ns(std::int64_t /*deadline*/) noexcept override {}
  std::atomic<std::int64_t> now{50'000 * kMs};
};

HidInfo tracker_info(const std::string& serial, const std::string& path = "/dev/made-up-tracker") {
  HidInfo info;
  info.path = path;
  info.usage_page = JND_USAGE_PAGE;
  info.usage = JND_USAGE_TRACKER;
  info.serial = serial;
  return info;
}

jnd_pose pose_of(std::uint8_t finger, std::uint32_t sequence, std::uint64_t time_us, double x_m) {
  jnd_pose pose{};
  pose.finger = finger;
  pose.seen = true;
  pose.sequence = sequence;
  pose.time_us = time_us;
  pose.position_nm[0] = static_cast<std::int32_t>(std::lround(1e9 * x_m));
  const PoseLine pressing = pressing_pose(kThumb, 0, x_m);
  const std::array<double, 4> numbers = {pressing.orientation.w(), pressing.orientation.x(), pressing.orientation.y(),
                                         pressing.orientation.z()};
  for (std::size_t i = 0; i < 4; ++i)
    pose.orientation[i] = static_cast<std::int32_t>(std::lround((1 << 30) * numbers[i]));
  return pose;
}

std::vector<std::uint8_t> bytes_of(const jnd_pose& pose) {
  std::vector<std::uint8_t> bytes(JND_REPORT_SIZE);
  jnd_encode_pose(&pose, bytes.data());
  return bytes;
}

jnd_identity identity_of(const std::string& serial) {
  jnd_identity identity{};
  identity.lowest_version = identity.highest_version = JND_PROTOCOL_VERSION;
  identity.model = JND_MODEL_TRACKER;
  identity.degrees_of_freedom = 6;
  identity.firmware[0] = 2;
  identity.firmware[1] = 7;
  identity.loop_rate_hz = 200;
  identity.capabilities = JND_CAN_TRACK;
  std::copy(serial.begin(), serial.end(), std::begin(identity.serial));
  return identity;
}

// Shows its identity page when asked.
jnd::test::MadeUpBus::Answers shows(const jnd_identity& identity) {
  return [identity](std::span<const std::uint8_t> bytes) -> std::vector<std::uint8_t> {
    jnd_request request{};
    if (jnd_decode_request(bytes.data(), bytes.size(), &request) != JND_DECODE_OK) return {};
    jnd_answer answer{};
    answer.page = request.page;
    answer.token = request.token;
    answer.result = request.page == JND_PAGE_IDENTITY ? JND_PAGE_OK : JND_PAGE_UNKNOWN;
    if (answer.result == JND_PAGE_OK) jnd_encode_identity(&identity, answer.data);
    std::vector<std::uint8_t> report(JND_REPORT_SIZE);
    jnd_encode_answer(&answer, report.data());
    return report;
  };
}

// A tracker on a made-up bus, and a way to send it reports that arrive at chosen times.
struct Bench {
  explicit Bench(const std::string& serial = "") : tracker(bus, serial, kTwoFingers, kHere, clock) {
    bus.answer(shows(identity_of("TR-1")));
  }
  std::int64_t heard() const {
    const auto report = tracker.report();
    return report->poses + report->refused;
  }
  // Waits until it has been taken or refused.
  void send(const std::vector<std::uint8_t>& bytes, std::int64_t arrival_ns) {
    clock.now = arrival_ns;
    const std::int64_t before = heard();
    bus.send(bytes);
    REQUIRE(wait_until([&] { return heard() > before; }));
  }
  bool connects() {
    return wait_until([&] { return tracker.report()->connected; });
  }

  jnd::test::MadeUpBus bus;
  SetClock clock;
  HidTracker tracker;
};

}  // namespace

TEST_CASE("reports of a tracker become poses of the fingers that wear devices") {
  Bench bench;
  CHECK(bench.tracker.missing() == "the tracker is not connected");
  HidInfo fingertip = tracker_info("TR-0", "/dev/fingertip");
  fingertip.usage = JND_USAGE_FINGERTIP;
  bench.bus.plug(fingertip);
  bench.bus.plug(tracker_info("TR-1"));
  REQUIRE(bench.connects());
  CHECK(bench.tracker.report()->source == "TR-1");
  CHECK(bench.tracker.missing() == "no pose of the thumb has come yet");
  jnd_pose thumb = pose_of(JND_THUMB, 7, 1'000'000, -0.05);
  thumb.position_nm[1] = 12'345'678;
  thumb.has_flexion = true;
  thumb.flexion_urad = -250'000;
  bench.send(bytes_of(thumb), 50'000 * kMs);
  bench.send(bytes_of(pose_of(JND_INDEX, 8, 1'005'000, 0.05)), 50'005 * kMs);
  FingerPose pose;
  REQUIRE(bench.tracker.read(0, 0, pose));
  CHECK((pose.position_m - Eigen::Vector3d(-0.05, 0.012345678, 0)).norm() < 1e-15);
  CHECK((pose.device_axes.col(2) - Eigen::Vector3d(-1, 0, 0)).norm() < 1e-8);
  CHECK((pose.device_axes * pose.device_axes.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-14);
  CHECK(pose.flexion_rad == Approx(-0.25));
  CHECK(pose.time_ns == 50'000 * kMs);
  REQUIRE(bench.tracker.read(1, 0, pose));
  CHECK(pose.time_ns == 50'005 * kMs);
  CHECK(pose.flexion_rad == 0);
  CHECK(bench.tracker.missing().empty());
  bench.clock.now = 50'021 * kMs;
  CHECK(bench.tracker.missing() == "the newest pose of the thumb is 21 ms old (at most 20 ms)");
}

TEST_CASE("a late report is as old as it is, and a lost finger keeps its last pose") {
  Bench bench;
  bench.bus.plug(tracker_info("TR-1"));
  REQUIRE(bench.connects());
  for (std::uint32_t i = 0; i < 100; ++i)
    bench.send(bytes_of(pose_of(JND_THUMB, i, 5'000 * i, -0.05)), (50'000 + 5 * static_cast<std::int64_t>(i)) * kMs);
  bench.send(bytes_of(pose_of(JND_THUMB, 100, 500'000, -0.04)), 50'508 * kMs);  // 8 ms late
  FingerPose pose;
  REQUIRE(bench.tracker.read(0, 0, pose));
  CHECK(std::abs(pose.time_ns - 50'500 * kMs) < 2'000);
  CHECK(bench.tracker.report()->latency_max_ms == Approx(8).margin(0.01));
  CHECK(bench.tracker.report()->latency_p50_ms < 0.1);
  jnd_pose lost{};
  lost.finger = JND_THUMB;
  lost.sequence = 101;
  lost.time_us = 510'000;
  bench.bus.send(bytes_of(lost));
  REQUIRE(wait_until([&] { return bench.tracker.missing() == "the tracker does not see the thumb"; }));
  REQUIRE(bench.tracker.read(0, 0, pose));
  CHECK(pose.position_m.x() == Approx(-0.04));
  CHECK(std::abs(pose.time_ns - 50'500 * kMs) < 2'000);
}

TEST_CASE("gaps and damage are counted exactly") {
  Bench bench;
  bench.bus.plug(tracker_info("TR-1"));
  REQUIRE(bench.connects());
  std::int64_t time_ms = 0;
  const auto send = [&](std::vector<std::uint8_t> bytes) { bench.send(bytes, (50'000 + time_ms) * kMs); };
  const auto next = [&](std::uint32_t sequence) {
    time_ms += 5;
    return bytes_of(pose_of(sequence % 2 == 0 ? JND_THUMB : JND_INDEX, sequence,
                            static_cast<std::uint64_t>(1'000 * time_ms), 0.05));
  };
  for (std::uint32_t i = 0xFFFF'FFF0; i != 16; ++i) send(next(i));
  CHECK(bench.tracker.report()->gaps == 0);
  send(next(20));  // 16 to 19 are missing
  CHECK(bench.tracker.report()->gaps == 4);
  auto damaged = next(21);
  damaged[20] ^= 1;
  send(damaged);
  send(std::vector<std::uint8_t>(10, JND_REPORT_TRACKER));
  send(std::vector<std::uint8_t>(64, 0x55));
  auto page = std::vector<std::uint8_t>(64);
  page[0] = JND_REPORT_PAGE;
  bench.bus.send(page);  // an answer to another program
  send(next(22));
  auto report = bench.tracker.report();
  CHECK(report->refused == 3);
  CHECK(report->gaps == 5);
  CHECK(report->poses == 34);
  jnd_pose ages = pose_of(JND_THUMB, 23, 0xFFFF'FFFF'FFFF'FFFF, 0.05);  // 600,000 years
  send(bytes_of(ages));
  CHECK(bench.tracker.report()->refused == 4);
}

TEST_CASE("a tracker that is unplugged is missing, and taken up again on another path") {
  Bench bench("TR-1");
  bench.bus.plug(tracker_info("TR-2", "/dev/other"));
  bench.bus.plug(tracker_info("TR-1"));
  REQUIRE(bench.connects());
  CHECK(bench.tracker.report()->source == "TR-1");
  bench.send(bytes_of(pose_of(JND_THUMB, 1000, 9'000'000, -0.05)), 50'000 * kMs);
  bench.bus.unplug();
  REQUIRE(wait_until([&] { return !bench.tracker.report()->connected; }));
  CHECK(bench.tracker.missing().substr(0, 38) == "the tracker TR-1 is not connected: unp");
  CHECK(bench.tracker.report()->trouble.find("pulled out") != std::string::npos);
  FingerPose pose;
  REQUIRE(bench.tracker.read(0, 0, pose));
  CHECK(pose.time_ns == 50'000 * kMs);  // it grows old
  bench.bus.plug(tracker_info("TR-1", "/dev/made-up-again"));
  REQUIRE(bench.connects());
  bench.send(bytes_of(pose_of(JND_THUMB, 0, 10, -0.05)), 60'000 * kMs);  // numbers and clock are new
  REQUIRE(bench.tracker.read(0, 0, pose));
  CHECK(pose.time_ns == 60'000 * kMs);
  CHECK(bench.tracker.report()->gaps == 0);
  CHECK(bench.tracker.report()->trouble.empty());
}

TEST_CASE("a tracker is asked who it is before its poses count") {
  const auto said_of = [](const jnd_identity& identity, const std::string& wanted = "") {
    Bench bench(wanted);
    bench.bus.answer(shows(identity));
    bench.bus.plug(tracker_info(""));  // no serial number on the bus
    const std::string none = "the tracker" + (wanted.empty() ? "" : " " + wanted) + " is not connected";
    REQUIRE(wait_until([&] { return bench.tracker.missing() != none; }));
    return bench.tracker.missing();
  };
  jnd_identity later = identity_of("TR-1");
  later.lowest_version = 2;
  later.highest_version = 3;
  CHECK(said_of(later).find("speaks versions 2 to 3 of the report protocol") != std::string::npos);
  jnd_identity fingertip = identity_of("TR-1");
  fingertip.model = JND_MODEL_RRS3;
  CHECK(said_of(fingertip).find("says that it is a 3RRS fingertip device") != std::string::npos);
  CHECK(said_of(identity_of("TR-2"), "TR-1").find("is tracker TR-2, not TR-1") != std::string::npos);
  CHECK(said_of(identity_of("TR-1"), "TR-1") == "no pose of the thumb has come yet");
}

TEST_CASE("a tracker that answers nothing is not used") {
  Bench bench;
  bench.bus.answer([](std::span<const std::uint8_t>) { return std::vector<std::uint8_t>(); });
  bench.bus.plug(tracker_info("TR-1"));
  REQUIRE(wait_until([&] { return bench.tracker.missing().find("did not answer") != std::string::npos; }));
  CHECK_FALSE(bench.tracker.report()->connected);
}

TEST_CASE("a tracker says its firmware, and whether it is a model in software") {
  for (const bool model : {false, true}) {
    Bench bench;
    jnd_identity identity = identity_of("TR-1");
    if (model) identity.capabilities |= JND_IS_MODEL;
    bench.bus.answer(shows(identity));
    bench.bus.plug(tracker_info(""));
    REQUIRE(bench.connects());
    CHECK(bench.tracker.report()->source == "TR-1");
    CHECK(bench.tracker.report()->firmware == "2.7.0");
    CHECK(bench.tracker.report()->is_model == model);
  }
}

TEST_CASE("a tracker that may not be opened is told with the reason") {
  Bench bench;
  bench.bus.refuse("this login may not open it");
  bench.bus.plug(tracker_info("TR-1"));
  CHECK(wait_until(
      [&] { return bench.tracker.missing() == "the tracker is not connected: this login may not open it"; }));
}

TEST_CASE("a HID tracker that falls silent takes the force away within 20 ms") {
  Bench bench;
  bench.bus.plug(tracker_info("TR-1"));
  REQUIRE(bench.connects());
  bench.send(bytes_of(pose_of(JND_THUMB, 1, 1'000'000, -0.036)), 50'000 * kMs);
  bench.send(bytes_of(pose_of(JND_INDEX, 2, 1'000'000, 0.036)), 50'000 * kMs);
  const Presentation given = present_on(bench.tracker, 50'000 * kMs);
  CHECK(given.fault == Fault::stale_pose);
  const ForceEnd end = force_end(given);
  CHECK(end.largest_n > 0.05);  // the soft start is not over yet
  CHECK(end.last_given_n == 0);
  CHECK(end.last_force_ns > 50'000 * kMs);
  CHECK(end.last_force_ns <= 50'020 * kMs);
  CHECK(end.last_tick_ns <= 50'021 * kMs);
}

TEST_CASE("the tracker of a protocol is made from what the rig file says") {
  jnd::test::MadeUpBus bus;
  const SteadyClock clock;
  for (const char* const kind : {"hid", "process", "replay"}) CHECK(is_streamed(kind));
  for (const char* const kind : {"hand", "encoder", "", "HID"}) CHECK_FALSE(is_streamed(kind));
  CHECK(make_streamed_tracker("hid", kTwoFingers, {}, bus, clock)->report()->kind == "hid");
  const auto message = [&](const char* kind) -> std::string {
    try {
      (void)make_streamed_tracker(kind, kTwoFingers, {}, bus, clock);
    } catch (const InputError& error) {
      return error.what();
    }
    return "made";
  };
  CHECK(message("process").find("\"command\"") != std::string::npos);
  CHECK(message("replay").find("\"replay\"") != std::string::npos);
  CHECK(message("hand").find("\"hand\"") != std::string::npos);
  TrackerSource source;
  source.command = {"tail", "-f", "/dev/null"};
  CHECK(make_streamed_tracker("process", kTwoFingers, source, bus, clock)->report()->source == "tail -f /dev/null");
  const ScratchFile file("poses.txt",
                         "jnd-poses 1 units=m clock=source\nindex 0 0 0 0 1 0 0 0\nthumb 0 0 0 0 1 0 0 0\n");
  source.replay = file.path();
  CHECK(make_streamed_tracker("replay", kTwoFingers, source, bus, clock)->report()->poses == 2);
}
