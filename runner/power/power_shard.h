// A shard of a power study as a file: what was asked, which studies these are, their tally and its own hash. It says
// everything that is needed to add shards up, and it appears whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "runner/power/power_result.h"
#include "runner/power/power_study.h"

namespace jnd {

struct PowerShard {
  PowerResult result;   // its tally is that of `range`
  std::string program;  // version of the program that made it
  int number = 1, of = 1;
  StudyRange range;  // the studies that are in it
};

std::string shard_text(const PowerShard& shard);
// Throws InputError: it is no shard, or not as it was written.
PowerShard read_shard(const std::filesystem::path& file);

enum class ShardEnd { made, was_there };
// Simulates a shard and writes it, and about every ten seconds what is done of it beside it, as FILE.part: where that is
// there, it goes on from it. Throws InputError where the file is something else, StorageError where it cannot be written,
// and Stopped; then FILE.part remains.
ShardEnd make_shard(const Protocol& protocol, const PowerQuestion& question, int number, int of,
                    const std::filesystem::path& file, int threads,
                    const std::function<void(std::int64_t)>& progress = {});

// All of a study from its shards, in any order. Throws InputError: one is missing, there twice, of another question, another
// protocol or another version of the program.
PowerResult combined(std::span<const std::filesystem::path> files);

}  // namespace jnd
