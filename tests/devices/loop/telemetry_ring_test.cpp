// The queue between the loop and main: order, drops counted exactly, and two threads at once.
#include "devices/loop/telemetry_ring.h"

#include <thread>

#include "tests/catch.h"

using namespace jnd;

namespace {

TickRecord numbered(std::int64_t number) {
  TickRecord record;
  record.time_ns = number;
  record.penetration = 1e-6 * static_cast<double>(number);
  record.finger_m = {0, 1, static_cast<double>(number)};
  return record;
}

}  // namespace

TEST_CASE("records come out whole, in order, after what is there already") {
  TelemetryRing ring(8);
  std::vector<TickRecord> out = {numbered(100)};
  CHECK(ring.drain(out) == 0);
  for (int i = 0; i < 5; ++i) ring.push(numbered(i));
  CHECK(ring.drain(out) == 5);
  REQUIRE(out.size() == 6);
  CHECK(out[0].time_ns == 100);
  for (int i = 0; i < 5; ++i) {
    const TickRecord& record = out[static_cast<std::size_t>(i) + 1];
    CHECK(record.time_ns == i);
    CHECK(record.penetration == 1e-6 * i);
    CHECK(record.finger_m[2] == i);
  }
  CHECK(ring.take_dropped() == 0);
}

TEST_CASE("a full ring keeps the oldest and counts every drop once") {
  for (const std::size_t capacity : {1U, 2U, 7U, 64U}) {
    TelemetryRing ring(capacity);
    CHECK(ring.capacity() == capacity);
    for (std::int64_t i = 0; i < 100; ++i) ring.push(numbered(i));
    std::vector<TickRecord> out;
    CHECK(ring.drain(out) == capacity);
    for (std::size_t i = 0; i < capacity; ++i) CHECK(out[i].time_ns == static_cast<std::int64_t>(i));
    CHECK(ring.take_dropped() == 100 - static_cast<std::int64_t>(capacity));
    CHECK(ring.take_dropped() == 0);
    ring.push(numbered(7));
    CHECK(ring.drain(out) == 1);
    CHECK(out.back().time_ns == 7);
    CHECK(ring.take_dropped() == 0);
  }
}

TEST_CASE("a ring that is not enabled takes nothing and counts nothing") {
  TelemetryRing ring(4);
  CHECK(ring.enabled());
  ring.enable(false);
  for (int i = 0; i < 10; ++i) ring.push(numbered(i));
  std::vector<TickRecord> out;
  CHECK(ring.drain(out) == 0);
  CHECK(ring.take_dropped() == 0);
  ring.enable(true);
  ring.push(numbered(1));
  CHECK(ring.drain(out) == 1);
}

TEST_CASE("between two threads nothing is lost, doubled, torn or uncounted") {
  constexpr std::int64_t kRecords = 200'000;
  TelemetryRing ring(64);  // small: it overflows whenever the consumer is away
  std::atomic<bool> done{false};
  std::thread producer([&] {
    for (std::int64_t i = 1; i <= kRecords; ++i) ring.push(numbered(i));
    done.store(true, std::memory_order_release);
  });
  std::vector<TickRecord> out;
  std::int64_t received = 0, dropped = 0, last = 0;
  bool ordered = true, whole = true;
  for (bool last_round = false; !last_round;) {
    last_round = done.load(std::memory_order_acquire);
    out.clear();
    ring.drain(out);
    dropped += ring.take_dropped();
    received += static_cast<std::int64_t>(out.size());
    for (const TickRecord& record : out) {
      ordered = ordered && record.time_ns > last;
      whole = whole && record.finger_m[2] == static_cast<double>(record.time_ns) &&
              record.penetration == 1e-6 * static_cast<double>(record.time_ns);
      last = record.time_ns;
    }
  }
  producer.join();
  CHECK(ordered);
  CHECK(whole);
  CHECK(received > 0);
  CHECK(received + dropped == kRecords);
}
