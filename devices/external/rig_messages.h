// What the program and an external rig say to each other, as records: version 1.2 of devices/external/PROTOCOL.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "analysis/numerics/words.h"
#include "devices/rig.h"

namespace jnd {

inline constexpr int kExternalProtocol = 1;
inline constexpr std::size_t kLongestRigLine = 65536;  // bytes, without its end
inline constexpr std::size_t kLongestRigName = 40;     // of a quantity, parameter or channel
inline constexpr std::size_t kMostRigItems = 64;       // quantities, parameters, channels, words, values of a message

// -- what the rig says; its texts are UTF-8 without control characters -----------------------------------------------

// A number with its unit: a quantity, a parameter or a measured channel. Both ends belong to the range; min <= max.
struct RigRange {
  std::string name, unit;  // unit may be empty
  double min = 0, max = 0;
  bool operator==(const RigRange&) const = default;
};
// A parameter that is one of some words.
struct RigChoice {
  std::string name;
  std::vector<std::string> words;
  bool operator==(const RigChoice&) const = default;
};
using RigParameter = std::variant<RigRange, RigChoice>;
struct RigChannel {
  std::string name, unit;
  bool operator==(const RigChannel&) const = default;
};

struct RigHello {
  std::string name, version, serial;
  bool model = true;                     // in software: what is felt with it is no real data
  std::vector<RigRange> quantities;      // at least one
  std::vector<RigParameter> parameters;  // names differ from each other
  std::vector<RigChannel> measures;
  bool answers = false;  // it has buttons of its own
  int places = 1;        // values that it presents side by side, at most: 1 or 2
  double ready_s = 0;    // longest time from "prepare" to "ready"
  bool holds = true;     // what is ready stays so until "present", without anybody feeling it
  std::string token;     // over TCP; in no message and in no log
};

struct RigReady {
  std::uint64_t id = 0;
};
struct RigContact {
  std::uint64_t id = 0;
  double time_s = 0;  // since the presentation began, on the rig's clock
};

enum class RigOutcome { complete, no_contact, stopped };
inline constexpr auto kRigOutcomeWords = words<RigOutcome>(
    {{"complete", RigOutcome::complete}, {"no_contact", RigOutcome::no_contact}, {"stopped", RigOutcome::stopped}});

using NamedNumbers = std::vector<std::pair<std::string, double>>;

struct RigDone {
  std::uint64_t id = 0;
  RigOutcome outcome = RigOutcome::complete;
  std::optional<double> delivered;         // of the quantity, as measured; none: not measured
  std::optional<double> delivered_beside;  // the same of the value beside it
  std::optional<double> first_contact_s;   // since the presentation began
  double duration_s = 0;                   // of the presentation
  int contacts = 0;
  NamedNumbers peaks;     // largest of a measured channel
  NamedNumbers channels;  // other numbers of measured channels, such as means
};
struct RigTelemetry {
  std::optional<std::uint64_t> id;
  double time_s = 0;  // on the rig's clock
  NamedNumbers values;
};
struct RigAnswer {
  std::uint64_t id = 0;           // of the question
  std::string answer;             // one of the question's answers
  std::optional<double> after_s;  // from the question to the button
};
struct RigFault {
  std::optional<std::uint64_t> id;  // void is this presentation; none: the whole rig
  std::string cause;
};
struct RigAlive {
  std::uint64_t n = 0;  // as in the program's own
};

using RigMessage = std::variant<RigHello, RigReady, RigContact, RigDone, RigTelemetry, RigAnswer, RigFault, RigAlive>;

// -- what the program says --------------------------------------------------------------------------------------------

using RigParameterValue = std::variant<double, std::string>;

enum class RigExplorationEnd { time, contacts, stop };  // stop: the program says when, such as by a key
inline constexpr auto kRigExplorationEndWords = words<RigExplorationEnd>(
    {{"time", RigExplorationEnd::time}, {"contacts", RigExplorationEnd::contacts}, {"stop", RigExplorationEnd::stop}});

struct RigExploration {
  RigExplorationEnd ends = RigExplorationEnd::time;
  double duration_s = 0;     // where time ends it
  bool from_contact = true;  // what the duration counts from; false: the beginning
  int contacts = 0;          // where they end it
  double no_contact_s = 0;   // without a contact for so long from the beginning: outcome no_contact; 0: no such limit
  // What the participant was told to keep to, for a rig that shows it; the program judges. limits: by the measure, in its
  // unit, lowest and highest.
  std::optional<double> pace_hz{};
  std::map<std::string, std::array<double, 2>> limits{};
};

// One interval, as a task asks for it.
struct RenderRequest {
  IntervalId id;
  std::string quantity, unit;
  double value = 0;                // of two, the one on the left
  std::optional<double> beside{};  // the one on the right
  std::map<std::string, RigParameterValue> parameters;
  std::optional<std::map<std::string, RigParameterValue>> beside_parameters{};  // of the one on the right, where others
  RigExploration exploration;
  double time_out_s = 10;  // from "present" to "done"; what takes longer is stopped, and void
};

// Why a presentation is stopped. enough: it ends as it should, and counts.
enum class RigStop { enough, emergency, interrupted, time_out, fault };
inline constexpr auto kRigStopWords = words<RigStop>({{"enough", RigStop::enough},
                                                      {"emergency", RigStop::emergency},
                                                      {"interrupted", RigStop::interrupted},
                                                      {"time_out", RigStop::time_out},
                                                      {"fault", RigStop::fault}});

// One line each, with its end.
std::string hello_line(std::string_view program_version);
std::string prepare_line(std::uint64_t id, const RenderRequest& request);
std::string present_line(std::uint64_t id, const RenderRequest& request);
std::string ask_line(std::uint64_t id, const std::vector<std::string>& answers);
std::string stop_line(std::uint64_t id, RigStop reason);  // id 0: whatever goes on
std::string alive_line(std::uint64_t n);
std::string bye_line();

}  // namespace jnd
