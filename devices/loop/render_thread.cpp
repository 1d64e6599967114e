#include "devices/loop/render_thread.h"

#include <csignal>
#include <utility>

namespace jnd {

namespace {

// While it lives, threads that are made start with signals blocked: handlers belong to the main thread, whose blocking
// reads they must interrupt. A fault of such a thread still comes to its handler, which puts the terminal back.
class SignalsBlocked {
 public:
  SignalsBlocked() noexcept {
    sigset_t others;
    sigfillset(&others);
    for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS, SIGABRT}) sigdelset(&others, fault);
    pthread_sigmask(SIG_SETMASK, &others, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace

RenderThread::RenderThread(RealtimePolicy policy) {
  {
    const SignalsBlocked blocked;
    thread_ = std::thread([this, policy] { serve(policy); });
  }
  try {
    std::unique_lock lock(mutex_);
    wait_done(lock);
  } catch (...) {
    thread_.join();  // it has ended: it could not become what was required
    throw;
  }
}

RenderThread::~RenderThread() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void RenderThread::run(const std::function<void()>& job) {
  begin(job);
  std::unique_lock lock(mutex_);
  wait_done(lock);
}

void RenderThread::run(const std::function<void()>& job, std::chrono::nanoseconds period,
                       const std::function<void()>& meanwhile) {
  begin(job);
  std::exception_ptr thrown;
  auto next = std::chrono::steady_clock::now() + period;
  std::unique_lock lock(mutex_);
  while (!thrown && !changed_.wait_until(lock, next, [this] { return !busy_; })) {
    lock.unlock();
    try {
      meanwhile();
    } catch (...) {
      thrown = std::current_exception();  // the job still runs, on what the caller owns
    }
    // From now on, not from when it was due: a slow call is not made up for.
    next = std::chrono::steady_clock::now() + period;
    lock.lock();
  }
  wait_done(lock);
  if (thrown) std::rethrow_exception(thrown);
}

void RenderThread::begin(const std::function<void()>& job) {
  {
    const std::lock_guard lock(mutex_);
    job_ = &job;
    busy_ = true;
  }
  changed_.notify_all();
}

void RenderThread::wait_done(std::unique_lock<std::mutex>& lock) {
  changed_.wait(lock, [this] { return !busy_; });
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

void RenderThread::serve(RealtimePolicy policy) noexcept {
  std::unique_ptr<RealtimeScope> realtime;
  std::exception_ptr error;
  try {
    realtime = std::make_unique<RealtimeScope>(policy);
  } catch (...) {
    error = std::current_exception();
  }
  std::unique_lock lock(mutex_);
  if (realtime) report_ = realtime->report();
  for (;;) {
    error_ = std::exchange(error, nullptr);
    job_ = nullptr;
    busy_ = false;
    changed_.notify_all();
    if (!realtime) return;
    changed_.wait(lock, [this] { return ends_ || job_ != nullptr; });
    if (ends_) return;
    lock.unlock();
    try {
      (*job_)();
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
  }
}

}  // namespace jnd
