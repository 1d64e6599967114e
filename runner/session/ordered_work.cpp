#include "runner/session/ordered_work.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace jnd {

void work_in_order(int places, int threads, const std::function<Work(int)>& work, const std::function<void(int)>& done,
                   const std::function<void()>& meanwhile) {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::optional<Work>> results(static_cast<std::size_t>(places) + 1);
  std::exception_ptr failure;
  std::atomic<int> next{1};

  const auto worker = [&] {
    for (int place = next++; place <= places; place = next++) {
      Work result = Work::interrupted;
      std::exception_ptr problem;
      try {
        result = work(place);
      } catch (...) {
        problem = std::current_exception();
        next = places + 1;
      }
      const std::lock_guard lock(mutex);
      results[static_cast<std::size_t>(place)] = result;
      if (problem && !failure) failure = problem;
      changed.notify_all();
    }
  };
  std::vector<std::jthread> workers;
  for (int i = 0; i < std::clamp(threads, 1, std::max(1, places)); ++i) workers.emplace_back(worker);

  for (int place = 1; place <= places; ++place) {
    std::unique_lock lock(mutex);
    const std::optional<Work>& result = results[static_cast<std::size_t>(place)];
    while (!result && !failure) {
      changed.wait_for(lock, std::chrono::milliseconds(100));
      if (meanwhile) meanwhile();
    }
    if (failure || result == Work::interrupted) break;
    const bool finished = result == Work::finished;
    lock.unlock();
    if (finished) done(place);
  }
  workers.clear();
  if (meanwhile) meanwhile();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace jnd
