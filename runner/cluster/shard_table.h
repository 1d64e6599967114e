// What is known of each shard of a campaign while a scheduler works on it, and what follows from that. It looks at nothing
// itself: it is told, look by look, which files are there and what the queue says.
//
// A shard is finished when its file is there, whatever the scheduler says of it; and it is lost when it was submitted, has
// no file, and no job in the queue at several looks one after the other (a file may come to be seen later than its job is
// gone from the queue).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace jnd {

// A task of an array, as the queue has it: also one that is over, for a while.
struct QueueTask {
  std::int64_t job = 0;  // the array's
  int shard = 0;
  std::string state, reason;  // Slurm's words: "PENDING", "Resources"

  bool alive() const;
  bool waiting() const;
  bool held() const;  // it waits for a person
};

struct QueueLook {
  std::set<int> finished;                       // whose file is there
  std::map<int, std::uintmax_t> progress;       // of others, Campaign::progress
  std::optional<std::vector<QueueTask>> queue;  // none: it did not answer
};

struct LostShard {
  int shard = 0;
  std::int64_t job = 0;  // the last one; 0 where that is not known
  std::string state;     // the queue's last word; empty where it has none
  int tries = 0;         // in a row without getting on, this one counted
  bool given_up = false;
};

class ShardTable {
 public:
  // retries: how often a shard is submitted again that does not get on.
  ShardTable(int shards, int retries);

  void submitted(int shard, std::int64_t job);
  // The shards that have just turned out to be lost. Those that are not given up are to be submitted again.
  std::vector<LostShard> look(const QueueLook& look);

  struct Counts {
    int finished = 0, running = 0, waiting = 0;
    int unseen = 0;  // submitted, and in no queue just now
    int lost = 0;    // to be submitted again
    int given_up = 0;
    int never = 0;            // not submitted yet
    std::string why_waiting;  // "Priority", of most that wait
  };
  Counts counts() const;
  std::set<int> to_submit() const;  // the lost ones
  std::set<int> given_up() const;
  std::set<int> never_submitted() const;
  std::vector<QueueTask> held() const;  // of the last look

 private:
  enum class State { never, waiting, running, unseen, lost, given_up, finished };
  struct Shard {
    State state = State::never;
    std::int64_t job = 0;
    int looks_unseen = 0, tries = 0;
    std::uintmax_t progress = 0;
    std::string reason;
  };
  std::set<int> of(State state) const;
  void see(Shard& shard, const QueueTask& task) const;
  std::optional<LostShard> miss(int number, Shard& shard, std::uintmax_t progress, const QueueTask* last) const;

  int retries_;
  std::map<int, Shard> shards_;
  std::vector<QueueTask> held_;
};

// "1-3,7" of 1, 2, 3, 7; and back. The text of sbatch --array.
std::string ranges_text(const std::set<int>& numbers);
std::set<int> ranges_from(std::string_view text);

}  // namespace jnd
