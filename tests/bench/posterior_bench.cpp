// What one trial of the Bayesian adaptive procedure costs, beside the plain loop that its definition describes: for every
// level and either answer an explicit posterior over the observers, and its variance or entropy.
//
//   posterior_bench      microseconds of a choice and of an update, same-different with 25 levels and 1581 observers
//                        (aim: a choice within 1 ms) and which with 20 levels and 1170; the plain loop's, and the ratio
#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/normal.h"
#include "analysis/selftest/model_quantities.h"

namespace {

using namespace jnd;

struct PlainObserver {
  double ln_s, shift, lapse, mass;
};

class PlainLoop {
 public:
  explicit PlainLoop(const PosteriorConfiguration& given) : c_(given) {
    for (const double ln_s : c_.ln_s)
      for (const double shift : c_.shift)
        for (std::size_t l = 0; l < c_.lapse.size(); ++l) {
          const double z1 = (ln_s - c_.ln_s_prior.mean) / c_.ln_s_prior.sd;
          const double z2 = (shift - c_.shift_prior.mean) / c_.shift_prior.sd;
          observers_.push_back({ln_s, shift, c_.lapse[l], std::exp(-0.5 * (z1 * z1 + z2 * z2)) * c_.lapse_weights[l]});
        }
  }

  std::size_t choose() const {
    std::size_t best = 0;
    double highest = -HUGE_VAL;
    for (std::size_t i = 0; i < c_.levels.size(); ++i) {
      double yes = 0, no = 0;
      const double value_yes = value_of(after(c_.levels[i], true, yes));
      const double value_no = value_of(after(c_.levels[i], false, no));
      const double value = (yes * value_yes + no * value_no) / (yes + no);
      if (value > highest) {
        highest = value;
        best = i;
      }
    }
    return best;
  }
  void update(std::size_t level, bool positive) {
    double share = 0;
    observers_ = after(c_.levels[level], positive, share);
  }

 private:
  std::vector<PlainObserver> after(double level, bool positive, double& share) const {
    std::vector<PlainObserver> next = observers_;
    share = 0;
    for (PlainObserver& of : next) {
      const double s = std::exp(of.ln_s);
      const double z = c_.task == PosteriorTask::which ? (level - c_.standard - of.shift) / s : level / s - of.shift;
      const double p = std::clamp(of.lapse / 2 + (1 - of.lapse) * normal_cdf(z), 1e-9, 1 - 1e-9);
      of.mass *= positive ? p : 1 - p;
      share += of.mass;
    }
    for (PlainObserver& of : next) of.mass /= share;
    return next;
  }
  double value_of(const std::vector<PlainObserver>& observers) const {
    double mean = 0, sum = 0;
    if (c_.utility == PosteriorUtility::entropy) {
      for (const PlainObserver& of : observers)
        if (of.mass > 0) sum += of.mass * std::log(of.mass);
      return sum;
    }
    for (const PlainObserver& of : observers) mean += of.mass * of.ln_s;
    for (const PlainObserver& of : observers) sum -= of.mass * (of.ln_s - mean) * (of.ln_s - mean);
    return sum;
  }

  PosteriorConfiguration c_;
  std::vector<PlainObserver> observers_;
};

template <typename Work>
double microseconds_of(int times, Work work) {
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < times; ++i) work(i);
  return 1e6 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / times;
}

// Both in the middle of a run of 40 trials; the same levels, or the program says so.
bool bench(const char* name, PosteriorTask task, PosteriorUtility utility) {
  const PosteriorConfiguration c = reference_posterior(task, utility);
  const auto slot = task == PosteriorTask::which ? PosteriorSlot::free : PosteriorSlot::different;
  PosteriorProcedure ours(c);
  PlainLoop plain(c);
  std::size_t chosen = 0, plain_chosen = 0;
  double choice = 0, plain_choice = 0, update = 0, plain_update = 0;
  int apart = 0;
  constexpr int kTrials = 40;
  for (int trial = 0; trial < kTrials; ++trial) {
    choice += microseconds_of(200, [&](int) { chosen = ours.choose(slot).level; });
    plain_choice += microseconds_of(1, [&](int) { plain_chosen = plain.choose(); });
    if (task == PosteriorTask::which && plain_chosen != chosen) ++apart;
    const bool positive = trial % 3 != 0;
    update += microseconds_of(1, [&](int) { ours.update(chosen, positive); });
    plain_update += microseconds_of(1, [&](int) { plain.update(chosen, positive); });
  }
  fmt::print(
      "{:<26} choice {:7.1f} us, plain loop {:8.0f} us, ratio {:5.0f};   update {:6.1f} us, plain {:6.1f} us, ratio {:4.1f}\n",
      name, choice / kTrials, plain_choice / kTrials, plain_choice / choice, update / kTrials, plain_update / kTrials,
      plain_update / update);
  if (apart > 0) fmt::print("  {} of {} levels differ (mirror ties)\n", apart, kTrials);
  return choice / kTrials < 1000;
}

}  // namespace

int main() {
  bool fast = true;
  fast = bench("same-different, variance", PosteriorTask::same_different, PosteriorUtility::variance) && fast;
  fast = bench("same-different, entropy", PosteriorTask::same_different, PosteriorUtility::entropy) && fast;
  fast = bench("which, variance", PosteriorTask::which, PosteriorUtility::variance) && fast;
  fast = bench("which, entropy", PosteriorTask::which, PosteriorUtility::entropy) && fast;
  return fast ? 0 : 1;
}
