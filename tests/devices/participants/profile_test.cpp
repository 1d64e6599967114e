// Profiles and the simulated hand.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

#include <Eigen/LU>
#include <unistd.h>

#include "devices/participants/simulated_hand.h"
#include "devices/participants/simulated_participant.h"
#include "protocols/input/input_error.h"
#include "protocols/planning/planned_precision.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// Shipped device and profiles, and what their readers say of mistakes.

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() / ("jnd_profile_" + std::to_string(::getpid()) + ".json")) {
    std::ofstream(path_) << text;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string complaint(const std::string& text) {
  const TemporaryFile file(text);
  try {
    (void)load_profile(file.path());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("the shipped device has the paper's limits") {
  const DeviceSpec spec = rrs3_spec();
  CHECK(spec.name == "rrs3");
  CHECK(spec.max_force_n == 4.7);
  CHECK(spec.stroke_m == 0.015);
  CHECK(spec.max_roll_rad == Approx(std::numbers::pi / 5));
  CHECK(spec.max_pitch_rad == Approx(std::numbers::pi / 6));
  CHECK(spec.max_joint_speed_rad_per_s == Approx(std::numbers::pi / 3 / 0.1));
  CHECK(spec.min_vibration_g == 0.05);
  CHECK(spec.max_vibration_g == 1);
  CHECK(spec.min_vibration_hz == 50);
  CHECK(spec.max_vibration_hz == 240);
  CHECK(spec.max_stiffness >= 900);
  CHECK(spec.bd_m == Approx(2 * std::sqrt(3.0) * spec.bh_m));
}

TEST_CASE("shipped profiles hold the published calibration") {
  const ParticipantProfile magnitude = shipped_profile("chinello2017");
  CHECK(magnitude.strategy == ParticipantProfile::Strategy::magnitude);
  CHECK(magnitude.sigma_force_n_per_m == 283.5);
  CHECK(magnitude.sigma_vibration_n_per_m == 351);
  CHECK(magnitude.criterion_n_per_m == 150);
  CHECK(magnitude.criterion_sigmas == 0);
  CHECK(magnitude.lapse_rate == 0);
  CHECK(magnitude.drift_per_trial == 0);
  CHECK(magnitude.spread_cv == 0);
  CHECK(magnitude.sha256.size() == 64);
  const ParticipantProfile differencing = shipped_profile("chinello2017-differencing");
  CHECK(differencing.strategy == ParticipantProfile::Strategy::differencing);
  CHECK(differencing.sigma_force_n_per_m == 148.2);
  CHECK(differencing.sigma_vibration_n_per_m == 173.5);
  CHECK(differencing.criterion_sigmas == 2);
  const ParticipantProfile varied = shipped_profile("chinello2017-varied");
  CHECK(varied.spread_cv == 0.2);
  CHECK(varied.lapse_rate == 0.02);
  CHECK(varied.drift_per_trial > 0);
  CHECK(varied.sha256 != magnitude.sha256);
  for (const auto* profile : {&magnitude, &differencing, &varied}) {
    CHECK(profile->ratings.at("S").first == 6.7);
    CHECK(profile->ratings.at("V").first == 3.7);
    CHECK(profile->ratings.at("SV").first == 7.6);
  }
}

TEST_CASE("shipped profiles keep their Weber fractions at another reference") {
  StimulusSpec stimulus;
  stimulus.reference = 900;
  for (const char* name : {"chinello2017", "chinello2017-differencing", "chinello2017-varied", "kinaesthetic",
                           "chinello2017-experiment2"}) {
    CAPTURE(name);
    const ParticipantProfile profile = shipped_profile(name);
    stimulus.reference = 900;
    const ParticipantProfile published = at_reference(profile, stimulus);
    CHECK(published.sigma_force_n_per_m == profile.sigma_force_n_per_m);
    CHECK(published.sigma_vibration_n_per_m == profile.sigma_vibration_n_per_m);
    CHECK(published.criterion_n_per_m == profile.criterion_n_per_m);
    stimulus.reference = 450;
    const ParticipantProfile half = at_reference(profile, stimulus);
    CHECK(half.sigma_force_n_per_m == profile.sigma_force_n_per_m / 2);
    CHECK(half.sigma_vibration_n_per_m == profile.sigma_vibration_n_per_m / 2);
    CHECK(half.criterion_n_per_m == profile.criterion_n_per_m / 2);
    CHECK(half.criterion_sigmas == profile.criterion_sigmas);
  }
  ParticipantProfile absolute = shipped_profile("chinello2017");
  absolute.calibrated_at_n_per_m = 0;
  CHECK(at_reference(absolute, stimulus).sigma_force_n_per_m == 283.5);
}

TEST_CASE("planning assumes the JNDs of the simulated participants") {
  Protocol protocol;
  protocol.stimulus.reference = 450;
  for (const Cues cues : {Cues{true, false, false}, Cues{false, true, false}, Cues{true, true, false},
                          Cues{true, false, true}, Cues{false, false, true}}) {
    protocol.conditions = {{"c", "c", cues, true}};
    const ParticipantProfile profile =
        at_reference(shipped_profile(default_profile(protocol).c_str()), protocol.stimulus);
    double precision = 0;
    if (cues.force) precision += std::pow(profile.sigma_force_n_per_m, -2);
    if (cues.vibration) precision += std::pow(profile.sigma_vibration_n_per_m, -2);
    if (cues.kinaesthetic) precision += std::pow(profile.kinaesthetic_weber * 450, -2);
    CHECK(planned_jnd(protocol, "c").value == Approx(1 / std::sqrt(precision)).epsilon(1e-12));
  }
}

TEST_CASE("mistakes in a profile are named, all at once") {
  const std::string good = R"("format": 1, "name": "x", "title": "t", "strategy": "magnitude",
    "sigma_force_n_per_m": 100, "sigma_vibration_n_per_m": 100)";
  CHECK(complaint("{" + good + R"(, "criterion_n_per_m": 50})").empty());
  CHECK(complaint("{" + good + "}").find("criterion") != std::string::npos);
  CHECK(complaint("{" + good + R"(, "criterion_n_per_m": 50, "criterion_sigmas": 2})").find("both") !=
        std::string::npos);
  const std::string two = complaint("{" + good + R"(, "criterion_n_per_m": -1, "lapserate": 0.1})");
  CHECK(two.find("criterion_n_per_m") != std::string::npos);
  CHECK(two.find("lapse_rate") != std::string::npos);  // the nearest known name
  CHECK(complaint("{" + good + R"(, "criterion_n_per_m": 50, "ratings": {"S": {"mean": 5}}})").find("sd") !=
        std::string::npos);
  CHECK(complaint("{" + good + R"(, "criterion_n_per_m": 50, "hand": {"press_depth_m": 5}})").find("press_depth_m") !=
        std::string::npos);
  CHECK(complaint("{" + good).find(":") != std::string::npos);
  CHECK_THROWS_AS(load_profile("no/such/profile.json"), InputError);
}

// The hand presses as it should, never repeats itself by accident and always repeats itself on purpose.

std::vector<double> deepest_of_presses(SimulatedHand& hand, int finger, int presses) {
  std::vector<double> depths(static_cast<std::size_t>(presses), -1);
  for (int ms = 0; ms < 1000 * presses; ++ms) {
    const double depth = hand.depth_m(finger, hand.approach_s() + ms * 1e-3);
    double& deepest = depths[static_cast<std::size_t>(ms / 1000)];
    deepest = std::max(deepest, depth);
  }
  return depths;
}

TEST_CASE("fingers face each other, rest apart, and close in their own time") {
  SimulatedHand hand(HandHabits{}, 2, 1, 1);
  hand.begin(request(500, kForce), 1000);
  FingerPose thumb, index;
  REQUIRE(hand.read(0, 1000, thumb));
  REQUIRE(hand.read(1, 1000, index));
  CHECK((index.position_m - thumb.position_m).norm() == Approx(0.130).margin(0.002));
  CHECK(thumb.position_m.norm() == Approx(0.065));
  CHECK(thumb.position_m.x() < 0);
  CHECK(index.position_m.x() > 0);
  CHECK(thumb.time_ns == 1000);
  for (const FingerPose& pose : {thumb, index}) {
    CHECK((pose.device_axes.transpose() * pose.device_axes - Eigen::Matrix3d::Identity()).norm() < 1e-12);
    CHECK(pose.device_axes.determinant() == Approx(1));
    // Dorsal is away from the sphere.
    CHECK(pose.device_axes.col(2).dot(pose.position_m) > 0.06);
  }
  CHECK(hand.approach_s() == Approx(0.5));
  for (int ms = 0; ms <= 500; ++ms) CHECK(hand.depth_m(0, ms * 1e-3) <= 1e-12);
  CHECK(hand.depth_m(0, 0.510) > 0);
  SimulatedHand hasty(HandHabits{.closing_speed_m_per_s = 0.4}, 2, 1, 1);
  CHECK(hasty.approach_s() == kLeastApproach_s);
}

TEST_CASE("depths are normal about the expected press and differ from press to press and finger to finger") {
  SimulatedHand hand(HandHabits{}, 2, 5, 2);
  double sum = 0, squares = 0;
  int count = 0;
  for (int trial = 1; trial <= 200; ++trial) {
    PresentRequest asked = request(500, kForce, {.trial = trial});
    hand.begin(asked, 0);
    const std::vector<double> thumb = deepest_of_presses(hand, 0, 3), index = deepest_of_presses(hand, 1, 3);
    CHECK(thumb[0] != thumb[1]);
    CHECK(thumb[0] != index[0]);
    for (const std::vector<double>* depths : {&thumb, &index}) {
      for (const double depth : *depths) {
        CHECK(depth > kLeastPress_m * 0.99);
        sum += depth;
        squares += depth * depth;
        ++count;
      }
    }
  }
  const double mean = sum / count, sd = std::sqrt(squares / count - mean * mean);
  CHECK(mean == Approx(0.005).margin(4 * 0.001 / std::sqrt(count)));
  CHECK(sd == Approx(0.001).epsilon(0.1));
}

TEST_CASE("motion is smooth and within a person's speed") {
  SimulatedHand hand(HandHabits{}, 2, 9, 4);
  hand.begin(request(900, kBoth), 0);
  FingerPose before, now;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  REQUIRE(hand.read(1, 0, before));
  for (int ms = 1; ms < 3500; ++ms) {
    REQUIRE(hand.read(1, ms * 1'000'000LL, now));
    const Eigen::Vector3d next = (now.position_m - before.position_m) * 1000;
    REQUIRE(next.norm() < 0.15);
    if (ms > 1) REQUIRE((next - velocity).norm() < 0.002);  // 2 m/s^2 over a millisecond
    velocity = next;
    before = now;
  }
}

TEST_CASE("the same interval moves the same, another one does not") {
  const auto depth = [](std::uint64_t seed, int participant, IntervalId id, double stiffness) {
    SimulatedHand hand(HandHabits{}, 2, seed, participant);
    hand.begin(request(stiffness, kBoth, id), 77);
    return hand.depth_m(1, 2.7);
  };
  const double base = depth(1, 1, {.trial = 5, .attempt = 1, .interval = 0}, 500);
  CHECK(depth(1, 1, {.trial = 5, .attempt = 1, .interval = 0}, 900) == base);
  CHECK(depth(2, 1, {.trial = 5, .attempt = 1, .interval = 0}, 500) != base);
  CHECK(depth(1, 2, {.trial = 5, .attempt = 1, .interval = 0}, 500) != base);
  CHECK(depth(1, 1, {.trial = 6, .attempt = 1, .interval = 0}, 500) != base);
  CHECK(depth(1, 1, {.trial = 5, .attempt = 2, .interval = 0}, 500) != base);
  CHECK(depth(1, 1, {.trial = 5, .attempt = 1, .interval = 1}, 500) != base);
}

TEST_CASE("the contact point wanders by about its habit") {
  SimulatedHand hand(HandHabits{.lateral_sd_m = 0.001}, 1, 3, 3);
  double squares = 0;
  constexpr int kTrials = 400;
  for (int trial = 1; trial <= kTrials; ++trial) {
    hand.begin(request(500, kForce, {.trial = trial}), 0);
    FingerPose pose;
    REQUIRE(hand.read(0, 500'000'000, pose));
    squares += pose.position_m.y() * pose.position_m.y();
  }
  CHECK(std::sqrt(squares / kTrials) == Approx(0.001).epsilon(0.15));
}

TEST_CASE("impossible hands are refused") {
  CHECK_THROWS_AS(SimulatedHand(HandHabits{.sphere_radius_m = 0.065}, 2, 1, 1), InputError);
  CHECK_THROWS_AS(SimulatedHand(HandHabits{.press_period_s = 0}, 2, 1, 1), InputError);
}

}  // namespace
