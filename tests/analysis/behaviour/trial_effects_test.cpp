// Order of the intervals, response bias and drift: published tables, exact sums and closed forms.
#include "analysis/behaviour/trial_effects.h"

#include <cmath>
#include <vector>

#include "analysis/numerics/binomial.h"
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

TEST_CASE("the exact binomial test is twice a tail, summed exactly, and agrees with its interval",
          "[analysis][trials]") {
  CHECK(binomial_exact_p(682, 925, 0.75) == Approx(0.3920185341077667).epsilon(1e-12));
  CHECK(binomial_exact_p(63, 108, 0.5) == Approx(0.10143273504110499).epsilon(1e-12));  // as R's, where p is one half
  CHECK(binomial_exact_p(0, 10, 0.5) == Approx(2.0 / 1024).epsilon(1e-12));
  CHECK(binomial_exact_p(7, 12, 0.5) == Approx(0.7744140625).epsilon(1e-12));
  CHECK(binomial_exact_p(30, 108, 1.0 / 3) == Approx(0.2600930711726329).epsilon(1e-12));
  CHECK(binomial_exact_p(0, 0, 0.5) == 1);
  for (int k = 0; k <= 40; ++k)
    for (const double rate : {0.1, 0.25, 1.0 / 3, 0.5, 0.8}) {
      const ExactProportion interval = exact_proportion(k, 40);
      CHECK((binomial_exact_p(k, 40, rate) < 0.05) == (rate < interval.ci_low || rate > interval.ci_high));
    }
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

TEST_CASE("the order effect has Miettinen and Nurminen's interval and p", "[analysis][trials]") {
  // Newcombe 1998 (Stat Med 17:873), table II, method 6, to four decimals; more of them, and p, by the likelihood maximised
  // numerically instead of by the cubic.
  struct Published {
    int k1, n1, k2, n2;
    double low, high, p;
  };
  for (const Published& one :
       {Published{56, 70, 48, 80, 0.05282971324584472, 0.33817294001586834, 0.008258287929380763},
        Published{9, 10, 3, 10, 0.170025016424399, 0.8406495439433282, 0.007601641475220163},
        Published{6, 7, 2, 7, 0.03417554508436444, 0.8534052598974202, 0.037372988340651454},
        Published{5, 56, 0, 29, -0.03259656174351369, 0.1933309766908807, 0.09917565457055083},
        Published{0, 10, 0, 20, -0.1657602275421716, 0.2843813395343772, 1},
        Published{10, 10, 0, 10, 0.6636415518947675, 1, 1.3071845366763056e-05}}) {
    CAPTURE(one.k1, one.n1, one.k2, one.n2);
    const OrderEffect found = order_effect(one.k1, one.n1, one.k2, one.n2);
    CHECK(found.ci_low == Approx(one.low).epsilon(1e-9));
    CHECK(found.ci_high == Approx(one.high).epsilon(1e-9));
    CHECK(found.p == Approx(one.p).epsilon(1e-9));
  }
  for (int first = 0; first <= 12; ++first)
    for (int second = 0; second <= 9; ++second) {
      const OrderEffect found = order_effect(first, 12, second, 9);
      CHECK((found.p < 0.05) == (found.ci_low > 0 || found.ci_high < 0));
      CHECK(found.ci_low <= found.difference);
      CHECK(found.difference <= found.ci_high);
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
  CHECK(found.ci_low == Approx(0.02411288589502632).epsilon(1e-9));
  CHECK(found.ci_high == Approx(0.3718891921331301).epsilon(1e-9));
  CHECK(found.p == Approx(0.0264182252143199).epsilon(1e-9));

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
  CHECK(found.said_different.ci_low == Approx(0.3843082476379664).epsilon(1e-10));
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
  // Differences and errors computed apart, in Python.
  struct Halves {
    Counts first, second;
    double dprime, dprime_se, criterion, criterion_se;
  };
  for (const Halves& one : {Halves{{27, 24, 27, 5},
                                   {27, 16, 27, 9},
                                   -1.3646754956117615,
                                   0.5413234658865391,
                                   0.24230367870996777,
                                   0.27066173294326956},
                            Halves{{30, 20, 24, 10},
                                   {26, 25, 28, 3},
                                   2.1468842899942864,
                                   0.6137296253287974,
                                   -0.10378945283623223,
                                   0.3068648126643987},
                            Halves{{12, 10, 15, 0},
                                   {12, 6, 15, 3},
                                   -1.9557338795626096,
                                   0.9177836507006814,
                                   -0.10844316649241875,
                                   0.4588918253503407}}) {
    const Drift found = drift(one.first, one.second);
    CHECK(found.status == RateStatus::ok);
    CHECK(found.dprime.difference == Approx(one.dprime).epsilon(1e-10));
    CHECK(found.dprime.se == Approx(one.dprime_se).epsilon(1e-10));
    CHECK(found.dprime.p == Approx(std::erfc(std::abs(one.dprime / one.dprime_se) / std::sqrt(2.0))).epsilon(1e-9));
    CHECK(found.criterion.difference == Approx(one.criterion).epsilon(1e-9));
    CHECK(found.criterion.se == Approx(one.criterion_se).epsilon(1e-10));
    CHECK((found.criterion.p < 0.05) == (found.criterion.ci_low > 0 || found.criterion.ci_high < 0));
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
  CHECK(std::isnan(constant.dprime.p));
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
