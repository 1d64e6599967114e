// What many simulated studies of one design came to, as counts and exact sums: the same bits however the studies were
// cut in shards, in whatever order these are added.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include <nlohmann/json.hpp>

#include "runner/power/drawn_study.h"
#include "runner/power/exact_sum.h"

namespace jnd {

// How often a positive number fell into each of the bins, 128 to an octave: its quantiles are known to within 0.3 %.
class LogHistogram {
 public:
  void add(double value);  // > 0; infinite ones are counted as the largest
  LogHistogram& operator+=(const LogHistogram& other);
  double quantile(double share) const;  // the middle of its bin; inf where it is infinite, NaN without any
  const std::map<int, std::int64_t>& bins() const noexcept { return bins_; }
  static LogHistogram of(std::map<int, std::int64_t> bins);

 private:
  std::map<int, std::int64_t> bins_;
};

// Of estimates and their intervals.
struct EstimateTally {
  std::int64_t defined = 0;  // studies that have an estimate
  // Of estimate - truth, or of the estimate where no truth is known: of ln JND, or on the contrast's scale.
  ExactSum errors, squares, fourths;  // and of their second and fourth powers
  std::int64_t intervals = 0;         // studies that have an interval
  std::int64_t covered = 0;           // of these, the truth is in it
  LogHistogram half_widths;           // of ln JND, or on the contrast's scale
  EstimateTally& operator+=(const EstimateTally& other);
};

struct ContrastTally {
  EstimateTally estimates;
  std::int64_t tested = 0, significant = 0;  // studies that have a p; p below alpha
  ContrastTally& operator+=(const ContrastTally& other);
};

// One analysis of one design.
struct AnalysisTally {
  std::vector<EstimateTally> group;      // by condition
  std::vector<ContrastTally> contrasts;  // and tests of groups, as PowerQuestion::tests() has them
  std::int64_t undefined = 0;            // studies with something undefined
  std::int64_t any = 0, all = 0;         // studies in which some contrast, and every one, is significant
  AnalysisTally& operator+=(const AnalysisTally& other);

  void add(const StudyOutcome& outcome, PowerAnalysis analysis, const StudyAnalyst& analyst, double alpha);
};

struct PowerTally {
  std::int64_t studies = 0;                           // of each design
  std::vector<std::vector<AnalysisTally>> by_design;  // by design, then analysis, as the question has them
  PowerTally& operator+=(const PowerTally& other);

  static PowerTally of(const PowerQuestion& question);  // nothing counted yet
};

nlohmann::ordered_json to_json(const PowerTally& tally);
// Throws nlohmann::json::exception or std::invalid_argument where it is not a tally of such a question.
PowerTally power_tally_from(const nlohmann::ordered_json& json, const PowerQuestion& question);

}  // namespace jnd
