// d' of choices, from right answers, or from hits and false alarms.
#include "analysis/choice/choice_dprime.h"

#include <rapidcheck.h>

#include "analysis/choice/choice_task.h"
#include "analysis/numerics/normal.h"
#include "tests/analysis/detection/detection_fixtures.h"

namespace jnd {
namespace {

// d' from counts of right answers: R's numbers, the definitions by plain quadrature, plain bisection, and the edges.

using testing::agrees;

constexpr ChoiceTask kChoiceTasks[] = {ChoiceTask::two_afc, ChoiceTask::three_afc,        ChoiceTask::four_afc,
                                       ChoiceTask::oddity,  ChoiceTask::abx_differencing, ChoiceTask::abx_independent,
                                       ChoiceTask::duo_trio};

// Simpson's rule on -14..14 about the middle.
template <typename Function>
double simpson_integral(Function&& function, double low, double high) {
  constexpr int kParts = 20'000;
  double sum = function(low) + function(high);
  for (int i = 1; i < kParts; ++i) sum += (i % 2 == 1 ? 4 : 2) * function(low + (high - low) * i / kParts);
  return sum * (high - low) / (3 * kParts);
}

// P(d') as the tasks are defined, by no formula of the program's own.
double defined_rate(ChoiceTask task, double d) {
  const auto phi = [](double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * M_PI); };
  const auto cdf = [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); };
  const auto matching = [&](double a, double b) { return cdf(a) * cdf(b) + cdf(-a) * cdf(-b); };
  const auto mafc = [&](int m) {
    return simpson_integral([&](double x) { return phi(x - d) * std::pow(cdf(x), m - 1); }, -14 + std::fmin(d, 0),
                            14 + std::fmax(d, 0));
  };
  switch (task) {
    case ChoiceTask::two_afc:
      return mafc(2);
    case ChoiceTask::three_afc:
      return mafc(3);
    case ChoiceTask::four_afc:
      return mafc(4);
    case ChoiceTask::oddity:
      return 2 * simpson_integral(
                     [&](double x) {
                       const double shift = d * std::sqrt(2.0 / 3);
                       return (cdf(-x * std::sqrt(3.0) + shift) + cdf(-x * std::sqrt(3.0) - shift)) * phi(x);
                     },
                     0, 14);
    case ChoiceTask::abx_differencing:
      return matching(d / std::sqrt(2.0), d / std::sqrt(6.0));
    case ChoiceTask::abx_independent:
      return matching(d / std::sqrt(2.0), d / 2);
    case ChoiceTask::duo_trio: {
      const double a = cdf(d / std::sqrt(2.0)), b = cdf(d / std::sqrt(6.0));
      return 1 - a - b + 2 * a * b;
    }
  }
  return kNaN;
}

TEST_CASE("d' of counts of right answers agrees with R", "[analysis][choice]") {
  for (const nlohmann::json& one : reference_numbers("choice").at("counts")) {
    CAPTURE(one.at("name").get<std::string>());
    const nlohmann::json &input = one.at("input"), &expected = one.at("expected");
    const ChoiceDprime found = choice_dprime_of_counts(choice_task_from(input.at("task").get<std::string>()).value(),
                                                       input.at("correct"), input.at("n"));
    CHECK(agrees(found.pc, expected.at("pc"), 1e-15));
    CHECK(agrees(found.dprime, expected.at("dprime"), 1e-9));
    CHECK(agrees(found.se, expected.at("se"), 1e-9));
    CHECK(agrees(found.log_likelihood, expected.at("loglik"), 1e-10));
    CHECK(agrees(found.ci_low, expected.at("dprime_ci").at(0), 1e-8));
    CHECK(agrees(found.ci_high, expected.at("dprime_ci").at(1), 1e-8));
  }
}

TEST_CASE("P(d') is what the task's definition integrates to, its slope what P differs by", "[analysis][choice]") {
  for (const ChoiceTask task : kChoiceTasks) {
    CAPTURE(to_string(task));
    CHECK(choice_rate(task, 0).correct == Approx(chance_level(task)).epsilon(1e-14));
    for (const double dprime : {-6.0, -2.0, -0.3, 0.01, 0.5, 1.0, 2.5, 4.0, 7.0}) {
      CAPTURE(dprime);
      const ChoiceRate rate = choice_rate(task, dprime);
      CHECK(rate.correct == Approx(defined_rate(task, dprime)).epsilon(1e-11));
      CHECK(rate.correct + rate.wrong == Approx(1).epsilon(1e-14));
      const double h = 1e-5;
      const double difference = choice_rate(task, dprime + h).correct - choice_rate(task, dprime - h).correct;
      CHECK(rate.slope == Approx(difference / (2 * h)).epsilon(1e-5).margin(1e-11));
    }
  }
}

TEST_CASE("d' of a proportion inverts P(d'), from the faintest sensitivity to the rarest error", "[analysis][choice]") {
  for (const ChoiceTask task : kChoiceTasks)
    for (const double dprime : {-15.0, -3.0, -0.2, 1e-3, 0.1, 1.0, 3.0, 8.0, 20.0}) {
      if (dprime < 0 && !has_signed_dprime(task)) continue;
      CAPTURE(to_string(task), dprime);
      const ChoiceRate rate = choice_rate(task, dprime);
      CHECK(choice_dprime(task, rate.correct, rate.wrong) == Approx(dprime).epsilon(1e-9));
    }
  for (const ChoiceTask task : kChoiceTasks) {
    CHECK(choice_dprime(task, 1, 0) == kInf);
    CHECK(choice_dprime(task, 0, 1) == (has_signed_dprime(task) ? -kInf : 0));
    CHECK(std::abs(choice_dprime(task, chance_level(task), 1 - chance_level(task))) < 1e-12);
    CHECK(choice_rate(task, kInf).correct == 1);
    CHECK(choice_rate(task, -kInf).correct == (has_signed_dprime(task) ? 0 : 1));
    CHECK(std::isnan(choice_dprime(task, kNaN, kNaN)));
    CHECK(std::isnan(choice_rate(task, kNaN).correct));
  }
}

// The ends of the interval by bisection on d' itself.
double end_by_bisection(ChoiceTask task, int correct, int n, double inside, double outside) {
  const auto log_likelihood = [&](double p) {
    return (correct > 0 ? correct * std::log(p) : 0) + (n > correct ? (n - correct) * std::log1p(-p) : 0);
  };
  const double best =
      log_likelihood(has_signed_dprime(task) ? 1.0 * correct / n : std::fmax(1.0 * correct / n, chance_level(task)));
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (inside + outside);
    const bool holds = 2 * (best - log_likelihood(choice_rate(task, middle).correct)) <= 3.841458820694124;
    (holds ? inside : outside) = middle;
  }
  return inside;
}

TEST_CASE("intervals of d' end where bisection says", "[analysis][choice]") {
  REQUIRE(rc::check("any count of any task", [] {
    const ChoiceTask task =
        *rc::gen::elementOf(std::vector<ChoiceTask>(std::begin(kChoiceTasks), std::end(kChoiceTasks)));
    const int n = *rc::gen::inRange(1, 80), correct = *rc::gen::inRange(0, n + 1);
    const ChoiceDprime found = choice_dprime_of_counts(task, correct, n);
    RC_ASSERT(found.ci_low <= found.dprime && found.dprime <= found.ci_high);
    RC_ASSERT(std::isnan(found.se) == (found.status != ChoiceStatus::ok));
    const double inside = std::fmin(std::fmax(found.dprime, -12.0), 12.0);
    if (std::isfinite(found.ci_high))
      RC_ASSERT(std::abs(found.ci_high - end_by_bisection(task, correct, n, inside, 14)) < 1e-7);
    else
      RC_ASSERT(correct == n);
    if (has_signed_dprime(task) && correct > 0)
      RC_ASSERT(std::abs(found.ci_low - end_by_bisection(task, correct, n, inside, -14)) < 1e-7);
    if (!has_signed_dprime(task) && found.ci_low > 0)
      RC_ASSERT(std::abs(found.ci_low - end_by_bisection(task, correct, n, inside, 0)) < 1e-6);
    if (!has_signed_dprime(task) && found.ci_low == 0 && found.dprime > 0)
      RC_ASSERT(end_by_bisection(task, correct, n, inside, 0) < 1e-6);
  }));
}

TEST_CASE("statuses of counts of right answers", "[analysis][choice]") {
  for (const ChoiceTask task : kChoiceTasks) {
    CAPTURE(to_string(task));
    const bool is_signed = has_signed_dprime(task);
    const ChoiceDprime all = choice_dprime_of_counts(task, 12, 12), none = choice_dprime_of_counts(task, 0, 12);
    CHECK(all.status == ChoiceStatus::ceiling);
    CHECK(all.dprime == kInf);
    CHECK(all.log_likelihood == 0);
    CHECK(none.status == (is_signed ? ChoiceStatus::floor : ChoiceStatus::not_above_chance));
    CHECK(none.dprime == (is_signed ? -kInf : 0));
    CHECK(none.ci_low == (is_signed ? -kInf : 0));
    CHECK(std::isfinite(none.ci_high));
    const ChoiceDprime chance = choice_dprime_of_counts(task, 12 / chance_of_one_in(task), 12);
    CHECK(chance.status == (is_signed ? ChoiceStatus::ok : ChoiceStatus::not_above_chance));
    CHECK(std::abs(chance.dprime) < 1e-12);
    const ChoiceDprime missing = choice_dprime_of_counts(task, 0, 0);
    CHECK(missing.status == ChoiceStatus::missing);
    for (const double number : {missing.pc, missing.dprime, missing.se, missing.log_likelihood, missing.ci_low})
      CHECK(std::isnan(number));
  }
}

TEST_CASE("a billion answers have a d' and a narrow interval", "[analysis][choice]") {
  constexpr int kMany = 1'000'000'000;
  for (const ChoiceTask task : kChoiceTasks)
    for (const int correct : {kMany / 2 + 100'000, kMany / 10 * 9, kMany - 1}) {
      CAPTURE(to_string(task), correct);
      const ChoiceDprime found = choice_dprime_of_counts(task, correct, kMany);
      CHECK(found.status == ChoiceStatus::ok);
      CHECK(choice_rate(task, found.dprime).wrong == Approx(1.0 * (kMany - correct) / kMany).epsilon(1e-9));
      CHECK(found.ci_low < found.dprime);
      CHECK(found.ci_high > found.dprime);
      CHECK(found.ci_high - found.ci_low < 2);
    }
}

// ABX and reminder tasks from hits and false alarms: R's numbers and the edges.

void compare_two_rates(const TwoRates& found, const nlohmann::json& expected) {
  CHECK(agrees(found.hit_rate, expected.at("H"), 1e-14));
  CHECK(agrees(found.false_alarm_rate, expected.at("F"), 1e-14));
  CHECK(agrees(found.z_difference, expected.at("z_difference"), 1e-12));
  CHECK(agrees(found.dprime_differencing, expected.at("dprime_differencing"), 1e-9));
  CHECK(agrees(found.dprime_independent, expected.at("dprime_independent"), 1e-9));
  if (expected.contains("pc_unbiased")) CHECK(agrees(found.pc_unbiased, expected.at("pc_unbiased"), 1e-12));
}

TEST_CASE("d' of hits and false alarms in ABX and after a reminder agrees with R", "[analysis][choice]") {
  for (const nlohmann::json& one : reference_numbers("choice").at("rates")) {
    CAPTURE(one.at("name").get<std::string>());
    const nlohmann::json& input = one.at("input");
    const RatesTask task = input.at("task") == "abx" ? RatesTask::abx : RatesTask::reminder_one_interval;
    const RatesDprime found =
        dprime_of_rates(task, {input.at("n_signal"), input.at("hits"), input.at("n_noise"), input.at("false_alarms")});
    compare_two_rates(found.raw, one.at("expected").at("raw"));
    compare_two_rates(found.loglinear, one.at("expected").at("loglinear"));
  }
}

TEST_CASE("a reminder before two intervals halves what differencing gives before one", "[analysis][choice]") {
  const Counts counts{40, 30, 40, 9};
  const RatesDprime one = dprime_of_rates(RatesTask::reminder_one_interval, counts);
  const RatesDprime two = dprime_of_rates(RatesTask::reminder_two_intervals, counts);
  CHECK(one.raw.dprime_differencing == Approx(2 * two.raw.dprime_differencing).epsilon(1e-14));
  CHECK(two.raw.dprime_independent == two.raw.dprime_differencing);
  CHECK(two.raw.pc_unbiased == Approx(normal_cdf(two.raw.dprime_independent / std::sqrt(2))).epsilon(1e-14));
  CHECK(std::isnan(one.raw.pc_unbiased));
  CHECK(one.differencing_low == Approx(std::sqrt(2) * one.z_difference_low).epsilon(1e-14));
  CHECK(one.independent_low < one.raw.dprime_independent);
  CHECK(one.independent_high > one.raw.dprime_independent);
}

TEST_CASE("rates of 0 and 1, below chance, and without a class", "[analysis][choice]") {
  const RatesDprime perfect = dprime_of_rates(RatesTask::abx, {12, 12, 12, 0});
  CHECK(perfect.raw.z_difference == kInf);
  CHECK(perfect.raw.pc_unbiased == 1);
  CHECK(perfect.raw.dprime_differencing == kInf);
  CHECK(perfect.differencing_high == kInf);
  CHECK(perfect.differencing_low > 0);
  CHECK(std::isfinite(perfect.loglinear.dprime_independent));

  const RatesDprime below = dprime_of_rates(RatesTask::abx, {12, 3, 12, 8});
  CHECK(below.raw.z_difference < 0);
  CHECK(below.raw.dprime_independent == 0);
  CHECK(below.independent_low == 0);
  CHECK(dprime_of_rates(RatesTask::reminder_one_interval, {12, 3, 12, 8}).raw.dprime_differencing < 0);

  const RatesDprime alike = dprime_of_rates(RatesTask::abx, {12, 12, 12, 12});
  CHECK(alike.status == RateStatus::no_information);
  CHECK(std::isnan(alike.raw.z_difference));
  CHECK(std::isnan(alike.raw.dprime_differencing));
  CHECK(alike.loglinear.dprime_differencing == 0);
  CHECK(alike.differencing_low == 0);
  CHECK(alike.differencing_high == kInf);

  const RatesDprime missing = dprime_of_rates(RatesTask::reminder_two_intervals, {0, 0, 12, 3});
  CHECK(missing.status == RateStatus::missing);
  CHECK(std::isnan(missing.loglinear.z_difference));
  CHECK(std::isnan(missing.loglinear.dprime_independent));
  CHECK(std::isnan(missing.independent_high));
}

}  // namespace
}  // namespace jnd
