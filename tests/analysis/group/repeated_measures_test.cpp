// Repeated measures against R (car, afex), arbitrary precision at four conditions, and what must not matter.
#include "analysis/group/repeated_measures.h"

#include <cmath>
#include <utility>

#include <rapidcheck.h>

#include "analysis/group/post_hoc.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

constexpr double kRelative = 1e-11, kAbsoluteP = 1e-12;

TEST_CASE("repeated measures agree with R", "[analysis]") {
  for (const auto& dataset : group_reference().at("datasets")) {
    CAPTURE(dataset["id"].dump());
    const RepeatedMeasures found = repeated_measures(table_of(dataset["data"]));
    const WithinEffect& effect = found.effect;
    const auto& reference = dataset["rm_anova"];
    const auto near = [&](double value, const char* name) {
      INFO(name);
      CHECK(relative(value, reference[name]) <= kRelative);
    };
    const auto p_near = [&](double value, const nlohmann::json& p) {
      CHECK(std::abs(value - p.get<double>()) <= kAbsoluteP);
    };
    CHECK(found.status == StatisticStatus::ok);
    near(effect.ss, "SS_cond");
    near(effect.ss_error, "SS_error");
    near(found.ss_subjects, "SS_subjects");
    near(effect.f, "F");
    near(effect.df1, "df1");
    near(effect.df2, "df2");
    near(effect.epsilon_gg, "eps_gg");
    near(effect.epsilon_hf, "eps_hf");
    near(std::min(1.0, effect.epsilon_hf), "eps_hf_capped");
    near(1 / effect.df1, "eps_lower_bound");
    near(effect.eta2_partial, "eta2_partial");
    near(found.eta2_generalised, "eta2_generalized");
    near(found.eta2_generalised, "eta2");
    near(found.eta2_generalised, "afex_ges");
    near(effect.eta2_partial, "afex_pes");
    near(found.omega2_partial, "omega2_partial");
    near(found.cohen_f, "cohen_f");
    p_near(effect.p, reference["p"]);
    p_near(effect.p_gg, reference["p_gg"]);
    p_near(effect.p_hf, reference["p_hf"]);
    p_near(effect.p_lower_bound, reference["p_lb"]);
    const auto& car = reference["car"];
    CHECK(relative(effect.f, car["F"]) <= kRelative);
    CHECK(relative(effect.epsilon_gg, car["gg"]) <= kRelative);
    CHECK(relative(effect.epsilon_hf, car["hf"]) <= kRelative);
    CHECK(relative(effect.p, car["p"]) <= 1e-9);
    CHECK(relative(effect.p_gg, car["p_gg"]) <= 1e-9);
    CHECK(relative(effect.p_hf, car["p_hf"]) <= 1e-9);

    CHECK(effect.mauchly.status == StatisticStatus::ok);
    CHECK(relative(effect.mauchly.w, dataset["mauchly"]["W"]) <= kRelative);
    for (const char* name : {"p", "p_exact_k3", "p_chisq_first_order"})  // R's W itself is off by 5e-13
      CHECK(std::abs(effect.mauchly.p - dataset["mauchly"][name].get<double>()) <= 1e-11);

    const auto& manova = dataset["rm_manova"];
    CHECK(effect.hotelling_status == StatisticStatus::ok);
    CHECK(relative(effect.hotelling_t2, manova["T2"]) <= kRelative);
    CHECK(relative(effect.hotelling_f, manova["F"]) <= kRelative);
    CHECK(effect.hotelling_df1 == manova["df1"].get<double>());
    CHECK(effect.hotelling_df2 == manova["df2"].get<double>());
    p_near(effect.hotelling_p, manova["p"]);
  }
}

TEST_CASE("Mauchly of three conditions agrees with rational arithmetic", "[analysis]") {
  const std::vector<std::pair<double, double>> exact = {{0.83219580281379543645, 0.23004042895778522834},
                                                        {0.83892380481604406468, 0.41553976448586663671}};
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const Mauchly found = repeated_measures(table_of(group_reference().at("datasets")[i]["data"])).effect.mauchly;
    CHECK(relative(found.w, exact[i].first) <= 1e-14);
    CHECK(relative(found.p, exact[i].second) <= 1e-13);
  }
}

TEST_CASE("four conditions: Mauchly's second-order p and the epsilons", "[analysis]") {
  const auto& reference = group_reference().at("four_conditions");
  const WithinEffect effect = repeated_measures(table_of(reference["data"])).effect;
  CHECK(relative(effect.ss, reference["ss"]) <= kRelative);
  CHECK(relative(effect.ss_error, reference["ss_error"]) <= kRelative);
  CHECK(relative(effect.f, reference["f"]) <= kRelative);
  CHECK(relative(effect.epsilon_gg, reference["eps_gg"]) <= kRelative);
  CHECK(relative(effect.epsilon_hf, reference["eps_hf"]) <= kRelative);
  CHECK(relative(effect.mauchly.w, reference["mauchly_w"]) <= kRelative);
  CHECK(relative(effect.mauchly.p, reference["mauchly_p_r"]) <= kRelative);
  CHECK(relative(effect.p, reference["p"]) <= kRelative);
  CHECK(relative(effect.p_gg, reference["p_gg"]) <= kRelative);
  CHECK(relative(effect.p_hf, reference["p_hf"]) <= kRelative);
}

TEST_CASE("two conditions: F is t squared, and sphericity is no question", "[analysis]") {
  REQUIRE(rc::check("", [] {
    WithinTable table = random_table(2, 2, 30);
    table.k = 2;
    table.values.resize(2 * table.n);
    const RepeatedMeasures found = repeated_measures(table);
    const PairedT t = paired_t(table.column(0), table.column(1));
    RC_ASSERT(found.status == t.status);
    RC_PRE(t.status == StatisticStatus::ok);
    RC_ASSERT(std::abs(found.effect.f - t.t * t.t) <= 1e-10 * (1 + t.t * t.t));
    RC_ASSERT(std::abs(found.effect.p - t.p) < 1e-10);
    RC_ASSERT(found.effect.epsilon_gg == 1);
    RC_ASSERT(found.effect.epsilon_hf == 1);
    RC_ASSERT(found.effect.mauchly.status == StatisticStatus::not_applicable);
    RC_ASSERT(std::isnan(found.effect.mauchly.p));
  }));
}

TEST_CASE("repeated measures: unit, origin, participants' level and every order are irrelevant", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const WithinTable table = random_table(3, 3, 30);
    const WithinEffect found = repeated_measures(table).effect;
    RC_PRE(found.status == StatisticStatus::ok);
    RC_ASSERT(found.epsilon_gg <= 1);
    RC_ASSERT(found.epsilon_gg * found.df1 >= 1 - 1e-12);
    WithinTable changed = permuted(table, random_order(table.n), random_order(table.k));
    for (std::size_t i = 0; i < table.n; ++i)
      for (std::size_t j = 0; j < table.k; ++j) {
        double& value = changed.values[i * table.k + j];
        value = 0.37 * value - 80 + 5.5 * static_cast<double>(i);
      }
    const WithinEffect again = repeated_measures(changed).effect;
    RC_ASSERT(std::abs(again.f - found.f) <= 1e-8 * (1 + found.f));
    RC_ASSERT(std::abs(again.p - found.p) < 1e-8);
    RC_ASSERT(std::abs(again.epsilon_gg - found.epsilon_gg) < 1e-9);
    RC_ASSERT(again.mauchly.status == found.mauchly.status);
    if (found.mauchly.status == StatisticStatus::ok) RC_ASSERT(std::abs(again.mauchly.w - found.mauchly.w) < 1e-9);
  }));
}

TEST_CASE("repeated measures: statuses where something is undefined", "[analysis]") {
  SECTION("too few") {
    const RepeatedMeasures found = repeated_measures({1, 3, {1, 2, 3}});
    CHECK(found.status == StatisticStatus::too_few);
    CHECK(std::isnan(found.effect.f));
    CHECK(std::isnan(found.effect.mauchly.w));
    CHECK(found.effect.df1 == 2);
  }
  SECTION("everybody differs alike: F is infinite or 0/0") {
    // 0.1 + 0.2 is not 0.3: the differences are equal up to rounding only.
    const RepeatedMeasures found = repeated_measures({3, 3, {0.1, 0.2, 0.3, 0.2, 0.3, 0.4, 0.7, 0.8, 0.9}});
    CHECK(found.status == StatisticStatus::no_variance);
    CHECK(std::isnan(found.effect.f));
    CHECK(std::isnan(found.effect.p_gg));
    CHECK(found.effect.mauchly.status == StatisticStatus::no_variance);
    CHECK(found.effect.eta2_partial == Approx(1).epsilon(1e-12));
    CHECK(repeated_measures({3, 3, {5, 5, 5, 5, 5, 5, 5, 5, 5}}).status == StatisticStatus::no_variance);
  }
  SECTION("two participants: one direction of variance") {
    const WithinEffect effect = repeated_measures({2, 3, {1, 2, 4, 2, 5, 3}}).effect;
    CHECK(effect.status == StatisticStatus::ok);
    CHECK(effect.f > 0);
    CHECK(effect.epsilon_gg == Approx(0.5).epsilon(1e-12));
    CHECK(std::isnan(effect.epsilon_hf));
    CHECK(std::isnan(effect.p_hf));
    CHECK(effect.mauchly.status == StatisticStatus::too_few);
    CHECK(effect.hotelling_status == StatisticStatus::too_few);
  }
  SECTION("a condition that is the mean of the two others") {
    const WithinEffect effect = repeated_measures({5, 3, {1, 2, 3, 4, 6, 8, 2, 5, 8, 7, 7.5, 8, 3, 3, 3}}).effect;
    CHECK(effect.status == StatisticStatus::ok);
    CHECK(effect.mauchly.status == StatisticStatus::singular);
    CHECK(std::isnan(effect.mauchly.w));
    CHECK(effect.hotelling_status == StatisticStatus::singular);
    CHECK(effect.epsilon_gg == Approx(0.5).epsilon(1e-12));
  }
}

TEST_CASE("repeated measures keep their digits where others cancel", "[analysis]") {
  const auto& dataset = group_reference().at("datasets")[0];
  const WithinTable table = table_of(dataset["data"]);
  SECTION("a spread of 1e-4 at 1e6") {
    // Scaled by a power of two, so that the differences survive the rounding of the sum as whole multiples.
    WithinTable near = table, far = table;
    for (double& value : near.values) value = std::round(value * 64) * 0x1p-26;
    for (std::size_t i = 0; i < far.values.size(); ++i) far.values[i] = 1e6 + near.values[i];
    const WithinEffect a = repeated_measures(near).effect, b = repeated_measures(far).effect;
    CHECK(relative(b.f, a.f) <= 1e-12);
    CHECK(relative(b.mauchly.w, a.mauchly.w) <= 1e-12);
  }
  SECTION("values near the limits of double") {
    for (const double unit : {0x1p-400, 0x1p400}) {
      WithinTable scaled = table;
      for (double& value : scaled.values) value *= unit;
      CHECK(relative(repeated_measures(scaled).effect.f, dataset["rm_anova"]["F"]) <= kRelative);
      CHECK(relative(repeated_measures(scaled).effect.epsilon_gg, dataset["rm_anova"]["eps_gg"]) <= kRelative);
    }
  }
  SECTION("p deep in the tail") {
    WithinTable sure{80, 3, {}};
    for (std::size_t i = 0; i < sure.n; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        sure.values.push_back(100.0 * static_cast<double>(j) + static_cast<double>((7 * i + 3 * j * i) % 5));
    const WithinEffect effect = repeated_measures(sure).effect;
    CHECK(effect.p > 0);
    CHECK(effect.p < 1e-200);
  }
}

TEST_CASE("Helmert contrasts are orthonormal", "[analysis]") {
  CHECK(helmert_contrasts(1).empty());
  for (const std::size_t k : {2U, 3U, 7U}) {
    const std::vector<double> c = helmert_contrasts(k);
    REQUIRE(c.size() == k * (k - 1));
    for (std::size_t r = 0; r + 1 < k; ++r) {
      double sum = 0;
      for (std::size_t j = 0; j < k; ++j) sum += c[r * k + j];
      CHECK(std::abs(sum) < 1e-14);
      for (std::size_t s = 0; s + 1 < k; ++s) {
        double product = 0;
        for (std::size_t j = 0; j < k; ++j) product += c[r * k + j] * c[s * k + j];
        CHECK(std::abs(product - (r == s ? 1 : 0)) < 1e-14);
      }
    }
  }
}

}  // namespace
}  // namespace jnd
