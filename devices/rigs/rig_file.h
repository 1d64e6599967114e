// What a laboratory's own rig is made of: which device is worn on which finger, where poses come from, and which
// buttons answer. A JSON file beside the protocols, given by `jnd run --rig FILE`; a protocol says what is presented,
// this file on what.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace jnd {

struct WornDevice {
  std::string finger;  // as in $.rig.fingers of a protocol
  std::string serial;  // empty: the only device made for that finger
};

// Where a tracker of the protocol's kind is to be found.
struct TrackerSource {
  std::string serial;                // hid: of the tracker; empty: the only one
  std::vector<std::string> command;  // process: program and arguments
  std::filesystem::path folder;      // process: where it runs, the rig file's; empty: where this program does
  std::filesystem::path replay;      // replay: a file of poses in the pipe's line format
  // From the tracker's frame to the world's: origin midway between the fingers' rest positions, x from the first finger
  // to the second, z up, metres.
  Eigen::Isometry3d to_world = Eigen::Isometry3d::Identity();
};

struct RigFile {
  std::string title;
  std::string sha256;
  std::vector<WornDevice> devices;  // empty: any device of ours, by the finger it is made for
  TrackerSource tracker;
  std::filesystem::path buttons;  // a mapping of `jnd device learn-buttons`; empty: the keyboard answers
};

// Throws InputError. Relative paths are relative to the file's folder.
RigFile load_rig_file(const std::filesystem::path& path);

}  // namespace jnd
