// The planner's figures for people: tables of a terminal, or Markdown.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analysis/precision/precision.h"
#include "protocols/planning/planned_precision.h"
#include "protocols/protocol.h"
#include "runner/precision/precision_table.h"

namespace jnd {

// A design's precision with where its JNDs come from, a source a condition.
struct PlannedPrecision {
  Precision precision;
  std::vector<JndSource> sources;
};

std::string_view to_string(ClassSizes sizes) noexcept;  // "random", "balanced"

// What the figures assume of the participants, in one line.
std::string assumed_of_participants(const PrecisionQuestion& question);
// All of it. Lines ended by a newline.
std::string precision_text(const PlannedPrecision& planned, const Protocol& protocol, TableStyle style);
// One participant's part in a few lines, for `jnd check`. name: by which the user calls the protocol.
std::string precision_summary(const PlannedPrecision& planned, const Protocol& protocol, const std::string& name);

}  // namespace jnd
