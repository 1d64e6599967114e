// What a rig is made of: one device a finger, or two that act on one finger, one on its pulp and one on its joint.
// JSON form: a device's own file, or one that names two, such as devices/specs/rrs3+mckibben.json.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "protocols/rigs/device_description.h"

namespace jnd {

struct RigSpec {
  std::string name;  // "rrs3", "mckibben", "rrs3+mckibben"
  std::string title;
  std::string sha256;                    // over the files it was read from, in order
  std::vector<std::string> file_hashes;  // SHA-256 of each file by itself, in that order
  std::vector<DeviceSpec> devices;       // those of one finger: cutaneous first
  // Where a contact described in N/m is felt at a joint too: the fingertip moves lever_arm_m into the object per radian
  // of the joint, so that a contact stiffness k is a joint stiffness k lever_arm_m^2 (N m/rad).
  double lever_arm_m = 0;

  // The device of a model, and that which presses the pulp or holds the joint; null where the rig has none.
  const DeviceSpec* of(DeviceModel model) const noexcept {
    for (const DeviceSpec& device : devices)
      if (device.model == model) return &device;
    return nullptr;
  }
  const DeviceSpec* cutaneous() const noexcept { return at(false); }
  const DeviceSpec* kinaesthetic() const noexcept { return at(true); }

 private:
  const DeviceSpec* at(bool joint) const noexcept {
    for (const DeviceSpec& device : devices)
      if (facts_of(device.model).acts_on_joint == joint) return &device;
    return nullptr;
  }
};

// Whether poses of this kind of tracker ($.rig.tracker) come from outside the program: "hid", "process", "replay".
inline bool is_streamed(const std::string& tracker) noexcept {
  return tracker == "hid" || tracker == "process" || tracker == "replay";
}

// Throws InputError. A rig of two devices names files beside its own.
RigSpec load_rig_spec(const std::filesystem::path& path);

}  // namespace jnd
