// Long work: how long it has gone on, on a terminal, and how much is done where the work tells it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace jnd {

// While it lives and standard error is a terminal: after a second "verifying s.sqlite: 3 s ..." on a line of its own,
// every second anew; with what work_progress() (analysis/numerics/stop_request.h) was told last, "3 s, 4 of 9 ...". At the end the line says how long it took. Shorter work, and work elsewhere than on a terminal, says
// nothing. What the work prints to standard output must wait until it is gone.
// Thread rule: one thread; the one that writes is inside.
class WorkLine {
 public:
  explicit WorkLine(std::string what);
  ~WorkLine();
  WorkLine(const WorkLine&) = delete;
  WorkLine& operator=(const WorkLine&) = delete;

 private:
  void draw_until_done();
  double elapsed_s() const;

  std::string what_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::mutex mutex_;  // guards done_, part_ and whole_
  std::condition_variable changed_;
  bool done_ = false;
  int part_ = 0, whole_ = 0;
  bool drawn_ = false;  // of the thread, until it is joined
  std::thread thread_;
};

}  // namespace jnd
