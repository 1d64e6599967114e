// What `jnd run` is asked to run on: a rig, and the buttons that answer.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "devices/hid/buttons/button_box.h"
#include "devices/hid/hid_bus.h"
#include "devices/rigs/rig_file.h"
#include "runner/opening/rig_source.h"
#include "runner/terminal/exit_code.h"

namespace jnd {

struct ChosenRig {
  std::unique_ptr<const RigSource> own;  // null: the one that is set
  RigFile file;                          // empty where none was given
  const RigSource& source() const noexcept { return own ? *own : rig_source(); }
};

// rig: "simulated", "hid", "specimens", or a rig file (--rig); fast: time is to be skipped. Throws UsageError, InputError, and
// DeviceError where the system's HID cannot be used.
ChosenRig choose_rig(const std::string& rig, bool fast);

struct ChosenButtons {
  std::unique_ptr<HidBus> bus;
  std::unique_ptr<ButtonBox> box;  // null: the keyboard answers
};

// mapping: a file of `jnd device learn-buttons` (--buttons); empty: the rig file's. Waits until the box is there;
// throws InputError and DeviceError.
ChosenButtons choose_buttons(const std::filesystem::path& mapping, const RigFile& rig);

// Where certificates of calibration are looked for: beside the rig file, beside the study, here.
std::vector<std::filesystem::path> certificate_folders(const RigFile& rig, const std::filesystem::path& study);

}  // namespace jnd
