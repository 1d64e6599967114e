// Fits of two-interval choices against R and Python, and what their statuses mean at the edges.
#include "analysis/choice/two_interval.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "analysis/selftest/reference_numbers.h"
#include "tests/analysis/choice/two_interval_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;
using nlohmann::json;

void check_number(const char* what, std::optional<double> ours, const json& theirs, double tolerance,
                  bool relative = true) {
  CAPTURE(what, ours.value_or(kNaN), theirs.dump());
  REQUIRE(ours.has_value() == !theirs.is_null());
  if (!ours) return;
  const double reference = reference_number(theirs);
  if (*ours == reference) return;  // infinities too
  CHECK(std::abs(*ours - reference) <= tolerance * (relative ? std::abs(reference) : 1));
}

void check_bounds(const char* what, const std::optional<ChoiceBounds>& ours, const json& expected) {
  if (!expected.contains(what)) return;
  REQUIRE(ours);
  check_number(what, ours->low, expected.at(what).at(0), 1e-6);
  check_number(what, ours->high, expected.at(what).at(1), 1e-6);
}

TwoIntervalStatus status_of(const std::vector<ChoiceRow>& rows, const TwoIntervalOptions& options = {}) {
  return fit_two_interval(rows, options).status;
}

TwoIntervalOptions with_lapse(std::optional<double> lapse, bool order_term = false) {
  TwoIntervalOptions options;
  options.lapse = lapse;
  options.order_term = order_term;
  return options;
}

TEST_CASE("every reference fit of two-interval choices agrees with R and Python", "[choice]") {
  for (const json& one : reference_numbers("two_interval").at("cases")) {
    CAPTURE(one.at("name").get<std::string>());
    const ChoiceCase of = choice_case(one.at("input"));
    const json& expected = one.at("expected");
    const TwoIntervalFit fit = fit_two_interval(of.rows, of.options);
    CHECK(word_of(kTwoIntervalStatusWords, fit.status) == expected.at("status").get<std::string>());
    check_number("loglik", fit.log_likelihood, expected.at("loglik"), 1e-8, false);
    check_number("constants", *fit.log_likelihood + log_binomial_constants(of.rows),
                 expected.at("loglik_with_binomial_constants"), 1e-8, false);
    check_number("deviance", fit.deviance, expected.at("deviance"), 1e-7, false);
    check_number("pse", fit.pse, expected.at("pse"), 1e-7);
    check_number("s", fit.s, expected.at("s"), 1e-7);
    check_number("lapse", fit.lapse, expected.at("lapse"), 1e-6, false);
    const ChoiceJnds jnds = choice_jnds(of.options.link, fit.s.value());
    check_number("jnd_75", jnds.jnd_75, expected.at("jnd_75"), 1e-7);
    check_number("jnd_84", jnds.jnd_84, expected.at("jnd_84"), 1e-7);
    check_number("jnd_dprime1", jnds.jnd_dprime1, expected.at("jnd_dprime1"), 1e-7);
    check_bounds("pse_range", fit.pse_range, expected);
    const TwoIntervalIntervals intervals = two_interval_intervals(of.rows, of.options);
    check_bounds("pse_ci", intervals.pse, expected);
    check_bounds("s_ci", intervals.s, expected);
    check_bounds("order_b_ci", intervals.order_b, expected);
    if (!of.options.order_term) continue;
    const OrderTermTest test = test_order_term(of.rows, of.options, fit);
    check_number("order_b", fit.order_b, expected.at("order_b"), 1e-7, false);
    check_number("without", test.log_likelihood_without, expected.at("loglik_without_order"), 1e-8, false);
    check_number("lr", test.lr, expected.at("order_lr"), 1e-7, false);
    check_number("p", test.p, expected.at("order_p"), 1e-8, false);
  }
}

TEST_CASE("the JNDs are quantiles of F", "[choice]") {
  for (const ChoiceLink link : {ChoiceLink::probit, ChoiceLink::logit}) {
    const ChoiceJnds unit = choice_jnds(link, 1);
    CHECK(plain_choice_cdf(link, unit.jnd_75) == Approx(0.75).epsilon(1e-14));
    CHECK(plain_choice_cdf(link, unit.jnd_84) == Approx(plain_choice_cdf(ChoiceLink::probit, 1)).epsilon(1e-14));
    CHECK(plain_choice_cdf(link, unit.jnd_dprime1) ==
          Approx(plain_choice_cdf(ChoiceLink::probit, std::sqrt(0.5))).epsilon(1e-14));
  }
}

TEST_CASE("two-interval choices without a maximum have a status instead", "[choice]") {
  CHECK(status_of({}) == TwoIntervalStatus::missing);
  CHECK(status_of({{800, 0, 0}}) == TwoIntervalStatus::missing);
  CHECK_FALSE(two_interval_intervals({}).pse);
  CHECK(status_of({{800, 9, 0}, {1000, 9, 0}}) == TwoIntervalStatus::all_same);
  CHECK(status_of({{800, 9, 4}}) == TwoIntervalStatus::not_identified);  // one level: any slope through it
  CHECK(fit_two_interval(std::vector<ChoiceRow>{{800, 9, 6}}, {.pse = 700}).status == TwoIntervalStatus::ok);
  CHECK(status_of({{800, 9, 9}, {1000, 9, 0}}) == TwoIntervalStatus::flat);
  CHECK(status_of({{800, 9, 0}, {900, 9, 4}, {1000, 9, 9}}) == TwoIntervalStatus::separated);
  CHECK(status_of({{800, 9, 0}, {900, 9, 4}, {950, 9, 4}, {1000, 9, 9}}) == TwoIntervalStatus::ok);
  CHECK(status_of({{800, 9, 9}, {900, 9, 4}, {1000, 9, 0}}) == TwoIntervalStatus::flat);
}

TEST_CASE("all answers the same: s anything, the PSE beside the levels", "[choice]") {
  const std::vector<ChoiceRow> none = {{800, 9, 0}, {1000, 9, 0}}, all = {{800, 9, 9}, {1000, 9, 9}};
  const TwoIntervalFit fit = fit_two_interval(all, with_lapse(0.04));
  CHECK(*fit.log_likelihood == Approx(18 * std::log(0.98)).epsilon(1e-14));
  CHECK_FALSE(fit.pse);
  CHECK_FALSE(fit.s);
  CHECK(*fit_two_interval(all, with_lapse(std::nullopt)).lapse == 0);
  const TwoIntervalIntervals of_all = two_interval_intervals(all), of_none = two_interval_intervals(none);
  CHECK(of_all.pse->low == -kInf);
  CHECK(of_all.pse->high == 800);
  CHECK(of_none.pse->low == 1000);
  CHECK(of_none.pse->high == kInf);
  CHECK(of_all.s->low == 0);
  CHECK(of_all.s->high == kInf);
}

TEST_CASE("a step at a level with mixed answers is that level", "[choice]") {
  const TwoIntervalFit fit = fit_two_interval(std::vector<ChoiceRow>{{800, 9, 0}, {900, 10, 3}, {1000, 9, 9}});
  CHECK(fit.pse_range->low == 900);
  CHECK(fit.pse_range->high == 900);
  CHECK(*fit.pse == 900);
  CHECK(*fit.s == 0);
  CHECK(*fit.log_likelihood == Approx(3 * std::log(0.3) + 7 * std::log(0.7)).epsilon(1e-14));
}

TEST_CASE("a fixed lapse rate lets data that are not separable run to a step", "[choice]") {
  const std::vector<ChoiceRow> rows = {{600, 40, 0}, {700, 40, 1}, {800, 40, 0}, {900, 40, 40}, {1000, 40, 40}};
  CHECK(status_of(rows) == TwoIntervalStatus::ok);
  const TwoIntervalFit fit = fit_two_interval(rows, with_lapse(0.02));
  CHECK(fit.status == TwoIntervalStatus::separated);
  CHECK(*fit.log_likelihood == Approx(std::log(0.01) + 199 * std::log(0.99)).epsilon(1e-12));
  CHECK(fit.pse_range->low == 800);
  CHECK(fit.pse_range->high == 900);
  const TwoIntervalFit free = fit_two_interval(rows, with_lapse(std::nullopt));
  CHECK(free.status == TwoIntervalStatus::separated);
  CHECK(*free.lapse == Approx(0.01).epsilon(1e-9));
}

TEST_CASE("levels far from zero and very many trials lose no digits", "[choice]") {
  const std::vector<ChoiceRow> near = {{-1, 30, 3}, {-0.5, 30, 11}, {0, 30, 14}, {0.5, 30, 21}, {1, 30, 29}};
  std::vector<ChoiceRow> far = near, many = near;
  for (ChoiceRow& row : far) row.level += 1e5;
  for (ChoiceRow& row : many) {
    row.n *= 1'000'000'000;
    row.chosen *= 1'000'000'000;
  }
  const TwoIntervalFit one = fit_two_interval(near), shifted = fit_two_interval(far), huge = fit_two_interval(many);
  CHECK(*shifted.pse - 1e5 == Approx(*one.pse).margin(1e-10));
  CHECK(*shifted.s == Approx(*one.s).epsilon(1e-10));
  CHECK(*huge.pse == Approx(*one.pse).margin(1e-9));
  CHECK(*huge.s == Approx(*one.s).epsilon(1e-9));
  CHECK(two_interval_intervals(many).s->high > *huge.s);
}

TEST_CASE("answers far in the tails keep a finite likelihood", "[choice]") {
  // One answer 40 s below the PSE that the others give.
  const std::vector<ChoiceRow> rows = {{-4000, 1, 1}, {-20, 500, 10}, {-10, 500, 80},
                                       {0, 500, 250}, {10, 500, 420}, {20, 500, 490}};
  for (const ChoiceLink link : {ChoiceLink::probit, ChoiceLink::logit}) {
    TwoIntervalOptions options;
    options.link = link;
    const TwoIntervalFit fit = fit_two_interval(rows, options);
    CHECK(fit.status == TwoIntervalStatus::ok);
    CHECK(std::isfinite(*fit.log_likelihood));
    options.lapse = 0.02;
    const TwoIntervalFit lapsing = fit_two_interval(rows, options);
    CHECK(*lapsing.log_likelihood > *fit.log_likelihood);
    CHECK(*lapsing.s < 20);
  }
}

TEST_CASE("the order of the intervals: separated, of one order, and all the same in one", "[choice]") {
  const std::vector<ChoiceRow> apart = {{1, 9, 0, 1},  {2, 9, 9, 1},  {3, 9, 9, 1},
                                        {1, 9, 0, -1}, {2, 9, 0, -1}, {3, 9, 9, -1}};
  const TwoIntervalFit fit = fit_two_interval(apart, with_lapse(0, true));
  CHECK(fit.status == TwoIntervalStatus::separated);
  CHECK(*fit.log_likelihood == 0);
  CHECK(*fit.pse == 2);
  CHECK(*fit.order_b == kInf);
  CHECK(test_order_term(apart, with_lapse(0, true), fit).lr == Approx(36 * std::log(2)).epsilon(1e-9));
  const std::vector<ChoiceRow> single = {{1, 9, 2, 1}, {2, 9, 4, 1}, {3, 9, 8, 1}};
  const TwoIntervalFit of_one = fit_two_interval(single, with_lapse(0, true));
  CHECK(of_one.status == TwoIntervalStatus::ok);
  CHECK_FALSE(of_one.order_b);
  CHECK(std::isnan(test_order_term(single, with_lapse(0, true), of_one).p));
  const std::vector<ChoiceRow> same = {{1, 9, 2, 1}, {2, 9, 4, 1}, {3, 9, 8, 1}, {1, 9, 9, -1}, {2, 9, 9, -1}};
  const TwoIntervalFit of_same = fit_two_interval(same, with_lapse(0, true));
  CHECK(of_same.status == TwoIntervalStatus::ok);
  CHECK(*of_same.order_b == -kInf);
  CHECK(*of_same.pse == -kInf);
  CHECK(*of_same.s == Approx(*of_one.s).epsilon(1e-9));
  CHECK(two_interval_intervals(same, with_lapse(0, true)).pse->low == -kInf);
}

TEST_CASE("rows and options outside their range are refused", "[choice]") {
  CHECK_THROWS_AS(status_of({{kNaN, 9, 4}}), std::invalid_argument);
  CHECK_THROWS_AS(status_of({{1, 9, 10}}), std::invalid_argument);
  CHECK_THROWS_AS(status_of({{1, 9, -1}}), std::invalid_argument);
  CHECK_THROWS_AS(status_of({{1, 9, 4, 0}}, with_lapse(0, true)), std::invalid_argument);
  CHECK_THROWS_AS(status_of({{1, 9, 4}}, with_lapse(1)), std::invalid_argument);
  CHECK_THROWS_AS(status_of({{1, 9, 4}}, with_lapse(kNaN)), std::invalid_argument);
}

}  // namespace

TEST_CASE("with the PSE at the standard, levels on one side of it have a JND", "[choice]") {
  // R 4.2.2: glm(cbind(k, n - k) ~ 0 + I(x - 400) [+ o], binomial(link)); intervals by uniroot on the profile likelihood.
  TwoIntervalOptions options;
  options.pse = 400;
  const std::vector<ChoiceRow> above = {{450, 20, 12}, {500, 20, 15}, {550, 20, 18}, {600, 20, 19}};
  const TwoIntervalFit fit = fit_two_interval(above, options);
  CHECK(fit.status == TwoIntervalStatus::ok);
  CHECK(*fit.pse == 400);
  CHECK(*fit.s == Approx(128.117670722).epsilon(1e-9));
  CHECK(*fit.log_likelihood == Approx(-35.4139770076).epsilon(1e-9));
  CHECK(fit.trials == 80);
  const TwoIntervalIntervals intervals = two_interval_intervals(above, options);
  CHECK(intervals.s->low == Approx(92.96345642).epsilon(1e-8));
  CHECK(intervals.s->high == Approx(193.6923487).epsilon(1e-8));

  options.order_term = true;
  const std::vector<ChoiceRow> orders = {{440, 24, 15, 1},  {480, 24, 19, 1},  {520, 24, 22, 1},
                                         {440, 24, 11, -1}, {480, 24, 16, -1}, {520, 24, 21, -1}};
  const TwoIntervalFit both = fit_two_interval(orders, options);
  CHECK(*both.s == Approx(113.512066359).epsilon(1e-8));
  CHECK(*both.order_b == Approx(0.179948969904).epsilon(1e-8));
  CHECK(*both.log_likelihood == Approx(-77.375148969).epsilon(1e-9));
  CHECK(*both.deviance == Approx(2.92175941599).epsilon(1e-8));
  const TwoIntervalIntervals of_both = two_interval_intervals(orders, options);
  CHECK(of_both.s->low == Approx(85.43353232).epsilon(1e-7));
  CHECK(of_both.s->high == Approx(165.129356).epsilon(1e-7));
  CHECK(of_both.order_b->low == Approx(-0.04720191741).epsilon(1e-6));
  CHECK(of_both.order_b->high == Approx(0.4100362035).epsilon(1e-6));
  options.link = ChoiceLink::logit;
  CHECK(*fit_two_interval(orders, options).s == Approx(69.1616801159).epsilon(1e-8));

  options = {};
  options.pse = 400;
  CHECK(fit_two_interval(std::vector<ChoiceRow>{{450, 20, 20}, {500, 20, 20}}, options).status ==
        TwoIntervalStatus::separated);
  CHECK(fit_two_interval(std::vector<ChoiceRow>{{450, 20, 8}, {500, 20, 9}}, options).status ==
        TwoIntervalStatus::flat);
  // Mirroring a table changes neither s nor its interval.
  const std::vector<ChoiceRow> below = {{350, 20, 8}, {300, 20, 5}, {250, 20, 2}, {200, 20, 1}};
  CHECK(*fit_two_interval(below, options).s == Approx(*fit.s).epsilon(1e-9));
  options.pse = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(fit_two_interval(above, options), std::invalid_argument);
}

}  // namespace jnd
