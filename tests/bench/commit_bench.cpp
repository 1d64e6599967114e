// What it costs to keep an answer: trials a second through a session's own log (a pilot session, so every answer is
// flushed), beside the least that such a promise can cost. In rounds, so that all meet the same disk:
//
//   session     SessionLog::mark(trial.began) and SessionLog::append(trial.completed), with what every finger got
//   one row     a bare SQLite table, WAL and synchronous=FULL: one prepared insert of the same bytes, one commit
//   raw         4 KiB appended to a file and fdatasync()
//
//   commit_bench [FOLDER] [TRIALS] [ROUNDS] [--slow]
//     FOLDER  of the disk to measure (default .); on a tmpfs a flush is free, and what is left is processor time
//     TRIALS  of each loop in a round (default 200); ROUNDS (default 7)
//     --slow  every flush of every loop takes 1 ms longer: a disk as labs have them, on a machine whose disk is faster
#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include "data/log/event_body.h"
#include "data/study/study.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/tasks/task.h"

namespace {

long extra_flush_ns = 0;
long flushes = 0;

int flush_with(const char* name, int descriptor) {
  ++flushes;
  if (extra_flush_ns > 0) {
    const timespec wait{0, extra_flush_ns};
    ::clock_nanosleep(CLOCK_MONOTONIC, 0, &wait, nullptr);
  }
  return reinterpret_cast<int (*)(int)>(::dlsym(RTLD_NEXT, name))(descriptor);
}

}  // namespace

// In front of the C library's, for SQLite too.
extern "C" int fdatasync(int descriptor) {
  return flush_with("fdatasync", descriptor);
}
extern "C" int fsync(int descriptor) {
  return flush_with("fsync", descriptor);
}

namespace {

using namespace jnd;
namespace fs = std::filesystem;

double seconds(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Cost {
  std::vector<double> wall_s, cpu_s, flushes;  // a trial, by round

  void measure(int trials, const std::function<void(int)>& one) {
    const long flushes_before = ::flushes;
    const double wall = seconds(CLOCK_MONOTONIC), cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (int i = 0; i < trials; ++i) one(i);
    wall_s.push_back((seconds(CLOCK_MONOTONIC) - wall) / trials);
    cpu_s.push_back((seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu) / trials);
    flushes.push_back(static_cast<double>(::flushes - flushes_before) / trials);
  }
};

TrialRecord record_of(const Protocol& protocol, const Trial& trial) {
  TrialRecord record;
  record.trial = trial;
  record.condition_name = protocol.conditions[static_cast<std::size_t>(trial.condition)].name;
  record.series_name = protocol.series[static_cast<std::size_t>(trial.series)].name;
  record.answer = {.said = trial.target, .entered_by = EnteredBy::participant, .response_time_s = 0.8123456};
  record.duration_s = 9.0123;
  for (std::size_t i = 0; i < 2; ++i) {
    Presentation& presentation = record.presentations[i];
    presentation.duration_s = 3.501;
    presentation.ticks = 3501;
    for (int finger = 0; finger < 2; ++finger) {
      FingerPresentation one;
      one.finger = finger;
      one.stiffness = trial.stimuli[i] - 0.2823456 + finger * 1e-4;
      one.stiffness_se = 0.3779869;
      one.fit_samples = 1947;
      one.peak_force_n = 3.8340401;
      one.deepest_penetration = 0.0054778;
      one.work_j = 0.0268156431;
      one.mean_speed = 0.0157919;
      one.contacts = 3;
      one.dwell_s = 1.947;
      presentation.fingers.push_back(one);
    }
  }
  return record;
}

// A table of one text column in a file of its own.
class OneRow {
 public:
  OneRow(const fs::path& path, std::size_t bytes) : text_(bytes, 'x') {
    require(sqlite3_open(path.c_str(), &connection_));
    require(sqlite3_exec(connection_,
                         "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; CREATE TABLE t (x TEXT NOT NULL)",
                         nullptr, nullptr, nullptr));
    require(sqlite3_prepare_v2(connection_, "INSERT INTO t VALUES (?)", -1, &insert_, nullptr));
  }
  ~OneRow() {
    sqlite3_finalize(insert_);
    sqlite3_close(connection_);
  }
  OneRow(const OneRow&) = delete;
  OneRow& operator=(const OneRow&) = delete;
  void add() {
    sqlite3_bind_text(insert_, 1, text_.data(), static_cast<int>(text_.size()), SQLITE_STATIC);
    if (sqlite3_step(insert_) != SQLITE_DONE) throw std::runtime_error(sqlite3_errmsg(connection_));
    sqlite3_reset(insert_);
  }

 private:
  void require(int result) const {
    if (result != SQLITE_OK) throw std::runtime_error(sqlite3_errmsg(connection_));
  }
  std::string text_;
  sqlite3* connection_ = nullptr;
  sqlite3_stmt* insert_ = nullptr;
};

class Raw {
 public:
  explicit Raw(const fs::path& path) : descriptor_(::open(path.c_str(), O_CREAT | O_WRONLY | O_APPEND, 0600)) {}
  ~Raw() { ::close(descriptor_); }
  Raw(const Raw&) = delete;
  Raw& operator=(const Raw&) = delete;
  void add() {
    if (::write(descriptor_, block_.data(), block_.size()) != static_cast<ssize_t>(block_.size()) ||
        ::fdatasync(descriptor_) != 0)
      throw std::runtime_error("the raw file cannot be written");
  }

 private:
  std::array<char, 4096> block_{};
  int descriptor_;
};

void print(const char* name, const Cost& cost) {
  fmt::print("{:8} {:10.0f} {:12.1f} {:12.1f} {:10.2f}\n", name, 1 / median(cost.wall_s), 1e6 * median(cost.wall_s),
             1e6 * median(cost.cpu_s), median(cost.flushes));
}

void run(const fs::path& folder, int trials, int rounds) {
  const Protocol protocol = load_protocol(std::string(JND_SOURCE_DIR) + "/protocols/chinello2017.json");
  const std::unique_ptr<Study> study = Study::create(folder / "bench.jnd", protocol.name, protocol.bytes, 1, {1, 1});
  const auto body_size = body_text(to_body(record_of(protocol, make_plan(protocol, 1, 1).trials.front()))).size();
  OneRow one_row(folder / "one-row.sqlite", body_size);
  Raw raw(folder / "raw");
  Cost session, row, plain;
  std::vector<double> speed, cpu;
  int participant = 0;
  for (int round = 0; round <= rounds; ++round) {  // the first one warms up
    // As many participants as the round has trials for, each with a session of their own.
    std::vector<TrialRecord> records;
    std::vector<std::unique_ptr<SessionLog>> logs;
    std::vector<SessionLog*> log_of;
    while (records.size() < static_cast<std::size_t>(trials)) {
      const Plan plan = make_plan(protocol, ++participant, 1);
      NewSession next;
      next.participant = fmt::format("P{:04}", participant);
      next.id = next.participant + "-pilot";
      next.participant_number = participant;
      next.kind = SessionKind::pilot;
      next.responder = "keyboard";
      next.rig = "rrs3";
      next.trials_total = main_trial_count(plan);
      next.stamp = {1, 1};
      logs.push_back(study->open_session(next));
      for (const Trial& trial : plan.trials) {
        records.push_back(record_of(protocol, trial));
        log_of.push_back(logs.back().get());
      }
    }
    session.measure(trials, [&](int i) {
      const auto place = static_cast<std::size_t>(i);
      const Trial& trial = records[place].trial;
      log_of[place]->mark(event_kind::kTrialBegan, {{"index", trial.index}, {"attempt", 1}}, {2, 2});
      log_of[place]->append(event_kind::kTrialCompleted, to_body(records[place]), {3, 3});
    });
    row.measure(trials, [&](int) { one_row.add(); });
    plain.measure(trials, [&](int) { raw.add(); });
    if (round == 0) session = row = plain = Cost{};
  }
  for (std::size_t i = 0; i < session.wall_s.size(); ++i) {
    speed.push_back(row.wall_s[i] / session.wall_s[i]);
    cpu.push_back(session.cpu_s[i] - row.cpu_s[i]);
  }
  fmt::print("{} trials a loop, medians of {} rounds, bodies of {} bytes in the session and in the one-row table\n",
             trials, rounds, body_size);
  if (extra_flush_ns > 0) fmt::print("a slow disk is simulated: 1 ms longer for every flush of every loop\n");
  fmt::print("            trials/s   us a trial   cpu us/trial    flushes\n");
  print("session", session);
  print("one row", row);
  print("raw", plain);
  const double flush_ms = 1e3 * median(plain.wall_s);
  fmt::print("4 KiB and fdatasync: {:.3f} ms\n", flush_ms);
  fmt::print("session / one row: {:.3f} (wanted: at least 0.8 where a flush takes 1 ms or more{})\n", median(speed),
             flush_ms >= 1 ? "" : "; here it takes less");
  fmt::print("our own processor time: {:.1f} us a trial more than one row (wanted: at most 250)\n", 1e6 * median(cpu));
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (std::erase(words, "--slow") > 0) extra_flush_ns = 1'000'000;
  const fs::path where = !words.empty() ? words[0] : ".";
  const int trials = words.size() > 1 ? std::atoi(words[1].c_str()) : 200;
  const int rounds = words.size() > 2 ? std::atoi(words[2].c_str()) : 7;
  const fs::path folder = where / fmt::format("jnd-commit-bench-{}", ::getpid());
  fs::create_directories(folder);
  int result = EXIT_SUCCESS;
  try {
    run(folder, std::max(1, trials), std::max(1, rounds));
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    result = EXIT_FAILURE;
  }
  fs::remove_all(folder);
  return result;
}
