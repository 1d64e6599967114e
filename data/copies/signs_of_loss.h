// Whether a damaged study is all that it once was: what the file itself says of its size and of its events.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "data/copies/damaged_file.h"

namespace jnd {

struct SignsOfLoss {
  std::vector<std::string> doubts;           // in words; empty where the file says that nothing is missing
  std::optional<std::int64_t> pages;         // that the file had by its header; none where that is damaged
  std::int64_t pages_missing = 0;            // of them, neither in the file nor in its log
  std::optional<std::int64_t> events_added;  // ever, by the study's own count; none where that is lost
};

// What speaks against everything having been found. found: events whose hashes follow from each other, of all chains.
SignsOfLoss signs_of_loss(Bytes file, Bytes log, std::int64_t found);

}  // namespace jnd
