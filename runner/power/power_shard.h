// Shards of a power study (runner/shards/study_shard.h): the result of each is its tally, and these are added up.
#pragma once

#include <filesystem>
#include <span>

#include "runner/power/power_result.h"
#include "runner/shards/study_shard.h"

namespace jnd {

StudyShard power_shard(const Protocol& protocol, const PowerQuestion& question, int number, int of);
// protocol and question must outlive it.
ShardWork power_work(const Protocol& protocol, const PowerQuestion& question, int threads);

// All of a study from its shards, in any order. Throws InputError, as for_each_shard does.
PowerResult combined_power(std::span<const std::filesystem::path> files);

}  // namespace jnd
