// How many of the random studies of tests/analysis/hierarchical/hierarchical_promises.h keep what is promised of every
// fit: all or, evenly chosen, fewer of 20,000.
//
//   hierarchical_promises_bench [STUDIES [THREADS]]    200 studies, 2 threads
//
// Prints what is broken on standard error as it is found, and at the end counts and rates; Ctrl-C ends it with those of
// what is done. Exit status 1 where a promise is broken.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "tests/analysis/hierarchical/hierarchical_promises.h"

int main(int count, char** arguments) {
  using namespace jnd;
  using namespace jnd::testing;
  constexpr int kAll = 20'000;
  const int studies = count > 1 ? std::atoi(arguments[1]) : 200, threads = count > 2 ? std::atoi(arguments[2]) : 2;
  if (studies < 1 || studies > kAll || threads < 1) {
    fmt::print(stderr, "usage: hierarchical_promises_bench [STUDIES [THREADS]], at most {} studies\n", kAll);
    return 2;
  }
  const auto stop = [](int /*signal*/) { stop_requested() = true; };
  std::signal(SIGINT, stop);
  std::signal(SIGTERM, stop);
  std::mutex mutex;
  int done = 0, broken = 0, intervals = 0, tests = 0, open = 0, out_of_work = 0, not_converged = 0;
  int unsettled = 0, inexact = 0, off = 0, submodel = 0;
  std::vector<double> seconds;
  std::atomic<int> next{0};
  const auto work = [&] {
    try {
      for (int i = next++; i < studies; i = next++) {
        stop_if_requested();
        const auto number = static_cast<std::uint64_t>(i) * kAll / static_cast<std::uint64_t>(studies);
        const RandomStudy study = random_study(number);
        const auto began = std::chrono::steady_clock::now();
        const Kept kept = kept_promises(study);
        const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
        const std::lock_guard lock(mutex);
        ++done;
        seconds.push_back(took);
        broken += kept.broken.empty() ? 0 : 1;
        intervals += kept.intervals;
        tests += kept.tests;
        out_of_work += kept.out_of_work;
        not_converged += kept.not_converged;
        unsettled += kept.unsettled;
        inexact += kept.inexact;
        off += kept.off;
        submodel += kept.submodel;
        open += kept.out_of_work + kept.not_converged > 0;
        for (const std::string& one : kept.broken) fmt::print(stderr, "study {}: {}\n", number, one);
        if (kept.unsettled || kept.inexact || kept.off || kept.submodel || kept.out_of_work || kept.not_converged)
          fmt::print(stderr, "study {}:{}{}{}{}{}{}\n", number, kept.unsettled ? " unsettled" : "",
                     kept.inexact ? " inexact" : "", kept.off ? " off" : "", kept.submodel ? " submodel better" : "",
                     kept.out_of_work ? " out of work" : "", kept.not_converged ? " ends not converged" : "");
        if (took > 20) fmt::print(stderr, "study {}: {:.0f} s\n", number, took);
      }
    } catch (const Stopped&) {
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < threads; ++i) workers.emplace_back(work);
  }
  if (done == 0) return 130;
  std::sort(seconds.begin(), seconds.end());
  const auto row = [](const char* what, int hits, int of) {
    fmt::print("{:<52} {:>6} of {:>6}  {:.3f} %\n", what, hits, of, of > 0 ? 100.0 * hits / of : 0);
  };
  const int all = intervals + out_of_work + not_converged;
  fmt::print("{} studies, {} intervals, {} tests; seconds a study: median {:.2f}, longest {:.1f}\n", done, all, tests,
             seconds[seconds.size() / 2], seconds.back());
  row("studies with a promise broken", broken, done);
  row("  whose search did not settle", unsettled, done);
  row("  inexact: denser nodes change ln L by 1e-6", inexact, done);
  row("  off: three times as dense ones by 1e-4", off, done);
  row("  a model without a spread is better by 1e-4", submodel, done);
  row("  with an interval that is not known", open, done);
  row("intervals out of work", out_of_work, all);
  row("intervals not converged", not_converged, all);
  return stop_requested() ? 130 : broken > 0 ? 1 : 0;
}
