// Slurm, by its programs sbatch, squeue and sacct. Of sacct it only asks why a task ended that the queue has forgotten: many
// clusters do without accounting.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "runner/cluster/shard_table.h"

namespace jnd {

class Slurm {
 public:
  // The jobs of that name, whose scripts are in the folder. Throws UsageError where Slurm is not here.
  Slurm(std::filesystem::path folder, std::string name);

  // Submits job.sh for these shards and returns the job's number; none where Slurm does not take it: trouble() says why.
  std::optional<std::int64_t> submit(const std::set<int>& shards, int at_once);
  // All tasks of the name that the queue still knows, those too that somebody else submitted; none where it does not answer.
  std::optional<std::vector<QueueTask>> queue();
  const std::string& trouble() const noexcept { return trouble_; }  // of the last call, in Slurm's words

  // What sacct says of the tasks of these jobs, for ending_in(); empty where there is no accounting.
  std::string accounts(const std::set<std::int64_t>& jobs);

  // Of squeue's lines "JOB|SHARD|STATE|REASON"; others are left out.
  static std::vector<QueueTask> tasks_in(std::string_view lines);
  // Of sacct's lines "JOB_SHARD|STATE|CODE:SIGNAL": "TIMEOUT", or "FAILED, exit code 5"; empty where it is not in them.
  static std::string ending_in(std::string_view lines, std::int64_t job, int shard);

 private:
  std::filesystem::path folder_;
  std::string name_, trouble_;
  bool accounting_ = true;
};

}  // namespace jnd
