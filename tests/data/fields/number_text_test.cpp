// Numbers as people read them: as many digits as mean something, and never 0 for what is not.
#include "data/fields/number_text.h"

#include <cmath>
#include <cstdlib>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "tests/catch.h"

namespace jnd {
namespace {

TEST_CASE("a number has the digits that its spread or size lets mean something", "[data]") {
  CHECK(decimals_of_spread(12.3) == 0);
  CHECK(decimals_of_spread(1.23) == 1);
  CHECK(decimals_of_spread(0.123) == 2);
  CHECK(decimals_of_spread(1e-12) == 6);
  CHECK(decimals_of_spread(kNaN) == decimals_of_spread(0));
  CHECK(decimals_of_size(123) == 0);
  CHECK(decimals_of_size(0.0123) == 4);
  CHECK(number_text(12.345, 1) == "12.3");
  CHECK(number_text(0.0004, 2) == "0.0004");
  CHECK(number_text(-0.0004, 2) == "-0.0004");
  CHECK(number_text(0, 2) == "0.00");
  CHECK(number_text(-0.0, 2) == "0.00");
  CHECK(number_text(kNaN, 2) == "-");
  CHECK(number_text(-kInf, 2) == "-inf");
  CHECK(percent_text(0.3553) == "35.5 %");
  CHECK(range_text(1.25, kInf, 1) == "1.2 to inf");
  CHECK(range_text(kNaN, 2, 1) == "-");
  CHECK(counted(1, "session") == "1 session");
  CHECK(counted(0, "session") == "0 sessions");
  REQUIRE(rc::check("what is not 0 is not printed as 0", [] {
    const double value = *rc::gen::inRange(1, 10000) * std::pow(10, *rc::gen::inRange(-12, 3));
    RC_ASSERT(std::strtod(number_text(value, *rc::gen::inRange(0, 7)).c_str(), nullptr) != 0);
  }));
}

TEST_CASE("a p has three decimals, and is neither 0 nor 1 where it is not", "[data]") {
  CHECK(p_value_text(0.0312) == ".031");
  CHECK(p_value_text(0.001) == ".001");
  CHECK(p_value_text(0.00099) == "< .001");
  CHECK(p_value_text(0) == "< .001");
  CHECK(p_value_text(0.9996) == "> .999");
  CHECK(p_value_text(1) == "1.000");
  CHECK(p_value_text(kNaN) == "-");
  CHECK(p_text(0.0312) == "p = .031");
  CHECK(p_text(1e-9) == "p < .001");
  CHECK(p_text(kNaN) == "no p");
}

}  // namespace
}  // namespace jnd
