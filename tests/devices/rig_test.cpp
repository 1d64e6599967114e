// A whole simulated rig: what it delivers is what was asked, within the device's limits, and it always ends at rest.
#include <cmath>
#include <set>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

struct SimulatedSetup {
  SimulatedClock clock{0};
  std::unique_ptr<Rig> rig;
  explicit SimulatedSetup(std::uint64_t seed = 7, int participant = 3) {
    rig = make_simulated_rig(small_protocol(), rrs3_rig(), shipped_profile("chinello2017"), participant, seed, clock);
  }
};

}  // namespace

TEST_CASE("the rig says what it is") {
  const SimulatedSetup setup;
  CHECK(setup.rig->info().name == "rrs3 x 2");
  CHECK(setup.rig->info().mode == "wrench");
  CHECK(setup.rig->info().tracker == "hand");
  CHECK(setup.rig->info().simulated);
}

TEST_CASE("every finger's fitted stiffness is what was asked, within one per cent") {
  SimulatedSetup setup;
  for (const double stiffness : {500.0, 600.0, 700.0, 900.0}) {
    for (int trial = 1; trial <= 10; ++trial) {
      const Presentation given = setup.rig->present(request(stiffness, kForce, {.trial = trial}));
      REQUIRE(given.fault == Fault::none);
      REQUIRE(given.fingers.size() == 2);
      for (const FingerPresentation& finger : given.fingers) {
        REQUIRE(finger.stiffness.has_value());
        CHECK(*finger.stiffness == Approx(stiffness).epsilon(0.01));
        CHECK(finger.contacts == 3);
        CHECK(finger.peak_force_n <= 4.7 + 1e-9);
        CHECK(finger.peak_force_n > 0.9);
        CHECK(finger.dwell_s == Approx(3 * kPressShare).margin(0.005));
        CHECK(finger.vibration_g == 0);
        CHECK(finger.work_j > 0);
        CHECK(finger.mean_speed > 0.005);
      }
      CHECK(given.first_contact_s > 0.3);
      CHECK(given.duration_s == Approx(given.first_contact_s + 3).margin(1e-9));
      CHECK(given.ticks == std::llround(given.duration_s * 1000));
      CHECK(given.overruns == 0);
      CHECK(given.lateness_max_us == 0);
    }
  }
}

TEST_CASE("without the force cue no force is commanded and none is fitted") {
  SimulatedSetup setup;
  const Presentation given = setup.rig->present(request(600, kVibration));
  for (const FingerPresentation& finger : given.fingers) {
    CHECK_FALSE(finger.stiffness.has_value());
    CHECK(finger.fit_samples == 0);
    CHECK(finger.peak_force_n == 0);
    CHECK(finger.work_j == 0);
    CHECK(finger.saturated_share == 0);
    CHECK(finger.vibration_g == Approx(600.0 / 1500 + 0.4));
    CHECK_FALSE(finger.vibration_clamped);
    CHECK(finger.deepest_penetration > 0.001);
  }
}

TEST_CASE("vibration follows (38) and is clamped, with a flag, above 900 N/m") {
  SimulatedSetup setup;
  for (const double stiffness : {500.0, 700.0, 900.0, 1200.0}) {
    const Presentation given = setup.rig->present(request(stiffness, kBoth));
    for (const FingerPresentation& finger : given.fingers) {
      CHECK(finger.vibration_g == Approx(std::min(stiffness / 1500 + 0.4, 1.0)));
      CHECK(finger.vibration_clamped == (stiffness > 900));
    }
  }
}

TEST_CASE("presses of 5 mm, SD 1 mm, saturate nearly every interval at 900 N/m and none at 500") {
  SimulatedSetup setup;
  int saturated_900 = 0, saturated_500 = 0;
  constexpr int kIntervals = 500;
  for (int trial = 1; trial <= kIntervals; ++trial) {
    const auto saturated = [&](double stiffness) {
      const Presentation given = setup.rig->present(request(stiffness, kForce, {.trial = trial}));
      for (const FingerPresentation& finger : given.fingers)
        if (finger.saturated_share > 0) return 1;
      return 0;
    };
    saturated_900 += saturated(900);
    saturated_500 += saturated(500);
  }
  // 1 - Phi(0.222)^6 = 0.959; four standard errors.
  CHECK(saturated_900 / static_cast<double>(kIntervals) == Approx(0.959).margin(0.036));
  CHECK(saturated_500 == 0);
}

TEST_CASE("an interval repeats exactly, whatever was presented before, at whatever time") {
  SimulatedSetup first, second;
  (void)second.rig->present(request(500, kBoth, {.trial = 9}));
  second.clock.sleep_until_ns(second.clock.now_ns() + 123'456'789);
  const Presentation a = first.rig->present(request(900, kBoth, {.trial = 4, .attempt = 2, .interval = 1}));
  const Presentation b = second.rig->present(request(900, kBoth, {.trial = 4, .attempt = 2, .interval = 1}));
  REQUIRE(a.fingers.size() == b.fingers.size());
  CHECK(a.ticks == b.ticks);
  for (std::size_t i = 0; i < a.fingers.size(); ++i) {
    CHECK(*a.fingers[i].stiffness == *b.fingers[i].stiffness);
    CHECK(a.fingers[i].peak_force_n == b.fingers[i].peak_force_n);
    CHECK(a.fingers[i].deepest_penetration == b.fingers[i].deepest_penetration);
    CHECK(a.fingers[i].work_j == b.fingers[i].work_j);
  }
}

TEST_CASE("what the hand does is the same for every stimulus") {
  SimulatedSetup setup;
  const Presentation soft = setup.rig->present(request(500, kForce));
  const Presentation hard = setup.rig->present(request(900, kBoth));
  const Presentation silent = setup.rig->present(request(900, kVibration));
  for (std::size_t i = 0; i < soft.fingers.size(); ++i) {
    CHECK(soft.fingers[i].deepest_penetration == hard.fingers[i].deepest_penetration);
    CHECK(soft.fingers[i].deepest_penetration == silent.fingers[i].deepest_penetration);
    CHECK(soft.fingers[i].dwell_s == hard.fingers[i].dwell_s);
    CHECK(soft.fingers[i].mean_speed == silent.fingers[i].mean_speed);
  }
  CHECK(soft.ticks == hard.ticks);
  CHECK(soft.first_contact_s == silent.first_contact_s);
}

TEST_CASE("an interval without contact ends at its time-out") {
  SimulatedSetup setup;
  PresentRequest early = request(500, kBoth);
  early.no_contact_time_out_s = 0.25;  // the hand has not arrived
  const Presentation given = setup.rig->present(early);
  CHECK(given.fault == Fault::no_contact);
  CHECK(given.first_contact_s == -1);
  CHECK(given.duration_s == Approx(0.25));
  CHECK_FALSE(given.fingers[0].stiffness.has_value());
}

TEST_CASE("an interval ends when so many contacts have ended, and with its time at the latest") {
  SimulatedSetup setup;
  PresentRequest twice = request(500, kForce);
  twice.contacts = 2;
  const Presentation given = setup.rig->present(twice), whole = setup.rig->present(request(500, kForce));
  REQUIRE(given.fault == Fault::none);
  int most = 0;
  for (const FingerPresentation& finger : given.fingers) most = std::max(most, finger.contacts);
  CHECK(most == 2);
  CHECK(given.first_contact_s == whole.first_contact_s);
  // Both hands press once a second, for a share of it: the second contact has ended, the third has not begun.
  CHECK(given.duration_s - given.first_contact_s > 1 + kPressShare - 0.1);
  CHECK(given.duration_s - given.first_contact_s < 2);
  PresentRequest many = request(500, kForce);
  many.contacts = 50;
  CHECK(setup.rig->present(many).ticks == whole.ticks);
}

TEST_CASE("an interval ends when it is enough, which is asked only once the object is touched") {
  SimulatedSetup setup;
  PresentRequest asked = request(500, kForce);
  int times = 0;
  asked.enough = [&times] { return ++times == 10; };
  const Presentation given = setup.rig->present(asked);
  REQUIRE(given.fault == Fault::none);
  CHECK(times == 10);
  CHECK(given.duration_s - given.first_contact_s == Approx(0.5).margin(0.051));
  times = 0;
  PresentRequest untouched = asked;
  untouched.no_contact_time_out_s = 0.25;
  CHECK(setup.rig->present(untouched).fault == Fault::no_contact);
  CHECK(times == 0);
}

TEST_CASE("a set latch refuses the next presentation until it is cleared") {
  SimulatedSetup setup;
  setup.rig->stop.latch(StopSource::program);
  const Presentation refused = setup.rig->present(request(500, kForce));
  CHECK(refused.fault == Fault::emergency_stop);
  CHECK(refused.duration_s == 0);
  CHECK(refused.fingers[0].peak_force_n == 0);
  setup.rig->stop.clear();
  CHECK(setup.rig->present(request(500, kForce)).fault == Fault::none);
}

TEST_CASE("one finger is enough for a rig") {
  SimulatedClock clock{0};
  Protocol protocol = small_protocol();
  protocol.rig.fingers = {"index"};
  const auto rig = make_simulated_rig(protocol, rrs3_rig(), shipped_profile("chinello2017"), 1, 1, clock);
  const Presentation given = rig->present(request(700, kForce));
  REQUIRE(given.fingers.size() == 1);
  CHECK(*given.fingers[0].stiffness == Approx(700).epsilon(0.01));
}

TEST_CASE("a rig that cannot be built says what to change") {
  SimulatedClock clock{0};
  const ParticipantProfile profile = shipped_profile("chinello2017");
  const auto build = [&](const Protocol& protocol, const ParticipantProfile& with) {
    return make_simulated_rig(protocol, rrs3_rig(), with, 1, 1, clock);
  };
  Protocol protocol = small_protocol();
  protocol.rig.tracker = "leap";
  CHECK_THROWS_AS(build(protocol, profile), InputError);
  protocol = small_protocol();
  protocol.rig.device = "other";
  CHECK_THROWS_AS(build(protocol, profile), InputError);
  protocol = small_protocol();
  protocol.rig.fingers = {"thumb", "index", "little"};
  CHECK_THROWS_AS(build(protocol, profile), InputError);
  protocol = small_protocol();
  protocol.rig.sphere_radius_m = 0.07;
  CHECK_THROWS_AS(build(protocol, profile), InputError);
  ParticipantProfile soft = profile;
  soft.pulp_stiffness_n_per_m = 400;
  CHECK_THROWS_AS(build(small_protocol(), soft), InputError);
}
