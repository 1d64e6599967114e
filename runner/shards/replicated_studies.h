// One study simulated many times over, each with a seed of its own: what jnd analyze makes of every one, in tables where
// the studies stand below each other. Any of them can be made again whole, by its seed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/export/export_folder.h"
#include "data/fields/csv_writer.h"
#include "data/results/study_results.h"
#include "runner/session/simulate.h"
#include "runner/shards/study_shard.h"

namespace jnd {

struct ReplicationQuestion {
  const Protocol& protocol;
  const RigDescription& rig;
  const ParticipantProfile& profile;
  int participants = 1;
  std::int64_t studies = 1;
  std::uint64_t seed = 1;  // of all; each has that of seed_of_study()
  DifferenceSource by = DifferenceSource::nominal;
};

// What jnd analyze makes of one simulated study, of which nothing else is kept. Throws Stopped where interrupted.
StudyResults simulated_results(const Simulation& simulation, DifferenceSource by, bool hierarchical = false);

StudyShard replication_shard(const ReplicationQuestion& question, int number, int of);
// question must outlive it. threads: studies at a time.
ShardWork replication_work(const ReplicationQuestion& question, int threads);

// The tables of all studies as a folder of CSV files, which grow shard by shard and appear when all are there.
class ReplicationFolder {
 public:
  // Throws StorageError, as ExportFolder does.
  ReplicationFolder(const std::filesystem::path& folder, bool replace) : folder_(folder), files_(folder, replace) {}

  // In the order of the studies. Throws InputError where the shard holds something else, StorageError.
  void add(const StudyShard& shard);
  // With dictionary.csv and datapackage.json. Returns lines that say what is there.
  std::string publish();

 private:
  std::filesystem::path folder_;
  ExportFolder files_;
  Protocol protocol_;                            // of the last shard: of all
  std::int64_t studies_ = 0, participants_ = 0;  // as its question has them
  std::string profile_;
  std::vector<std::string> names_;
  std::map<std::string, std::string> headers_;  // by name
  std::vector<DictionaryRow> dictionary_;
};

}  // namespace jnd
