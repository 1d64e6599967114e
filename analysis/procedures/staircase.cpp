#include "analysis/procedures/staircase.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/decimal_order.h"

namespace jnd {

std::string problem_of(const StaircaseRule& rule) {
  const double least = rule.multiplicative ? 1 : 0;
  if (rule.up < 1 || rule.down < 1) return "a staircase needs at least one wrong and one correct answer to move";
  if (!(rule.step_up > least) || !(rule.step_down > least) || std::isinf(rule.step_up) || std::isinf(rule.step_down))
    return rule.multiplicative ? "steps that multiply must be above 1: the level would not move, or move the wrong way"
                               : "steps must be above 0: the level would not move, or move the wrong way";
  if (!std::isfinite(rule.start) || (rule.multiplicative && rule.start <= 0))
    return rule.multiplicative ? "steps that multiply need a start above 0" : "the start must be a finite number";
  if (std::any_of(rule.halve_after.begin(), rule.halve_after.end(), [](int reversal) { return reversal < 1; }))
    return "reversals are counted from 1";
  if (rule.accelerated && (rule.up != 1 || rule.down != 1 || !rule.halve_after.empty()))
    return "accelerated steps follow every answer and shrink by themselves: 1 up, 1 down, and no halving";
  if (rule.clamp && !((*rule.clamp)[0] < (*rule.clamp)[1])) return "the clamp's lower end must be below its upper end";
  if (rule.clamp && (rule.start < (*rule.clamp)[0] || rule.start > (*rule.clamp)[1]))
    return "the start lies outside the clamp";
  if (rule.clamp && rule.multiplicative && (*rule.clamp)[0] < 0) return "levels that are multiplied stay above 0";
  return {};
}

Staircase::Staircase(const StaircaseRule& rule)
    : rule_(rule), level_(clamped(rule.start)), step_up_(rule.step_up), step_down_(rule.step_down) {}

double Staircase::clamped(double level) const {
  return rule_.clamp ? std::clamp(level, (*rule_.clamp)[0], (*rule_.clamp)[1]) : level;
}

double Staircase::stepped(bool correct) const {
  // A quotient of 1 leaves the bits of the step as they are.
  const double by = !rule_.accelerated ? 1 : answers_ <= 2 ? answers_ : 2 + static_cast<double>(reversals_.size());
  if (rule_.multiplicative) {
    const double factor = correct ? 1 / step_down_ : step_up_;
    return by == 1 ? (correct ? level_ / step_down_ : level_ * step_up_) : level_ * std::pow(factor, 1 / by);
  }
  return plain_sum(level_, correct ? -step_down_ / by : step_up_ / by);
}

void Staircase::answer(bool correct) {
  ++answers_;
  int& count = correct ? correct_ : wrong_;
  ++count;
  (correct ? wrong_ : correct_) = 0;
  if (count < (correct ? rule_.down : rule_.up)) return;
  count = 0;
  const int direction = correct ? -1 : 1;
  if (direction_ == -direction) {
    reversals_.push_back(level_);
    const auto now = static_cast<int>(reversals_.size());
    if (std::find(rule_.halve_after.begin(), rule_.halve_after.end(), now) != rule_.halve_after.end()) {
      step_up_ = rule_.multiplicative ? std::sqrt(step_up_) : step_up_ / 2;
      step_down_ = rule_.multiplicative ? std::sqrt(step_down_) : step_down_ / 2;
    }
  }
  direction_ = direction;
  level_ = clamped(stepped(correct));
  ++steps_;
}

double staircase_target(const StaircaseRule& rule) {
  const double rise = rule.multiplicative ? std::log(rule.step_up) : rule.step_up;
  const double fall = rule.multiplicative ? std::log(rule.step_down) : rule.step_down;
  const double wanted = rise / (rise + fall);
  // A run of `down` successes before one of `up` failures: Feller, An Introduction to Probability Theory and Its
  // Applications I, XIII.8, equation (8.3).
  const auto first_down = [&](double p) {
    const double successes = std::pow(p, rule.down - 1), failures = std::pow(1 - p, rule.up - 1);
    return successes * (1 - failures * (1 - p)) / (successes + failures - successes * failures);
  };
  double low = 0, high = 1;
  for (int i = 0; i < 200 && low < high; ++i) {  // to the last bit: the function rises from 0 to 1
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) break;
    (first_down(middle) < wanted ? low : high) = middle;
  }
  return high;
}

}  // namespace jnd
