// The loader of object files.
#include "devices/contact/object_json.h"

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "protocols/input/input_error.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

constexpr NumberLimits kCoordinate{.min = -kGreatestObject_m, .max = kGreatestObject_m, .unit = "m"};
constexpr NumberLimits kRadius{.min = kLeastRadius_m, .max = kGreatestObject_m, .unit = "m"};
constexpr NumberLimits kDirection{.min = -1000, .max = 1000};
constexpr double kLeastNormal = 1e-6;

// What reading a file carries along.
struct Reading {
  std::string file;
  std::vector<Diagnostic> diagnostics{};

  Eigen::Vector3d vector(JsonReader& reader, std::string_view key, const NumberLimits& limits) {
    Eigen::Vector3d result = Eigen::Vector3d::Zero();
    if (const JsonNode* node = reader.array(key, 3, 3)) {
      for (std::size_t i = 0; i < 3; ++i)
        result(static_cast<Eigen::Index>(i)) = number_of(node->items[i], limits, diagnostics, file).value_or(0);
    }
    return result;
  }
};

Sphere read_sphere(const JsonNode& node, Reading& reading) {
  JsonReader reader(node, reading.diagnostics, reading.file);
  Sphere sphere;
  sphere.centre_m = reading.vector(reader, "centre_m", kCoordinate);
  sphere.radius_m = reader.number("radius_m", kRadius);
  reader.finish();
  return sphere;
}

Capsule read_capsule(const JsonNode& node, Reading& reading) {
  JsonReader reader(node, reading.diagnostics, reading.file);
  Capsule capsule;
  capsule.a_m = reading.vector(reader, "a_m", kCoordinate);
  capsule.b_m = reading.vector(reader, "b_m", kCoordinate);
  capsule.radius_m = reader.number("radius_m", kRadius);
  reader.finish();
  if (is_sound(reading.diagnostics, node.path) && (capsule.b_m - capsule.a_m).norm() < kLeastRadius_m)
    reader.error(node, "has no length: a_m and b_m are the same point", "make it a sphere");
  return capsule;
}

Plane read_plane(const JsonNode& node, Reading& reading) {
  JsonReader reader(node, reading.diagnostics, reading.file);
  Plane plane;
  plane.point_m = reading.vector(reader, "point_m", kCoordinate);
  const Eigen::Vector3d normal = reading.vector(reader, "normal", kDirection);
  reader.finish();
  if (normal.norm() >= kLeastNormal)
    plane.normal = normal.normalized();
  else if (is_sound(reading.diagnostics, node.path))
    reader.error("normal", "has no length", "give the direction out of the wall, such as [1, 0, 0]");
  return plane;
}

void read_shapes(const JsonNode& shapes, Reading& reading, VirtualObject& object) {
  for (const JsonNode& item : shapes.items) {
    JsonReader reader(item, reading.diagnostics, reading.file);
    const JsonNode* sphere = reader.object_or_null("sphere");
    const JsonNode* capsule = reader.object_or_null("capsule");
    reader.finish();
    if (sphere && capsule)
      reader.error(item, "is both a sphere and a capsule", "make it two shapes");
    else if (!sphere && !capsule && is_sound(reading.diagnostics, item.path))
      reader.error(item, "is no shape", R"(give {"sphere": {...}} or {"capsule": {...}})");
    if (sphere) object.spheres.push_back(read_sphere(*sphere, reading));
    if (capsule) object.capsules.push_back(read_capsule(*capsule, reading));
  }
}

}  // namespace

ObjectFile load_object(const std::filesystem::path& path) {
  const std::string bytes = read_input_file(path);
  Reading reading{.file = path.string()};
  const JsonNode root = parse_json(bytes, reading.file);
  ObjectFile result;
  result.sha256 = sha256_hex(bytes);

  JsonReader reader(root, reading.diagnostics, reading.file);
  reader.ignore("$schema");
  reader.integer("format", {.min = 1, .max = 1});
  result.name = reader.text("name", {.max_length = 64});
  result.title = reader.text("title", {.max_length = 200});
  result.notes = reader.text_or("notes", "", {.max_length = 2000});
  const JsonNode* shapes = reader.array_or_null("shapes", 1, kMostPrimitives);
  const JsonNode* plane = reader.object_or_null("plane");
  reader.finish();
  if (shapes && plane)
    reader.error(*plane, "stands beside \"shapes\"", "a wall stands alone: leave out one of them");
  else if (!shapes && !plane && is_sound(reading.diagnostics, root.path))
    reader.error(root, "has neither \"shapes\" nor \"plane\"", "give the spheres and capsules, or the wall");
  if (shapes) read_shapes(*shapes, reading, result.shape);
  if (plane) result.shape.plane = read_plane(*plane, reading);
  if (!reading.diagnostics.empty()) throw InputError(std::move(reading.diagnostics));
  check(result.shape);
  return result;
}

}  // namespace jnd
