// A small protocol of any task on any rig, correct as it stands: what somebody starts from whose study is none of the
// shipped ones.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "protocols/vocabulary.h"

namespace jnd {

struct StartingPoint {
  TaskKind task = TaskKind::which;
  std::string rig = "rrs3";            // the name of a rig, as protocols have it
  std::string procedure = "constant";  // or a word of design.procedure.kind
};

// The protocol's file, to be written with readable_json(). Throws UsageError where task, rig and procedure do not go
// together.
nlohmann::ordered_json starting_protocol(const StartingPoint& point);

}  // namespace jnd
