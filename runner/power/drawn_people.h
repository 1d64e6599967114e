// The participants of simulated studies, with what the analyses take of each: drawn from a population of the response
// model, or simulated through the rig.
//
// Study e of a seed is the same on every machine and thread, and so is participant p of it, whatever the number of
// participants, trials or the effect: designs are compared on the same people (common random numbers). The numbers of a
// participant are those of ExperimentStream (seed, purpose, e, p).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "runner/power/person_answers.h"
#include "runner/power/power_question.h"

namespace jnd {

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
