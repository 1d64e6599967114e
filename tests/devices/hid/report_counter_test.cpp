// What is missing of a numbered stream.
#include "devices/hid/report_counter.h"

#include <set>

#include <rapidcheck.h>

#include "tests/catch.h"

using jnd::ReportCounter;

TEST_CASE("every gap is counted exactly, also where the numbers wrap around", "[report_counter]") {
  const bool held = rc::check([] {
    const auto first = static_cast<std::uint32_t>(-*rc::gen::inRange<std::int64_t>(0, 400));
    const auto lengths = *rc::gen::nonEmpty(rc::gen::container<std::vector<std::uint32_t>>(rc::gen::inRange(1U, 9U)));
    ReportCounter counter;
    std::uint32_t number = first;
    std::int64_t gaps = 0, taken = 0;
    RC_ASSERT(counter.take(number));
    ++taken;
    for (const std::uint32_t length : lengths) {
      number += length;
      gaps += length - 1;
      RC_ASSERT(counter.take(number));
      ++taken;
      RC_ASSERT(static_cast<std::int64_t>(static_cast<std::uint32_t>(number - first)) + 1 == taken + gaps);
    }
    RC_ASSERT(counter.missing() == gaps);
    RC_ASSERT(counter.taken() == taken);
    RC_ASSERT(counter.old() == 0);
  });
  CHECK(held);
}

TEST_CASE("what comes twice or out of order is never shown", "[report_counter]") {
  ReportCounter counter;
  CHECK(counter.take(5));
  CHECK_FALSE(counter.take(5));
  CHECK(counter.take(8));
  CHECK_FALSE(counter.take(7));
  CHECK_FALSE(counter.take(6));
  CHECK(counter.take(9));
  CHECK(counter.taken() == 3);
  CHECK(counter.missing() == 2);
  CHECK(counter.old() == 3);
}

TEST_CASE("a new connection has a numbering of its own", "[report_counter]") {
  ReportCounter counter;
  CHECK(counter.take(1000));
  counter.begin();
  CHECK(counter.take(3));
  CHECK(counter.take(5));
  CHECK(counter.missing() == 1);
  CHECK(counter.taken() == 3);
}

TEST_CASE("a device that began anew on the spot is believed after a while", "[report_counter]") {
  ReportCounter counter;
  CHECK(counter.take(100'000));
  std::uint32_t number = 1;
  while (!counter.take(number)) REQUIRE(++number <= 1000);
  CHECK(number == ReportCounter::kBeginsAnew);
  CHECK(counter.take(number + 1));
  CHECK(counter.missing() == 0);
  CHECK(counter.old() == ReportCounter::kBeginsAnew - 1);
}
