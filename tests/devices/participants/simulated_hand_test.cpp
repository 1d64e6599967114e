// The hand presses as it should, never repeats itself by accident and always repeats itself on purpose.
#include "devices/participants/simulated_hand.h"

#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

std::vector<double> deepest_of_presses(SimulatedHand& hand, int finger, int presses) {
  std::vector<double> depths(static_cast<std::size_t>(presses), -1);
  for (int ms = 0; ms < 1000 * presses; ++ms) {
    const double depth = hand.depth_m(finger, hand.approach_s() + ms * 1e-3);
    double& deepest = depths[static_cast<std::size_t>(ms / 1000)];
    deepest = std::max(deepest, depth);
  }
  return depths;
}

}  // namespace

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
