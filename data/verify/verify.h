// jnd verify: whether the file is whole, and the trials are those of its plan.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data/study/problem.h"
#include "data/study/study.h"

namespace jnd {

// What verify found. problems is empty for a whole study.
struct VerifyReport {
  int sessions = 0;
  std::int64_t events = 0;
  std::int64_t trials = 0;  // completed, main part
  std::int64_t voided = 0;
  std::int64_t telemetry = 0;       // blobs
  std::int64_t telemetry_lost = 0;  // that a recovery says it could not save
  std::string study_head;           // hash of the last event of the study's own chain
  std::vector<Problem> problems;
};
// Recomputes every hash, telemetry's among them, and every trial's stimuli from the protocol, seed and participant.
VerifyReport verify(const Study& study);

}  // namespace jnd
