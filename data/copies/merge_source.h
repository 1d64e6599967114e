// The studies that come into a merged one, and everything that stands in the way. Internal to merge.cpp.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "data/study/problem.h"
#include "data/study/study.h"

namespace jnd {

struct SourceSession {
  SessionInfo info;
  std::string seed, protocol_sha256;  // that it was opened with
};

struct SourceProtocol {
  std::string sha256, name, bytes;
};

struct SourceStudy {
  std::filesystem::path path;
  std::unique_ptr<Study> study;
  std::vector<SourceSession> sessions;
  std::vector<SourceProtocol> protocols;  // all that the file keeps
  std::vector<Event> own;                 // the study's chain
  std::vector<Problem> damage;            // what verify finds
};

// Throw InputError.
void refuse_same_files(const std::vector<std::filesystem::path>& paths);
// Reads and verifies every source; throws also what Study::open throws, all of it in one message.
std::vector<SourceStudy> open_sources(const std::vector<std::filesystem::path>& paths);
void refuse_conflicts(const std::vector<SourceStudy>& sources);

}  // namespace jnd
