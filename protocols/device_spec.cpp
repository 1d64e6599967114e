#include "protocols/device_spec.h"

#include <numbers>

#include "protocols/json_reader.h"
#include "protocols/read_file.h"

namespace jnd {
namespace {

void read_limits(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file,
                 DeviceSpec& spec) {
  constexpr double kQuarterTurn = std::numbers::pi / 2;
  JsonReader reader(node, diagnostics, file);
  spec.max_force_n = reader.number("max_force_n", {.min = 0, .max = 50, .above = true, .unit = "N"});
  spec.stroke_m = reader.number("stroke_m", {.min = 0, .max = 0.1, .above = true, .unit = "m"});
  spec.max_roll_rad = reader.number("max_roll_rad", {.min = 0, .max = kQuarterTurn, .unit = "rad"});
  spec.max_pitch_rad = reader.number("max_pitch_rad", {.min = 0, .max = kQuarterTurn, .unit = "rad"});
  spec.max_joint_speed_rad_per_s =
      reader.number("max_joint_speed_rad_per_s", {.min = 0, .max = 1000, .above = true, .unit = "rad/s"});
  spec.min_vibration_g = reader.number("min_vibration_g", {.min = 0, .max = 10, .unit = "g"});
  spec.max_vibration_g = reader.number("max_vibration_g", {.min = 0, .max = 10, .unit = "g"});
  spec.min_vibration_hz = reader.number("min_vibration_hz", {.min = 0, .max = 2000, .unit = "Hz"});
  spec.max_vibration_hz = reader.number("max_vibration_hz", {.min = 0, .max = 2000, .unit = "Hz"});
  spec.max_stiffness_n_per_m =
      reader.number("max_stiffness_n_per_m", {.min = 0, .max = 20000, .above = true, .unit = "N/m"});
  if (spec.max_vibration_g < spec.min_vibration_g && is_sound(diagnostics, node.path))
    reader.error("max_vibration_g", "is below min_vibration_g", "swap them");
  if (spec.max_vibration_hz < spec.min_vibration_hz && is_sound(diagnostics, node.path))
    reader.error("max_vibration_hz", "is below min_vibration_hz", "swap them");
  reader.finish();
}

void read_geometry(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file,
                   DeviceSpec& spec) {
  constexpr NumberLimits kLength{.min = 0, .max = 0.2, .above = true, .unit = "m"};
  JsonReader reader(node, diagnostics, file);
  spec.a_m = reader.number("a_m", kLength);
  spec.b_m = reader.number("b_m", kLength);
  spec.bh_m = reader.number("bh_m", kLength);
  spec.bd_m = reader.number("bd_m", kLength);
  spec.l1_m = reader.number("l1_m", kLength);
  spec.l2_m = reader.number("l2_m", kLength);
  // The platform lies below the body.
  spec.rest_z_m = reader.number("rest_z_m", {.min = -0.2, .max = 0, .unit = "m"});
  reader.finish();
}

}  // namespace

DeviceSpec load_device_spec(const std::filesystem::path& path) {
  const std::string file = path.string();
  const JsonNode root = parse_json(read_input_file(path), file);
  std::vector<Diagnostic> diagnostics;
  DeviceSpec spec;
  JsonReader reader(root, diagnostics, file);
  reader.ignore("$schema");
  reader.integer("format", {.min = 1, .max = 1});
  spec.name = reader.text("name", {.max_length = 16});
  spec.title = reader.text("title", {.max_length = 200});
  if (const JsonNode* limits = reader.object("limits")) read_limits(*limits, diagnostics, file, spec);
  if (const JsonNode* geometry = reader.object("geometry")) read_geometry(*geometry, diagnostics, file, spec);
  reader.finish();
  if (!diagnostics.empty()) throw InputError(std::move(diagnostics));
  return spec;
}

}  // namespace jnd
