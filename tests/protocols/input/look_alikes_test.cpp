// Which codes are taken for one another.
#include "protocols/input/look_alikes.h"

#include "tests/catch.h"

namespace jnd {

TEST_CASE("codes look alike whatever their capitals, zeros before a number, and way of writing an accent") {
  for (const auto& [one, other] : {std::pair("P1", "P001"),
                                   {"P01", "p1"},
                                   {"01", "1"},
                                   {"A0B00", "a00b0"},
                                   {"Jos\u00e9", "Jose\u0301"},
                                   {"\u00c5SA", "a\u030asa"}})
    CHECK(look_of(one) == look_of(other));
  for (const auto& [one, other] :
       {std::pair("P1", "P10"), {"P100", "P10"}, {"1", "P1"}, {"0", ""}, {"P10", "P1O"}, {"\u00df", "s"}})
    CHECK(look_of(one) != look_of(other));
}

TEST_CASE("codes that look alike are named, those that print alike with their lengths") {
  CHECK(look_alikes({"P1", "P2", "Q1"}).empty());
  CHECK(look_alikes({"P1", "P2", "P02", "p1"}) == R"("P2" and "P02", "P1" and "p1")");
  CHECK(look_alikes({"Jos\u00e9", "Jose\u0301"}) == "\"Jos\u00e9\" and \"Jose\u0301\" (4 and 5 characters)");
}

}  // namespace jnd
