// Many simulated studies, cut in shards that one machine each works through. A shard is a file: what was asked, which of
// the studies it has, what came of them, and its own hash. It says everything that is needed to put shards together, and
// it appears whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "protocols/protocol.h"

namespace jnd {

inline constexpr int kMostStudyShards = 100'000;

// Which studies: first to last - 1, of 0 to the number of all less 1.
struct StudyRange {
  std::int64_t first = 0, last = 0;
};
// Shard `number` of `of`, from 1, of all studies: they differ by one study at most.
StudyRange shard_range(std::int64_t studies, int number, int of) noexcept;

// What the studies of a shard are for; a word of its file.
enum class ShardKind {
  power,    // jnd plan --power
  simulate  // jnd simulate --studies
};

struct StudyShard {
  ShardKind kind = ShardKind::power;
  std::string program;  // version of the program that made it
  Protocol protocol;
  nlohmann::ordered_json question;  // all that the studies depend on but the protocol; "studies": how many there are
  int number = 1, of = 1;
  StudyRange range;               // the studies that are in it
  nlohmann::ordered_json result;  // of these

  std::int64_t studies() const;    // of all shards
  StudyRange whole_range() const;  // of the shard when it is finished
};

// number, of: from 1. Without studies yet, and with no result.
StudyShard empty_shard(ShardKind kind, const Protocol& protocol, nlohmann::ordered_json question, int number, int of);

std::string shard_text(const StudyShard& shard);
// A member of a shard. Throws nlohmann::json::exception unless it is a whole number from least, which is 0 or
// more, to most.
std::int64_t whole_number(const nlohmann::ordered_json& value, std::int64_t least, std::int64_t most);
// Throws InputError: it cannot be read, is no shard, or not as it was written.
StudyShard read_shard(const std::filesystem::path& file);

// How the studies of a kind are made and put together.
struct ShardWork {
  // The result of these studies. progress: called by one thread at a time with the number of studies that are done.
  std::function<nlohmann::ordered_json(StudyRange range, const std::function<void(std::int64_t)>& progress)> result;
  // Adds that of the studies that follow.
  std::function<void(nlohmann::ordered_json& result, const nlohmann::ordered_json& more)> add;
};

enum class ShardEnd { made, was_there };
// Makes the studies of an empty shard and writes it, and every ten seconds or tenth of its time what is done of it beside
// it, as FILE.part: where that is there, it goes on from it. Throws InputError where the file is something else,
// StorageError where it cannot be written, and Stopped; then FILE.part remains.
ShardEnd make_shard(const StudyShard& empty, const std::filesystem::path& file, const ShardWork& work,
                    const std::function<void(std::int64_t)>& progress = {});

// Gives every one of them to `take` in the order of their studies, whatever that of the files. Throws InputError before
// any is given: one is missing, there twice, not finished, of another kind, question, protocol or version of the program.
void for_each_shard(std::span<const std::filesystem::path> files, const std::function<void(StudyShard)>& take);

}  // namespace jnd
