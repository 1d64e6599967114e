#include "devices/rigs/rig_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "devices/trackers/pose_line.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

constexpr TextLimits kSerial{.max_length = 64};
constexpr TextLimits kWord{.max_length = 1000};
constexpr TextLimits kPath{.max_length = 1000};
constexpr std::size_t kMostWords = 100;
constexpr NumberLimits kLevel{.min = -80, .max = -6, .unit = "dB"};  // of a sound, re full scale

class RigFileReading {
 public:
  RigFileReading(const std::filesystem::path& path, RigFile& rig)
      : file_(path.string()), folder_(std::filesystem::absolute(path).parent_path()), rig_(rig) {}

  void read(const JsonNode& root) {
    JsonReader reader(root, diagnostics_, file_);
    reader.ignore("$schema");
    reader.ignore("notes");
    reader.integer("format", {.min = 1, .max = 1});
    rig_.folder = folder_;
    rig_.title = reader.text("title", {.max_length = 200});
    if (const JsonNode* devices = reader.array_or_null("devices", 0, 2)) read_devices(*devices);
    if (const JsonNode* tracker = reader.object_or_null("tracker")) read_tracker(*tracker);
    if (const JsonNode* external = reader.object_or_null("external")) {
      rig_.external = read_external_settings(*external, folder_, diagnostics_, file_);
      for (const std::string_view other : {"devices", "tracker"})
        if (reader.member(other) != nullptr)
          reader.error(other, "does not go with \"external\"", "an external rig has its own: take one of the two out");
    }
    if (const JsonNode* sound = reader.object_or_null("sound")) read_sound(*sound);
    rig_.buttons = beside(reader.optional_text("buttons", kPath));
    reader.finish();
  }
  std::vector<Diagnostic>& diagnostics() noexcept { return diagnostics_; }

 private:
  std::filesystem::path beside(const std::optional<std::string>& name) const {
    return name ? folder_ / *name : std::filesystem::path();  // an absolute name stays what it is
  }

  void read_devices(const JsonNode& list) {
    for (const JsonNode& node : list.items) {
      JsonReader reader(node, diagnostics_, file_);
      const auto finger = reader.word("finger", {kFingerNames.begin(), kFingerNames.end()}, {}, true);
      WornDevice device;
      if (finger) device.finger = kFingerNames[*finger];
      device.serial = reader.text_or("serial", "", kSerial);
      device.socket = beside(reader.optional_text("socket", kPath));
      device.command = read_command(reader);
      reader.finish();
      if (!device.socket.empty() && !device.command.empty())
        reader.error("command", "stands beside \"socket\"",
                     "a device that is a program is connected to, or started: leave one of them out");
      for (const WornDevice& other : rig_.devices) {
        if (finger && other.finger == device.finger)
          reader.error("finger", in_quotes(device.finger) + " is named twice", "each finger wears one device");
        if (!device.serial.empty() && other.serial == device.serial)
          reader.error("serial", in_quotes(device.serial) + " is named twice", "a device is worn on one finger");
        if (!device.socket.empty() && other.socket == device.socket)
          reader.error("socket", in_quotes(device.socket.string()) + " is named twice",
                       "a device is worn on one finger");
      }
      rig_.devices.push_back(std::move(device));
    }
  }

  std::vector<std::string> read_command(JsonReader& reader) {
    std::vector<std::string> command;
    if (const JsonNode* words = reader.array_or_null("command", 1, kMostWords)) {
      for (const JsonNode& word : words->items)
        if (auto text = text_of(word, kWord, diagnostics_, file_)) command.push_back(std::move(*text));
    }
    return command;
  }

  void read_tracker(const JsonNode& node) {
    JsonReader reader(node, diagnostics_, file_);
    TrackerSource& tracker = rig_.tracker;
    tracker.serial = reader.text_or("serial", "", kSerial);
    tracker.socket = beside(reader.optional_text("socket", kPath));
    tracker.command = read_command(reader);
    tracker.folder = folder_;
    tracker.replay = beside(reader.optional_text("replay", kPath));
    if (const JsonNode* position = reader.array_or_null("position_m", 3, 3)) {
      const auto numbers = read_numbers<3>(*position, {.min = -kFarthestPose_m, .max = kFarthestPose_m, .unit = "m"});
      tracker.to_world.translation() = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
    }
    if (const JsonNode* rotation = reader.array_or_null("rotation", 4, 4)) read_rotation(*rotation);
    reader.finish();
  }

  void read_sound(const JsonNode& node) {
    JsonReader reader(node, diagnostics_, file_);
    rig_.sound.cue = beside(reader.optional_text("cue", kPath));
    rig_.sound.cue_level_db = reader.number_or("cue_level_db", rig_.sound.cue_level_db, kLevel);
    if (const JsonNode* masking = reader.object_or_null("masking")) {
      JsonReader part(*masking, diagnostics_, file_);
      MaskingNoise noise;
      const std::string what = part.text("noise", kPath);
      noise.pink = what == "pink";
      if (what != "pink" && what != "white") noise.file = folder_ / what;
      noise.level_db = part.number_or("level_db", noise.level_db, kLevel);
      part.finish();
      rig_.sound.masking = noise;
    }
    reader.finish();
  }

  void read_rotation(const JsonNode& node) {
    const auto numbers = read_numbers<4>(node, {.min = -1 - kQuaternionSlack, .max = 1 + kQuaternionSlack});
    if (!is_sound(diagnostics_, node.path)) return;
    const Eigen::Quaterniond rotation(numbers[0], numbers[1], numbers[2], numbers[3]);
    if (std::abs(rotation.norm() - 1) > kQuaternionSlack) {
      diagnostics_.push_back(diagnostic_at(node, file_,
                                           fmt::format("is a quaternion of length {:.4g}", rotation.norm()),
                                           "[w, x, y, z] of length 1: [1, 0, 0, 0] turns nothing"));
      return;
    }
    rig_.tracker.to_world.linear() = rotation.normalized().toRotationMatrix();
  }

  template <std::size_t count>
  std::array<double, count> read_numbers(const JsonNode& list, const NumberLimits& limits) {
    std::array<double, count> numbers{};
    for (std::size_t i = 0; i < std::min(count, list.items.size()); ++i)
      numbers[i] = number_of(list.items[i], limits, diagnostics_, file_).value_or(0);
    return numbers;
  }

  std::string file_;
  std::filesystem::path folder_;
  RigFile& rig_;
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace

RigFile load_rig_file(const std::filesystem::path& path) {
  const std::string bytes = read_input_file(path);
  RigFile rig;
  RigFileReading reading(path, rig);
  reading.read(parse_json(bytes, path.string()));
  if (!reading.diagnostics().empty()) throw InputError(std::move(reading.diagnostics()));
  rig.sha256 = sha256_hex(bytes);
  return rig;
}

}  // namespace jnd
