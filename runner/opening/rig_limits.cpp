#include "runner/opening/rig_limits.h"

#include <algorithm>

#include <fmt/format.h>

#include "protocols/vocabulary.h"
#include "runner/opening/shipped_specs.h"

namespace jnd {

std::string limits_text(const DeviceSpec& device) {
  return fmt::format("{:g} N, {:g} {}", device.max_force_n, device.max_stiffness, to_string(device.unit));
}

std::string limits_text(const RigSpec& rig) {
  std::string text;
  for (const DeviceSpec& device : rig.devices)
    text += fmt::format("{}{} at most {}", text.empty() ? "" : "; ", device.name, limits_text(device));
  return text;
}

bool is_shipped(const RigSpec& rig) noexcept {
  return std::all_of(rig.file_hashes.begin(), rig.file_hashes.end(), [](const std::string& hash) {
    return std::any_of(kShippedSpecs.begin(), kShippedSpecs.end(),
                       [&](const ShippedSpec& shipped) { return hash == shipped.sha256; });
  });
}

std::string not_shipped_text(const RigSpec& rig) {
  if (is_shipped(rig)) return "";
  const bool same_name = std::any_of(kShippedSpecs.begin(), kShippedSpecs.end(),
                                     [&](const ShippedSpec& shipped) { return rig.name == shipped.name; });
  return same_name ? "not the shipped " + rig.name : "not a shipped device";
}

}  // namespace jnd
