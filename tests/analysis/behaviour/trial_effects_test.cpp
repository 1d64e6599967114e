// Order of the intervals, response bias and drift: published tables, exact sums and closed forms.
#include <cmath>
#include <vector>

#include "analysis/behaviour/drift.h"
#include "analysis/behaviour/order_effect.h"
#include "analysis/behaviour/response_bias.h"
#include "analysis/numerics/exact_proportion.h"
#include "analysis/numerics/special_values.h"
#include "tests/catch.h"

namespace jnd {
namespace {

JudgedTrial trial(bool same, bool said_different, double time = 0, bool first_stiffer = false) {
  JudgedTrial one;
  one.same = same;
  one.first_stiffer = first_stiffer;
  one.said_different = said_different;
  one.difference = same ? 0 : 300;
  one.time_fraction = time;
  return one;
}

TEST_CASE("Fisher's exact test agrees with published and exactly summed tables", "[analysis][trials]") {
  CHECK(fisher_exact_p(3, 4, 1, 4) == Approx(34.0 / 70).epsilon(1e-12));  // the lady tasting tea
  // Convicted twins (Fisher 1962), in the help of R's fisher.test: p = 0.0005367.
  CHECK(fisher_exact_p(2, 17, 10, 13) == Approx(0.0005367241191434358).epsilon(1e-12));
  // Sums of exact fractions.
  CHECK(fisher_exact_p(41, 54, 30, 54) == Approx(0.04188808702951476).epsilon(1e-12));
  CHECK(fisher_exact_p(0, 5, 5, 5) == Approx(2.0 / 252).epsilon(1e-12));
  CHECK(fisher_exact_p(900, 1000, 800, 1000) == Approx(4.1462306224363905e-10).epsilon(1e-10));
  CHECK(fisher_exact_p(3, 6, 3, 6) == 1);
  CHECK(fisher_exact_p(0, 6, 0, 6) == 1);
  CHECK(fisher_exact_p(2, 3, 0, 0) == 1);
  CHECK(fisher_exact_p(20'000, 20'000, 0, 20'000) == 0);  // below any double
}

TEST_CASE("the exact binomial test agrees with R and with exact sums", "[analysis][trials]") {
  CHECK(binomial_exact_p(682, 925, 0.75) ==
        Approx(0.3824915595748517).epsilon(1e-12));  // help of R's binom.test: 0.3825
  CHECK(binomial_exact_p(63, 108, 0.5) == Approx(0.10143273504110499).epsilon(1e-12));
  CHECK(binomial_exact_p(0, 10, 0.5) == Approx(2.0 / 1024).epsilon(1e-12));
  CHECK(binomial_exact_p(7, 12, 0.5) == Approx(0.7744140625).epsilon(1e-12));
  CHECK(binomial_exact_p(30, 108, 1.0 / 3) == Approx(0.26135145908819063).epsilon(1e-10));
  CHECK(binomial_exact_p(0, 0, 0.5) == 1);
}

TEST_CASE("shares have Wilson's interval, within 0..1 at the edges", "[analysis][trials]") {
  // Newcombe 1998 (Stat Med 17:857), table I, method 3: 15/148 and 1/29.
  CHECK(share_of(15, 148).ci_low == Approx(0.0624).margin(5e-5));
  CHECK(share_of(15, 148).ci_high == Approx(0.1605).margin(5e-5));
  CHECK(share_of(1, 29).ci_low == Approx(0.0061).margin(5e-5));
  CHECK(share_of(1, 29).ci_high == Approx(0.1718).margin(5e-5));
  CHECK(share_of(0, 20).ci_low == 0);
  CHECK(share_of(20, 20).ci_high == 1);
  CHECK(std::isnan(share_of(0, 0).value));
  CHECK(std::isnan(share_of(0, 0).ci_low));
}

TEST_CASE("the order effect has Newcombe's interval", "[analysis][trials]") {
  // Newcombe 1998 (Stat Med 17:873), table II, method 10.
  struct Published {
    int k1, n1, k2, n2;
    double low, high;
  };
  for (const Published& one : {Published{56, 70, 48, 80, 0.0524, 0.3339}, Published{9, 10, 3, 10, 0.1705, 0.8090},
                               Published{6, 7, 2, 7, 0.0582, 0.8062}, Published{5, 56, 0, 29, -0.0381, 0.1926}}) {
    const OrderEffect found = order_effect(one.k1, one.n1, one.k2, one.n2);
    CHECK(found.ci_low == Approx(one.low).margin(5e-5));
    CHECK(found.ci_high == Approx(one.high).margin(5e-5));
  }
}

TEST_CASE("the order effect looks at different pairs only, and says which order is absent", "[analysis][trials]") {
  std::vector<JudgedTrial> trials;
  for (int i = 0; i < 54; ++i) {
    trials.push_back(trial(false, i < 41, 0, true));
    trials.push_back(trial(false, i < 30, 0, false));
    trials.push_back(trial(true, i % 2 == 0, 0, i % 3 == 0));  // equal pairs have no order
  }
  const OrderEffect found = order_effect(trials);
  CHECK(found.status == OrderStatus::ok);
  CHECK(found.stiffer_first.k == 41);
  CHECK(found.stiffer_second.n == 54);
  CHECK(found.difference == Approx(11.0 / 54).epsilon(1e-12));
  CHECK(found.ci_low == Approx(0.02467058084256049).epsilon(1e-9));
  CHECK(found.ci_high == Approx(0.3657625823528443).epsilon(1e-9));
  CHECK(found.p == Approx(0.04188808702951476).epsilon(1e-12));

  // The orders exchanged turn the effect round.
  const OrderEffect other = order_effect(30, 54, 41, 54);
  CHECK(other.difference == -found.difference);
  CHECK(other.ci_low == Approx(-found.ci_high));
  CHECK(other.p == Approx(found.p));

  CHECK(order_effect(0, 0, 3, 6).status == OrderStatus::no_stiffer_first);
  CHECK(order_effect(3, 6, 0, 0).status == OrderStatus::no_stiffer_second);
  const std::vector<JudgedTrial> same_only = {trial(true, false)};
  CHECK(order_effect(same_only).status == OrderStatus::no_different_trials);
  CHECK(std::isnan(order_effect(same_only).p));
}

TEST_CASE("response bias: criterion with its interval, and the share of \"different\"", "[analysis][trials]") {
  std::vector<JudgedTrial> trials;
  for (int i = 0; i < 54; ++i) {
    trials.push_back(trial(false, i < 41));
    trials.push_back(trial(true, i < 11));
  }
  const ResponseBias found = response_bias(trials, 0.5);
  CHECK(found.status == RateStatus::ok);
  CHECK(found.counts == Counts{54, 41, 54, 11});
  // Computed apart with exact fractions and the normal quantiles of Python's statistics module.
  CHECK(found.criterion == Approx(0.06035800270498032).epsilon(1e-10));
  CHECK(found.se == Approx(0.13387968215802803).epsilon(1e-10));
  CHECK(found.ci_low == Approx(0.06035800270498032 - 1.959963984540054 * 0.13387968215802803).epsilon(1e-10));
  CHECK(found.said_different.k == 52);
  CHECK(found.said_different.ci_low == Approx(0.38951373394028815).epsilon(1e-10));
  CHECK(found.p == Approx(0.7729885295985343).epsilon(1e-12));
  // An observer who always says "same" leans far, whatever the pairs were.
  const ResponseBias constant = response_bias(Counts{20, 0, 20, 0}, 0.5);
  CHECK(constant.status == RateStatus::no_information);
  CHECK(constant.criterion > 1.9);
  CHECK(constant.p == Approx(std::ldexp(1.0, -39)).epsilon(1e-10));
  const ResponseBias missing = response_bias(Counts{20, 5, 0, 0}, 0.5);
  CHECK(missing.status == RateStatus::missing);
  CHECK(std::isnan(missing.criterion));
  CHECK(std::isnan(missing.se));
  CHECK(missing.said_different.value == 0.25);
  CHECK(std::isnan(response_bias(Counts{}, 0.5).p));
}

TEST_CASE("drift: d' and criterion of both halves against an independent computation", "[analysis][trials]") {
  // Differences, errors and likelihood-ratio p values computed apart, by golden sections in Python.
  struct Halves {
    Counts first, second;
    double dprime, dprime_se, dprime_p, criterion, criterion_se, criterion_p;
  };
  for (const Halves& one : {Halves{{27, 24, 27, 5},
                                   {27, 16, 27, 9},
                                   -1.3646754956117615,
                                   0.5413234658865391,
                                   0.00707325544127419,
                                   0.24230367870996777,
                                   0.27066173294326956,
                                   0.34087446791903936},
                            Halves{{30, 20, 24, 10},
                                   {26, 25, 28, 3},
                                   2.1468842899942864,
                                   0.6137296253287974,
                                   7.750635754176545e-05,
                                   -0.10378945283623223,
                                   0.3068648126643987,
                                   0.6353925885354437},
                            Halves{{12, 10, 15, 0},
                                   {12, 6, 15, 3},
                                   -1.9557338795626096,
                                   0.9177836507006814,
                                   0.005912788548552887,
                                   -0.10844316649241875,
                                   0.4588918253503407,
                                   0.394452715673418}}) {
    const Drift found = drift(one.first, one.second);
    CHECK(found.status == RateStatus::ok);
    CHECK(found.dprime.difference == Approx(one.dprime).epsilon(1e-10));
    CHECK(found.dprime.se == Approx(one.dprime_se).epsilon(1e-10));
    CHECK(found.dprime.p == Approx(one.dprime_p).epsilon(1e-7));
    CHECK(found.criterion.difference == Approx(one.criterion).epsilon(1e-9));
    CHECK(found.criterion.se == Approx(one.criterion_se).epsilon(1e-10));
    CHECK(found.criterion.p == Approx(one.criterion_p).epsilon(1e-7));
    CHECK(found.dprime.ci_low < found.dprime.difference);
  }
}

TEST_CASE("drift: equal halves, moved criteria, and halves without a class", "[analysis][trials]") {
  const Drift equal = drift(Counts{20, 15, 20, 4}, Counts{20, 15, 20, 4});
  CHECK(equal.dprime.difference == 0);
  CHECK(equal.dprime.p == Approx(1).margin(1e-6));
  CHECK(equal.criterion.p == Approx(1).margin(1e-6));
  // The two answers exchanged: d' stays, the criterion is mirrored.
  const Drift moved = drift(Counts{20, 18, 20, 12}, Counts{20, 8, 20, 2});
  CHECK(moved.dprime.difference == Approx(0).margin(1e-12));
  CHECK(moved.dprime.p == Approx(1).margin(1e-6));
  CHECK(moved.criterion.difference > 1);
  CHECK(moved.criterion.p < 0.001);
  const Drift missing = drift(Counts{20, 15, 20, 4}, Counts{20, 15, 0, 0});
  CHECK(missing.status == RateStatus::missing);
  CHECK(std::isnan(missing.dprime.difference));
  CHECK(std::isnan(missing.criterion.p));
  const Drift constant = drift(Counts{20, 15, 20, 4}, Counts{20, 0, 20, 0});
  CHECK(constant.status == RateStatus::no_information);
  CHECK(constant.dprime.p == Approx(1).margin(1e-12));
  // Trials are split at the middle of the session.
  const std::vector<JudgedTrial> trials = {trial(false, true, 0), trial(true, false, 0.49), trial(false, false, 0.5),
                                           trial(true, true, 1)};
  CHECK(drift(trials).first == Counts{1, 1, 1, 0});
  CHECK(drift(trials).second == Counts{1, 0, 1, 1});
}

TEST_CASE("drift over strata weighs each by its precision, and a stratum only against itself", "[analysis][trials]") {
  // An easy series in the first half and a hard one in the second would look like a loss; each held against itself does
  // not change at all.
  const Drift easy = drift({20, 18, 20, 2}, {20, 18, 20, 2}), hard = drift({20, 12, 20, 8}, {20, 12, 20, 8});
  const StratifiedDrift none = stratified_drift(std::vector<Drift>{easy, hard});
  CHECK(none.strata == 2);
  CHECK(none.difference == Approx(0).margin(1e-12));
  CHECK(none.p == Approx(1).epsilon(1e-10));

  const Drift better = drift({20, 12, 20, 8}, {20, 17, 20, 3});
  const StratifiedDrift both = stratified_drift(std::vector<Drift>{easy, better});
  const double w1 = 1 / (easy.dprime.se * easy.dprime.se), w2 = 1 / (better.dprime.se * better.dprime.se);
  CHECK(both.difference == Approx(w2 * better.dprime.difference / (w1 + w2)).epsilon(1e-12));
  CHECK(both.se == Approx(1 / std::sqrt(w1 + w2)).epsilon(1e-12));
  CHECK(both.p == Approx(std::erfc(both.difference / both.se / std::sqrt(2.0))).epsilon(1e-10));
  CHECK(both.ci_low < both.difference);

  // A stratum without a class in a half says nothing.
  const StratifiedDrift one = stratified_drift(std::vector<Drift>{better, drift({20, 12, 0, 0}, {20, 12, 20, 8})});
  CHECK(one.strata == 1);
  CHECK(one.difference == Approx(better.dprime.difference).epsilon(1e-12));
  CHECK(std::isnan(stratified_drift({}).p));
}

}  // namespace
}  // namespace jnd
