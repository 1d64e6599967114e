// What the study's own chain says of the study and its sessions. Internal to verify, recover and every reader that
// checks the chains.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>
#include <nlohmann/json.hpp>

#include "data/study/problem.h"
#include "data/study/study.h"

namespace jnd {

// Key in the bodies of session.opened and session.closed: the hash of the last event of the study's own chain just
// then.
inline constexpr const char* kStudyHeadKey = "study_head";

struct StudyFacts {
  std::set<std::string> seeds;                        // the study's, and those of merged studies
  std::set<std::string> protocols;                    // SHA-256 of the study's protocol, and of files that say the same
  std::map<std::string, std::string> protocol_names;  // by SHA-256, where the chain names them
  std::map<std::string, std::string> heads;           // of closed sessions
  // Who was left out, by kind and code: whether the number is free again.
  std::map<std::pair<std::string, std::string>, bool> excluded;
  // Of every event of this chain, and of the chains of the studies that this one was made from.
  std::set<std::string> hashes;
  bool chain_lost = false;               // a recovery says that part of such a chain was lost
  std::set<std::string> telemetry_lost;  // telemetry_key of what a recovery could not save
};

// From the rows of the study's own chain, without a look at its hashes. What cannot be read, and what stands where it
// means nothing, is a problem.
StudyFacts study_facts(SQLite::Database& database, const StudyInfo& info, std::vector<Problem>& problems);

// The hashes of the chains that the body of a study.merged or study.recovered keeps; chain_lost: as in StudyFacts.
void add_kept_hashes(const nlohmann::ordered_json& body, std::set<std::string>& hashes, bool& chain_lost);

// What names the ticks of one interval in a study: "session/seq/interval".
std::string telemetry_key(std::string_view session, std::int64_t seq, int interval);

// What a damaged study had already lost when it was recovered is known, and no problem of the new one.
std::set<std::string> lost_in_recovery(const Study& study);

}  // namespace jnd
