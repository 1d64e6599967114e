// A text is a number only as a whole.
#include "protocols/input/number_from.h"

#include <cmath>
#include <cstdint>

#include "tests/catch.h"

using namespace jnd;

TEST_CASE("a text is a number as a whole, without blanks, signs of plus or leftovers") {
  CHECK(number_from<double>("-2.5e1") == -25.0);
  CHECK(number_from<int>("-7") == -7);
  CHECK(number_from<std::uint32_t>("4294967295") == 4294967295U);
  CHECK(std::isinf(number_from<double>("inf").value()));
  for (const char* const text : {"", " 1", "1 ", "+1", "1x", "x", "0x1", "1,5"}) {
    CAPTURE(text);
    CHECK_FALSE(number_from<double>(text));
    CHECK_FALSE(number_from<int>(text));
  }
  CHECK_FALSE(number_from<int>("1.5"));
}

TEST_CASE("a number beyond its type's range is none") {
  CHECK_FALSE(number_from<std::uint32_t>("4294967296"));
  CHECK_FALSE(number_from<std::uint32_t>("-1"));
  CHECK_FALSE(number_from<double>("1e999"));
}
