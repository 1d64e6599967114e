// The self-test: that every quantity agrees here, that a disagreement is seen, and how reference numbers are read.
#include "analysis/selftest/selftest.h"

#include <stdexcept>

#include "analysis/numerics/special_values.h"
#include "analysis/selftest/reference_numbers.h"
#include "tests/catch.h"

namespace jnd {
namespace {

TEST_CASE("the self-test agrees with its references in every quantity", "[analysis]") {
  const std::vector<SelftestQuantity> quantities = selftest();
  CHECK(quantities.size() == 65);
  int cases = 0;
  for (const SelftestQuantity& quantity : quantities) {
    CAPTURE(quantity.name, quantity.largest_difference);
    CHECK(quantity.ok());
    cases += quantity.cases;
  }
  CHECK(cases == 2587);
}

TEST_CASE("a quantity of the self-test fails where it differs, is undefined or has no case", "[analysis]") {
  SelftestQuantity quantity{"d'", 0.25};
  CHECK_FALSE(quantity.ok());
  quantity.absolute(1, 1.25);
  quantity.absolute(kInf, kInf);
  quantity.absolute(kNaN, kNaN);
  CHECK(quantity.ok());
  SelftestQuantity relative = quantity, undefined = quantity;
  relative.relative(6, 8);
  CHECK(relative.ok());
  relative.relative(5, 8);
  CHECK(relative.largest_difference == 0.375);
  CHECK_FALSE(relative.ok());
  undefined.absolute(kNaN, 1);
  CHECK_FALSE(undefined.ok());
}

TEST_CASE("reference numbers: infinities and NaN are words, and nothing else is", "[analysis]") {
  CHECK(reference_number(2) == 2);
  CHECK(reference_number("Inf") == kInf);
  CHECK(reference_number("-Inf") == -kInf);
  for (const nlohmann::json& none : {nlohmann::json("NaN"), nlohmann::json("NA"), nlohmann::json()})
    CHECK(std::isnan(reference_number(none)));
  CHECK_THROWS_AS(reference_number("inf"), std::invalid_argument);
  CHECK_THROWS_AS(reference_number(true), std::invalid_argument);
  CHECK_THROWS_AS(reference_numbers("nothing"), std::out_of_range);
}

}  // namespace
}  // namespace jnd
