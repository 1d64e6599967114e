// Do two cues together do what they do apart? Where a condition has the cues of two others together, the JND that an
// optimal combination of the two would have stands beside the one that was found.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/group/group.h"
#include "data/task_results/task_results.h"
#include "protocols/protocol.h"

namespace jnd {

// Of independent noise in both cues: d'^2 of both together is the sum of both d'^2, so slopes add as squares (Ernst and
// Banks 2002, Nature 415:429: variances combine as their inverses). a, b: JNDs > 0, finite.
double optimal_jnd(double a, double b) noexcept;

struct CombinedParticipant {
  std::string participant;
  std::optional<double> predicted, observed;  // JNDs in the study's unit; none where a JND of the conditions is none
};

struct CueCombination {
  int a = 0, b = 0, both = 0;  // conditions: the cues of `both` are those of a and of b, which share none
  std::vector<CombinedParticipant> participants;
  // Of ln(observed / predicted) over those who have both, 95 % by Student's t; 0 is optimal, above it worse.
  MeanEstimate log_ratio;
};

// Every such triple of conditions, in the order of `both`, a and b; none of a task without an outcome "jnd", and of several
// standards.
std::vector<CueCombination> cue_combinations(const TaskResults& results, const Protocol& protocol);

}  // namespace jnd
