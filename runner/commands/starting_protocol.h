// A small protocol of any task on any rig, correct as it stands: what somebody starts from whose study is none of the
// shipped ones.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "protocols/vocabulary.h"

namespace jnd {

struct StartingPoint {
  TaskKind task = TaskKind::which;
  std::string rig = "rrs3";            // the name of a rig, as protocols have it
  std::string procedure = "constant";  // or a word of design.procedure.kind

  // What is not given is as the task and the rig have it.
  struct Condition {
    std::string name, label;
    std::vector<std::string> cues;  // of rigs that have cues
  };
  std::string title;
  std::string question;                       // asked after the intervals
  std::string quantity, unit;                 // of rigs that take any
  std::optional<double> standard;             // in the unit; of same-different the reference
  std::optional<std::vector<double>> levels;  // in the unit; classes, or the other value of each pair
  std::optional<int> trials_per_cell, participants;
  std::vector<Condition> conditions;
  std::vector<std::string> ratings;  // questions after the session, to be rated from 1 to 9
  std::string language;
};

// The rigs, with what each is in a few words.
struct StartingRig {
  std::string_view name, what;
};
std::vector<StartingRig> starting_rigs();
// The cues that the conditions of a rig are made of; none where conditions are free.
std::vector<std::string_view> starting_cues(const std::string& rig);
// The words of procedures that the task has on the rig; "constant" first.
std::vector<std::string> starting_procedures(TaskKind task, const std::string& rig);
// The point with everything that is not given filled in, as the protocol will have it; without conditions and ratings.
StartingPoint filled_in(StartingPoint point);

// The protocol's file, to be written with readable_json(). Throws UsageError where task, rig and procedure do not go
// together.
nlohmann::ordered_json starting_protocol(const StartingPoint& given);

}  // namespace jnd
