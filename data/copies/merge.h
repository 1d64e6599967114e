// jnd merge: studies of one protocol, from several machines, in one new study.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "data/study/study.h"
#include "data/verify/verify.h"

namespace jnd {

struct MergedSource {
  std::string file;
  int sessions = 0;
  std::int64_t events = 0;  // of its sessions
  int imported = 0;         // exclusions, notes, unblindings that go on to hold
  bool unblinded = false;
  bool reworded = false;  // its protocol has other bytes that mean the same
};

struct MergeReport {
  std::vector<MergedSource> sources;
  VerifyReport verified;  // of the new study
};

// Sessions come with their events, hashes and telemetry to the letter. The study's own chain is new: study.merged keeps
// the chains of the sources, and their exclusions, notes and unblindings are appended, so that they go on to hold. The
// new study has the first source's seed; each session keeps the one that it was planned with.
//
// Throws InputError with everything that stands in the way, and nothing is written: protocols that mean different
// things; the same session twice; a participant's code, or number under one seed, in two sources; an exclusion that
// would hit another source's participant; an open session planned with another seed than the first source's (it
// could not go on); damage. Throws StorageError where `to` exists or cannot be written, or a source is open in
// another process.
MergeReport merge(const std::vector<std::filesystem::path>& paths, const std::filesystem::path& to, Stamp stamp);

}  // namespace jnd
