// The thread that drives the devices: made once, real-time where the machine allows, and lent to one job at a time.
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "devices/realtime.h"

namespace jnd {

// Signals go to other threads. Thread rule: one thread at a time calls run, and not from within a job; the destructor
// runs when no job does.
class RenderThread {
 public:
  // Throws DeviceError where the policy is `require` and the machine does not give it all.
  explicit RenderThread(RealtimePolicy policy);
  ~RenderThread();
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  // Runs the job on the thread and returns when it is done. What the job throws, this throws.
  void run(const std::function<void()>& job);
  // The same; until the job is done the caller's thread calls `meanwhile` once in every period. A call that takes long
  // delays the caller only. What it throws, this throws, once the job is done; it is not called again before.
  void run(const std::function<void()>& job, std::chrono::nanoseconds period, const std::function<void()>& meanwhile);

  const RealtimeReport& report() const noexcept { return report_; }

 private:
  void serve(RealtimePolicy policy) noexcept;
  void begin(const std::function<void()>& job);
  void wait_done(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_:
  const std::function<void()>* job_ = nullptr;
  bool busy_ = true;  // starting, or at a job
  bool ends_ = false;
  std::exception_ptr error_;

  RealtimeReport report_;  // written before the constructor returns
  std::thread thread_;
};

}  // namespace jnd
