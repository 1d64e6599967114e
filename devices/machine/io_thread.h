// A thread that exchanges reports with a device.
#pragma once

#include <functional>
#include <thread>

namespace jnd {

// Runs `job` on a new thread with signals blocked: on hidraw a signal looks like a device that is gone, and handlers
// belong to the main thread. realtime_priority: of SCHED_FIFO where the login may, otherwise an ordinary thread; 0: an
// ordinary thread. job must not throw.
std::thread start_io_thread(std::function<void()> job, int realtime_priority);

}  // namespace jnd
