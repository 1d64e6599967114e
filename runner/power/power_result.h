// The numbers of a power study, each with its Monte-Carlo error or interval.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "protocols/protocol.h"
#include "runner/power/power_tally.h"

namespace jnd {

// What was asked, of which protocol, and what came of it.
struct PowerResult {
  Protocol protocol;
  PowerQuestion question;
  PowerTally tally;
};

// A number and its standard error over simulated studies; of a share also the exact 95 % interval (Clopper and Pearson).
// NaN: there is none. A share of none or of all studies has no error.
struct Simulated {
  double value = kNaN, error = kNaN, low = kNaN, high = kNaN;
};
std::string share_text(const Simulated& share);  // "83.2 % (80.7 to 85.5)"

struct EstimateSummary {
  double truth = kNaN;   // of ln JND, or on the contrast's scale; NaN: not known
  Simulated bias, rmse;  // against it; without a truth, bias is the mean estimate
  Simulated coverage;    // of 95 % intervals, of the studies that have one
  Simulated half_width;  // median, of these intervals
  Simulated undefined;   // share of studies without an estimate
};

// A contrast, or test of groups, under one design and analysis. Everything is NaN where the analysis has no such test.
struct ContrastSummary {
  PowerDesign design;
  PowerAnalysis analysis = PowerAnalysis::registered;
  std::size_t contrast = 0;  // place among PowerQuestion::tests()
  double ratio = kNaN;       // of the true JNDs; NaN: not known
  Simulated power;           // share of all studies whose p is below alpha; without a difference, of false findings
  Simulated untested;        // share of studies without a p
  EstimateSummary estimate;
};

// The group's JND in a condition under one design and analysis.
struct GroupSummary {
  PowerDesign design;
  PowerAnalysis analysis = PowerAnalysis::registered;
  std::size_t condition = 0;
  EstimateSummary estimate;
};

// Whole studies.
struct StudySummary {
  PowerDesign design;
  PowerAnalysis analysis = PowerAnalysis::registered;
  Simulated undefined, any, all;  // shares: with something undefined; with some, or every, contrast significant
};

// In the order of the designs, then the contrasts or conditions, then the analyses.
std::vector<ContrastSummary> contrast_summaries(const PowerResult& result);
std::vector<GroupSummary> group_summaries(const PowerResult& result);
std::vector<StudySummary> study_summaries(const PowerResult& result);

// The design with the fewest trials in all (then participants) whose power in a contrast is the wanted one, even at the
// low end of its interval.
struct SmallestDesign {
  double effect = 1;
  std::size_t contrast = 0;
  PowerAnalysis analysis = PowerAnalysis::registered;
  std::optional<ContrastSummary> design;  // none of those that were asked
};
std::vector<SmallestDesign> smallest_designs(const PowerResult& result);

// "S - SV"; of groups "patients - controls", "groups" and "groups x conditions".
std::string contrast_name(const PowerResult& result, std::size_t contrast);

}  // namespace jnd
