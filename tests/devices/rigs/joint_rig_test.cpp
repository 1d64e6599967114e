// Rigs with a McKibben finger, alone and under a fingertip with a platform: what each cue delivers is what was asked.
#include <cmath>

#include "protocols/input/input_error.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

constexpr Cues kCutaneous{.force = true, .vibration = false, .kinaesthetic = false};
constexpr Cues kKinaesthetic{.force = false, .vibration = false, .kinaesthetic = true};
constexpr Cues kTogether{.force = true, .vibration = false, .kinaesthetic = true};

struct JointSetup {
  Protocol protocol;
  RigDescription rig;
  SimulatedClock clock{0};
  std::unique_ptr<Rig> device;
  explicit JointSetup(const char* name, bool ideal_encoder = true, ForceGains gains = {}) {
    protocol = load_protocol(source_path("protocols") / (std::string(name) + ".json"));
    rig = shipped_rig(protocol.rig.device.c_str());
    for (DeviceSpec& spec : rig.spec.devices) {
      if (ideal_encoder) spec.sensors.encoder_pulses = 0;
      if (gains.kp > 0 && spec.model == DeviceModel::mckibben) spec.gains = gains;
    }
    device = make_simulated_rig(protocol, rig, shipped_profile("kinaesthetic"), 1, 7, clock);
  }
  Presentation present(double stiffness, Cues cues, int trial = 1) {
    PresentRequest asked = request(stiffness, cues, {.trial = trial});
    asked.explore_s = 6;
    return device->present(asked);
  }
};

}  // namespace

TEST_CASE("the McKibben rig renders what is asked at the joint, in N/rad") {
  JointSetup setup("mckibben-stiffness");
  CHECK(setup.device->info().name == "mckibben x 1");
  CHECK(setup.device->info().mode == "PI");
  CHECK(setup.device->info().tracker == "encoder");
  for (const double stiffness : {8.0, 15.0, 25.0, 30.0, 33.0, 37.0}) {
    INFO(stiffness);
    for (int trial = 1; trial <= 5; ++trial) {
      const Presentation given = setup.present(stiffness, kKinaesthetic, trial);
      REQUIRE(given.fault == Fault::none);
      REQUIRE(given.fingers.size() == 1);
      const FingerPresentation& joint = given.fingers[0];
      CHECK(joint.channel == Channel::kinaesthetic);
      REQUIRE(joint.stiffness.has_value());
      CHECK(*joint.stiffness == Approx(stiffness).epsilon(0.02));
      REQUIRE(joint.stiffness_se.has_value());
      CHECK(*joint.stiffness_se < 0.02 * stiffness);
      // The torque of the fingertip's force at the device's own lever arm.
      CHECK(*joint.joint_stiffness_n_m_per_rad ==
            Approx(*joint.stiffness * setup.rig.spec.kinaesthetic()->lever_arm_m));
      CHECK(joint.contacts == 3);
      CHECK(joint.peak_force_n <= 30);
      CHECK(joint.deepest_penetration > 0.1);
      CHECK(joint.work_j > 0);
    }
  }
}

TEST_CASE("the encoder's steps do not change what is rendered by more than two per cent") {
  JointSetup setup("mckibben-stiffness", false);
  for (const double stiffness : {25.0, 37.0})
    CHECK(*setup.present(stiffness, kKinaesthetic).fingers[0].stiffness == Approx(stiffness).epsilon(0.02));
}

TEST_CASE("under P alone the joint is softer than asked, and the delivered stiffness says so") {
  JointSetup setup("mckibben-stiffness", true, {.kp = 0.28});
  CHECK(setup.device->info().mode == "P");
  const FingerPresentation joint = setup.present(25, kKinaesthetic).fingers[0];
  REQUIRE(joint.stiffness.has_value());
  CHECK(*joint.stiffness < 0.85 * 25);
  CHECK(*joint.stiffness > 0.6 * 25);
}

TEST_CASE("one contact, two devices: each cue's delivered stiffness is recorded apart and is the asked one") {
  JointSetup setup("cutaneous-kinaesthetic");
  const double lever_m = setup.rig.spec.lever_arm_m;
  for (const double stiffness : {500.0, 600.0, 700.0, 900.0}) {
    INFO(stiffness);
    const Presentation given = setup.present(stiffness, kTogether);
    REQUIRE(given.fault == Fault::none);
    REQUIRE(given.fingers.size() == 2);
    const FingerPresentation &pulp = given.fingers[0], &joint = given.fingers[1];
    CHECK(pulp.channel == Channel::cutaneous);
    CHECK(joint.channel == Channel::kinaesthetic);
    CHECK(pulp.finger == 0);
    CHECK(joint.finger == 0);
    CHECK(*pulp.stiffness == Approx(stiffness).epsilon(0.02));
    CHECK_FALSE(pulp.joint_stiffness_n_m_per_rad.has_value());
    CHECK(*joint.stiffness == Approx(stiffness).epsilon(0.02));
    // Contact stiffness times the squared lever arm of the rig's file.
    CHECK(*joint.joint_stiffness_n_m_per_rad == Approx(stiffness * lever_m * lever_m).epsilon(0.02));
    CHECK(pulp.deepest_penetration == joint.deepest_penetration);
    CHECK(pulp.contacts == joint.contacts);
  }
}

TEST_CASE("each condition drives its own device only") {
  JointSetup setup("cutaneous-kinaesthetic");
  const Presentation pulp_only = setup.present(700, kCutaneous);
  CHECK(pulp_only.fingers[0].stiffness.has_value());
  CHECK_FALSE(pulp_only.fingers[1].stiffness.has_value());
  const Presentation joint_only = setup.present(700, kKinaesthetic);
  CHECK_FALSE(joint_only.fingers[0].stiffness.has_value());
  CHECK(joint_only.fingers[0].peak_force_n == 0);
  CHECK(joint_only.fingers[1].stiffness.has_value());
  // What the finger does is the same whatever it feels.
  CHECK(pulp_only.fingers[0].deepest_penetration == joint_only.fingers[0].deepest_penetration);
}

TEST_CASE("a stop and a wrong tracker are refused on joints too") {
  JointSetup setup("mckibben-stiffness");
  setup.device->stop.latch(StopSource::program);
  const Presentation refused = setup.present(25, kKinaesthetic);
  CHECK(refused.fault == Fault::emergency_stop);
  CHECK(refused.stopped_by == "program");
  setup.protocol.rig.tracker = "hand";
  CHECK_THROWS_AS(make_simulated_rig(setup.protocol, setup.rig, shipped_profile("kinaesthetic"), 1, 1, setup.clock),
                  InputError);
  setup.protocol.rig.tracker = "encoder";
  setup.protocol.rig.contact_flexion_rad = 0.6;  // beyond the finger's range
  CHECK_THROWS_AS(make_simulated_rig(setup.protocol, setup.rig, shipped_profile("kinaesthetic"), 1, 1, setup.clock),
                  InputError);
}
