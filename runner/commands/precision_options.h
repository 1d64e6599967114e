// `jnd plan --precision`: what a planned design will measure, and how well.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runner/commands/commands.h"
#include "runner/terminal/exit_code.h"

namespace CLI {
class App;
}

namespace jnd {

struct PrecisionOptions {
  bool asked = false;             // --precision
  std::vector<std::string> jnds;  // true JNDs: "208.5" for all conditions, "SV=208.5" for one; else the protocol's
  std::optional<int> trials;      // a cell; else the protocol's
  std::optional<int> participants;
  double between_cv = 0;  // of the participants' true JNDs
  double cv = 0.10;       // wanted, of one participant's JND
  bool markdown = false;
};
// Adds the options to `jnd plan`.
void add_precision_options(CLI::App& plan, PrecisionOptions& options);

// Uses protocol, seed and json of the plan's options. Throws UsageError where the options do not fit the protocol.
int command_plan_precision(const PlanOptions& plan, const PrecisionOptions& options);

}  // namespace jnd
