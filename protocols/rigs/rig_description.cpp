#include "protocols/rigs/rig_description.h"

#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"

namespace jnd {
namespace {

// The device file that a rig names, beside the rig's own.
void read_device(JsonReader& reader, std::string_view key, DeviceModel model, const std::filesystem::path& folder,
                 RigSpec& rig, std::string& bytes) {
  const std::string name = reader.text(key, {.max_length = 100});
  if (name.empty()) return;
  if (name.find('/') != std::string::npos) {
    reader.error(key, fmt::format("\"{}\" is not a file beside this one", name),
                 "give the name of a device file in the same folder");
    return;
  }
  const std::filesystem::path path = folder / name;
  DeviceSpec device = load_device_spec(path);
  if (device.model != model) {
    reader.error(key, fmt::format("{} acts on the {}", name, facts_of(device.model).place),
                 "the 3RRS device is cutaneous, the McKibben finger kinaesthetic");
    return;
  }
  const std::string device_bytes = read_input_file(path);
  bytes += device_bytes;
  rig.file_hashes.push_back(sha256_hex(device_bytes));
  rig.devices.push_back(std::move(device));
}

}  // namespace

RigSpec load_rig_spec(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::string bytes = read_input_file(path);
  const JsonNode root = parse_json(bytes, file);
  RigSpec rig;
  rig.file_hashes.push_back(sha256_hex(bytes));
  if (root.find("cutaneous") == nullptr && root.find("kinaesthetic") == nullptr) {
    rig.devices.push_back(load_device_spec(path));
    rig.name = rig.devices[0].name;
    rig.title = rig.devices[0].title;
    rig.sha256 = sha256_hex(bytes);
    return rig;
  }
  std::vector<Diagnostic> diagnostics;
  JsonReader reader(root, diagnostics, file);
  reader.ignore("$schema");
  reader.ignore("notes");
  reader.integer("format", {.min = 1, .max = 1});
  rig.name = reader.text("name", {.max_length = 16});
  rig.title = reader.text("title", {.max_length = 200});
  read_device(reader, "cutaneous", DeviceModel::rrs3, path.parent_path(), rig, bytes);
  read_device(reader, "kinaesthetic", DeviceModel::mckibben, path.parent_path(), rig, bytes);
  rig.lever_arm_m = reader.number("lever_arm_m", {.min = 0, .max = 0.3, .above = true, .unit = "m"});
  reader.finish();
  if (!diagnostics.empty()) throw InputError(std::move(diagnostics));
  rig.sha256 = sha256_hex(bytes);
  return rig;
}

}  // namespace jnd
