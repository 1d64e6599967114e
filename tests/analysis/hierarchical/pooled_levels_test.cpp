#include <cmath>
#include <set>

#include "analysis/hierarchical/hierarchical_likelihood.h"
#include "tests/catch.h"

namespace jnd {
namespace {

TEST_CASE("so many levels that nobody could tell apart are pooled at the mean of their trials", "[hierarchical]") {
  std::vector<HierarchicalCell> cells;
  for (int p = 0; p < 2; ++p)
    for (int i = 0; i < 64; ++i)
      cells.push_back({p, p, std::copysign(0.0 + i / 2 * 10.0, i % 2 ? 1 : -1), 1, 2, i >= 40, 1, 0});
  SECTION("as many as may be are left alone") {
    CHECK_FALSE(pool_levels(cells));
    CHECK(cells.size() == 128);
  }
  SECTION("one condition with more") {
    for (int i = 0; i < 4; ++i) cells.push_back({0, 0, 305.0 + i, 3, 0, true});
    const std::vector<HierarchicalCell> before = cells;
    CHECK(pool_levels(cells));
    CHECK(cells.size() < before.size());
    std::set<double> levels;
    for (const HierarchicalCell& cell : cells) levels.insert(cell.level);
    CHECK(levels.contains(0));
    double furthest = 0;
    for (const HierarchicalCell& cell : before) {
      double nearest = kInf;
      for (const double level : levels) nearest = std::min(nearest, std::abs(cell.level - level));
      furthest = std::max(furthest, nearest / std::max(std::abs(cell.level), 31.0));
    }
    CHECK(furthest < 0.06);
    const auto sums = [](const std::vector<HierarchicalCell>& of) {
      std::array<double, 6> sum{};
      for (const HierarchicalCell& cell : of) {
        const double trials = cell.counts().trials();
        sum[0] += cell.positive;
        sum[1] += cell.negative;
        sum[2] += cell.sure_positive;
        sum[3] += trials * cell.level;
        sum[4] += cell.second_half ? trials : 0;
        sum[5] += cell.participant == 1 ? trials : 0;
      }
      return sum;
    };
    for (std::size_t i = 0; i < 6; ++i) CHECK(sums(cells)[i] == Approx(sums(before)[i]));
  }
}

}  // namespace
}  // namespace jnd
