#include "devices/machine/io_thread.h"

#include <csignal>
#include <utility>

#include <pthread.h>
#include <sched.h>

namespace jnd {

std::thread start_io_thread(std::function<void()> job, int realtime_priority) {
  // A fault of the thread itself still comes to its handler, which puts the terminal back.
  sigset_t others, before;
  sigfillset(&others);
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS, SIGABRT}) sigdelset(&others, fault);
  pthread_sigmask(SIG_SETMASK, &others, &before);
  try {
    std::thread thread([job = std::move(job), realtime_priority] {
      if (realtime_priority > 0) {
        sched_param wanted{};
        wanted.sched_priority = realtime_priority;
        (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted);
      }
      job();
    });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    return thread;
  } catch (...) {
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    throw;
  }
}

}  // namespace jnd
