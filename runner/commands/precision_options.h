// `jnd plan --precision`: what a planned design will measure, and how well.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocols/planning/planned_precision.h"
#include "runner/terminal/command_tree.h"

namespace jnd {

struct PrecisionOptions {
  bool asked = false;             // --precision
  std::vector<std::string> jnds;  // true JNDs: "208.5" for all conditions, "SV=208.5" for one; else the protocol's
  std::vector<int> trials;        // a cell; else the protocol's. Several for --power alone, as participants
  std::vector<int> participants;
  std::optional<double> between_cv;  // of the participants' true JNDs
  double cv = 0.10;                  // wanted, of one participant's JND
  bool markdown = false;
  std::optional<double> noise;   // of a felt difference, of a task whose precision is simulated
  std::optional<int> simulated;  // participants of a task whose precision is simulated
};
// Adds the options to `jnd plan`.
void add_precision_options(const Command& plan, PrecisionOptions& options);

// The JND of each condition: as the arguments of --jnd have it, else as planned. Throws UsageError.
std::vector<PlannedJnd> asked_jnds(const std::vector<std::string>& arguments, const Protocol& protocol);

// name: a protocol's file, or the name of a shipped one. Returns the exit code. Throws UsageError where the options do not fit
// the protocol.
int plan_precision(const std::string& name, std::uint64_t seed, bool json, const PrecisionOptions& options);

}  // namespace jnd
