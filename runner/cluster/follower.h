// Follows a campaign on a scheduler to its end: says how it is getting on, submits again what was lost, and combines the
// shards when all are there.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runner/cluster/campaign.h"
#include "runner/cluster/shard_table.h"
#include "runner/cluster/slurm.h"

namespace jnd {

struct FollowOptions {
  int retries = 3;
  double every_s = 20;               // between two looks
  std::vector<std::string> combine;  // options of jnd combine
};

// Which job has which shards, of what this program submitted: a file in the campaign's folder that is only added to.
class Submissions {
 public:
  explicit Submissions(const Campaign& campaign);
  static std::filesystem::path file_of(const Campaign& campaign);
  // Where it cannot be written it is said, and that is all: the queue knows the job by its name.
  void add(std::int64_t job, const std::set<int>& shards) const;
  std::vector<std::pair<std::int64_t, std::set<int>>> all() const;

 private:
  std::filesystem::path file_;
};

// Submits the shards that have no file and no job in the queue. Returns how many; none where Slurm does not take them, which
// is said.
std::optional<std::size_t> submit_missing(const Campaign& campaign, Slurm& slurm);

// "12 of 64 shards there, 8 running, 44 waiting (Priority)".
std::string progress_text(const ShardTable::Counts& counts, int shards);

class Follower {
 public:
  Follower(const Campaign& campaign, Slurm& slurm, FollowOptions options);
  // Returns the exit code.
  int follow();
  // How it is getting on, at one look; no more than is known where the queue does not answer.
  std::string state();

 private:
  QueueLook look();
  void tell_trouble();
  void tell_lost(const std::vector<LostShard>& lost);
  void tell_held();
  void tell_progress();
  void say(const std::string& text);  // a line of its own, not over the progress
  void submit_lost();
  std::optional<int> ended();
  int say_given_up();
  bool wait() const;

  const Campaign& campaign_;
  Slurm& slurm_;
  FollowOptions options_;
  Submissions submissions_;
  ShardTable table_;
  std::string shown_, trouble_, refusal_, held_;  // what was said last
  bool drawn_ = false;
  int refusals_ = 0;
};

}  // namespace jnd
