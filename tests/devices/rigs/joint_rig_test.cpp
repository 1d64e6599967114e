// Rigs with a McKibben finger, and a laboratory's rig file.
#include <cmath>
#include <set>

#include "devices/rigs/rig_file.h"
#include "protocols/input/input_error.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/devices/tracker_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// Rigs with a McKibben finger, alone and under a fingertip with a platform: what each cue delivers is what was asked.

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

// A laboratory's rig file: everything that it may say, and every mistake with its place.

std::vector<Diagnostic> mistakes_of(const std::string& text) {
  const ScratchFile file("rig.json", text);
  try {
    (void)load_rig_file(file.path());
  } catch (const InputError& error) {
    return error.diagnostics();
  }
  return {};
}

// The only mistake of a file whose other members are right.
Diagnostic mistake(const std::string& members) {
  const auto mistakes = mistakes_of("{\"format\": 1, \"title\": \"Ours\",\n " + members + "}");
  REQUIRE(mistakes.size() == 1);
  CHECK(mistakes[0].line == 2);
  CHECK(mistakes[0].column > 1);
  CHECK_FALSE(mistakes[0].file.empty());
  return mistakes[0];
}

TEST_CASE("a rig file with everything is read") {
  const ScratchFile file("rig.json", R"({
    "format": 1, "title": "Booth 2", "notes": "by the window",
    "devices": [{"finger": "thumb", "serial": "T-01"}, {"finger": "index"}],
    "tracker": {"serial": "TR-7", "command": ["python3", "bridge.py", "--rate", "200"], "replay": "poses/press.txt",
                "position_m": [0.1, -0.2, 0.3], "rotation": [0.5, 0.5, 0.5, 0.5]},
    "buttons": "/etc/buttons.json"})");
  const RigFile rig = load_rig_file(file.path());
  CHECK(rig.title == "Booth 2");
  CHECK(rig.sha256.size() == 64);
  REQUIRE(rig.devices.size() == 2);
  CHECK(rig.devices[0].finger == "thumb");
  CHECK(rig.devices[0].serial == "T-01");
  CHECK(rig.devices[1].finger == "index");
  CHECK(rig.devices[1].serial.empty());
  CHECK(rig.tracker.serial == "TR-7");
  CHECK(rig.tracker.command == std::vector<std::string>{"python3", "bridge.py", "--rate", "200"});
  CHECK(rig.tracker.folder == file.folder());
  CHECK(rig.tracker.replay == file.folder() / "poses/press.txt");
  CHECK(rig.buttons == "/etc/buttons.json");
  // A third of a turn about (1, 1, 1): x to y, y to z, z to x.
  const Eigen::Vector3d moved = rig.tracker.to_world * Eigen::Vector3d(1, 0, 0);
  CHECK((moved - Eigen::Vector3d(0.1, 0.8, 0.3)).norm() < 1e-15);
}

TEST_CASE("a device that is a program stands in a rig file by its socket, or by its command") {
  const ScratchFile file("rig.json", R"({"format": 1, "title": "Ours", "devices": [
    {"finger": "thumb", "socket": "thumb.sock"}, {"finger": "index", "serial": "I-1", "command": ["./serve", "--now"]}],
    "tracker": {"socket": "/run/tracker.sock"}})");
  const RigFile rig = load_rig_file(file.path());
  REQUIRE(rig.devices.size() == 2);
  CHECK(rig.folder == file.folder());
  CHECK(rig.devices[0].socket == file.folder() / "thumb.sock");
  CHECK(rig.devices[0].path() == (file.folder() / "thumb.sock").string());
  CHECK(rig.devices[0].command.empty());
  CHECK(rig.devices[1].command == std::vector<std::string>{"./serve", "--now"});
  CHECK(rig.devices[1].path() == "program:index");
  CHECK(rig.tracker.socket == "/run/tracker.sock");
}

TEST_CASE("a device that is a program has one way to it, and one finger") {
  CHECK(mistake(R"("devices": [{"finger": "thumb", "socket": "a", "command": ["b"]}])")
            .message.find("beside \"socket\"") != std::string::npos);
  CHECK(mistake(R"("devices": [{"finger": "thumb", "socket": "a"}, {"finger": "index", "socket": "a"}])")
            .message.find("is named twice") != std::string::npos);
  CHECK(mistake(R"("devices": [{"finger": "thumb", "command": []}])").path == "$.devices[0].command");
}

TEST_CASE("what a participant hears stands in a rig file") {
  const auto sound_of = [](const std::string& text) {
    const ScratchFile file("rig.json", R"({"format": 1, "title": "Ours", "sound": )" + text + "}");
    SoundSettings sound = load_rig_file(file.path()).sound;
    if (!sound.cue.empty()) CHECK(sound.cue.parent_path() == file.folder());
    return sound;
  };
  CHECK(sound_of("{}").cue.empty());
  CHECK(sound_of("{}").cue_level_db == -20);
  CHECK_FALSE(sound_of("{}").masking);
  CHECK(sound_of(R"({"cue": "beep.wav", "cue_level_db": -12.5})").cue.filename() == "beep.wav");
  CHECK(sound_of(R"({"cue_level_db": -12.5})").cue_level_db == -12.5);
  const SoundSettings pink = sound_of(R"({"masking": {"noise": "pink"}})");
  REQUIRE(pink.masking);
  CHECK(pink.masking->pink);
  CHECK(pink.masking->level_db == -30);
  CHECK_FALSE(sound_of(R"({"masking": {"noise": "white", "level_db": -40}})").masking->pink);
  CHECK(sound_of(R"({"masking": {"noise": "rain.wav"}})").masking->file.filename() == "rain.wav");
  CHECK(mistake(R"("sound": {"masking": {"noise": "pink", "level_db": 0}})").path == "$.sound.masking.level_db");
  CHECK(mistake(R"("sound": {"masking": {}})").path == "$.sound.masking.noise");
}

TEST_CASE("what a rig file leaves out is what is usual") {
  const ScratchFile file("rig.json", R"({"format": 1, "title": "Ours"})");
  const RigFile rig = load_rig_file(file.path());
  CHECK(rig.devices.empty());
  CHECK(rig.tracker.serial.empty());
  CHECK(rig.tracker.command.empty());
  CHECK(rig.tracker.replay.empty());
  CHECK(rig.tracker.to_world.matrix() == Eigen::Matrix4d::Identity());
  CHECK(rig.buttons.empty());
}

TEST_CASE("a rotation that is nearly of length 1 is made so") {
  const ScratchFile file("rig.json",
                         R"({"format": 1, "title": "Ours", "tracker": {"rotation": [0.7071, 0, 0, 0.7071]}})");
  const Eigen::Matrix3d rotation = load_rig_file(file.path()).tracker.to_world.linear();
  CHECK((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-14);
}

TEST_CASE("every mistake of a rig file is told with its path") {
  CHECK(mistake(R"("devices": [{"finger": "toe"}])").path == "$.devices[0].finger");
  CHECK(mistake(R"("devices": [{"serial": "a"}])").path == "$.devices[0].finger");
  CHECK(mistake(R"("devices": [{"finger": "thumb"}, {"finger": "thumb"}])").path == "$.devices[1].finger");
  CHECK(mistake(R"("devices": [{"finger": "thumb", "serial": "a"}, {"finger": "index", "serial": "a"}])").path ==
        "$.devices[1].serial");
  CHECK(mistake(R"("devices": [{"finger": "thumb", "serial": ""}])").path == "$.devices[0].serial");
  CHECK(mistake(R"("devices": [{"finger": "thumb", "colour": "red"}])").path == "$.devices[0].colour");
  CHECK(mistake(R"("devices": "thumb")").path == "$.devices");
  CHECK(mistake(R"("tracker": "hid")").path == "$.tracker");
  CHECK(mistake(R"("tracker": {"command": "python3 bridge.py"})").path == "$.tracker.command");
  CHECK(mistake(R"("tracker": {"command": []})").path == "$.tracker.command");
  CHECK(mistake(R"("tracker": {"command": ["a", 2]})").path == "$.tracker.command[1]");
  CHECK(mistake(R"("tracker": {"replay": 5})").path == "$.tracker.replay");
  CHECK(mistake(R"("tracker": {"position_m": [0, 0]})").path == "$.tracker.position_m");
  CHECK(mistake(R"("tracker": {"position_m": [0, "0", 0]})").path == "$.tracker.position_m[1]");
  CHECK(mistake(R"("tracker": {"position_m": [0, 0, 300]})").path == "$.tracker.position_m[2]");
  CHECK(mistake(R"("tracker": {"rotation": [1, 0, 0]})").path == "$.tracker.rotation");
  CHECK(mistake(R"("tracker": {"rotation": [0, 0, 0, 0]})").path == "$.tracker.rotation");
  CHECK(mistake(R"("tracker": {"rotation": [1, 0, 0, 90]})").path == "$.tracker.rotation[3]");
  CHECK(mistake(R"("buttons": {})").path == "$.buttons");
  CHECK(mistake(R"("button": "b.json")").path == "$.button");
}

TEST_CASE("all mistakes of a rig file are told at once") {
  const auto mistakes = mistakes_of(R"({"format": 2,
    "devices": [{"finger": "toe"}],
    "tracker": {"position_m": [1e9, 0, 0], "rotation": [1, 1, 1, 1]},
    "extra": 1})");
  std::set<std::string> paths;
  for (const Diagnostic& one : mistakes) paths.insert(one.path);
  CHECK(paths == std::set<std::string>{"$.format", "$.title", "$.devices[0].finger", "$.tracker.position_m[0]",
                                       "$.tracker.rotation", "$.extra"});
  CHECK(mistakes_of("{").size() == 1);
  CHECK(mistakes_of("[]").size() >= 1);
  CHECK_THROWS_AS(load_rig_file("/nowhere/rig.json"), InputError);
}

}  // namespace
