// A cue from the devices: one short vibration, whatever the object would be, and never a force.
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

TEST_CASE("a tap is one vibration on every pulp, without an object and without a force") {
  SimulatedClock clock{0};
  const std::unique_ptr<Rig> rig =
      make_simulated_rig(small_protocol(), rrs3_rig(), shipped_profile("chinello2017"), 3, 7, clock);
  for (int trial = 1; trial <= 3; ++trial) {
    PresentRequest tap;
    tap.tap_g = 0.5;
    tap.explore_s = 0.15;
    tap.id = {trial, 1, 0};
    const Presentation given = rig->present(tap);
    REQUIRE(given.fault == Fault::none);
    CHECK(given.duration_s == Approx(0.15).margin(1e-9));
    CHECK(given.first_contact_s == -1);
    REQUIRE(given.fingers.size() == 2);
    for (const FingerPresentation& finger : given.fingers) {
      CHECK(finger.vibration_g == Approx(0.5));
      CHECK(finger.peak_force_n == 0);
      CHECK(finger.contacts == 0);
    }
    // The stimulus after it is what it is without a tap.
    const Presentation stimulus = rig->present(request(600, kForce, {.trial = trial}));
    REQUIRE(stimulus.fault == Fault::none);
    CHECK(stimulus.fingers[0].vibration_g == 0);
    REQUIRE(stimulus.fingers[0].stiffness.has_value());
    CHECK(*stimulus.fingers[0].stiffness == Approx(600).epsilon(0.01));
  }
}
