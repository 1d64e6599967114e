// --shard K/N --to FILE, of the commands that simulate many studies.
#pragma once

#include <string>

#include "runner/shards/study_shard.h"
#include "runner/terminal/command_tree.h"

namespace jnd {

struct ShardOptions {
  std::string shard;  // "3/64"; empty: all
  std::string to;     // file of the shard; empty: none
};
// studies: the name of the option that both belong to, "--power".
void add_shard_options(const Command& command, ShardOptions& options, const std::string& studies);

struct ShardPlace {
  int number = 1, of = 1;
};
// Throws UsageError.
ShardPlace place_of(const ShardOptions& options);

// Makes the shard with a bar, says what is in it, and returns the exit code.
int make_shard_file(const StudyShard& empty, const ShardWork& work, const ShardOptions& options);

}  // namespace jnd
