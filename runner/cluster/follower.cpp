#include "runner/cluster/follower.h"

#include <algorithm>
#include <chrono>
#include <sstream>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "data/fields/number_text.h"
#include "data/files/descriptor.h"
#include "data/files/draft.h"
#include "protocols/input/number_from.h"
#include "protocols/input/read_file.h"
#include "runner/cluster/called_program.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

constexpr int kTailLines = 8;
constexpr int kMostTails = 3;      // of shards that are given up
constexpr int kMostRefusals = 10;  // of sbatch, one after the other, with nothing left in the queue

std::string shards_text(const std::set<int>& shards) {
  return fmt::format("{} {}", shards.size() == 1 ? "shard" : "shards", ranges_text(shards));
}

std::string as_jobs(const std::vector<QueueTask>& tasks) {
  std::string text;
  for (const QueueTask& task : tasks) text += fmt::format("{}{}_{}", text.empty() ? "" : ",", task.job, task.shard);
  return text;
}

}  // namespace

Submissions::Submissions(const Campaign& campaign) : file_(file_of(campaign)) {}

std::filesystem::path Submissions::file_of(const Campaign& campaign) {
  return campaign.folder() / "submitted.txt";
}

void Submissions::add(std::int64_t job, const std::set<int>& shards) const {
  const int file = open(file_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  int error = file < 0 ? errno : write_all(file, fmt::format("{} {}\n", job, ranges_text(shards)));
  if (error == 0 && fsync(file) != 0) error = errno;
  if (file >= 0) close(file);
  if (error != 0) write_marked_message(cannot_write(file_, error).what());
}

std::vector<std::pair<std::int64_t, std::set<int>>> Submissions::all() const {
  std::vector<std::pair<std::int64_t, std::set<int>>> found;
  if (!std::filesystem::exists(file_)) return found;
  std::istringstream lines(read_input_file(file_));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t blank = line.find(' ');
    const auto job = number_from<std::int64_t>(std::string_view(line).substr(0, blank));
    if (job && blank != std::string::npos)
      found.emplace_back(*job, ranges_from(std::string_view(line).substr(blank + 1)));
  }
  return found;
}

std::optional<std::size_t> submit_missing(const Campaign& campaign, Slurm& slurm) {
  const std::optional<std::vector<QueueTask>> queue = slurm.queue();
  if (!queue) {
    if (!interrupt_requested())
      write_marked_message(
          fmt::format("squeue: {}\nnothing was submitted: without its answer shards could run twice", slurm.trouble()));
    return {};
  }
  std::set<int> missing;
  for (int shard = 1; shard <= campaign.shards(); ++shard) missing.insert(shard);
  for (const int shard : campaign.finished()) missing.erase(shard);
  for (const QueueTask& task : *queue)
    if (task.alive()) missing.erase(task.shard);
  if (missing.empty()) return 0;
  const std::optional<std::int64_t> job = slurm.submit(missing, campaign.settings().at_once);
  if (!job) {
    write_marked_message(fmt::format("Slurm does not take the job: {}", slurm.trouble()));
    return {};
  }
  Submissions(campaign).add(*job, missing);
  print_message("{}: job {}, {}\n", printable(campaign.folder().string()), *job, shards_text(missing));
  return missing.size();
}

std::string progress_text(const ShardTable::Counts& counts, int shards) {
  std::string text = fmt::format("{} of {} there", counts.finished, counted(shards, "shard"));
  const auto add = [&text](int count, std::string_view what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(counts.running, "running");
  add(counts.waiting, counts.why_waiting.empty() ? "waiting" : fmt::format("waiting ({})", counts.why_waiting));
  add(counts.unseen, "just ended");
  add(counts.lost, "to be submitted again");
  add(counts.given_up, "failed");
  add(counts.never, "not submitted");
  return text;
}

Follower::Follower(const Campaign& campaign, Slurm& slurm, FollowOptions options)
    : campaign_(campaign),
      slurm_(slurm),
      options_(std::move(options)),
      submissions_(campaign),
      table_(campaign.shards(), options_.retries) {
  for (const auto& [job, shards] : submissions_.all())
    for (const int shard : shards)
      if (shard >= 1 && shard <= campaign.shards()) table_.submitted(shard, job);
}

int Follower::follow() {
  for (;;) {
    const QueueLook now = look();
    if (interrupt_requested()) break;
    tell_trouble();
    const std::vector<LostShard> lost = table_.look(now);
    tell_lost(lost);
    if (now.queue) {
      tell_held();
      submit_lost();
    }
    tell_progress();
    if (const std::optional<int> code = ended()) return *code;
    if (!wait()) break;
  }
  say("Interrupted: the jobs go on. The same command follows them again.");
  return exit_code::kInterrupted;
}

std::string Follower::state() {
  table_.look(look());
  return progress_text(table_.counts(), campaign_.shards());
}

QueueLook Follower::look() {
  QueueLook now;
  now.queue = slurm_.queue();
  // After the queue: what was finished before its job left the queue is then seen.
  now.finished = campaign_.finished();
  for (int shard = 1; shard <= campaign_.shards(); ++shard)
    if (!now.finished.contains(shard)) now.progress[shard] = campaign_.progress(shard);
  return now;
}

void Follower::tell_trouble() {
  if (slurm_.trouble() == trouble_) return;
  trouble_ = slurm_.trouble();
  if (!trouble_.empty()) say(fmt::format("squeue does not answer: {}; asking on", trouble_));
}

void Follower::tell_lost(const std::vector<LostShard>& lost) {
  // Those that ended alike are said together: a node that fails takes many with it.
  std::map<std::string, std::set<int>> alike;
  std::set<std::int64_t> jobs;
  for (const LostShard& shard : lost) jobs.insert(shard.job);
  jobs.erase(0);
  const std::string accounts = slurm_.accounts(jobs);
  for (const LostShard& shard : lost) {
    std::string why = Slurm::ending_in(accounts, shard.job, shard.shard);
    if (why.empty()) why = shard.state;
    if (why.starts_with("COMPLETED")) why += ", but its file is not there";
    if (why.empty()) why = "gone from the queue without its file";
    why += shard.given_up    ? fmt::format("; given up (try {})", shard.tries)
           : shard.tries > 1 ? fmt::format("; again (try {})", shard.tries + 1)
                             : "; again";
    alike[why].insert(shard.shard);
  }
  for (const auto& [why, shards] : alike) say(fmt::format("{}: {}", shards_text(shards), why));
}

void Follower::tell_held() {
  const std::vector<QueueTask> held = table_.held();
  const std::string jobs = as_jobs(held);
  if (jobs == held_) return;
  held_ = jobs;
  if (!held.empty())
    say(fmt::format("these wait for you or an administrator ({}); scontrol release {}", held.front().reason, jobs));
}

void Follower::tell_progress() {
  const std::string text = progress_text(table_.counts(), campaign_.shards());
  if (text == shown_) return;
  shown_ = text;
  if (!is_terminal(STDERR_FILENO)) {
    print_message("{}\n", printable(text));
    return;
  }
  // On one line, which a longer one would leave.
  print_message("\r\x1b[K{}", printable(text).substr(0, static_cast<std::size_t>(terminal_width() - 1)));
  drawn_ = true;
}

void Follower::say(const std::string& text) {
  if (std::exchange(drawn_, false)) write_message("\r\x1b[K");
  shown_.clear();
  write_message(printable_lines(text) + "\n");
}

void Follower::submit_lost() {
  const std::set<int> lost = table_.to_submit();
  if (lost.empty()) return;
  const std::optional<std::int64_t> job = slurm_.submit(lost, campaign_.settings().at_once);
  if (!job) {
    ++refusals_;
    const std::string text = fmt::format("Slurm does not take {} again: {}", shards_text(lost), slurm_.trouble());
    if (text != std::exchange(refusal_, text)) say(text);
    // It may have taken it all the same, and only its answer was lost: then the queue shows it at the next look.
    return;
  }
  refusals_ = 0;
  refusal_.clear();
  for (const int shard : lost) table_.submitted(shard, *job);
  submissions_.add(*job, lost);
}

std::optional<int> Follower::ended() {
  const ShardTable::Counts counts = table_.counts();
  if (counts.finished == campaign_.shards()) {
    if (std::exchange(drawn_, false)) write_message("\n");
    std::vector<std::string> command = {"bash", Campaign::kScript, "combine"};
    command.insert(command.end(), options_.combine.begin(), options_.combine.end());
    return run_program(command, campaign_.folder());
  }
  if (counts.running + counts.waiting + counts.unseen > 0) return {};
  if (counts.lost > 0 && refusals_ < kMostRefusals) return {};
  return say_given_up();
}

int Follower::say_given_up() {
  std::set<int> missing = table_.given_up();
  missing.merge(table_.to_submit());
  int tails = 0;
  for (const int shard : missing) {
    if (tails == kMostTails) break;
    const std::string tail = campaign_.log_tail(shard, kTailLines);
    if (tail.empty()) continue;
    say(tail.substr(0, tail.size() - 1));
    ++tails;
  }
  if (!missing.empty())
    say(fmt::format(
        "given up: {}; the others are there or were not submitted. When the cause is gone, the same command "
        "with --submit goes on",
        shards_text(missing)));
  if (const std::set<int> never = table_.never_submitted(); !never.empty())
    say(fmt::format("never submitted: {}; --submit does it", shards_text(never)));
  return exit_code::kProblemFound;
}

bool Follower::wait() const {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(options_.every_s);
  while (Clock::now() < end && !interrupt_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  return !interrupt_requested();
}

}  // namespace jnd
