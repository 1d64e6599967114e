// The measurement of lateness, on clocks that are late on purpose; and the histogram that it fills.
#include <numeric>

#include "devices/machine/machine_checks.h"
#include "tests/catch.h"
#include "tests/units.h"

using namespace jnd;

namespace {

// Wakes late by a pattern that repeats.
class LateClock final : public Clock {
 public:
  explicit LateClock(std::vector<std::int64_t> late_ns) : late_ns_(std::move(late_ns)) {}
  std::int64_t now_ns() const noexcept override { return now_; }
  std::int64_t utc_ns() const noexcept override { return now_; }
  void sleep_until_ns(std::int64_t deadline) noexcept override {
    now_ = std::max(now_, deadline) + late_ns_[sleeps_++ % late_ns_.size()];
    if (stop != nullptr && static_cast<int>(sleeps_) == stop_at) stop->store(true);
  }
  std::atomic<bool>* stop = nullptr;
  int stop_at = 0;

 private:
  std::vector<std::int64_t> late_ns_;
  std::size_t sleeps_ = 0;
  std::int64_t now_ = 5 * kMs;
};

const std::atomic<bool> kNever{false};

std::int64_t ticks_of(const LatenessHistogram& histogram) {
  return std::accumulate(histogram.by_edges().begin(), histogram.by_edges().end(), std::int64_t{0});
}

}  // namespace

TEST_CASE("a punctual clock is measured as punctual, a tick a millisecond") {
  SimulatedClock clock(0);
  const JitterReport report = probe_jitter(RealtimePolicy::off, 2, clock, kNever);
  CHECK(report.ticks == 2000);
  CHECK(report.overruns == 0);
  CHECK(ticks_of(report.lateness) == 2000);
  CHECK(report.lateness.largest_us() == 0);
  CHECK(clock.now_ns() == 2000 * kMs);
  CHECK(report.realtime.items.empty());
}

TEST_CASE("lateness is of each wake-up, not of the one before") {
  LateClock clock(std::vector<std::int64_t>{10 * kUs, 10 * kUs, 10 * kUs, 250 * kUs});
  const JitterReport report = probe_jitter(RealtimePolicy::off, 1, clock, kNever);
  CHECK(report.ticks == 1000);
  CHECK(report.overruns == 0);
  CHECK(report.lateness.percentile_us(0.50) == 10);
  CHECK(report.lateness.percentile_us(0.75) == 10);
  CHECK(report.lateness.percentile_us(0.76) == 250);
  CHECK(report.lateness.largest_us() == 250);
}

TEST_CASE("whole periods that are missed are counted and not caught up") {
  LateClock clock(std::vector<std::int64_t>{0, 0, 0, 0, 3 * kMs + 100 * kUs});
  const JitterReport report = probe_jitter(RealtimePolicy::off, 0.8, clock, kNever);
  CHECK(report.ticks == 500);  // each five ticks take eight milliseconds
  CHECK(report.overruns == 300);
  CHECK(report.ticks + report.overruns == 800);
  CHECK(report.lateness.largest_us() == Approx(3100));
}

TEST_CASE("the measurement ends when it is told to") {
  std::atomic<bool> stop{false};
  LateClock clock(std::vector<std::int64_t>{0});
  clock.stop = &stop;
  clock.stop_at = 17;
  CHECK(probe_jitter(RealtimePolicy::off, 10, clock, stop).ticks == 17);
}

TEST_CASE("on the real clock every period is either a tick or counted as missed") {
  SteadyClock clock;
  const JitterReport report = probe_jitter(RealtimePolicy::prefer, 0.05, clock, kNever);
  CHECK(report.ticks >= 1);
  CHECK(report.ticks + report.overruns >= 50);
  CHECK(ticks_of(report.lateness) == report.ticks);
  CHECK(report.realtime.items.size() == 5);
}

TEST_CASE("percentiles beyond the finest buckets are not made smaller than they are") {
  LatenessHistogram histogram;
  CHECK(histogram.percentile_us(0.99) == 0);
  for (int i = 0; i < 90; ++i) histogram.add(7 * kUs + 999);
  for (int i = 0; i < 9; ++i) histogram.add(2046 * kUs);
  histogram.add(9 * kMs);
  CHECK(histogram.percentile_us(0.90) == 7);
  CHECK(histogram.percentile_us(0.99) == 2046);
  CHECK(histogram.percentile_us(1) == Approx(9000));
}

TEST_CASE("ticks by the edges that a presentation keeps") {
  LatenessHistogram histogram;
  for (const std::int64_t late_ns : {std::int64_t{-5}, std::int64_t{0}, kUs, kUs + 1, 2 * kUs, 5 * kUs, 7 * kUs,
                                     1000 * kUs, 1000 * kUs + 1, 5 * kMs, 5 * kMs + 1, 3'600'000 * kMs})
    histogram.add(late_ns);
  // kLatenessEdges_us: 1 2 5 10 20 50 100 200 500 1000 2000 5000, each with what is exactly on it.
  CHECK(histogram.by_edges() == LatenessHistogram::ByEdges{3, 2, 1, 1, 0, 0, 0, 0, 0, 1, 1, 1, 2});
  CHECK(ticks_of(histogram) == 12);
  histogram.clear();
  CHECK(histogram.by_edges() == LatenessHistogram::ByEdges{});
  CHECK(histogram.percentile_us(1) == 0);
}
