// The chains of a study: every hash, every number, and that no end is missing. What verify and every reader of results
// check before they believe anything else.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

#include "data/log/storage_error.h"
#include "data/study/study.h"
#include "data/study/study_facts.h"

namespace jnd {

struct ChainReport {
  std::int64_t events = 0;
  std::string study_head;  // hash of the last event of the study's own chain; empty where there is none
  std::vector<Problem> problems;
};

// Calls each for every event, in the order of session and seq. Hashes on several threads; `each` runs on this one.
// Throws SQLite::Exception where the file cannot be read to its end: `report` has what was found until then.
void check_chains(SQLite::Database& database, const StudyFacts& facts, const std::function<void(const Event&)>& each,
                  ChainReport& report);

// For analyses and exports, before they compute: what the chains are, where nothing is wrong with them, the protocol, the
// schema, and the indexes that find events. Throws BrokenChain with the first problem, in words that give nothing of the plan away, and StorageError. Grows
// linearly with the events.
ChainReport require_whole_chains(const Study& study);

// "every hash agrees (2125 events); head of the study's own chain: HASH"
std::string chain_line(const ChainReport& report);

}  // namespace jnd
