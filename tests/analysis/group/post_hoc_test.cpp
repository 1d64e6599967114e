// Paired t, Games-Howell and Tukey against R.
#include "analysis/group/post_hoc.h"

#include <cmath>
#include <string>

#include <rapidcheck.h>

#include "analysis/group/repeated_measures.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

TEST_CASE("post hoc tests agree with R", "[analysis]") {
  for (const auto& dataset : group_reference().at("datasets")) {
    const WithinTable table = table_of(dataset["data"]);
    const WithinEffect effect = repeated_measures(table).effect;
    std::size_t pair = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = a + 1; b < 3; ++b, ++pair) {
        CAPTURE(dataset["id"].dump(), a, b);
        const std::vector<double> x = table.column(a), y = table.column(b);
        const auto& t_reference = dataset["paired_t"][pair];
        const PairedT t = paired_t(x, y);
        CHECK(t.status == StatisticStatus::ok);
        CHECK(relative(t.mean_difference, t_reference["diff"]) <= 1e-12);
        CHECK(relative(t.t, t_reference["t"]) <= 1e-12);
        CHECK(t.df == t_reference["df"].get<double>());
        CHECK(std::abs(t.p - t_reference["p"].get<double>()) <= 1e-13);
        CHECK(relative(t.ci_low, t_reference["lo"]) <= 1e-11);
        CHECK(relative(t.ci_high, t_reference["hi"]) <= 1e-11);
        CHECK(relative(t.dz, t_reference["dz"]) <= 1e-12);
        CHECK(relative(t.d_av, t_reference["d_av"]) <= 1e-12);

        const auto& gh_reference = dataset["games_howell"][pair];
        const GamesHowell gh = games_howell(x, y, 3);
        CHECK(gh.status == StatisticStatus::ok);
        CHECK(relative(gh.q, gh_reference["q"]) <= 1e-12);
        CHECK(relative(gh.df, gh_reference["df"]) <= 1e-12);
        CHECK(relative(gh.se, gh_reference["se_welch"]) <= 1e-12);
        CHECK(std::abs(gh.q / std::sqrt(2.0) - std::abs(gh_reference["t"].get<double>())) <= 1e-11);
        CHECK(std::abs(gh.p - gh_reference["p"].get<double>()) <= 1e-11);
        CHECK(std::abs(gh.p - dataset["games_howell_rstatix_padj"][pair].get<double>()) <=
              5e-3 * gh.p);  // printed with three digits
        // By R's qtukey, whose iteration stops early.
        const double half_width = games_howell_half_width(gh, 3);
        CHECK(relative(t.mean_difference - half_width, gh_reference["lo"]) <= 1e-6);
        CHECK(relative(t.mean_difference + half_width, gh_reference["hi"]) <= 1e-6);

        const auto& tukey_reference = dataset["tukey_rm"][pair];
        const Tukey found =
            tukey(t.mean_difference, effect.ss_error / effect.df2, static_cast<double>(table.n), effect.df2, 3);
        CHECK(relative(found.q, tukey_reference["q"]) <= 1e-12);
        CHECK(std::abs(found.p - tukey_reference["p"].get<double>()) <= 1e-11);
      }
    }
  }
}

TEST_CASE("post hoc tests: undefined where nothing varies", "[analysis]") {
  const std::vector<double> one = {3}, constant = {5, 5, 5}, shifted = {6.1, 6.1, 6.1}, some = {1, 2, 4};
  CHECK(paired_t(one, one).status == StatisticStatus::too_few);
  CHECK(games_howell(one, one, 3).status == StatisticStatus::too_few);
  CHECK(paired_t(constant, shifted).status == StatisticStatus::no_variance);
  CHECK(paired_t(constant, shifted).mean_difference == Approx(-1.1));
  CHECK(std::isnan(paired_t(constant, shifted).t));
  CHECK(std::isnan(paired_t(constant, shifted).ci_low));
  CHECK(games_howell(constant, shifted, 3).status == StatisticStatus::no_variance);
  CHECK(std::isnan(games_howell_half_width(games_howell(constant, shifted, 3), 3)));
  CHECK(tukey(1, 0, 5, 8, 3).status == StatisticStatus::no_variance);
  CHECK(std::isnan(tukey(1, 0, 5, 8, 3).p));
  CHECK(tukey(1, 1, 1, 0, 3).status == StatisticStatus::too_few);
  // One of the two varies: Welch has the degrees of freedom of that one.
  CHECK(games_howell(constant, some, 3).status == StatisticStatus::ok);
  CHECK(games_howell(constant, some, 3).df == Approx(2));
  // The same values twice: no difference at all is no variance of differences, too.
  CHECK(paired_t(some, some).status == StatisticStatus::no_variance);
  CHECK(games_howell(some, some, 3).p == 1);
}

TEST_CASE("post hoc tests: unit, origin and order of the participants are irrelevant", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const WithinTable table = random_table(3, 2, 30);
    const std::vector<double> x = table.column(0), y = table.column(1);
    const PairedT t = paired_t(x, y);
    RC_PRE(t.status == StatisticStatus::ok);
    std::vector<double> x2, y2;
    for (const std::size_t i : random_order(table.n)) {
      x2.push_back(2.5 * x[i] + 40);
      y2.push_back(2.5 * y[i] + 40);
    }
    const PairedT again = paired_t(x2, y2), backward = paired_t(y, x);
    RC_ASSERT(std::abs(again.t - t.t) <= 1e-10 * (1 + std::abs(t.t)));
    RC_ASSERT(std::abs(again.dz - t.dz) <= 1e-10 * (1 + std::abs(t.dz)));
    RC_ASSERT(backward.p == t.p);
    RC_ASSERT(backward.ci_low == -t.ci_high);
    RC_ASSERT((t.ci_low > 0 || t.ci_high < 0) == (t.p < 0.05));
    const GamesHowell gh = games_howell(x, y, 4), moved = games_howell(y2, x2, 4);
    RC_ASSERT(gh.status == moved.status);
    if (gh.status == StatisticStatus::ok) {
      RC_ASSERT(std::abs(gh.q - moved.q) < 1e-10 * (1 + gh.q));
      RC_ASSERT(std::abs(gh.df - moved.df) < 1e-9 * gh.df);
      RC_ASSERT(gh.p <= 1);
    }
  }));
}

TEST_CASE("a t of many participants keeps the digits of a tiny p", "[analysis]") {
  std::vector<double> x, y;
  for (int i = 0; i < 150; ++i) {
    x.push_back(100 + i % 7);
    y.push_back(i % 5);
  }
  const PairedT t = paired_t(x, y);
  CHECK(t.p > 0);
  CHECK(t.p < 1e-180);
}

}  // namespace
}  // namespace jnd
