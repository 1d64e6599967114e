// Group means and intervals against R 4.2.2.
#include "analysis/group/group.h"

#include <cmath>
#include <vector>

#include "tests/catch.h"

namespace jnd {
namespace {

struct Case {
  std::vector<double> values;
  double mean, sd, half_width;
};

// Values -> mean, sd, half width of the 95 % t interval (R 4.2.2: mean, sd, qt).
const std::vector<Case> kReference = {
    {{253.711, 310.211, 284.511, 330.411, 256.511, 315.211, 274.511, 253.411, 431.711, 283.711, 240.011, 234.711,
      260.011, 298.911, 268.711, 269.011, 264.811, 272.911},
     283.499888888889,
     45.0099059539889,
     22.3828996471104},
    {{388.989, 322.989, 469.989, 275.489, 274.289, 352.889, 379.489, 414.189, 387.389, 278.889, 365.389, 311.289,
      409.589, 382.889, 283.589, 349.089, 314.989, 356.589},
     351.000111111111,
     54.9943086776087,
     27.3480263111733},
    {{212.1, 175.6, 288.6, 259, 204.1, 193.1, 168.2, 230.8, 211.7, 166.9, 179.8, 209.9, 215.9, 262.2, 181.6, 208.3,
      216.8, 168.4},
     208.5,
     34.5942701818056,
     17.203325833116},
    {{7, 6, 8, 5, 7, 6, 8, 7, 6, 5, 9, 7}, 6.75, 1.21543108701099, 0.772248069726115},
    {{4, 3, 5, 4, 2, 3, 4, 5, 6, 3, 2, 4}, 3.75, 1.21543108701099, 0.772248069726115},
    {{8, 7, 8, 9, 7, 6, 9, 8, 7, 8, 7, 7}, 7.58333333333333, 0.90033663737852, 0.57204660778351},
};

TEST_CASE("mean, standard deviation and t interval agree with R", "[analysis]") {
  for (const Case& one : kReference) {
    const MeanEstimate found = mean_with_ci(one.values);
    CHECK(found.n == static_cast<int>(one.values.size()));
    CHECK(found.mean == Approx(one.mean).epsilon(1e-12));
    CHECK(found.sd == Approx(one.sd).epsilon(1e-12));
    CHECK(found.mean - found.ci_low == Approx(one.half_width).epsilon(1e-10));
    CHECK(found.ci_high - found.mean == Approx(one.half_width).epsilon(1e-10));
  }
}

TEST_CASE("too few values give what they can and no more", "[analysis]") {
  const MeanEstimate none = mean_with_ci({});
  CHECK(none.n == 0);
  CHECK(std::isnan(none.mean));
  const std::vector<double> single = {3.5};
  const MeanEstimate one = mean_with_ci(single);
  CHECK(one.n == 1);
  CHECK(one.mean == 3.5);
  CHECK(std::isnan(one.sd));
  CHECK(std::isnan(one.ci_low));
  CHECK(std::isnan(one.ci_high));
}

}  // namespace
}  // namespace jnd
