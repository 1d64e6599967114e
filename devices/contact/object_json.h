// Reads a virtual object from its JSON form (devices/objects/*.json):
//
//   {"format": 1, "name": "snowman", "title": "Two balls and a stick", "notes": "optional",
//    "shapes": [{"sphere": {"centre_m": [0, 0, 0], "radius_m": 0.03}},
//               {"capsule": {"a_m": [0, 0, 0.03], "b_m": [0.04, 0, 0.03], "radius_m": 0.002}}]}
//
// or, in place of "shapes", a wall: "plane": {"point_m": [0, 0, 0], "normal": [1, 0, 0]}. The normal points out of the
// solid side and may have any length.
#pragma once

#include <filesystem>
#include <string>

#include "devices/contact/virtual_object.h"

namespace jnd {

struct ObjectFile {
  std::string name;    // by which a protocol asks for it
  std::string title;   // for people
  std::string notes;   // where its measures come from; may be empty
  std::string sha256;  // of the file's bytes
  VirtualObject shape;
};

// Throws InputError with every mistake of the file, each with its line, column and JSON path. The shape that is
// returned passes check().
ObjectFile load_object(const std::filesystem::path& path);

}  // namespace jnd
