// Clopper and Pearson's interval: closed forms at the ends, R's binom.test between them.
#include <cmath>

#include "analysis/numerics/binomial.h"
#include "tests/catch.h"

using namespace jnd;

TEST_CASE("at the ends the exact interval has a closed form", "[analysis]") {
  for (const int n : {1, 5, 12, 200}) {
    const ExactProportion all = exact_proportion(n, n), none = exact_proportion(0, n);
    CHECK(all.share == 1);
    CHECK(all.ci_high == 1);
    CHECK(all.ci_low == Approx(std::pow(0.025, 1.0 / n)).epsilon(1e-12));
    CHECK(none.share == 0);
    CHECK(none.ci_low == 0);
    CHECK(none.ci_high == Approx(1 - std::pow(0.025, 1.0 / n)).epsilon(1e-12));
  }
}

TEST_CASE("between the ends it is binom.test's", "[analysis]") {
  const ExactProportion three = exact_proportion(3, 10);
  CHECK(three.ci_low == Approx(0.06673951117773447).epsilon(1e-12));
  CHECK(three.ci_high == Approx(0.6524528500599972).epsilon(1e-12));
  const ExactProportion half = exact_proportion(6, 12, 0.9);
  CHECK(half.ci_low == Approx(1 - half.ci_high).epsilon(1e-12));
  CHECK(half.ci_low > exact_proportion(6, 12).ci_low);
}

TEST_CASE("nobody gives no share and the widest interval", "[analysis]") {
  const ExactProportion nobody = exact_proportion(0, 0);
  CHECK(std::isnan(nobody.share));
  CHECK(nobody.ci_low == 0);
  CHECK(nobody.ci_high == 1);
}
