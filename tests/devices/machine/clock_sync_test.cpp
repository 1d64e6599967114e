// Two clocks and a transport that takes its time.
#include "devices/machine/clock_sync.h"

#include <cmath>
#include <random>

#include <rapidcheck.h>

#include "tests/catch.h"

using jnd::ClockSync;

namespace {

// A device whose clock runs fast by drift, sends every millisecond, and echoes a command that was written a moment
// before. Ways take a least time and an exponential wait.
class Transport {
 public:
  Transport(std::uint32_t seed, double drift_ppm) : random_(seed), rate_(1 + 1e-6 * drift_ppm) {}

  double least_out_ns = 60e3, least_back_ns = 60e3, wait_ns = 50e3;
  double offset_ns = 7.5e12;  // of the device's clock

  std::uint64_t device_us(double host_ns) const {
    return static_cast<std::uint64_t>(std::llround((offset_ns + rate_ * host_ns) * 1e-3));
  }
  void millisecond(ClockSync& sync, bool commands) {
    now_ns_ += 1e6;
    const double sampled_ns = now_ns_ + uniform() * 5e4;
    const double arrived_ns = sampled_ns + least_back_ns + wait();
    if (commands) {
      const double echoed_ns = sampled_ns - uniform() * 9e5;
      const double written_ns = echoed_ns - least_out_ns - wait();
      sync.add_round_trip(std::llround(written_ns), device_us(echoed_ns), device_us(sampled_ns),
                          std::llround(arrived_ns));
    } else {
      sync.add_arrival(device_us(sampled_ns), std::llround(arrived_ns));
    }
    sampled_ns_ = sampled_ns;
  }
  // Of the last report: estimate less truth, ns.
  double error_ns(const ClockSync& sync) const {
    return static_cast<double>(sync.to_host_ns(device_us(sampled_ns_))) - sampled_ns_;
  }
  double now_ns_ = 3e12;

 private:
  double uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  double wait() { return std::exponential_distribution<double>(1)(random_) * wait_ns; }

  std::mt19937 random_;
  double rate_, sampled_ns_ = 0;
};

}  // namespace

TEST_CASE("times of a drifting clock are right within the uncertainty, which is small", "[clock_sync]") {
  const bool held = rc::check([] {
    const double drift = *rc::gen::inRange(-100, 101);
    Transport transport(*rc::gen::arbitrary<std::uint32_t>(), drift);
    transport.offset_ns = 1e9 * *rc::gen::inRange(1, 1'000'000);
    ClockSync sync;
    for (int ms = 0; ms < 30'000; ++ms) {
      transport.millisecond(sync, true);
      if (ms < 100) continue;
      // Half the round trip, half a microsecond of the device's rounding, and what a drift still unknown does in 2 s.
      const double bound_ns = 1e9 * sync.uncertainty_s() + 5e3 + (ms < 5000 ? 2 * 100e3 : 0);
      RC_ASSERT(std::abs(transport.error_ns(sync)) <= bound_ns);
    }
    RC_ASSERT(sync.uncertainty_s() < 100e-6);
    RC_ASSERT(std::abs(sync.drift_ppm() - drift) < 5);
    RC_ASSERT(sync.steps() == 0);
    // Device clock = offset + (1 + drift) * host clock.
    const double host_s = 1e-9 * transport.now_ns_;
    const double device_s = sync.offset_s() + (1 + 1e-6 * sync.drift_ppm()) * host_s;
    RC_ASSERT(std::abs(device_s - 1e-6 * static_cast<double>(transport.device_us(transport.now_ns_))) < 300e-6);
  });
  CHECK(held);
}

TEST_CASE("without commands for minutes the times stay right", "[clock_sync]") {
  Transport transport(5, 80);
  ClockSync sync;
  for (int ms = 0; ms < 40; ++ms) transport.millisecond(sync, true);
  double worst_ns = 0;
  for (int ms = 0; ms < 300'000; ++ms) {
    transport.millisecond(sync, false);
    if (ms > 5000) worst_ns = std::max(worst_ns, std::abs(transport.error_ns(sync)));
  }
  CHECK(worst_ns < 200e3);
  CHECK(sync.drift_ppm() == Approx(80).margin(3));
}

TEST_CASE("one-way: late by the shortest way and no more", "[clock_sync]") {
  const bool held = rc::check([] {
    Transport transport(*rc::gen::arbitrary<std::uint32_t>(), *rc::gen::inRange(-100, 101));
    ClockSync sync;
    for (int ms = 0; ms < 20'000; ++ms) {
      transport.millisecond(sync, false);
      if (ms < 3000) continue;
      const double error_ns = transport.error_ns(sync);
      RC_ASSERT(error_ns > transport.least_back_ns - 150e3);
      RC_ASSERT(error_ns < transport.least_back_ns + 150e3);
    }
    RC_ASSERT(std::isinf(sync.uncertainty_s()));
  });
  CHECK(held);
}

TEST_CASE("a device's clock that is set is noticed within two seconds", "[clock_sync]") {
  const bool held = rc::check([] {
    Transport transport(*rc::gen::arbitrary<std::uint32_t>(), *rc::gen::inRange(-100, 101));
    ClockSync sync;
    for (int ms = 0; ms < 5000; ++ms) transport.millisecond(sync, true);
    RC_ASSERT(sync.steps() == 0);
    const double step_ns = 1e6 * *rc::gen::inRange(30, 5000);
    transport.offset_ns += *rc::gen::arbitrary<bool>() ? step_ns : -step_ns;
    for (int ms = 0; ms < 2500; ++ms) transport.millisecond(sync, true);
    RC_ASSERT(sync.steps() >= 1);
    RC_ASSERT(std::abs(transport.error_ns(sync)) < 500e3);
  });
  CHECK(held);
}

TEST_CASE("seconds of delay, as of a machine that hangs, do not spoil what was learned", "[clock_sync]") {
  Transport transport(9, -60);
  ClockSync sync;
  for (int ms = 0; ms < 10'000; ++ms) transport.millisecond(sync, true);
  transport.least_back_ns = 6e6;  // for half a second every report is 6 ms late
  for (int ms = 0; ms < 500; ++ms) {
    transport.millisecond(sync, true);
    CHECK(std::abs(transport.error_ns(sync)) < 200e3);
  }
  CHECK(sync.steps() == 0);
}

TEST_CASE("what cannot be is survived", "[clock_sync]") {
  ClockSync sync;
  CHECK(sync.to_host_ns(5) == 0);
  const bool held = rc::check([] {
    ClockSync any;
    for (int i = 0; i < 300; ++i) {
      const auto device = *rc::gen::arbitrary<std::uint64_t>();
      const auto echoed = *rc::gen::arbitrary<std::uint64_t>();
      const auto host = *rc::gen::inRange<std::int64_t>(0, std::int64_t{1} << 60);
      any.add_round_trip(host - *rc::gen::inRange(-1000, 1000), echoed, device, host);
      (void)any.to_host_ns(device);
      RC_ASSERT(std::isfinite(any.offset_s()));
      RC_ASSERT(std::isfinite(any.drift_ppm()));
    }
  });
  CHECK(held);
}
