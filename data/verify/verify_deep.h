// jnd verify --deep: beside the hashes, whether a study can have come about as it says.
//
// Telemetry: every number that can be computed from the ticks is computed again and compared with the event. The course
// of every session: attempts, blocks, practice, breaks, questions and answers against the protocol's rules. The file:
// every byte is read, and nothing that a program left behind lies beside it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "data/study/problem.h"
#include "data/study/study.h"

namespace jnd {

struct DeepReport {
  std::int64_t intervals = 0;  // recomputed from their telemetry
  std::int64_t numbers = 0;    // compared, in these
  int sessions = 0;            // whose course was followed
  std::int64_t bytes = 0;      // read
  std::vector<Problem> problems;
  std::vector<std::string> findings;  // no problems: what lies beside the file, and who else may read it
};

// Of a study that verify finds whole; of another one, problems may follow from problems. Throws StorageError where the
// file cannot be read.
DeepReport verify_deep(const Study& study);

}  // namespace jnd
