// Friedman's test against R, and its edges.
#include <cmath>

#include <rapidcheck.h>

#include "analysis/group/rank_tests.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

TEST_CASE("Friedman agrees with R, with and without ties", "[analysis]") {
  for (const auto& dataset : group_reference().at("datasets")) {
    CAPTURE(dataset["id"].dump());
    const auto& reference = dataset["friedman"];
    const Friedman found = friedman(table_of(dataset["data"]));
    CHECK(found.status == StatisticStatus::ok);
    CHECK(relative(found.chi2, reference["chi2"]) <= 1e-12);
    CHECK(found.df == reference["df"].get<int>());
    CHECK(std::abs(found.p - reference["p"].get<double>()) <= 1e-12);
    CHECK(relative(found.kendall_w, reference["kendall_W"]) <= 1e-12);
    CHECK(relative(found.f_iman_davenport, reference["F_iman_davenport"]) <= 1e-12);
    CHECK(std::abs(found.p_iman_davenport - reference["p_iman_davenport"].get<double>()) <= 1e-12);
  }
}

TEST_CASE("Friedman: perfect agreement, no agreement, nothing to rank", "[analysis]") {
  WithinTable alike{4, 3, {1, 2, 3, 1, 2, 3, 5, 6, 7, 1, 8, 9}};
  CHECK(friedman(alike).kendall_w == Approx(1).epsilon(1e-15));
  CHECK(std::isinf(friedman(alike).f_iman_davenport));
  CHECK(friedman(alike).p_iman_davenport == 0);
  const WithinTable balanced{3, 3, {1, 2, 3, 2, 3, 1, 3, 1, 2}};
  CHECK(friedman(balanced).chi2 == 0);
  CHECK(friedman(balanced).p == 1);
  const WithinTable tied{3, 3, {1, 1, 1, 2, 2, 2, 3, 3, 3}};
  CHECK(friedman(tied).status == StatisticStatus::no_variance);
  CHECK(std::isnan(friedman(tied).chi2));
  CHECK(friedman({1, 3, {1, 2, 3}}).status == StatisticStatus::too_few);
  CHECK(friedman({3, 1, {1, 2, 3}}).status == StatisticStatus::too_few);
  CHECK(friedman({0, 0, {}}).status == StatisticStatus::too_few);
}

TEST_CASE("Friedman sees only the order within each participant", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const WithinTable table = random_table(2, 2, 5);
    const Friedman found = friedman(table);
    RC_PRE(found.status == StatisticStatus::ok);
    RC_ASSERT(found.kendall_w >= 0);
    RC_ASSERT(found.kendall_w <= 1 + 1e-12);
    WithinTable changed = table;  // each participant with an own origin and unit
    for (std::size_t i = 0; i < table.n; ++i)
      for (std::size_t j = 0; j < table.k; ++j)
        changed.values[i * table.k + j] = 100.0 * static_cast<double>(i) + std::exp(table.at(i, j));
    RC_ASSERT(friedman(changed).chi2 == found.chi2);
    const Friedman moved = friedman(permuted(table, random_order(table.n), random_order(table.k)));
    RC_ASSERT(relative(moved.chi2, found.chi2) < 1e-12);
  }));
}

}  // namespace
}  // namespace jnd
