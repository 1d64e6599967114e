// What a follower concludes from files and a queue; the words of Slurm's programs.
#include "runner/cluster/shard_table.h"

#include <random>

#include "runner/cluster/slurm.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

QueueLook seen(std::vector<QueueTask> queue, std::set<int> finished = {}, std::map<int, std::uintmax_t> progress = {}) {
  return {std::move(finished), std::move(progress), std::move(queue)};
}

// Looks until the shards without a job are lost, at most.
std::vector<LostShard> lost_by(ShardTable& table, const QueueLook& look) {
  for (int i = 0; i < 10; ++i)
    if (std::vector<LostShard> lost = table.look(look); !lost.empty()) return lost;
  return {};
}

}  // namespace

TEST_CASE("numbers of shards as ranges, and back") {
  CHECK(ranges_text({}).empty());
  CHECK(ranges_text({4}) == "4");
  CHECK(ranges_text({1, 2, 3, 7, 9, 10}) == "1-3,7,9-10");
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    std::set<int> numbers;
    for (int shard = 1; shard <= 40; ++shard)
      if (random() % 2 == 0) numbers.insert(shard);
    CHECK(ranges_from(ranges_text(numbers)) == numbers);
  }
  CHECK(ranges_from("x,3-,5") == std::set<int>{5});
}

TEST_CASE("lines of squeue and of sacct") {
  const std::vector<QueueTask> tasks = Slurm::tasks_in(
      "12|3|RUNNING|None\nslurm says something\n12|N/A|PENDING|Resources\n"
      "13|4|PENDING|Node(s) | down\n");
  REQUIRE(tasks.size() == 2);
  CHECK(tasks[0].shard == 3);
  CHECK(tasks[0].alive());
  CHECK_FALSE(tasks[0].waiting());
  CHECK(tasks[1].reason == "Node(s) | down");
  CHECK(Slurm::ending_in("12_3|TIMEOUT|0:0\n", 12, 3) == "TIMEOUT");
  CHECK(Slurm::ending_in("12_3|FAILED|5:0\n12_4|FAILED|1:0\n", 12, 3) == "FAILED, exit code 5");
  CHECK(Slurm::ending_in("12_3|OUT_OF_MEMORY|0:125\n", 12, 3) == "OUT_OF_MEMORY, signal 125");
  CHECK(Slurm::ending_in("12_[3-8]|PENDING|0:0\n", 12, 3).empty());
}

TEST_CASE("a shard is lost when neither its file nor its job is seen for a while") {
  ShardTable table(3, 2);
  table.submitted(1, 7);
  table.submitted(2, 7);
  // A file is enough, whatever the queue says; a queue that does not answer says nothing.
  const QueueLook look = seen({{7, 2, "FAILED", ""}}, {2});
  CHECK(table.look(look).empty());
  for (int i = 0; i < 20; ++i) CHECK(table.look({{2}, {}, {}}).empty());
  const std::vector<LostShard> lost = lost_by(table, look);
  REQUIRE(lost.size() == 1);
  CHECK(lost[0].shard == 1);
  CHECK(lost[0].state.empty());
  CHECK(table.to_submit() == std::set<int>{1});
  CHECK(table.never_submitted() == std::set<int>{3});
  CHECK(lost_by(table, look).empty());  // it is said once
}

TEST_CASE("a job in the queue is waited for, also one that another submitted") {
  ShardTable table(1, 2);
  table.submitted(1, 7);
  const QueueLook look = seen({{7, 1, "NODE_FAIL", ""}, {9, 1, "PENDING", "Priority"}});
  CHECK(lost_by(table, look).empty());
  CHECK(table.counts().why_waiting == "Priority");
  const std::vector<LostShard> lost = lost_by(table, seen({{7, 1, "NODE_FAIL", ""}, {9, 1, "TIMEOUT", ""}}));
  REQUIRE(lost.size() == 1);
  CHECK(lost[0].job == 9);
  CHECK(lost[0].state == "TIMEOUT");
}

TEST_CASE("what an earlier job came to is no reason of a later one") {
  ShardTable table(1, 2);
  table.submitted(1, 9);
  const std::vector<LostShard> lost = lost_by(table, seen({{7, 1, "NODE_FAIL", ""}}));
  REQUIRE(lost.size() == 1);
  CHECK(lost[0].job == 9);
  CHECK(lost[0].state.empty());
}

TEST_CASE("tries are counted only where a shard does not get on") {
  ShardTable table(1, 2);
  for (std::uintmax_t round = 1; round <= 10; ++round) {
    table.submitted(1, static_cast<std::int64_t>(round));
    const std::vector<LostShard> lost = lost_by(table, seen({}, {}, {{1, round * 100}}));
    REQUIRE(lost.size() == 1);
    CHECK(lost[0].tries == 1);
  }
  table.submitted(1, 11);
  CHECK(lost_by(table, seen({}, {}, {{1, 1000}})).at(0).tries == 2);
  table.submitted(1, 12);
  CHECK(lost_by(table, seen({}, {}, {{1, 500}})).at(0).given_up);  // begun anew
  CHECK(table.given_up() == std::set<int>{1});
  CHECK(table.look(seen({}, {1})).empty());  // it came all the same
  CHECK(table.counts().finished == 1);
}

TEST_CASE("a file that is removed is made again") {
  ShardTable table(1, 2);
  CHECK(table.look(seen({}, {1})).empty());
  CHECK(lost_by(table, seen({})).size() == 1);
}

TEST_CASE("random histories: nothing that runs is lost, and all ends") {
  std::mt19937 random(3);
  for (int history = 0; history < 100; ++history) {
    constexpr int kShards = 12;
    ShardTable table(kShards, 1000);
    std::set<int> finished;
    std::map<int, std::int64_t> running;
    std::int64_t job = 0;
    const auto submit = [&](const std::set<int>& shards) {
      ++job;
      for (const int shard : shards) {
        running[shard] = job;
        table.submitted(shard, job);
      }
    };
    submit(ranges_from("1-12"));
    int looks = 0;
    while (table.counts().finished < kShards && looks < 2000) {
      ++looks;
      for (auto task = running.begin(); task != running.end();) {
        const auto chance = random() % 10;
        if (chance == 0) finished.insert(task->first);
        task = chance <= 2 ? running.erase(task) : std::next(task);
      }
      QueueLook look{finished, {}, {}};
      if (random() % 5 != 0) {
        look.queue.emplace();
        for (const auto& [shard, number] : running) look.queue->push_back({number, shard, "RUNNING", ""});
      }
      for (const LostShard& lost : table.look(look)) {
        CHECK_FALSE(running.contains(lost.shard));
        CHECK_FALSE(finished.contains(lost.shard));
      }
      if (const std::set<int> lost = table.to_submit(); !lost.empty()) submit(lost);
    }
    CHECK(table.counts().finished == kShards);
  }
}
