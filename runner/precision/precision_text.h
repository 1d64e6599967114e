// The planner's figures for people: tables of a terminal, or Markdown.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/precision/precision.h"
#include "protocols/planning/planned_precision.h"
#include "protocols/protocol.h"

namespace jnd {

enum class TableStyle { terminal, markdown };

// For a terminal or in Markdown: the first column to the left, numbers to the right.
class PrecisionTable {
 public:
  explicit PrecisionTable(std::vector<std::string> header) : rows_{std::move(header)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  std::string text(TableStyle style) const;

 private:
  std::string markdown() const;
  std::vector<std::vector<std::string>> rows_;
};

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
