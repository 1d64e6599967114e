#include "analysis/choice/choice_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

namespace jnd {

namespace {

// One threshold of one order: how many answers it takes for lapses, and the level on it.
struct ChoiceThreshold {
  double low = 0, high = 0;       // of the threshold
  double errors = 0, trials = 0;  // of the levels off it
  double on_n = 0, on_k = 0;      // of the level on it

  bool is_level() const noexcept { return low == high; }
  bool is_outer() const noexcept { return std::isinf(low) || std::isinf(high); }  // beside all levels
};

// Every threshold of the rows of one order (0: of all rows). Those below and above all levels, which are constants too,
// only where asked for.
std::vector<ChoiceThreshold> thresholds_of(const ChoiceData& data, int order, bool with_outer) {
  std::vector<double> t, n, k;
  for (std::size_t i = 0; i < data.rows(); ++i) {
    if (order != 0 && data.o[i] != order) continue;
    if (t.empty() || t.back() != data.t[i]) {
      t.push_back(data.t[i]);
      n.push_back(0);
      k.push_back(0);
    }
    n.back() += data.n[i];
    k.back() += data.k[i];
  }
  double trials = 0, rest_above = 0, chosen_below = 0;
  for (std::size_t j = 0; j < t.size(); ++j) {
    trials += n[j];
    rest_above += n[j] - k[j];
  }
  std::vector<ChoiceThreshold> all;
  for (std::size_t j = 0; j <= t.size(); ++j) {
    // NOLINTNEXTLINE(bugprone-narrowing-conversions)
    const double below = j == 0 ? -kInf : t[j - 1], above = j == t.size() ? kInf : t[j];
    if (with_outer || (j > 0 && j < t.size())) all.push_back({below, above, chosen_below + rest_above, trials, 0, 0});
    if (j == t.size()) break;
    rest_above -= n[j] - k[j];
    all.push_back({t[j], t[j], chosen_below + rest_above, trials - n[j], n[j], k[j]});
    chosen_below += k[j];
  }
  return all;
}

double value_at_rate(double n, double k, double lapse) noexcept {
  if (n == 0) return 0;
  const double p = std::clamp(k / n, 0.5 * lapse, 1 - 0.5 * lapse);
  return choice_count_log(k, p) + choice_count_log(n - k, 1 - p);
}

// What is left to sum up when a step, or a constant, is one or two thresholds.
struct ChoiceSum {
  double errors = 0, trials = 0;
  std::array<double, 2> n{}, k{};

  double value(double lapse) const noexcept {
    return choice_count_log(errors, 0.5 * lapse) + choice_count_log(trials - errors, 1 - 0.5 * lapse) +
           value_at_rate(n[0], k[0], lapse) + value_at_rate(n[1], k[1], lapse);
  }
  // A sum of pieces that are concave in the lapse: the best one is a bound of a piece or the top of one.
  std::pair<double, double> best(const std::optional<double>& lapse) const noexcept {
    if (lapse) return {value(*lapse), *lapse};
    std::array<double, 2> fewer{};
    for (std::size_t i = 0; i < 2; ++i) fewer[i] = std::fmin(k[i], n[i] - k[i]);
    const auto share = [](double some, double all) { return all > 0 ? 2 * some / all : 0; };
    std::pair<double, double> best = {value(0), 0};
    for (const double rate : {kLargestChoiceLapse, share(fewer[0], n[0]), share(fewer[1], n[1]), share(errors, trials),
                              share(errors + fewer[0], trials + n[0]), share(errors + fewer[1], trials + n[1]),
                              share(errors + fewer[0] + fewer[1], trials + n[0] + n[1])}) {
      const double inside = std::fmin(rate, kLargestChoiceLapse), here = value(inside);
      if (here > best.first) best = {here, inside};
    }
    return best;
  }
};

ChoiceSum sum_of(const ChoiceThreshold& first, const ChoiceThreshold& second) noexcept {
  return {
      first.errors + second.errors, first.trials + second.trials, {first.on_n, second.on_n}, {first.on_k, second.on_k}};
}

constexpr double kTie = 1e-11;  // log-likelihoods nearer than this are one

double clamped_link(const ChoiceData& data, const ChoiceThreshold& on, double lapse) noexcept {
  const double p = std::clamp((on.on_k / on.on_n - 0.5 * lapse) / (1 - lapse), 0.0, 1.0);
  return choice_quantile(data.link, p);
}

// b where the thresholds of the orders are `second` (o = 1) and `first` (o = -1).
std::optional<double> order_of(const ChoiceData& data, const ChoiceThreshold& second, const ChoiceThreshold& first,
                               double lapse) noexcept {
  if (second.high < first.low || (second.high == first.low && !(second.is_level() && first.is_level()))) return kInf;
  if (first.high < second.low || (first.high == second.low && !(second.is_level() && first.is_level()))) return -kInf;
  if (!second.is_level() || !first.is_level()) return std::nullopt;
  return 0.5 * (clamped_link(data, second, lapse) - clamped_link(data, first, lapse));
}

void take_step(ChoiceLimit& best, double value, double lapse, double low, double high, const std::optional<double>& b) {
  if (value > best.value + kTie) {
    best = {value, lapse, low, high, b};
    return;
  }
  if (value < best.value - kTie) return;
  // As good: an interval rather than the level at its end; of several intervals, all between them.
  if (best.b != b) best.b.reset();
  const bool touches = low <= best.high && high >= best.low;
  if (low == high && touches) return;
  if (best.low == best.high && touches) {
    best.low = low;
    best.high = high;
    return;
  }
  best.low = std::fmin(best.low, low);
  best.high = std::fmax(best.high, high);
}

// Constants: the level on the threshold is all trials of an order.
ChoiceSum constants_of(const ChoiceData& data, bool with_order) noexcept {
  ChoiceSum sum;
  for (std::size_t i = 0; i < data.rows(); ++i) {
    const std::size_t which = with_order && data.o[i] < 0 ? 1 : 0;
    sum.n[which] += data.n[i];
    sum.k[which] += data.k[i];
  }
  return sum;
}

}  // namespace

ChoiceLimit best_step(const ChoiceData& data, bool with_order, const std::optional<double>& lapse) {
  ChoiceLimit best;
  if (!with_order) {
    for (const ChoiceThreshold& at : thresholds_of(data, 0, false)) {
      const auto [value, rate] = sum_of(at, {}).best(lapse);
      take_step(best, value, rate, at.low, at.high, std::nullopt);
    }
    return best;
  }
  const std::vector<ChoiceThreshold> seconds = thresholds_of(data, 1, true), firsts = thresholds_of(data, -1, true);
  for (const ChoiceThreshold& second : seconds)
    for (const ChoiceThreshold& first : firsts) {
      if (second.is_outer() && first.is_outer()) continue;  // a constant
      // NOLINTNEXTLINE(readability-suspicious-call-argument)
      const auto [value, rate] = sum_of(second, first).best(lapse);
      if (value < best.value - kTie) continue;
      take_step(best, value, rate, 0.5 * (second.low + first.low), 0.5 * (second.high + first.high),
                order_of(data, second, first, rate));
    }
  return best;
}

double best_step_at(const ChoiceData& data, bool with_order, const std::optional<double>& lapse, double t) {
  double best = -kInf;
  if (!with_order) {
    for (const ChoiceThreshold& at : thresholds_of(data, 0, true)) {
      if (!at.is_level() && !(t > at.low && t < at.high)) continue;
      if (at.is_level() && t != at.low) continue;
      ChoiceSum sum = sum_of(at, {});
      double half = 0;
      if (at.is_level()) {  // on the PSE the comparison is chosen in half of the trials
        half = at.on_n * std::log(0.5);
        sum.n = sum.k = {};
      }
      best = std::fmax(best, sum.best(lapse).first + half);
    }
    return best;
  }
  for (const ChoiceThreshold& second : thresholds_of(data, 1, true))
    for (const ChoiceThreshold& first : thresholds_of(data, -1, true)) {
      const double low = second.low + first.low, high = second.high + first.high;
      const bool point = second.is_level() && first.is_level();
      if (point ? 2 * t != low : !(2 * t > low && 2 * t < high)) continue;
      if (point && second.low == first.low) continue;  // both on the PSE: the rates are tied; near it they are not
      // NOLINTNEXTLINE(readability-suspicious-call-argument)
      best = std::fmax(best, sum_of(second, first).best(lapse).first);
    }
  return best;
}

ChoiceLimit best_constant(const ChoiceData& data, bool with_order, const std::optional<double>& lapse) {
  const ChoiceSum sum = constants_of(data, with_order);
  ChoiceLimit best;
  std::tie(best.value, best.lapse) = sum.best(lapse);
  if (!with_order || sum.n[0] == 0 || sum.n[1] == 0) return best;
  const auto eta = [&](std::size_t i) {
    const double p = (sum.k[i] / sum.n[i] - 0.5 * best.lapse) / (1 - best.lapse);
    return choice_quantile(data.link, std::clamp(p, 0.0, 1.0));
  };
  const double b = 0.5 * (eta(0) - eta(1));
  if (!std::isnan(b)) best.b = b;
  return best;
}

double best_constant_beside(const ChoiceData& data, bool with_order, const std::optional<double>& lapse, int side) {
  ChoiceSum sum = constants_of(data, with_order);
  if (!with_order) {
    const double half = side < 0 ? std::fmin(sum.k[0], 0.5 * sum.n[0]) : std::fmax(sum.k[0], 0.5 * sum.n[0]);
    if (half == sum.k[0]) return sum.best(lapse).first;
    return sum.n[0] * std::log(0.5);
  }
  // The unrestricted best where its a has the sign; else a = 0, so that the orders mirror each other.
  const double middle = (sum.n[0] > 0 ? sum.k[0] / sum.n[0] : 0) + (sum.n[1] > 0 ? sum.k[1] / sum.n[1] : 0) - 1;
  if (side * middle >= 0) return sum.best(lapse).first;
  ChoiceSum mirrored;
  mirrored.n[0] = sum.n[0] + sum.n[1];
  mirrored.k[0] = sum.k[0] + (sum.n[1] - sum.k[1]);
  return mirrored.best(lapse).first;
}

}  // namespace jnd
