// What was acknowledged is there: after kill -9, after an interruption, from many threads at once.
#include <csignal>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

#include "data/log/replay.h"
#include "data/study/study.h"
#include "data/verify/verify.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

// In a child: answers trials and tells each one through the pipe after its append returned, until it is killed.
[[noreturn]] void answer_until_killed(const std::filesystem::path& path, SessionKind kind, int pipe) {
  try {
    const auto study = Study::open(path, Study::Access::read_write);
    const auto log = study->open_session(new_session(1, kind));
    for (const Trial& trial : make_plan(chinello(), 1, kSeed).trials) {
      log->append(event_kind::kTrialCompleted, to_body(record_of(chinello(), trial, usual_answer(trial))),
                  stamp_of(trial));
      if (::write(pipe, &trial.index, sizeof trial.index) != sizeof trial.index) break;
    }
    for (;;) ::pause();
  } catch (...) {
  }
  ::_exit(1);
}

TEST_CASE("kill -9 in the middle of appending loses nothing that was acknowledged", "[data]") {
  for (const SessionKind kind : {SessionKind::real, SessionKind::simulated}) {
    for (const int victims : {1, 17, 60}) {
      const TemporaryFolder folder;
      const auto path = folder / "study.jnd";
      new_study(path, chinello())->close();
      int ends[2];
      REQUIRE(::pipe(ends) == 0);
      const pid_t child = ::fork();
      REQUIRE(child >= 0);
      if (child == 0) {
        ::close(ends[0]);
        answer_until_killed(path, kind, ends[1]);
      }
      ::close(ends[1]);
      int acknowledged = 0, index = 0;
      while (acknowledged < victims && ::read(ends[0], &index, sizeof index) == sizeof index) ++acknowledged;
      ::kill(child, SIGKILL);
      while (::read(ends[0], &index, sizeof index) == sizeof index) ++acknowledged;
      ::close(ends[0]);
      int status = 0;
      REQUIRE(::waitpid(child, &status, 0) == child);
      REQUIRE(WIFSIGNALED(status));
      REQUIRE(acknowledged >= victims);

      // First a reader (which must replay the write-ahead log), then the next writer, whom no stale lock stops.
      const std::string id = new_session(1, kind).id;
      {
        const auto reader = Study::open(path, Study::Access::read_only);
        CHECK(static_cast<int>(replay(reader->events(id)).completed.size()) >= acknowledged);
      }
      const auto study = Study::open(path, Study::Access::read_write);
      const auto log = study->resume_session(id);
      const SessionState state = replay(log->events());
      CHECK(state.opened);
      const std::vector<Trial> planned = make_plan(chinello(), 1, kSeed).trials;
      const std::size_t done = state.completed.size();
      REQUIRE(static_cast<int>(done) >= acknowledged);
      for (std::size_t i = 0; i < done; ++i) CHECK(state.completed[i].trial == planned[i]);
      for (std::size_t i = done; i < planned.size(); ++i)
        log->append(event_kind::kTrialCompleted, to_body(record_of(chinello(), planned[i], usual_answer(planned[i]))),
                    stamp_of(planned[i]));
      study->close_session(id, {9, 9});
      CHECK(verify(*study).problems == std::vector<Problem>{});
      study->close();
      CHECK_FALSE(std::filesystem::exists(path.string() + ".lock"));
    }
  }
}

TEST_CASE("an interrupted and resumed session has the same log as an undisturbed one", "[data]") {
  const TemporaryFolder folder;
  const auto session_events = [&](const std::string& name, bool interrupted) {
    const auto path = folder / name;
    auto study = new_study(path);
    auto log = study->open_session(new_session(1));
    const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      if (interrupted && i % 5 == 3) {
        log.reset();
        study.reset();
        study = Study::open(path, Study::Access::read_write);
        log = study->resume_session("P01-simulated");
        REQUIRE(replay(log->events()).completed.size() == i);
      }
      log->append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), trials[i], usual_answer(trials[i]))),
                  stamp_of(trials[i]));
    }
    return log->events();
  };
  const std::vector<Event> whole = session_events("whole.jnd", false);
  const std::vector<Event> parts = session_events("parts.jnd", true);
  REQUIRE(whole.size() == parts.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    CHECK(whole[i].body == parts[i].body);
    CHECK(whole[i].hash == parts[i].hash);
  }
}

TEST_CASE("sessions in several threads keep their own whole chains", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd", chinello());
  constexpr int kThreads = 4, kEach = 3;
  std::vector<std::thread> threads;
  for (int thread = 0; thread < kThreads; ++thread)
    threads.emplace_back([&study, thread] {
      for (int i = 0; i < kEach; ++i) run_whole_session(*study, chinello(), thread * kEach + i + 1);
    });
  for (std::thread& thread : threads) thread.join();
  const VerifyReport report = verify(*study);
  CHECK(report.problems == std::vector<Problem>{});
  CHECK(report.sessions == kThreads * kEach);
  CHECK(study->sessions().size() == kThreads * kEach);
}

}  // namespace
}  // namespace jnd
