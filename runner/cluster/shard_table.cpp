#include "runner/cluster/shard_table.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "protocols/input/number_from.h"

namespace jnd {

namespace {

constexpr int kLooksUntilLost = 3;

}  // namespace

bool QueueTask::alive() const {
  // The states that a job does not leave; with any other, also one that is not known here, it may still finish.
  constexpr std::array<std::string_view, 10> kOver = {"BOOT_FAIL", "CANCELLED", "COMPLETED", "DEADLINE",
                                                      "FAILED",    "NODE_FAIL", "REVOKED",   "OUT_OF_MEMORY",
                                                      "PREEMPTED", "TIMEOUT"};
  return std::find(kOver.begin(), kOver.end(), state) == kOver.end();
}

bool QueueTask::waiting() const {
  constexpr std::array<std::string_view, 7> kWaiting = {"PENDING",     "CONFIGURING",  "REQUEUED",     "REQUEUE_HOLD",
                                                        "REQUEUE_FED", "SPECIAL_EXIT", "RESV_DEL_HOLD"};
  return std::find(kWaiting.begin(), kWaiting.end(), state) != kWaiting.end();
}

bool QueueTask::held() const {
  if (!waiting()) return false;
  return state == "REQUEUE_HOLD" || state == "SPECIAL_EXIT" || reason.find("eld") != std::string::npos ||
         reason == "DependencyNeverSatisfied" || reason == "BadConstraints" || reason == "PartitionTimeLimit";
}

ShardTable::ShardTable(int shards, int retries) : retries_(retries) {
  for (int shard = 1; shard <= shards; ++shard) shards_[shard] = {};
}

void ShardTable::submitted(int shard, std::int64_t job) {
  Shard& one = shards_.at(shard);
  if (one.state == State::finished) return;
  one.state = State::unseen;
  one.job = std::max(one.job, job);
  one.looks_unseen = 0;
}

void ShardTable::see(Shard& shard, const QueueTask& task) const {
  shard.state = task.waiting() ? State::waiting : State::running;
  shard.job = task.job;
  shard.looks_unseen = 0;
  shard.reason = task.waiting() ? task.reason : "";
}

std::optional<LostShard> ShardTable::miss(int number, Shard& shard, std::uintmax_t progress,
                                          const QueueTask* last) const {
  const bool known = last != nullptr && last->job >= shard.job;
  if (known) shard.job = last->job;
  if (shard.state == State::never && last == nullptr) return {};
  if (shard.state == State::lost || shard.state == State::given_up) return {};
  shard.state = State::unseen;
  if (++shard.looks_unseen < kLooksUntilLost) return {};
  shard.tries = progress > shard.progress ? 1 : shard.tries + 1;
  shard.progress = std::max(progress, shard.progress);
  shard.state = shard.tries > retries_ ? State::given_up : State::lost;
  return LostShard{number, shard.job, known ? last->state : "", shard.tries, shard.state == State::given_up};
}

std::vector<LostShard> ShardTable::look(const QueueLook& look) {
  std::map<int, const QueueTask*> alive, over;
  if (look.queue) {
    held_.clear();
    for (const QueueTask& task : *look.queue) {
      const QueueTask*& place = (task.alive() ? alive : over)[task.shard];
      if (place == nullptr || task.job > place->job) place = &task;
    }
  }
  std::vector<LostShard> lost;
  for (auto& [number, shard] : shards_) {
    if (look.finished.contains(number)) {
      shard.state = State::finished;
      continue;
    }
    // Removed by hand: it is to be made again.
    if (shard.state == State::finished) shard.state = State::unseen;
    if (!look.queue) continue;
    if (const auto found = alive.find(number); found != alive.end()) {
      see(shard, *found->second);
      if (found->second->held()) held_.push_back(*found->second);
      continue;
    }
    const auto last = over.find(number);
    const auto progress = look.progress.find(number);
    if (const std::optional<LostShard> one = miss(number, shard, progress == look.progress.end() ? 0 : progress->second,
                                                  last == over.end() ? nullptr : last->second))
      lost.push_back(*one);
  }
  return lost;
}

ShardTable::Counts ShardTable::counts() const {
  Counts counts;
  std::map<std::string, int> reasons;
  for (const auto& [number, shard] : shards_) {
    switch (shard.state) {
      case State::never:
        ++counts.never;
        break;
      case State::waiting:
        ++counts.waiting;
        ++reasons[shard.reason];
        break;
      case State::running:
        ++counts.running;
        break;
      case State::unseen:
        ++counts.unseen;
        break;
      case State::lost:
        ++counts.lost;
        break;
      case State::given_up:
        ++counts.given_up;
        break;
      case State::finished:
        ++counts.finished;
        break;
    }
  }
  const auto most = std::max_element(reasons.begin(), reasons.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most != reasons.end() && most->first != "None") counts.why_waiting = most->first;
  return counts;
}

std::set<int> ShardTable::of(State state) const {
  std::set<int> found;
  for (const auto& [number, shard] : shards_)
    if (shard.state == state) found.insert(number);
  return found;
}

std::set<int> ShardTable::to_submit() const {
  return of(State::lost);
}

std::set<int> ShardTable::given_up() const {
  return of(State::given_up);
}

std::set<int> ShardTable::never_submitted() const {
  return of(State::never);
}

std::vector<QueueTask> ShardTable::held() const {
  return held_;
}

std::string ranges_text(const std::set<int>& numbers) {
  std::string text;
  for (auto number = numbers.begin(); number != numbers.end();) {
    const int first = *number;
    int last = first;
    while (++number != numbers.end() && *number == last + 1) ++last;
    text += text.empty() ? "" : ",";
    text += first == last ? std::to_string(first) : fmt::format("{}-{}", first, last);
  }
  return text;
}

std::set<int> ranges_from(std::string_view text) {
  std::set<int> numbers;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), part.size() + 1));
    const std::size_t dash = part.find('-');
    const auto first = number_from<int>(part.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : number_from<int>(part.substr(dash + 1));
    if (!first || !last) continue;
    for (int number = *first; number <= *last && *last - *first < 100'000; ++number) numbers.insert(number);
  }
  return numbers;
}

}  // namespace jnd
