#include "runner/terminal/work_line.h"

#include <csignal>
#include <utility>

#include <pthread.h>
#include <unistd.h>

#include "analysis/numerics/stop_request.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

WorkLine::WorkLine(std::string what) : what_(std::move(what)) {
  if (!is_terminal(STDERR_FILENO)) return;
  work_progress() = [this](int part, int whole) {
    const std::lock_guard lock(mutex_);
    part_ = part;
    whole_ = whole;
  };
  // Signals are for the thread that works.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { draw_until_done(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

WorkLine::~WorkLine() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  changed_.notify_one();
  thread_.join();
  work_progress() = {};
  if (drawn_) print_message("\r{}: {}\x1b[K\n", printable(what_), duration_text(elapsed_s()));
}

double WorkLine::elapsed_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void WorkLine::draw_until_done() {
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, std::chrono::seconds(1), [this] { return done_; })) {
    const std::string told = whole_ > 0 ? fmt::format(", {} of {}", part_, whole_) : "";
    print_message("\r{}: {}{} ...\x1b[K", printable(what_), duration_text(elapsed_s()), told);
    drawn_ = true;
  }
}

}  // namespace jnd
