// Fits and intervals of two-interval choices against a slow search: the likelihood written down directly, over a grid of
// all functions of the family, and from its best places uphill along the axes.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "tests/analysis/choice/two_interval_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;

enum SlowVariable : std::size_t { kPse, kLogS, kOrderB, kLapse };
using SlowPlace = std::array<double, 4>;
using SlowHeld = std::array<std::optional<double>, 4>;

class SlowSearch {
 public:
  explicit SlowSearch(const ChoiceCase& of) : of_(of) {
    for (const ChoiceRow& row : of.rows) levels_.push_back(row.level);
    std::sort(levels_.begin(), levels_.end());
    levels_.erase(std::unique(levels_.begin(), levels_.end()), levels_.end());
    range_ = levels_.size() > 1 ? levels_.back() - levels_.front() : 1;
  }

  double range() const { return range_; }

  // The largest log-likelihood with some variables held.
  double maximum(const SlowHeld& held) const {
    std::vector<std::pair<double, SlowPlace>> seen;
    for (const double pse : some(held[kPse], places()))
      for (const double log_s : some(held[kLogS], log_widths()))
        for (const double b : some(held[kOrderB], {-3, -1, -0.3, 0, 0.3, 1, 3}))
          for (const double lapse : some(held[kLapse], {0, 0.01, 0.03, 0.06, 0.1})) {
            const SlowPlace place = {pse, log_s, b, lapse};
            seen.emplace_back(value(place), place);
          }
    const std::size_t kept = std::min<std::size_t>(seen.size(), 60);
    std::partial_sort(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(kept), seen.end(),
                      [](const auto& a, const auto& b) { return a.first > b.first; });
    double best = -kInf;
    for (std::size_t i = 0; i < kept; ++i) best = std::max(best, uphill(seen[i].second, held));
    return best;
  }

 private:
  static std::vector<double> some(const std::optional<double>& held, const std::vector<double>& free) {
    return held ? std::vector<double>{*held} : free;
  }
  std::vector<double> places() const {
    std::vector<double> all;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      for (const double beside : {-0.05, -0.01, -0.001, 0.0, 0.001, 0.01, 0.05})
        all.push_back(levels_[i] + beside * range_);
      for (const double part : {0.25, 0.5, 0.75})
        if (i > 0) all.push_back(levels_[i - 1] + part * (levels_[i] - levels_[i - 1]));
    }
    for (const double away : {0.1, 0.3, 1.0, 3.0, 10.0, 100.0}) {
      all.push_back(levels_.front() - away * range_);
      all.push_back(levels_.back() + away * range_);
    }
    return all;
  }
  std::vector<double> log_widths() const {
    std::vector<double> all;
    for (double width = -12; width < 8; width += 0.7) all.push_back(std::log(range_) + width);
    return all;
  }
  double value(const SlowPlace& at) const {
    return plain_choice_log_likelihood(of_, at[kPse], std::exp(at[kLogS]), at[kOrderB], at[kLapse]);
  }
  double uphill(SlowPlace at, const SlowHeld& held) const {
    SlowPlace step = {0.1 * range_, 0.5, 0.3, 0.02};
    double best = value(at);
    for (int round = 0; round < 400; ++round) {
      bool moved = false;
      for (std::size_t i = 0; i < at.size(); ++i) {
        if (held[i]) continue;
        for (const double sign : {1.0, -1.0}) {
          SlowPlace next = at;
          next[i] += sign * step[i];
          if (i == kLapse) next[i] = std::clamp(next[i], 0.0, kLargestChoiceLapse);
          const double there = value(next);
          if (!(there > best)) continue;
          at = next;
          best = there;
          step[i] *= 1.3;
          moved = true;
          break;
        }
      }
      if (moved) continue;
      if (step[kPse] < 1e-9 * range_) break;
      for (double& one : step) one /= 2;
    }
    return best;
  }

  const ChoiceCase& of_;
  std::vector<double> levels_;
  double range_ = 1;
};

// Few trials, so that many have no maximum; now and then an answer against the rest.
ChoiceCase random_case(std::mt19937_64& generator, bool with_order) {
  const auto uniform = [&] { return static_cast<double>(generator() >> 11U) * 0x1p-53; };
  ChoiceCase one;
  one.options.link = uniform() < 0.5 ? ChoiceLink::probit : ChoiceLink::logit;
  one.options.order_term = with_order;
  const double s = 0.3 * std::exp(4 * uniform() - 2), pse = 1.2 * uniform() - 0.1, b = with_order ? uniform() - 0.5 : 0;
  const int levels = 2 + static_cast<int>(5 * uniform());
  const long long n = 1 + static_cast<long long>((uniform() < 0.5 ? 4 : 30) * uniform());
  for (int i = 0; i < levels; ++i)
    for (const int order : {-1, 1}) {
      if (!with_order && order > 0) continue;
      const double x = static_cast<double>(i) / (levels - 1);
      double p = plain_choice_cdf(one.options.link, (x - pse) / s + b * order);
      if (uniform() < 0.05) p = 1 - p;
      ChoiceRow row{100 + 50 * x, n, 0, with_order ? order : 0};
      for (long long trial = 0; trial < n; ++trial) row.chosen += uniform() < p ? 1 : 0;
      one.rows.push_back(row);
    }
  return one;
}

SlowHeld held_by(const ChoiceCase& of) {
  SlowHeld held;
  if (!of.options.order_term) held[kOrderB] = 0;
  held[kLapse] = of.options.lapse;
  return held;
}

// An end of an interval: just outside no function may be good enough, and on the way to it some must be.
void check_end(const SlowSearch& slow, SlowHeld held, SlowVariable variable, double log_likelihood, double estimate,
               double end, double outwards) {
  if (!std::isfinite(end)) return;
  constexpr double kDrop = 1.9207294103470621;  // qchisq(0.95, 1) / 2
  CAPTURE(variable, estimate, end);
  held[variable] = end + outwards;
  CHECK(log_likelihood - slow.maximum(held) > kDrop - 1e-4);
  if (!std::isfinite(estimate) || std::abs(estimate - end) < 1e-6) return;
  held[variable] = estimate + 0.97 * (end - estimate);
  CHECK(log_likelihood - slow.maximum(held) < kDrop + 5e-3);
}

void check_case(const ChoiceCase& one) {
  const TwoIntervalFit fit = fit_two_interval(one.rows, one.options);
  const SlowSearch slow(one);
  const SlowHeld held = held_by(one);
  const double best = slow.maximum(held);
  CAPTURE(one.options.lapse.value_or(-1), static_cast<int>(one.options.link), *fit.log_likelihood, best);
  for (const ChoiceRow& row : one.rows)
    UNSCOPED_INFO(row.level << " " << row.n << " " << row.chosen << " " << row.order);
  CHECK(best <= *fit.log_likelihood + 1e-7);
  if (fit.status == TwoIntervalStatus::ok && std::isfinite(*fit.pse)) {
    const double there = plain_choice_log_likelihood(one, *fit.pse, *fit.s, fit.order_b.value_or(0), *fit.lapse);
    CHECK(std::abs(there - *fit.log_likelihood) <= 1e-7);
  }
  if (fit.status == TwoIntervalStatus::all_same || one.options.order_term) return;
  const TwoIntervalIntervals intervals = two_interval_intervals(one.rows, one.options);
  const double little = 1e-6 * slow.range(), pse = fit.pse.value_or(kNaN), log_s = std::log(*fit.s);
  check_end(slow, held, kPse, *fit.log_likelihood, pse, intervals.pse->low, -little);
  check_end(slow, held, kPse, *fit.log_likelihood, pse, intervals.pse->high, little);
  check_end(slow, held, kLogS, *fit.log_likelihood, log_s, std::log(intervals.s->low), -1e-6);
  check_end(slow, held, kLogS, *fit.log_likelihood, log_s, std::log(intervals.s->high), 1e-6);
}

TEST_CASE("no function of the family beats a two-interval fit, and its intervals end where they should",
          "[choice][long]") {
  std::mt19937_64 generator(20261125);
  for (int i = 0; i < 150; ++i) {
    ChoiceCase one = random_case(generator, false);
    for (const std::optional<double> lapse :
         {std::optional<double>(0.0), std::optional<double>(0.03), std::optional<double>()}) {
      one.options.lapse = lapse;
      check_case(one);
    }
  }
}

TEST_CASE("no function of the family beats a two-interval fit with an order term", "[choice][long]") {
  std::mt19937_64 generator(1125);
  for (int i = 0; i < 50; ++i) {
    ChoiceCase one = random_case(generator, true);
    for (const double lapse : {0.0, 0.03}) {
      one.options.lapse = lapse;
      check_case(one);
    }
  }
}

}  // namespace
}  // namespace jnd
