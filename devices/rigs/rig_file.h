// What a laboratory's own rig is made of: which device is worn on which finger, where poses come from, and which
// buttons answer. A JSON file beside the protocols, given by `jnd run --rig FILE`; a protocol says what is presented,
// this file on what.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "devices/external/external_settings.h"

namespace jnd {

struct WornDevice {
  std::string finger;  // as in $.rig.fingers of a protocol
  std::string serial;  // empty: the only device made for that finger
  // A device that is a program, by its socket or started by this one; both empty: it is connected by USB.
  std::filesystem::path socket{};
  std::vector<std::string> command{};

  // How the bus calls a device that is a program; empty: the device is connected by USB.
  std::string path() const {
    return !socket.empty() ? socket.string() : command.empty() ? std::string() : "program:" + finger;
  }
};

// Where a tracker of the protocol's kind is to be found.
struct TrackerSource {
  std::string serial;                // hid: of the tracker; empty: the only one
  std::filesystem::path socket;      // hid: that it is served on; empty: it is connected by USB
  std::vector<std::string> command;  // process: program and arguments
  std::filesystem::path folder;      // process: where it runs, the rig file's; empty: where this program does
  std::filesystem::path replay;      // replay: a file of poses in the pipe's line format
  // From the tracker's frame to the world's: origin midway between the fingers' rest positions, x from the first finger
  // to the second, z up, metres.
  Eigen::Isometry3d to_world = Eigen::Isometry3d::Identity();
};

// Over what the devices themselves can be heard to do, from the first interval of a trial to its question.
struct MaskingNoise {
  std::filesystem::path file;  // a WAV file; empty: made, white or pink
  bool pink = false;
  double level_db = -30;  // root mean square re full scale
};

// What the participant hears.
struct SoundSettings {
  std::filesystem::path cue;  // a WAV file for every cue of the kind "sound"; empty: a tone is made
  double cue_level_db = -20;  // of that tone, root mean square re full scale
  std::optional<MaskingNoise> masking;
};

struct RigFile {
  std::string title;
  std::string sha256;
  std::filesystem::path folder;     // of the file, absolute: where its programs run
  std::vector<WornDevice> devices;  // empty: any device of ours, by the finger it is made for
  TrackerSource tracker;
  std::optional<ExternalSettings> external;  // a rig of the laboratory's own; then there are no devices and no tracker
  SoundSettings sound;
  std::filesystem::path buttons;  // a mapping of `jnd device learn-buttons`; empty: the keyboard answers
};

// Throws InputError. Relative paths are relative to the file's folder.
RigFile load_rig_file(const std::filesystem::path& path);

}  // namespace jnd
