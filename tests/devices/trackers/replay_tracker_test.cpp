// Trackers without a device: poses from a file, and the simulated hand.
#include "devices/trackers/replay_tracker.h"

#include <cmath>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/devices/tracker_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

// Poses from a file: in time with the interval, straight between poses, never beyond them, the same every time.

namespace {

constexpr const char* kHeader = "# made up\njnd-poses 1 units=m clock=source\n";

std::vector<Diagnostic> mistakes_of(const std::string& text, const std::vector<std::string>& fingers = {"index"}) {
  const ScratchFile file("poses.txt", text);
  try {
    const ReplayTracker tracker(file.path(), fingers, kHere);
  } catch (const InputError& error) {
    return error.diagnostics();
  }
  return {};
}

// Both fingers every 5 ms: from 50 mm into the sphere of 40 mm, and there to stay.
std::string press(std::int64_t for_ns) {
  std::string text = kHeader;
  for (std::int64_t time = 0; time <= for_ns; time += 5 * kMs) {
    const double x = std::max(0.036, 0.050 - 0.14 * 1e-9 * static_cast<double>(time));
    text += text_of(pressing_pose(kThumb, 7'000 * kMs + time, -x));
    text += text_of(pressing_pose(kIndex, 7'000 * kMs + time, x));
  }
  return text;
}

}  // namespace

TEST_CASE("between poses the finger goes straight, on the loop's clock") {
  const ScratchFile file("poses.txt", std::string(kHeader) +
                                          "index 100.000 0.050 0 0 1 0 0 0 0.1\n"
                                          "index 100.010 0.060 0.010 0 0 0 0 1 0.2\r\n"
                                          "little 100.012 0 0 0 1 0 0 0\n"
                                          "\n"
                                          "index 100.030 0.070 0.010 0 0 0 0 1 0.2");
  ReplayTracker tracker(file.path(), {"index"}, kHere);
  FingerPose pose;
  for (const std::int64_t start : {std::int64_t{0}, 5'000'000'000, 77'000'000'123}) {
    tracker.begin({}, start);
    CHECK_FALSE(tracker.read(0, start - 1, pose));
    CHECK_FALSE(tracker.read(1, start, pose));
    REQUIRE(tracker.read(0, start, pose));
    CHECK(pose.position_m == Eigen::Vector3d(0.050, 0, 0));
    CHECK(pose.time_ns == start);
    REQUIRE(tracker.read(0, start + 4 * kMs, pose));
    CHECK((pose.position_m - Eigen::Vector3d(0.054, 0.004, 0)).norm() < 1e-15);
    CHECK(pose.flexion_rad == Approx(0.14));
    CHECK(pose.time_ns == start + 4 * kMs);
    // Half a turn about z in 10 ms: 0.4 of it.
    const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.4 * M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    CHECK((pose.device_axes - turned).norm() < 1e-12);
    REQUIRE(tracker.read(0, start + 20 * kMs, pose));  // 20 ms apart is not too far
    CHECK((pose.position_m - Eigen::Vector3d(0.065, 0.010, 0)).norm() < 1e-15);
    REQUIRE(tracker.read(0, start + 50 * kMs, pose));  // never beyond the last
    CHECK(pose.position_m == Eigen::Vector3d(0.070, 0.010, 0));
    CHECK(pose.time_ns == start + 30 * kMs);
  }
}

TEST_CASE("across a long wait and a lost finger the last pose stays, and grows old") {
  const ScratchFile file("poses.txt", std::string(kHeader) +
                                          "index 0 0.01 0 0 1 0 0 0\n"
                                          "index 0.020001 0.02 0 0 1 0 0 0\n"
                                          "index 0.025 lost\n"
                                          "index 0.030 0.03 0 0 1 0 0 0\n");
  ReplayTracker tracker(file.path(), {"index"}, kHere);
  tracker.begin({}, 0);
  FingerPose pose;
  REQUIRE(tracker.read(0, 20'000'999, pose));
  CHECK(pose.position_m.x() == 0.01);
  CHECK(pose.time_ns == 0);
  REQUIRE(tracker.read(0, 29 * kMs, pose));
  CHECK(pose.position_m.x() == 0.02);
  CHECK(pose.time_ns == 20'001'000);
  REQUIRE(tracker.read(0, 30 * kMs, pose));
  CHECK(pose.position_m.x() == 0.03);
}

TEST_CASE("a replay begins when every finger has a pose, and says what the file is like") {
  Eigen::Isometry3d to_world = Eigen::Isometry3d::Identity();
  to_world.translation() = Eigen::Vector3d(0, 0, -0.5);
  std::string text = kHeader;
  for (int i = 0; i <= 100; ++i) text += fmt::format("thumb {:.3f} 0 0 0.5 1 0 0 0 n={}\n", 1 + 0.010 * i, 2 * i);
  for (int i = 0; i <= 100; ++i)
    if (i != 50) text += fmt::format("index {:.3f} 0.1 0 0.5 1 0 0 0\n", 1.042 + 0.005 * i);
  const ScratchFile file("poses.txt", text);
  ReplayTracker tracker(file.path(), {"index", "thumb"}, to_world);
  tracker.begin({}, 1'000 * kMs);
  FingerPose pose;
  REQUIRE(tracker.read(0, 1'000 * kMs, pose));
  CHECK(pose.position_m == Eigen::Vector3d(0.1, 0, 0));
  REQUIRE(tracker.read(1, 1'000 * kMs, pose));
  CHECK(pose.time_ns == 1'000 * kMs);  // between those at 1.04 and 1.05
  const auto report = tracker.report();
  REQUIRE(report);
  CHECK(report->kind == "replay");
  CHECK(report->source == file.path().string());
  CHECK(report->connected);
  CHECK(report->poses == 201);
  CHECK(report->gaps == 100);  // every other number
  CHECK(report->rate_hz == Approx(100).epsilon(1e-9));
  CHECK(report->longest_wait_ms == Approx(10));
  CHECK(report->latency_max_ms == 0);
  CHECK(tracker.missing().empty());
}

TEST_CASE("a replay presses as a hand does, alike every time, and its end takes the force away within 20 ms") {
  const ScratchFile file("poses.txt", press(600 * kMs));
  ReplayTracker tracker(file.path(), kTwoFingers, kHere);
  Presentation first;
  for (const std::int64_t start : {1'000 * kMs, 9'000 * kMs}) {
    const Presentation given = present_on(tracker, start);
    CHECK(given.fault == Fault::stale_pose);
    const ForceEnd end = force_end(given);
    CHECK(end.largest_n > 1);
    CHECK(end.last_given_n == 0);
    CHECK(end.last_force_ns >= start + 600 * kMs);
    CHECK(end.last_force_ns <= start + 620 * kMs);
    CHECK(end.last_tick_ns <= start + 621 * kMs);
    if (start == 1'000 * kMs) first = given;
    CHECK(given.ticks == first.ticks);
    REQUIRE(given.fingers.size() == first.fingers.size());
    CHECK(given.last_ticks.back().finger_m == first.last_ticks.back().finger_m);
  }
  const ScratchFile long_file("poses.txt", press(5'000 * kMs));
  ReplayTracker whole(long_file.path(), kTwoFingers, kHere);
  CHECK(present_on(whole, 0).fault == Fault::none);
}

TEST_CASE("a file that cannot be played is told with its lines") {
  CHECK(mistakes_of(std::string(kHeader) + "index 0 0 0 0 1 0 0 0\n").empty());
  const auto mistakes = mistakes_of(std::string(kHeader) +
                                    "index 0 0 0 0 1 0 0 0\n"
                                    "index 0 0 0 0 1 0 0 0\n"
                                    "index 1 0 0 0 2 0 0 0\n"
                                    "thumb what\n" +
                                    std::string(300, 'x') + "\n");
  REQUIRE(mistakes.size() == 4);
  std::vector<int> lines;
  for (const Diagnostic& mistake : mistakes) {
    lines.push_back(mistake.line);
    CHECK_FALSE(mistake.message.empty());
    CHECK_FALSE(mistake.suggestion.empty());
  }
  std::sort(lines.begin(), lines.end());
  CHECK(lines == std::vector<int>{4, 5, 6, 7});
  CHECK(mistakes_of("").size() == 1);
  CHECK(mistakes_of("index 0 0 0 0 1 0 0 0\n").at(0).line == 1);
  CHECK(mistakes_of(kHeader).at(0).message.find("no pose of the index") != std::string::npos);
  CHECK(mistakes_of(std::string(kHeader) + "index 0 lost\n").size() == 1);
  CHECK(mistakes_of(std::string(kHeader) + "index 0 0 0 0 1 0 0 0\n", kTwoFingers).size() == 1);
  std::string many = kHeader;
  for (int i = 0; i < 1000; ++i) many += "nonsense\n";
  CHECK(mistakes_of(many).size() == 20);
  CHECK_THROWS_AS(ReplayTracker("/nowhere/poses.txt", kTwoFingers, kHere), InputError);
  CHECK_THROWS_AS(ReplayTracker("/", kTwoFingers, kHere), InputError);
}

// Where a protocol asks for a tracker outside the program, a simulated rig has the simulated hand, and says so.

TEST_CASE("a simulated rig takes the hand for any tracker of fingers in space, and does not claim another") {
  const auto made = [](const char* tracker, Clock& clock) {
    Protocol protocol = small_protocol();
    protocol.rig.tracker = tracker;
    return make_simulated_rig(protocol, rrs3_rig(), shipped_profile("chinello2017"), 1, 5, clock);
  };
  SimulatedClock clock(0);
  const auto hand = made("hand", clock);
  CHECK(hand->info().tracker == "hand");
  const Presentation by_hand = hand->present(request(700, kForce));
  REQUIRE(by_hand.fault == Fault::none);
  for (const std::string kind : {"hid", "process", "replay"}) {
    SimulatedClock own(0);
    const auto rig = made(kind.c_str(), own);
    CHECK(rig->info().tracker == "hand (for " + kind + ")");
    CHECK(rig->info().simulated);
    CHECK_FALSE(rig->connections().tracker);
    const Presentation given = rig->present(request(700, kForce));
    CHECK(given.ticks == by_hand.ticks);
    CHECK(given.first_contact_s == by_hand.first_contact_s);
    CHECK(given.fingers.at(0).stiffness.value() == by_hand.fingers.at(0).stiffness.value());
  }
  CHECK_THROWS_AS(made("encoder", clock), InputError);
  CHECK_THROWS_AS(made("pipe", clock), InputError);
}

TEST_CASE("a joint has its encoder and nothing else") {
  Protocol protocol = small_protocol();
  protocol.rig = {.device = "mckibben", .fingers = {"index"}, .tracker = "hid"};
  SimulatedClock clock(0);
  CHECK_THROWS_AS(make_simulated_rig(protocol, shipped_rig("mckibben"), shipped_profile("kinaesthetic"), 1, 5, clock),
                  InputError);
}
