// The participants of simulated studies, with what the analyses take of each: drawn from a population of the response
// model, or simulated through the rig.
//
// Study e of a seed is the same on every machine and thread, and so is participant p of it, whatever the number of
// participants, trials or the effect: designs are compared on the same people (common random numbers). The numbers of a
// participant are those of ExperimentStream (seed, purpose, e, p).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "analysis/hierarchical/hierarchical_likelihood.h"
#include "data/task_results/task_results.h"
#include "protocols/protocol.h"
#include "runner/power/power_question.h"

namespace jnd {

// What one participant leaves.
struct DrawnPerson {
  std::optional<int> group{};              // place in Protocol::groups
  std::vector<HierarchicalCell> answers;   // by condition and level; participant 0
  std::vector<TaskEstimateRow> estimates;  // by condition and standard
  bool dropped = false;                    // out: nothing of it counts
};

class PeopleSource {
 public:
  virtual ~PeopleSource() = default;
  // Participants 1 to `count` of a study. Any thread.
  virtual std::vector<DrawnPerson> people(std::uint64_t study, int count) const = 0;
};

// protocol: with the design's trials of a cell; it must outlive the source, as must the question. With a profile in the
// question participants go through whole sessions on the simulated rig at its 1 kHz.
std::unique_ptr<PeopleSource> people_source(const Protocol& protocol, const PowerQuestion& question, double effect);

}  // namespace jnd
