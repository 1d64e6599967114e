// Where a protocol asks for a tracker outside the program, a simulated rig has the simulated hand, and says so.
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

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
