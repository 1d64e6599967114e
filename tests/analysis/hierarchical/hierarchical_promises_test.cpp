// What is promised of every fit, in a few random studies that are quick. In thousands:
// tests/bench/hierarchical_promises_bench.cpp.
#include "tests/analysis/hierarchical/hierarchical_promises.h"

#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;

TEST_CASE("an interval excludes a value exactly where the test there has p < .05, of random studies",
          "[hierarchical][long]") {
  int intervals = 0, tests = 0;
  for (const std::uint64_t number : std::initializer_list<std::uint64_t>{
           12, 58, 73, 92, 114, 119, 127, 175, 190, 261, 295, 330, 352, 443, 515, 773, 831, 848, 942, 989}) {
    const Kept kept = kept_promises(random_study(number));
    CAPTURE(number, kept.broken);
    CHECK(kept.broken.empty());
    CHECK_FALSE(kept.unsettled);
    CHECK_FALSE(kept.inexact);
    CHECK_FALSE(kept.off);
    CHECK_FALSE(kept.submodel);
    CHECK(kept.out_of_work + kept.not_converged == 0);
    intervals += kept.intervals;
    tests += kept.tests;
  }
  CHECK(intervals >= 41);
  CHECK(tests >= 64);
}

}  // namespace
}  // namespace jnd
