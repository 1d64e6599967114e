// Whether a damaged study is all that it once was: what the file itself says of its size and of its events.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data/copies/damaged_file.h"

namespace jnd {

// What speaks against everything having been found, each in words; empty where the file says that nothing is missing.
// found: events whose hashes follow from each other, of all chains.
std::vector<std::string> signs_of_loss(Bytes file, Bytes log, std::int64_t found);

}  // namespace jnd
