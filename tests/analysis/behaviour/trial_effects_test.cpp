// What answers depend on besides the stimuli.
#include "analysis/behaviour/trial_effects.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "analysis/behaviour/cue_strategy.h"
#include "analysis/behaviour/falling_answers.h"
#include "analysis/numerics/binomial.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// Order of the intervals, response bias and drift: published tables, exact sums and closed forms.

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

// Answers that fall with the level: the trend test at its boundary, and the ends that are named.

TEST_CASE("answers fall if the trend test has a one-sided p below .001", "[analysis]") {
  // Two levels of 50 trials: the test of equal proportions, z = 3.203 and 3.005; the bound is 3.090.
  CHECK(falling_answers({{1, 50, 34}, {2, 50, 18}}));
  CHECK(!falling_answers({{1, 50, 34}, {2, 50, 19}}));
  CHECK(!falling_answers({{1, 50, 18}, {2, 50, 34}}));
}

TEST_CASE("nothing falls without two levels and both answers", "[analysis]") {
  CHECK(!falling_answers({}));
  CHECK(!falling_answers({{1, 0, 0}, {2, 0, 0}}));
  CHECK(!falling_answers({{1, 50, 20}}));
  CHECK(!falling_answers({{1, 50, 50}, {2, 50, 50}}));
  CHECK(!falling_answers({{1, 50, 0}, {2, 50, 0}}));
}

TEST_CASE("both ends are named, of 10 trials each, rows of one level together", "[analysis]") {
  const auto counted = falling_answers({{1100, 20, 2}, {700, 12, 11}, {900, 20, 11}, {700, 8, 7}});
  REQUIRE(counted);
  CHECK(counted->low.from == 700);
  CHECK(counted->low.to == 700);
  CHECK(counted->low.n == 20);
  CHECK(counted->low.k == 18);
  CHECK(counted->high.k == 2);
  std::vector<AnsweredLevel> single;
  for (int i = 0; i < 40; ++i) single.push_back({static_cast<double>(i), 1, i < 20 ? 1 : 0});
  const auto trials = falling_answers(single);
  REQUIRE(trials);
  CHECK(trials->low.to == 9);
  CHECK(trials->high.from == 39);
  CHECK(trials->high.to == 30);
  CHECK(trials->high.n == 10);
}

// Which cue explains the answers: simulated observers who use one cue only, and fits against brute force.

double uniform(std::mt19937_64& generator) {
  return (static_cast<double>(generator() >> 11U) + 0.5) * 0x1p-53;
}

// Presses that vary: force, work and dwell follow the stiffness, each with a spread of its own.
std::vector<CueTrial> observer_of(Cue used, int trials, std::mt19937_64& generator) {
  std::vector<CueTrial> all;
  for (int i = 0; i < trials; ++i) {
    CueTrial trial;
    const double stiffness = 400 * uniform(generator);
    trial.difference = {stiffness, std::abs(0.005 * stiffness + normal_quantile(uniform(generator))),
                        1e-3 * std::abs(0.02 * stiffness + 5 * normal_quantile(uniform(generator))),
                        std::abs(normal_quantile(uniform(generator)))};
    const double largest[] = {400, 3, 13e-3, 2};
    const auto place = static_cast<std::size_t>(used);
    const double felt = trial.difference[place].value_or(0) / largest[place];
    trial.said_different = normal_cdf(6 * (felt - 0.4)) > uniform(generator);
    all.push_back(trial);
  }
  return all;
}

std::vector<CueTrial> some_trials(int n = 60) {
  std::mt19937_64 generator(4);
  return observer_of(Cue::stiffness, n, generator);
}

double plain_log_likelihood(const std::vector<CueTrial>& trials, Cue cue, double l, double b, double mean, double sd) {
  double sum = 0;
  for (const CueTrial& trial : trials) {
    const double z = (trial.difference[static_cast<std::size_t>(cue)].value_or(0) - mean) / sd;
    sum += std::log(0.5 * std::erfc((trial.said_different ? -1 : 1) * (l + b * z) / std::sqrt(2.0)));
  }
  return sum;
}

TEST_CASE("an observer who uses one cue alone is found out, and the other cues add nothing to stiffness", "[cues]") {
  std::mt19937_64 generator(2);
  for (const Cue used : kCues) {
    const CueStrategy found = cue_strategy(observer_of(used, 400, generator));
    CAPTURE(to_string(used));
    REQUIRE(found.status == CueStatus::ok);
    REQUIRE(found.best.has_value());
    CHECK(found.best.value_or(Cue::stiffness) == used);
    CHECK(found.common_trials == 400);
    for (const CueFit& fit : found.cues) {
      CHECK(fit.status == CueStatus::ok);
      CHECK(fit.n == 400);
      const CuePartialTest& partial = fit.beside_stiffness;
      if (fit.cue == Cue::stiffness) {
        CHECK(std::isnan(partial.p));
      } else if (fit.cue == used) {
        CHECK(partial.p < 1e-6);
      } else if (used == Cue::stiffness) {
        CHECK(partial.p > 1e-3);
      }
    }
  }
}

TEST_CASE("the fit is the maximum of the likelihood, and its numbers follow from it", "[cues]") {
  const std::vector<CueTrial> trials = some_trials();
  const CueStrategy found = cue_strategy(trials);
  for (const CueFit& fit : found.cues) {
    CAPTURE(to_string(fit.cue));
    REQUIRE(fit.status == CueStatus::ok);
    double mean = 0, square = 0, different = 0;
    const double n = 60;
    for (const CueTrial& trial : trials) {
      const double x = trial.difference[static_cast<std::size_t>(fit.cue)].value_or(0);
      mean += x / n;
      square += x * x / n;
      different += trial.said_different ? 1 : 0;
    }
    const double sd = std::sqrt(square - mean * mean);
    CHECK(fit.sd == Approx(sd).epsilon(1e-10));
    const auto at = [&](double l, double b) { return plain_log_likelihood(trials, fit.cue, l, b, mean, sd); };
    CHECK(fit.log_likelihood == Approx(at(fit.intercept, fit.slope)).epsilon(1e-10));
    for (double l = -2; l <= 2; l += 0.1)
      for (double b = -3; b <= 3; b += 0.1) CHECK(at(l, b) <= fit.log_likelihood + 1e-12);
    const double h = 1e-4;
    const auto d = [&](double dl, double db) {
      return (at(fit.intercept + dl, fit.slope + db) - at(fit.intercept - dl, fit.slope - db)) / (2 * h);
    };
    CHECK(std::abs(d(h, 0)) < 1e-5);
    CHECK(std::abs(d(0, h)) < 1e-5);
    // Observed information by second differences, inverted.
    const double k = 1e-3, top = at(fit.intercept, fit.slope);
    const double ll = (at(fit.intercept + k, fit.slope) - 2 * top + at(fit.intercept - k, fit.slope)) / (k * k);
    const double bb = (at(fit.intercept, fit.slope + k) - 2 * top + at(fit.intercept, fit.slope - k)) / (k * k);
    const double lb = (at(fit.intercept + k, fit.slope + k) - at(fit.intercept + k, fit.slope - k) -
                       at(fit.intercept - k, fit.slope + k) + at(fit.intercept - k, fit.slope - k)) /
                      (4 * k * k);
    CHECK(fit.slope_se == Approx(std::sqrt(-ll / (ll * bb - lb * lb))).epsilon(1e-4));
    const double constant = different * std::log(different / n) + (n - different) * std::log(1 - different / n);
    CHECK(fit.deviance_explained == Approx(1 - fit.log_likelihood / constant).epsilon(1e-10));
    CHECK(fit.aic == Approx(4 - 2 * fit.log_likelihood).epsilon(1e-12));
  }
}

TEST_CASE("the partial test compares maxima: both predictors against stiffness alone", "[cues]") {
  const std::vector<CueTrial> trials = some_trials();
  const CueStrategy found = cue_strategy(trials);
  const CueFit& dwell = found.cues[static_cast<std::size_t>(Cue::dwell)];
  // Coordinate ascent on the likelihood of l + b1 x1 + b2 x2, raw predictors scaled to about 1.
  double beta[3] = {0, 0, 0};
  const auto value = [&](const double* b) {
    double sum = 0;
    for (const CueTrial& trial : trials) {
      const double u = b[0] + b[1] * trial.difference[0].value_or(0) / 200 + b[2] * trial.difference[3].value_or(0);
      sum += std::log(0.5 * std::erfc((trial.said_different ? -u : u) / std::sqrt(2.0)));
    }
    return sum;
  };
  double best = value(beta);
  for (double step = 1; step > 1e-7; step /= 2)
    for (bool moved = true; moved;) {
      moved = false;
      for (double& one : beta)
        for (const double move : {step, -step}) {
          one += move;
          if (const double now = value(beta); now > best + 1e-13) {
            best = now;
            moved = true;
          } else {
            one -= move;
          }
        }
    }
  REQUIRE(dwell.beside_stiffness.status == CueStatus::ok);
  CHECK(dwell.beside_stiffness.chi_square == Approx(2 * (best - found.cues[0].log_likelihood)).margin(1e-6));
  CHECK(dwell.beside_stiffness.p == Approx(std::erfc(std::sqrt(dwell.beside_stiffness.chi_square / 2))).epsilon(1e-9));
}

TEST_CASE("neither units nor the order of trials matter", "[cues]") {
  std::vector<CueTrial> trials = some_trials(), other = trials;
  std::reverse(other.begin(), other.end());
  for (CueTrial& trial : other)
    for (auto& difference : trial.difference) difference = 1000 * difference.value_or(0);
  const CueStrategy a = cue_strategy(trials), b = cue_strategy(other);
  CHECK(a.best == b.best);
  for (std::size_t i = 0; i < kCues.size(); ++i) {
    CHECK(a.cues[i].slope == Approx(b.cues[i].slope).epsilon(1e-8));
    CHECK(a.cues[i].log_likelihood == Approx(b.cues[i].log_likelihood).epsilon(1e-10));
    CHECK(1000 * a.cues[i].sd == Approx(b.cues[i].sd).epsilon(1e-10));
  }
}

TEST_CASE("what cannot be fitted says why, and trials without a value are counted", "[cues]") {
  CHECK(cue_strategy({}).status == CueStatus::too_few_trials);
  CHECK(cue_strategy(some_trials(19)).cues[0].status == CueStatus::too_few_trials);
  CHECK(cue_strategy(some_trials(20)).cues[0].status != CueStatus::too_few_trials);

  std::vector<CueTrial> trials = some_trials();
  for (std::size_t i = 0; i < 45; ++i) trials[i].difference[2].reset();
  for (std::size_t i = 0; i < 7; ++i) trials[i].difference[1].reset();
  for (CueTrial& trial : trials) trial.difference[3] = 0.7;
  CueStrategy found = cue_strategy(trials);
  CHECK(found.cues[1].n == 53);
  CHECK(found.cues[1].missing == 7);
  CHECK(found.cues[2].status == CueStatus::too_few_trials);
  CHECK(found.cues[2].missing == 45);
  CHECK(found.cues[3].status == CueStatus::no_variation);
  CHECK(found.cues[3].beside_stiffness.status == CueStatus::no_variation);
  CHECK(found.common_trials == 53);  // work has no fit, and is no reason to leave trials out
  CHECK(std::isnan(found.cues[2].slope));

  // A cue that is stiffness in another unit adds nothing to it.
  for (CueTrial& trial : trials) trial.difference[3] = 0.01 * trial.difference[0].value_or(0) + 3;
  CHECK(cue_strategy(trials).cues[3].beside_stiffness.status == CueStatus::no_variation);

  std::vector<CueTrial> same = some_trials();
  for (CueTrial& trial : same) trial.said_different = false;
  CHECK(cue_strategy(same).cues[0].status == CueStatus::no_information);
  CHECK_FALSE(cue_strategy(same).best.has_value());
}

TEST_CASE("an error-free threshold on a cue is separated and still the best cue", "[cues]") {
  std::vector<CueTrial> trials = some_trials();
  for (CueTrial& trial : trials) trial.said_different = trial.difference[1].value_or(0) > 1.2;
  const CueStrategy found = cue_strategy(trials);
  CHECK(found.cues[1].status == CueStatus::separated);
  CHECK(found.cues[1].slope == kInf);
  CHECK(std::isnan(found.cues[1].intercept));
  CHECK(found.cues[1].log_likelihood == Approx(0).margin(1e-6));
  CHECK(found.best == Cue::peak_force);
  CHECK(found.cues[1].beside_stiffness.status == CueStatus::separated);
  for (CueTrial& trial : trials) trial.said_different = !trial.said_different;
  const CueStrategy reversed = cue_strategy(trials);
  CHECK(reversed.cues[1].slope == -kInf);
  CHECK(reversed.best != Cue::peak_force);  // who calls the smaller difference different does not use it so
}

}  // namespace
}  // namespace jnd
