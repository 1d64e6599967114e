// The real clock: a wait ends at its deadline or later, never before, whatever signals come.
#include <atomic>
#include <csignal>
#include <thread>

#include "devices/clock.h"
#include "tests/catch.h"
#include "tests/wait_until.h"

using namespace jnd;

namespace {
std::atomic<int> signals{0};
}

TEST_CASE("signals do not shorten a wait") {
  struct sigaction handler {
  }, before{};
  handler.sa_handler = [](int) { signals.fetch_add(1); };
  sigaction(SIGUSR1, &handler, &before);  // without SA_RESTART: every signal interrupts the sleep
  SteadyClock clock;
  std::atomic<bool> slept{false};
  std::int64_t deadline = 0, woke = 0;
  std::thread sleeper([&] {
    // Where the machine let none come in time, once more.
    while (signals.load() == 0 && woke >= deadline) {
      deadline = clock.now_ns() + 30'000'000;
      clock.sleep_until_ns(deadline);
      woke = clock.now_ns();
    }
    slept.store(true);
  });
  CHECK(wait_until([&] {
    pthread_kill(sleeper.native_handle(), SIGUSR1);
    return slept.load();
  }));
  sleeper.join();
  sigaction(SIGUSR1, &before, nullptr);
  CHECK(woke >= deadline);
  CHECK(signals.load() > 0);
}

TEST_CASE("a deadline that is past, or no time at all, returns") {
  SteadyClock clock;
  for (const std::int64_t deadline : {INT64_MIN, std::int64_t{-1}, std::int64_t{0}, std::int64_t{1}, clock.now_ns()})
    clock.sleep_until_ns(deadline);
  CHECK(clock.now_ns() > 0);
}
