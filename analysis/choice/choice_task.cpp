#include "analysis/choice/choice_task.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <boost/math/special_functions/owens_t.hpp>

#include "analysis/numerics/boost_policy.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

namespace {

constexpr double kRootHalf = 1 / std::numbers::sqrt2;
constexpr double kRootSixth = kRootHalf / std::numbers::sqrt3;

constexpr auto kChoiceTaskWords = words<ChoiceTask>({{"2afc", ChoiceTask::two_afc},
                                                     {"3afc", ChoiceTask::three_afc},
                                                     {"4afc", ChoiceTask::four_afc},
                                                     {"oddity3", ChoiceTask::oddity},
                                                     {"abx_differencing", ChoiceTask::abx_differencing},
                                                     {"abx_independent", ChoiceTask::abx_independent},
                                                     {"duo_trio", ChoiceTask::duo_trio}});

// All terms are positive, so that P and 1 - P keep their digits. The trapezoid rule converges faster than any power of
// its step here: the integrands are entire and fall off at least as fast as phi on both sides of their peak, which lies
// between 0 and d' or at most one standard deviation outside.
ChoiceRate mafc_rate(int alternatives, double dprime) noexcept {
  constexpr double kStep = 0.25, kTail = 10;
  const double low = std::fmin(0, dprime) - kTail, high = std::fmax(0, dprime) + kTail;
  const int others = alternatives - 1;
  ChoiceRate sum{0, 0, 0};
  for (int i = 0; low + i * kStep < high; ++i) {
    const double x = low + i * kStep;
    const double density = normal_density(x - dprime), below = normal_cdf(x);
    const double all_but_one = std::pow(below, others - 1);
    double powers = 0;  // 1 + Phi + ... + Phi^(others - 1) = (1 - Phi^others) / (1 - Phi)
    for (int j = 0; j < others; ++j) powers = powers * below + 1;
    sum.correct += density * all_but_one * below;
    sum.wrong += density * normal_cdf(-x) * powers;
    sum.slope += density * others * all_but_one * normal_density(x);
  }
  return {kStep * sum.correct, kStep * sum.wrong, kStep * sum.slope};
}

// Phi(z) - 1/2 without cancellation.
double half_above(double z) noexcept {
  return 0.5 * std::erf(z * kRootHalf);
}

ChoiceRate oddity_rate(double dprime) noexcept {
  const double h = dprime * kRootSixth;
  const double wrong = 4 * boost::math::owens_t(std::abs(h), std::numbers::sqrt3, QuietPolicy());
  return {1 - wrong, wrong, 4 * kRootSixth * normal_density(h) * half_above(std::numbers::sqrt3 * h)};
}

// Phi(a) Phi(b) + Phi(-a) Phi(-b) with a and b in proportion to d'.
ChoiceRate matching_rate(double dprime, double per_a, double per_b) noexcept {
  const double a = std::abs(dprime) * per_a, b = std::abs(dprime) * per_b;
  const double slope = 2 * (per_a * normal_density(a) * half_above(b) + per_b * normal_density(b) * half_above(a));
  return {0.5 + 2 * half_above(a) * half_above(b), normal_cdf(a) * normal_cdf(-b) + normal_cdf(-a) * normal_cdf(b),
          std::copysign(slope, dprime)};
}

}  // namespace

std::string_view to_string(ChoiceTask task) noexcept {
  return word_of(kChoiceTaskWords, task);
}

std::optional<ChoiceTask> choice_task_from(std::string_view name) noexcept {
  return value_of(kChoiceTaskWords, name);
}

std::optional<ChoiceTask> mafc_task(int alternatives) noexcept {
  if (alternatives == 2) return ChoiceTask::two_afc;
  if (alternatives == 3) return ChoiceTask::three_afc;
  if (alternatives == 4) return ChoiceTask::four_afc;
  return std::nullopt;
}

int chance_of_one_in(ChoiceTask task) noexcept {
  if (task == ChoiceTask::four_afc) return 4;
  return task == ChoiceTask::three_afc || task == ChoiceTask::oddity ? 3 : 2;
}

bool has_signed_dprime(ChoiceTask task) noexcept {
  return task == ChoiceTask::two_afc || task == ChoiceTask::three_afc || task == ChoiceTask::four_afc;
}

ChoiceRate choice_rate(ChoiceTask task, double dprime) noexcept {
  constexpr double kCertain = 150;  // beyond it the rarer answer is below the smallest double
  if (std::isnan(dprime)) return {kNaN, kNaN, kNaN};
  if (std::abs(dprime) > kCertain) {
    const double correct = dprime > 0 || !has_signed_dprime(task) ? 1 : 0;
    return {correct, 1 - correct, 0};
  }
  switch (task) {
    case ChoiceTask::two_afc:
      return {normal_cdf(dprime * kRootHalf), normal_cdf(-dprime * kRootHalf),
              kRootHalf * normal_density(dprime * kRootHalf)};
    case ChoiceTask::three_afc:
      return mafc_rate(3, dprime);
    case ChoiceTask::four_afc:
      return mafc_rate(4, dprime);
    case ChoiceTask::oddity:
      return oddity_rate(dprime);
    case ChoiceTask::abx_differencing:
    case ChoiceTask::duo_trio:
      return matching_rate(dprime, kRootHalf, kRootSixth);
    case ChoiceTask::abx_independent:
      break;
  }
  return matching_rate(dprime, kRootHalf, 0.5);
}

double choice_dprime(ChoiceTask task, double correct, double wrong) noexcept {
  if (!(correct >= 0 && wrong >= 0)) return kNaN;
  if (wrong == 0) return kInf;
  const bool is_signed = has_signed_dprime(task);
  if (!is_signed && correct <= chance_level(task)) return 0;
  if (correct == 0) return -kInf;
  if (task == ChoiceTask::two_afc)
    return std::numbers::sqrt2 * (correct < wrong ? normal_quantile(correct) : -normal_quantile(wrong));

  // Newton's method on the logarithm of the rarer answer, inside a bracket that never lets go of the solution.
  const bool rarely_correct = correct < wrong;
  const double wanted = std::log(rarely_correct ? correct : wrong);
  double low = is_signed ? -100 : 0, high = 100;
  double dprime = 1;
  for (int i = 0; i < 200 && high - low > 1e-14 * (1 + std::abs(dprime)); ++i) {
    const ChoiceRate at = choice_rate(task, dprime);
    const double rarer = rarely_correct ? at.correct : at.wrong;
    const double error = std::log(rarer) - wanted;
    const bool below = (error < 0) == rarely_correct;
    (below ? low : high) = dprime;
    const double next = dprime - error * rarer / (rarely_correct ? at.slope : -at.slope);
    if (std::abs(next - dprime) <= 1e-10 * (1 + std::abs(dprime))) return std::clamp(next, low, high);
    dprime = next > low && next < high ? next : 0.5 * (low + high);
  }
  return dprime;
}

}  // namespace jnd
