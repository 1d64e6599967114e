// A laboratory's rig file: everything that it may say, and every mistake with its place.
#include "devices/rigs/rig_file.h"

#include <set>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/tracker_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

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

}  // namespace

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
