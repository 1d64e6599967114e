// How long the registered analysis of a large study takes, from the closed file to tables of numbers, how much memory, and how
// both grow with the trials; beside it, the least that any analysis must do: read every body from the file.
//
//   study_bench [TRIALS] [full]    default 1000000; full: with what every finger got (2.3 kB a trial instead of 0.4 kB)
//
// Every number is of a process of its own, whose peak is that of its resident memory. kB/participant: by how much the peak of
// the analysis is above that of reading.
//
// The study is generated in bulk, in one transaction, with bodies and hashes as the program writes them: an analysis looks
// first whether every hash holds. Its sessions stay open.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <string>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "data/log/chain.h"
#include "data/log/event_body.h"
#include "data/results/study_results.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/tasks/task.h"

namespace {

using namespace jnd;
namespace fs = std::filesystem;

struct Cost {
  double seconds = 0;
  double peak_mb = 0;
};

// In a process of its own.
Cost cost_of(const std::function<void()>& action) {
  const auto begin = std::chrono::steady_clock::now();
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      action();
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
      ::_exit(1);
    }
    ::_exit(0);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || ::wait4(child, &status, 0, &usage) != child || status != 0) std::exit(1);
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
          static_cast<double>(usage.ru_maxrss) / 1024};
}

std::string body_of(const Protocol& protocol, const Trial& trial, bool full) {
  TrialRecord record;
  record.trial = trial;
  record.condition_name = protocol.conditions[static_cast<std::size_t>(trial.condition)].name;
  record.series_name = protocol.series[static_cast<std::size_t>(trial.series)].name;
  const bool wrong = trial.index % 4 == 1;
  record.answer = {.said = (trial.target == kClassSame) != wrong ? kClassSame : kClassDifferent,
                   .entered_by = EnteredBy::participant,
                   .response_time_s = 0.5 + 0.001 * trial.index};
  record.duration_s = 9 + 0.001 * trial.index;
  for (std::size_t i = 0; i < 2 && full; ++i) {
    Presentation& presentation = record.presentations[i];
    presentation.duration_s = 3.501;
    presentation.ticks = 3501;
    for (int finger = 0; finger < 2; ++finger) {
      FingerPresentation one;
      one.finger = finger;
      one.stiffness = trial.stimuli[i] - 0.2823456 + finger * 1e-4;
      one.stiffness_se = 0.3779869;
      one.fit_samples = 1947;
      one.peak_force_n = 3.8340401 + 0.001 * trial.index;
      one.deepest_penetration = 0.0054778;
      one.work_j = 0.0268156431 + 1e-5 * trial.index;
      one.mean_speed = 0.0157919;
      one.contacts = 3;
      one.dwell_s = 1.947 + 0.001 * (trial.index % 7);
      presentation.fingers.push_back(one);
    }
  }
  return body_text(to_body(record));
}

constexpr std::string_view kTime = "2026-01-01T00:00:00.000000000Z";

void generate(const fs::path& path, const Protocol& protocol, int participants, bool full) {
  Study::create(path, protocol.name, protocol.bytes, 1, {1, 1})->close();
  SQLite::Database database(path.string(), SQLite::OPEN_READWRITE);
  database.exec("PRAGMA synchronous = OFF");
  SQLite::Transaction transaction(database);
  SQLite::Statement insert(database,
                           fmt::format("INSERT INTO event (session, seq, kind, utc, monotonic_ns, version, body, hash) "
                                       "VALUES (?, ?, ?, '{}', 0, 'bench', ?, ?)",
                                       kTime));
  std::string head;  // of the session that is being written
  const auto add = [&](const std::string& session, int seq, std::string_view kind, const std::string& body) {
    const Event event{.session = session,
                      .seq = seq,
                      .kind = std::string(kind),
                      .stamp = {},
                      .version = "bench",
                      .body = body,
                      .hash = {}};
    head = event_hash(seq == 1 ? std::string_view() : head, event, kTime);
    insert.bind(1, session);
    insert.bind(2, seq);
    insert.bind(3, event.kind);
    insert.bind(4, body);
    insert.bind(5, head);
    insert.exec();
    insert.reset();
  };
  for (int participant = 1; participant <= participants; ++participant) {
    const Plan plan = make_plan(protocol, participant, 1);
    const std::string session = fmt::format("s{:06}", participant);
    int seq = 0;
    add(session, ++seq, event_kind::kSessionOpened,
        fmt::format(R"({{"participant":"P{0:06}","participant_number":{0},"kind":"simulated","responder":"bench",)"
                    R"("trials_total":{1}}})",
                    participant, plan.trials.size()));
    for (const Trial& trial : plan.trials)
      add(session, ++seq, event_kind::kTrialCompleted, body_of(protocol, trial, full));
  }
  transaction.commit();
}

// The reference: every body through the reader of the file, and nothing else.
void read_bodies(const fs::path& path) {
  SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
  SQLite::Statement query(database, "SELECT body FROM event NOT INDEXED WHERE kind = 'trial.completed'");
  std::size_t bytes = 0;
  while (query.executeStep()) bytes += static_cast<std::size_t>(query.getColumn(0).getBytes());
  if (bytes == 0) std::abort();
}

void analyse(const fs::path& path, const Protocol& protocol, int participants) {
  const auto study = Study::open(path, Study::Access::read_only);
  const StudyResults results = results_of(*study, protocol, SessionKind::simulated);
  if (results.attendance.participants != participants) std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  const int most = argc > 1 ? std::atoi(argv[1]) : 1'000'000;
  const bool full = argc > 2 && std::string(argv[2]) == "full";
  const Protocol protocol = load_protocol(std::string(JND_SOURCE_DIR) + "/protocols/chinello2017.json");
  const fs::path folder = fs::temp_directory_path() / fmt::format("jnd-study-bench-{}", ::getpid());
  fs::create_directories(folder);
  const int trials_each = static_cast<int>(make_plan(protocol, 1, 1).trials.size());
  fmt::print(
      "   trials   participants   analysis s   us/trial   bodies alone s   ratio   peak MB   bodies alone MB   "
      "kB/participant\n");
  for (const int trials : {most / 100, most / 10, most}) {
    const int participants = std::max(1, trials / trials_each);
    const double answered = participants * trials_each;
    const fs::path path = folder / fmt::format("{}.sqlite", trials);
    cost_of([&] { generate(path, protocol, participants, full); });
    cost_of([&] { read_bodies(path); });  // into the page cache
    const Cost reading = cost_of([&] { read_bodies(path); });
    const Cost analysing = cost_of([&] { analyse(path, protocol, participants); });
    fmt::print("{:9} {:14} {:12.3f} {:10.2f} {:16.3f} {:7.2f} {:9.1f} {:17.1f} {:16.2f}\n", answered, participants,
               analysing.seconds, 1e6 * analysing.seconds / answered, reading.seconds,
               analysing.seconds / reading.seconds, analysing.peak_mb, reading.peak_mb,
               1024 * (analysing.peak_mb - reading.peak_mb) / participants);
    fs::remove(path);
  }
  fs::remove_all(folder);
  return 0;
}
