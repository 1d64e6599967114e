// Answers that fall with the level: the trend test at its boundary, and the ends that are named.
#include "analysis/behaviour/falling_answers.h"

#include "tests/catch.h"

namespace jnd {
namespace {

TEST_CASE("answers fall if the trend test has a one-sided p below .001", "[analysis]") {
  // Two levels of 50 trials: the test of equal proportions, z = 3.203 and 3.005; the bound is 3.090.
  CHECK(falling_answers({{1, 50, 34}, {2, 50, 18}}));
  CHECK(!falling_answers({{1, 50, 34}, {2, 50, 19}}));
  CHECK(!falling_answers({{1, 50, 18}, {2, 50, 34}}));
}

TEST_CASE("nothing falls without two levels and both answers", "[analysis]") {
  CHECK(!falling_answers({}));
  CHECK(!falling_answers({{1, 0, 0}, {2, 0, 0}}));
  CHECK(!falling_answers({{1, 50, 20}}));
  CHECK(!falling_answers({{1, 50, 50}, {2, 50, 50}}));
  CHECK(!falling_answers({{1, 50, 0}, {2, 50, 0}}));
}

TEST_CASE("both ends are named, of 10 trials each, rows of one level together", "[analysis]") {
  const auto counted = falling_answers({{1100, 20, 2}, {700, 12, 11}, {900, 20, 11}, {700, 8, 7}});
  REQUIRE(counted);
  CHECK(counted->low.from == 700);
  CHECK(counted->low.to == 700);
  CHECK(counted->low.n == 20);
  CHECK(counted->low.k == 18);
  CHECK(counted->high.k == 2);
  std::vector<AnsweredLevel> single;
  for (int i = 0; i < 40; ++i) single.push_back({static_cast<double>(i), 1, i < 20 ? 1 : 0});
  const auto trials = falling_answers(single);
  REQUIRE(trials);
  CHECK(trials->low.to == 9);
  CHECK(trials->high.from == 39);
  CHECK(trials->high.to == 30);
  CHECK(trials->high.n == 10);
}

}  // namespace
}  // namespace jnd
