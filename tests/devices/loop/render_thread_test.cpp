// The thread that jobs are lent to.
#include "devices/loop/render_thread.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <stdexcept>
#include <vector>

#include <sched.h>

#include "devices/device_error.h"
#include "tests/catch.h"

using namespace jnd;

TEST_CASE("jobs run one after the other, all on the same thread, which is not the caller's") {
  RenderThread render(RealtimePolicy::off);
  std::vector<std::thread::id> ids;
  for (int i = 0; i < 1000; ++i) render.run([&] { ids.push_back(std::this_thread::get_id()); });
  REQUIRE(ids.size() == 1000);  // and each was done when run returned
  CHECK(ids.front() != std::this_thread::get_id());
  CHECK(std::count(ids.begin(), ids.end(), ids.front()) == 1000);
  CHECK(render.report().policy == RealtimePolicy::off);
  CHECK(render.report().items.empty());
}

TEST_CASE("what a job throws, run throws, and the thread lives on") {
  RenderThread render(RealtimePolicy::off);
  CHECK_THROWS_WITH(render.run([] { throw std::runtime_error("of the job"); }), "of the job");
  CHECK_THROWS_AS(render.run([] { throw 7; }), int);
  int done = 0;
  render.run([&] { ++done; });
  CHECK(done == 1);
}

TEST_CASE("the caller is called again and again while a job runs, on its own thread, and not after it") {
  RenderThread render(RealtimePolicy::off);
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<int> calls{0};
  bool here = true;
  render.run(
      [&] {
        for (int seen = 0; seen < 5; seen = calls.load()) calls.wait(seen);
      },
      std::chrono::milliseconds(1),
      [&] {
        here = here && std::this_thread::get_id() == caller;
        calls.fetch_add(1);
        calls.notify_all();
      });
  CHECK(calls.load() >= 5);
  CHECK(here);
  const int before = calls.load();
  render.run([] {});
  CHECK(calls.load() == before);
  // A job that is over before the first period never calls.
  render.run([] {}, std::chrono::hours(1), [&] { calls.fetch_add(1); });
  CHECK(calls.load() == before);
}

TEST_CASE("what the caller's own part throws comes out when the job is done, and it is not called again") {
  RenderThread render(RealtimePolicy::off);
  std::atomic<bool> called{false};
  bool done = false;
  int calls = 0;
  CHECK_THROWS_WITH(render.run(
                        [&] {
                          called.wait(false);
                          done = true;
                        },
                        std::chrono::milliseconds(1),
                        [&] {
                          ++calls;
                          called = true;
                          called.notify_all();
                          throw std::runtime_error("of the caller");
                        }),
                    "of the caller");
  CHECK(done);
  CHECK(calls == 1);
  // The job's own error goes first.
  called = false;
  CHECK_THROWS_WITH(render.run(
                        [&] {
                          called.wait(false);
                          throw std::runtime_error("of the job");
                        },
                        std::chrono::milliseconds(1),
                        [&] {
                          called = true;
                          called.notify_all();
                          throw std::runtime_error("of the caller");
                        }),
                    "of the job");
}

TEST_CASE("the report is of the render thread, and the caller keeps its own scheduling") {
  const int before = sched_getscheduler(0);
  RenderThread render(RealtimePolicy::prefer);
  REQUIRE(render.report().items.size() == 5);
  int inside = -1;
  render.run([&] { inside = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK; });
  CHECK((inside == SCHED_FIFO) == render.report().fifo());
  CHECK(sched_getscheduler(0) == before);
}

TEST_CASE("what is required and not given is an error on the thread that asks") {
  bool possible = false;
  {
    const RenderThread render(RealtimePolicy::prefer);
    possible = render.report().all_ok();
  }
  if (possible)
    CHECK(RenderThread(RealtimePolicy::require).report().all_ok());
  else
    CHECK_THROWS_AS(RenderThread(RealtimePolicy::require), DeviceError);
}

TEST_CASE("signals are left to other threads") {
  sigset_t before;
  pthread_sigmask(SIG_SETMASK, nullptr, &before);
  RenderThread render(RealtimePolicy::off);
  bool blocked = false;
  render.run([&] {
    sigset_t mask;
    pthread_sigmask(SIG_SETMASK, nullptr, &mask);
    blocked = sigismember(&mask, SIGINT) == 1 && sigismember(&mask, SIGTERM) == 1;
  });
  CHECK(blocked);
  sigset_t after;
  pthread_sigmask(SIG_SETMASK, nullptr, &after);
  CHECK(sigismember(&after, SIGINT) == sigismember(&before, SIGINT));
}
