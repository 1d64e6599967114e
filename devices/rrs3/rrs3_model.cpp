#include "devices/rrs3/rrs3_model.h"

#include <utility>

#include "protocols/input/json_reader.h"
#include "protocols/input/read_file.h"

namespace jnd {

namespace {

// As in protocols/rigs/device_description.cpp. The upper end refuses lengths in millimetres.
constexpr NumberLimits kLength{.min = 0, .max = 0.2, .above = true, .unit = "m"};
constexpr NumberLimits kHeight{.min = -0.2, .max = 0, .unit = "m"};

Rrs3Geometry read_short(JsonReader& reader) {
  return {.a_m = reader.number("a", kLength),
          .b_m = reader.number("b", kLength),
          .bh_m = reader.number("bh", kLength),
          .bd_m = reader.number("bd", kLength),
          .l1_m = reader.number("l1", kLength),
          .l2_m = reader.number("l2", kLength),
          .rest_z_m = reader.number_or("pz0", 0, kHeight)};
}

Rrs3Geometry read_long(JsonReader& reader) {
  return {.a_m = reader.number("a_m", kLength),
          .b_m = reader.number("b_m", kLength),
          .bh_m = reader.number("bh_m", kLength),
          .bd_m = reader.number("bd_m", kLength),
          .l1_m = reader.number("l1_m", kLength),
          .l2_m = reader.number("l2_m", kLength),
          .rest_z_m = reader.number("rest_z_m", kHeight)};
}

bool is_long(const JsonNode& node) noexcept {
  for (const char* key : {"a_m", "b_m", "bh_m", "bd_m", "l1_m", "l2_m", "rest_z_m"})
    if (node.find(key)) return true;
  return false;
}

Rrs3Geometry read_lengths(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file) {
  JsonReader reader(node, diagnostics, file);
  const Rrs3Geometry geometry = is_long(node) ? read_long(reader) : read_short(reader);
  reader.finish();
  return geometry;
}

}  // namespace

std::optional<Rrs3ModelAnswer> ask_rrs3_model(const Rrs3ModelQuery& query) {
  const Rrs3Kinematics kinematics(query.geometry);
  const std::optional<Rrs3Configuration> at = kinematics.configuration(query.coordinates);
  if (!at) return std::nullopt;
  const std::optional<Rrs3Differential> rates = kinematics.differential(*at);
  if (!rates) return std::nullopt;
  const std::optional<Rrs3SingularityDistances> distances = singularity_distances(kinematics, query.coordinates);
  if (!distances) return std::nullopt;
  return Rrs3ModelAnswer{
      .yaw = yaw_of(*at),
      .p = at->position,
      .b = at->platform_joints.transpose(),
      .d = at->elbows.transpose(),
      .q = kinematics.joint_angles(*at),
      .j_chi = rates->j,
      .j_xi = rates->j * Rrs3Kinematics::rate_map(*at, query.coordinates.pitch_rad),
      .h = rates->h,
      .tau = joint_torques(*rates, query.wrench),
      .kq = joint_stiffness(*rates, query.translational_n_per_m, query.rotational_n_m_per_rad),
      .cond = kinematics.condition_number(rates->j),
      .det_ux = rates->det_u,
      .singularities = *distances,
  };
}

Rrs3Geometry rrs3_geometry_from_json(const JsonNode& node, const std::string& file) {
  std::vector<Diagnostic> diagnostics;
  Rrs3Geometry geometry;
  if (node.find("geometry")) {
    JsonReader reader(node, diagnostics, file);
    // The other members of a device specification are no part of the geometry.
    for (const char* key : {"$schema", "format", "name", "title", "limits"}) reader.ignore(key);
    if (const JsonNode* lengths = reader.object("geometry")) geometry = read_lengths(*lengths, diagnostics, file);
    reader.finish();
  } else {
    geometry = read_lengths(node, diagnostics, file);
  }
  if (!diagnostics.empty()) throw InputError(std::move(diagnostics));
  return geometry;
}

Rrs3Geometry load_rrs3_geometry(const std::filesystem::path& path) {
  const std::string file = path.string();
  return rrs3_geometry_from_json(parse_json(read_input_file(path), file), file);
}

}  // namespace jnd
