// Comparisons of conditions and of groups, their paired tests and the corrections for many, against R.
#include "analysis/group/compare.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <rapidcheck.h>

#include "analysis/group/between_groups.h"
#include "analysis/group/p_adjust.h"
#include "analysis/group/post_hoc.h"
#include "analysis/group/repeated_measures.h"
#include "protocols/random_stream.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// The whole comparison against R, and what it says where parts of it are undefined.

TEST_CASE("a comparison agrees with R in every part", "[analysis]") {
  for (const auto& dataset : group_reference().at("datasets")) {
    CAPTURE(dataset["id"].dump());
    const Comparison found = compare(table_of(dataset["data"]));
    CHECK(found.status == StatisticStatus::ok);
    REQUIRE(found.conditions.size() == 3);
    for (std::size_t j = 0; j < 3; ++j) {
      const ConditionSummary& of = found.conditions[j];
      CHECK(of.status == StatisticStatus::ok);
      CHECK(of.n == static_cast<int>(dataset["data"].size()));
      CHECK(relative(of.mean, dataset["mean"][j]) <= 1e-13);
      CHECK(relative(of.sd, dataset["sd"][j]) <= 1e-13);
      CHECK(relative(of.mean - of.ci_low, dataset["ci95_halfwidth_t"][j]) <= 1e-12);
      CHECK(relative(of.ci_high - of.mean, dataset["ci95_halfwidth_t"][j]) <= 1e-12);
      CHECK(relative(of.mean - of.ci_within_low, dataset["ci95_within_morey"][j]) <= 1e-12);
      CHECK(relative(of.ci_within_high - of.mean, dataset["ci95_within_morey"][j]) <= 1e-12);
      CHECK(std::abs(of.shapiro.w - dataset["shapiro"][j]["W"].get<double>()) <= 1e-12);
      CHECK(std::abs(of.shapiro.p - dataset["shapiro"][j]["p"].get<double>()) <= 1e-10);
    }
    CHECK(std::abs(found.residuals.w - dataset["shapiro_residuals"]["W"].get<double>()) <= 1e-12);
    CHECK(std::abs(found.residuals.p - dataset["shapiro_residuals"]["p"].get<double>()) <= 1e-10);
    CHECK(relative(found.anova.effect.f, dataset["rm_anova"]["F"]) <= 1e-11);
    CHECK(relative(found.friedman.chi2, dataset["friedman"]["chi2"]) <= 1e-12);

    REQUIRE(found.pairs.size() == 3);
    std::vector<double> wilcoxon;
    for (std::size_t i = 0; i < 3; ++i) {
      const PairComparison& pair = found.pairs[i];
      const auto& t = dataset["paired_t"][i];
      CHECK(pair.a == (i == 2 ? 1U : 0U));
      CHECK(pair.b == (i == 0 ? 1U : 2U));
      CHECK(relative(pair.mean_difference, t["diff"]) <= 1e-12);
      CHECK(relative(pair.t.t, t["t"]) <= 1e-12);
      CHECK(std::abs(pair.t_p_holm - t["p_holm"].get<double>()) <= 1e-13);
      CHECK(std::abs(pair.t_p_bh - t["p_BH"].get<double>()) <= 1e-13);
      CHECK(std::abs(pair.t_p_bonferroni - t["p_bonferroni"].get<double>()) <= 1e-13);
      CHECK(std::abs(pair.games_howell.p - dataset["games_howell"][i]["p"].get<double>()) <= 1e-11);
      CHECK(std::abs(pair.tukey.p - dataset["tukey_rm"][i]["p"].get<double>()) <= 1e-11);
      CHECK(pair.wilcoxon.v == dataset["wilcoxon"][i]["V"].get<double>());
      CHECK(std::abs(pair.wilcoxon.p - dataset["wilcoxon"][i]["R_default_p"].get<double>()) <= 1e-12);
      CHECK(pair.wilcoxon_p_holm >= pair.wilcoxon.p);
      CHECK(pair.wilcoxon_p_bh <= pair.wilcoxon_p_holm);
    }
  }
}

TEST_CASE("the median of a condition", "[analysis]") {
  const Comparison odd = compare({3, 2, {1, 9, 5, 7, 2, 8}}), even = compare({2, 2, {1, 9, 4, 7}});
  CHECK(odd.conditions[0].median == 2);
  CHECK(odd.conditions[1].median == 8);
  CHECK(even.conditions[0].median == 2.5);
}

TEST_CASE("with two conditions the within-subject interval is the paired t's", "[analysis]") {
  // Two Cousineau-Morey intervals of half width w: the difference's has half width w sqrt 2.
  const Comparison found = compare({4, 2, {3, 5, 4, 9, 6, 6, 8, 11}});
  const double within = found.conditions[0].ci_within_high - found.conditions[0].mean;
  CHECK(within * std::sqrt(2.0) == Approx((found.pairs[0].t.ci_high - found.pairs[0].t.ci_low) / 2).epsilon(1e-12));
  CHECK(found.anova.effect.mauchly.status == StatisticStatus::not_applicable);
  CHECK(found.anova.effect.p == Approx(found.pairs[0].t.p).epsilon(1e-12));
  CHECK(found.pairs[0].tukey.p == Approx(found.pairs[0].t.p).epsilon(1e-12));
  CHECK(found.pairs[0].t_p_holm == found.pairs[0].t.p);
}

TEST_CASE("a comparison of too little", "[analysis]") {
  for (const WithinTable& table : {WithinTable{0, 3, {}}, WithinTable{1, 3, {1, 2, 3}}, WithinTable{3, 1, {1, 2, 3}}}) {
    const Comparison found = compare(table);
    CHECK(found.status == StatisticStatus::too_few);
    CHECK(found.conditions.size() == table.k);
    CHECK(found.pairs.size() == table.k * (table.k - 1) / 2);
    CHECK(std::isnan(found.anova.effect.f));
    CHECK(std::isnan(found.friedman.p));
    for (const PairComparison& pair : found.pairs) {
      CHECK(pair.t.status == StatisticStatus::too_few);
      CHECK(std::isnan(pair.t_p_holm));
      CHECK(pair.tukey.status != StatisticStatus::ok);
    }
  }
  const ConditionSummary single = compare({1, 3, {1, 2, 3}}).conditions[1];
  CHECK(single.mean == 2);
  CHECK(single.median == 2);
  CHECK(std::isnan(single.sd));
  CHECK(std::isnan(single.ci_within_low));
  CHECK(single.status == StatisticStatus::too_few);
}

TEST_CASE("a comparison of constants", "[analysis]") {
  const Comparison found = compare({4, 3, std::vector<double>(12, 7.3)});
  CHECK(found.conditions[0].mean == 7.3);
  CHECK(found.conditions[0].sd == 0);
  CHECK(found.conditions[0].shapiro.status == StatisticStatus::no_variance);
  CHECK(found.residuals.status == StatisticStatus::no_variance);
  CHECK(found.anova.status == StatisticStatus::no_variance);
  CHECK(found.friedman.status == StatisticStatus::no_variance);
  for (const PairComparison& pair : found.pairs) {
    CHECK(pair.mean_difference == 0);
    CHECK(pair.t.status == StatisticStatus::no_variance);
    CHECK(pair.games_howell.status == StatisticStatus::no_variance);
    CHECK(pair.tukey.status == StatisticStatus::no_variance);
    CHECK(pair.wilcoxon.status == StatisticStatus::no_variance);
    CHECK(std::isnan(pair.wilcoxon_p_holm));
  }
}

TEST_CASE("every undefined number of a comparison has a status", "[analysis]") {
  REQUIRE(rc::check("whatever the table", [] {
    WithinTable table = random_table(1, 1, *rc::gen::inRange(0, 4));
    const Comparison found = compare(table);
    const auto agrees = [](StatisticStatus status, double value) {
      return (status == StatisticStatus::ok) == !std::isnan(value);
    };
    for (const ConditionSummary& of : found.conditions) {
      RC_ASSERT(agrees(of.status, of.sd));
      RC_ASSERT(agrees(of.shapiro.status, of.shapiro.p));
    }
    const WithinEffect& effect = found.anova.effect;
    RC_ASSERT(agrees(found.anova.status, effect.f));
    RC_ASSERT(agrees(found.anova.status, effect.p));
    RC_ASSERT(agrees(found.anova.status, effect.p_gg));
    RC_ASSERT(agrees(effect.mauchly.status, effect.mauchly.p));
    RC_ASSERT(agrees(effect.hotelling_status, effect.hotelling_p));
    RC_ASSERT(agrees(found.friedman.status, found.friedman.p));
    RC_ASSERT(agrees(found.residuals.status, found.residuals.p));
    for (const PairComparison& pair : found.pairs) {
      RC_ASSERT(agrees(pair.t.status, pair.t_p_holm));
      RC_ASSERT(agrees(pair.games_howell.status, pair.games_howell.p));
      RC_ASSERT(agrees(pair.tukey.status, pair.tukey.p));
      RC_ASSERT(agrees(pair.wilcoxon.status, pair.wilcoxon_p_holm));
    }
  }));
}

// Paired t, Games-Howell and Tukey against R.

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

// Corrections for many tests against R's p.adjust.

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

// Two groups: R's documented data sets, enumeration of every split, and what is undefined.

// R's data set `sleep` (Student 1908, Cushny and Peebles): extra hours of sleep, drug 1 and drug 2.
const std::vector<double> kFirstDrug = {0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0};
const std::vector<double> kSecondDrug = {1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};

TEST_CASE("Welch's t of the sleep data is R's", "[analysis][between]") {
  // R 4.2.2: t.test(extra ~ group, data = sleep), as its help page prints it.
  const WelchT found = welch_t(kFirstDrug, kSecondDrug);
  CHECK(found.status == StatisticStatus::ok);
  CHECK(found.t == Approx(-1.8608).margin(5e-5));
  CHECK(found.df == Approx(17.776).margin(5e-4));
  CHECK(found.p == Approx(0.07939).margin(5e-6));
  CHECK(found.ci_low == Approx(-3.3654832).margin(5e-8));
  CHECK(found.ci_high == Approx(0.2054832).margin(5e-8));
  CHECK(found.mean_difference == Approx(-1.58).epsilon(1e-14));
  const WelchT turned = welch_t(kSecondDrug, kFirstDrug);
  CHECK((turned.t == -found.t && turned.p == found.p && turned.ci_low == -found.ci_high));
}

TEST_CASE("Welch's t of equal sizes and variances is Student's", "[analysis][between]") {
  const std::vector<double> x = {1, 2, 3}, y = {4, 5, 6};
  const WelchT found = welch_t(x, y);
  CHECK(found.t == Approx(-3 / std::sqrt(2.0 / 3)).epsilon(1e-14));
  CHECK(found.df == Approx(4).epsilon(1e-14));
  CHECK(found.d == Approx(-3).epsilon(1e-14));
  // Student's t with 4 degrees of freedom in closed form.
  const double t = std::abs(found.t), cosine = 2 / std::sqrt(4 + t * t), sine = t / std::sqrt(4 + t * t);
  CHECK(found.p == Approx(1 - sine * (1 + cosine * cosine / 2)).epsilon(1e-12));
  std::vector<double> far_x, far_y;
  for (const double value : x) far_x.push_back(value + 1e9);
  for (const double value : y) far_y.push_back(value + 1e9);
  CHECK(welch_t(far_x, far_y).t == Approx(found.t).epsilon(1e-14));
}

TEST_CASE("Mann and Whitney's W and p are R's", "[analysis][between]") {
  // wilcox.test(extra ~ group, data = sleep): ties, so normal.
  const MannWhitney sleep = mann_whitney(kFirstDrug, kSecondDrug);
  CHECK(sleep.w == 25.5);
  CHECK((sleep.ties && !sleep.exact));
  CHECK(sleep.p == Approx(0.06933).margin(5e-6));
  // R's help page of wilcox.test, data of Hollander and Wolfe (1973): W = 35, one-sided p = 0.1272.
  const std::vector<double> x = {0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46};
  const std::vector<double> y = {1.15, 0.88, 0.90, 0.74, 1.21};
  const MannWhitney found = mann_whitney(x, y);
  CHECK((found.w == 35 && found.exact && !found.ties));
  CHECK(found.p == Approx(2 * 0.1272).margin(1e-4));
  CHECK(found.rank_biserial == Approx(2 * 35.0 / 50 - 1).epsilon(1e-14));
  CHECK((mann_whitney(y, x).w == 15 && mann_whitney(y, x).p == found.p));
}

// The share of all splits of the pooled values into two such groups whose W is as far on the same side.
double enumerated(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> all = x;
  all.insert(all.end(), y.begin(), y.end());
  const auto w_of = [&](const std::vector<int>& chosen) {
    double w = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t j = 0; j < all.size(); ++j)
        if (chosen[i] == 1 && chosen[j] == 0) w += all[i] > all[j] ? 1 : 0;
    return w;
  };
  std::vector<int> chosen(all.size(), 0);
  std::fill(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(x.size()), 1);
  const double w = w_of(chosen), middle = static_cast<double>(x.size() * y.size()) / 2;
  double as_far = 0, count = 0;
  std::sort(chosen.begin(), chosen.end());
  do {
    const double other = w_of(chosen);
    as_far += (w > middle ? other >= w : other <= w) ? 1 : 0;
    ++count;
  } while (std::next_permutation(chosen.begin(), chosen.end()));
  return std::min(1.0, 2 * as_far / count);
}

TEST_CASE("the exact p counts every split", "[analysis][between]") {
  RandomStream stream(5, 1, "between");
  for (int i = 0; i < 40; ++i) {
    std::vector<double> values(10), x, y;
    std::iota(values.begin(), values.end(), 1.0);
    stream.shuffle(values);
    const auto size = static_cast<std::ptrdiff_t>(1 + stream.below(8));
    x.assign(values.begin(), values.begin() + size);
    y.assign(values.begin() + size, values.end());
    const MannWhitney found = mann_whitney(x, y);
    CHECK(found.exact);
    CHECK(found.p == Approx(enumerated(x, y)).epsilon(1e-13));
  }
}

TEST_CASE("groups of 50 have a normal p near the exact one of 49", "[analysis][between]") {
  std::vector<double> x, y;
  for (int i = 0; i < 49; ++i) {
    x.push_back(2 * i);
    y.push_back(2 * i + 9);
  }
  const MannWhitney exact = mann_whitney(x, y);
  CHECK((exact.exact && std::isfinite(exact.p)));
  CHECK(exact.p == Approx(exact.p_normal).epsilon(0.03));
  x.push_back(98);
  CHECK_FALSE(mann_whitney(x, y).exact);
}

TEST_CASE("what is undefined between two groups has a status", "[analysis][between]") {
  const std::vector<double> one = {3}, none, same = {4, 4, 4}, other = {5, 5};
  CHECK(welch_t(one, same).status == StatisticStatus::too_few);
  CHECK(welch_t(one, same).mean_difference == -1);
  CHECK(welch_t(same, other).status == StatisticStatus::no_variance);
  CHECK(std::isnan(welch_t(same, other).t));
  CHECK(welch_t(same, kFirstDrug).status == StatisticStatus::ok);
  CHECK(mann_whitney(none, one).status == StatisticStatus::too_few);
  CHECK(mann_whitney(same, same).status == StatisticStatus::no_variance);
  CHECK((mann_whitney(same, same).w == 4.5 && std::isnan(mann_whitney(same, same).p)));
  CHECK(mann_whitney(one, std::vector{5.0, 6.0}).p == Approx(2.0 / 3).epsilon(1e-12));
  // Differences of decimals tie, whatever their binary forms: 0.1 + 0.2 is written 0.30000000000000004.
  CHECK(mann_whitney(std::vector{0.3, 0.5}, std::vector{0.3, 0.7}).ties);
}

}  // namespace
}  // namespace jnd
