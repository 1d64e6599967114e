// Corrections for many tests against R's p.adjust.
#include "analysis/group/p_adjust.h"

#include <cmath>

#include <rapidcheck.h>

#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

void check_adjusted(const std::vector<double>& found, const nlohmann::json& reference) {
  REQUIRE(found.size() == reference.size());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(relative(found[i], reference[i]) <= 1e-14);
}

TEST_CASE("corrections agree with R", "[analysis]") {
  const auto& reference = group_reference().at("padjust");
  const std::vector<double> p = numbers_of(reference["p"]);
  check_adjusted(holm(p), reference["holm_m8"]);
  check_adjusted(holm(p, 17), reference["holm_m17"]);
  check_adjusted(benjamini_hochberg(p, 17), reference["BH_m17"]);
  check_adjusted(bonferroni(p, 17), reference["bonferroni_m17"]);
  for (const auto& dataset : group_reference().at("datasets")) {
    std::vector<double> t;
    for (const auto& pair : dataset["paired_t"]) t.push_back(pair["p"]);
    for (std::size_t i = 0; i < t.size(); ++i) {
      CHECK(relative(holm(t)[i], dataset["paired_t"][i]["p_holm"]) <= 1e-14);
      CHECK(relative(benjamini_hochberg(t)[i], dataset["paired_t"][i]["p_BH"]) <= 1e-14);
      CHECK(relative(bonferroni(t)[i], dataset["paired_t"][i]["p_bonferroni"]) <= 1e-14);
    }
  }
}

TEST_CASE("corrections: nothing, undefined, and a family smaller than given", "[analysis]") {
  CHECK(holm({}).empty());
  CHECK(benjamini_hochberg({}).empty());
  CHECK(bonferroni({}).empty());
  const std::vector<double> p = {0.01, std::nan(""), 0.03};
  for (const auto& adjusted : {holm(p), benjamini_hochberg(p), bonferroni(p)}) CHECK(std::isnan(adjusted[1]));
  CHECK(holm(p)[0] == 0.02);
  CHECK(holm(p)[2] == 0.03);
  CHECK(bonferroni(p)[2] == 0.06);
  CHECK(bonferroni(p, 1)[0] == 0.02);
}

TEST_CASE("corrections keep the order and never lower p", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const int size = *rc::gen::inRange(1, 20);
    std::vector<double> p;
    for (int i = 0; i < size; ++i) p.push_back(*rc::gen::inRange(0, 1001) / 1000.0);
    const std::vector<double> h = holm(p), b = benjamini_hochberg(p), f = bonferroni(p);
    for (std::size_t i = 0; i < p.size(); ++i) {
      RC_ASSERT(p[i] <= b[i]);
      RC_ASSERT(b[i] <= h[i] * (1 + 1e-15));
      RC_ASSERT(h[i] <= f[i] * (1 + 1e-15));
      RC_ASSERT(f[i] <= 1);
      for (std::size_t j = 0; j < p.size(); ++j) {
        if (p[i] > p[j]) continue;
        RC_ASSERT(h[i] <= h[j]);
        RC_ASSERT(b[i] <= b[j]);
      }
    }
  }));
}

}  // namespace
}  // namespace jnd
