// The Bayesian adaptive procedure: reference sequences, a plain second computation of everything, and its edges.
#include "analysis/procedures/posterior.h"

#include <cmath>
#include <numeric>

#include "analysis/numerics/normal.h"
#include "analysis/selftest/model_quantities.h"
#include "protocols/random_stream.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// The definition written out: a list of observers with their masses, and explicit posteriors of either answer.
struct PlainPosterior {
  explicit PlainPosterior(const PosteriorConfiguration& given) : c(given) {
    for (const double ln_s : c.ln_s)
      for (const double shift : c.shift)
        for (std::size_t l = 0; l < c.lapse.size(); ++l) {
          const double z1 = (ln_s - c.ln_s_prior.mean) / c.ln_s_prior.sd;
          const double z2 = (shift - c.shift_prior.mean) / c.shift_prior.sd;
          observers.push_back({ln_s, shift, c.lapse[l], std::exp(-0.5 * (z1 * z1 + z2 * z2)) * c.lapse_weights[l]});
        }
    normalise();
  }
  struct Observer {
    double ln_s, shift, lapse, mass;
  };
  double p(const Observer& of, double level) const {
    const double s = std::exp(of.ln_s);
    const double z = c.task == PosteriorTask::which ? (level - c.standard - of.shift) / s : level / s - of.shift;
    return std::min(1 - 1e-9, std::max(1e-9, of.lapse / 2 + (1 - of.lapse) * normal_cdf(z)));
  }
  double normalise() {
    double total = 0;
    for (const Observer& of : observers) total += of.mass;
    for (Observer& of : observers) of.mass /= total;
    return total;
  }
  PlainPosterior after(double level, bool positive, double& share) const {
    PlainPosterior next = *this;
    for (Observer& of : next.observers) of.mass *= positive ? p(of, level) : 1 - p(of, level);
    share = next.normalise();
    return next;
  }
  double variance() const {
    double mean = 0, sum = 0;
    for (const Observer& of : observers) mean += of.mass * of.ln_s;
    for (const Observer& of : observers) sum += of.mass * (of.ln_s - mean) * (of.ln_s - mean);
    return sum;
  }
  // Of this posterior from `from`, in nats.
  double divergence(const PlainPosterior& from) const {
    double sum = 0;
    for (std::size_t i = 0; i < observers.size(); ++i)
      if (observers[i].mass > 0) sum += observers[i].mass * std::log(observers[i].mass / from.observers[i].mass);
    return sum;
  }
  double utility(double level) const {
    double yes = 0, no = 0;
    const PlainPosterior if_yes = after(level, true, yes), if_no = after(level, false, no);
    if (c.utility == PosteriorUtility::entropy) return yes * if_yes.divergence(*this) + no * if_no.divergence(*this);
    const double expected = yes * if_yes.variance() + no * if_no.variance();
    return c.task == PosteriorTask::which ? variance() - expected : -expected;
  }
  PosteriorConfiguration c;
  std::vector<Observer> observers;
};

PosteriorConfiguration small(PosteriorTask task, PosteriorUtility utility) {
  PosteriorConfiguration c = reference_posterior(task, utility);
  c.ln_s = {4.5, 5, 5.25, 5.7, 6.4, 6.5, 7};
  c.shift = task == PosteriorTask::which ? std::vector<double>{-80, -10, 0, 35} : std::vector<double>{0, 0.4, 1.3};
  c.lapse = {0, 0.04};
  c.lapse_weights = {3, 1};
  return c;
}

TEST_CASE("the posterior procedure meets every reference sequence", "[analysis][posterior]") {
  for (const SelftestQuantity& quantity : posterior_quantities()) {
    CAPTURE(quantity.name, quantity.largest_difference);
    CHECK(quantity.ok());
    CHECK(quantity.cases >= 96);
  }
}

TEST_CASE("utilities and posteriors are those of the definition written out", "[analysis][posterior]") {
  RandomStream stream(3, 1, "posterior");
  for (const PosteriorTask task : {PosteriorTask::same_different, PosteriorTask::which})
    for (const PosteriorUtility utility : {PosteriorUtility::variance, PosteriorUtility::entropy}) {
      const PosteriorConfiguration c = small(task, utility);
      PosteriorProcedure run(c);
      PlainPosterior plain(c);
      for (int trial = 0; trial < 25; ++trial) {
        const auto slot = task == PosteriorTask::which ? PosteriorSlot::free : PosteriorSlot::different;
        const std::size_t first = task == PosteriorTask::which ? 0 : 1;
        const PosteriorChoice choice = run.choose(slot);
        double best = -INFINITY;
        for (std::size_t i = first; i < c.levels.size(); ++i) best = std::max(best, plain.utility(c.levels[i]));
        CHECK(choice.utility == Approx(plain.utility(c.levels[choice.level])).margin(1e-11));
        CHECK(choice.utility >= best - 1e-11);
        const std::size_t shown =
            trial % 4 == 3 ? static_cast<std::size_t>(stream.below(c.levels.size())) : choice.level;
        const bool positive = stream.coin();
        double share = 0;
        plain = plain.after(c.levels[shown], positive, share);
        run.update(shown, positive);
        const PosteriorEstimate of = run.estimate();
        CHECK(of.sd_ln_s == Approx(std::sqrt(plain.variance())).margin(1e-11));
        double mean_shift = 0;
        for (const auto& one : plain.observers) mean_shift += one.mass * one.shift;
        CHECK(of.mean_shift == Approx(mean_shift).margin(1e-10));
      }
    }
}

TEST_CASE("mirror ties go to the first level", "[analysis][posterior]") {
  PosteriorProcedure run(reference_posterior(PosteriorTask::which, PosteriorUtility::entropy));
  const PosteriorChoice first = run.choose(PosteriorSlot::free);
  CHECK(first.level < 10);
  const PosteriorChoice mirrored = run.choose(PosteriorSlot::above);
  CHECK(mirrored.level == 19 - first.level);
  CHECK(mirrored.utility == Approx(first.utility).margin(1e-13));
  CHECK(run.choose(PosteriorSlot::below).level == first.level);
  // Two answers that mirror each other leave the posterior symmetric.
  run.update(first.level, false);
  run.update(mirrored.level, true);
  CHECK(run.choose(PosteriorSlot::free).level < 10);
}

TEST_CASE("balanced slots keep the sides of the standard even", "[analysis][posterior]") {
  PosteriorProcedure run(reference_posterior(PosteriorTask::which, PosteriorUtility::variance));
  for (int t = 0; t < 5; ++t) run.update(3, t % 2 == 0);  // b = 5, t = 5: 10 > 6
  CHECK(run.choose(PosteriorSlot::balanced).level >= 10);
  for (int t = 0; t < 7; ++t) run.update(15, t % 2 == 0);  // b = 5, t = 12: 10 < 11
  CHECK(run.choose(PosteriorSlot::balanced).level < 10);
  run.update(3, true);  // b = 6, t = 13: neither
  CHECK(run.choose(PosteriorSlot::balanced).utility == run.choose(PosteriorSlot::free).utility);
}

TEST_CASE("free slots of same-different keep between a third and half of the trials same", "[analysis][posterior]") {
  for (const PosteriorUtility utility : {PosteriorUtility::variance, PosteriorUtility::entropy}) {
    PosteriorProcedure run(reference_posterior(PosteriorTask::same_different, utility));
    RandomStream stream(8, 1, "posterior");
    int same = 0;
    for (int t = 0; t < 120; ++t) {
      const PosteriorChoice choice = run.choose(PosteriorSlot::free);
      CHECK(std::isfinite(choice.utility));
      const bool is_same = choice.level == 0;
      if (same + 1 > (t + 2) / 2) CHECK_FALSE(is_same);
      if (same + 1 <= (t + 2) / 2 && same < (t + 1) / 3) CHECK(is_same);
      same += is_same ? 1 : 0;
      run.update(choice.level, stream.uniform() < 0.2 + 0.001 * run.level(choice.level));
    }
    CHECK(same >= 40);
    CHECK(same <= 61);
    CHECK((run.choose(PosteriorSlot::same).level == 0 && std::isnan(run.choose(PosteriorSlot::same).utility)));
  }
}

TEST_CASE("a thousand answers of one kind leave every number finite", "[analysis][posterior]") {
  for (const bool answer : {false, true}) {
    PosteriorProcedure run(reference_posterior(PosteriorTask::same_different, PosteriorUtility::entropy));
    for (int t = 0; t < 1000; ++t) run.update(run.choose(PosteriorSlot::free).level, answer);
    const PosteriorEstimate of = run.estimate();
    for (const double value : {of.mean_ln_s, of.sd_ln_s, of.mean_shift, of.mean_lapse, run.ln_s_quantile(0.025),
                               run.ln_s_quantile(0.975), run.choose(PosteriorSlot::different).utility})
      CHECK(std::isfinite(value));
    std::vector<double> masses;
    run.ln_s_masses(masses);
    CHECK(std::accumulate(masses.begin(), masses.end(), 0.0) == Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("a copy of the procedure goes its own way, and replaying gives the same", "[analysis][posterior]") {
  PosteriorProcedure run(reference_posterior(PosteriorTask::which, PosteriorUtility::entropy));
  run.update(2, true);
  PosteriorProcedure copy = run;
  copy.update(4, false);
  CHECK((run.trials() == 1 && copy.trials() == 2));
  run.update(4, false);
  CHECK(run.estimate().mean_ln_s == copy.estimate().mean_ln_s);
  CHECK(run.choose(PosteriorSlot::free).utility == copy.choose(PosteriorSlot::free).utility);
}

TEST_CASE("quantiles of ln s lie where the mass does", "[analysis][posterior]") {
  PosteriorConfiguration c = small(PosteriorTask::same_different, PosteriorUtility::variance);
  c.ln_s = {1, 2, 3};
  c.ln_s_prior = {2, 1e3};  // flat
  const PosteriorProcedure run(c);
  CHECK(run.ln_s_quantile(1.0 / 6) == Approx(1.25).margin(1e-6));  // the first third lies from 1 to 1.5
  CHECK(run.ln_s_quantile(0.5) == Approx(2).margin(1e-6));
  CHECK(run.ln_s_quantile(5.0 / 6) == Approx(2.75).margin(1e-6));
  c.ln_s = {4};
  CHECK(PosteriorProcedure(c).ln_s_quantile(0.3) == 4);
}

TEST_CASE("configurations that cannot be used say why", "[analysis][posterior]") {
  const auto broken = [](PosteriorTask task, auto change) {
    PosteriorConfiguration c = reference_posterior(task, PosteriorUtility::variance);
    CHECK(problem_of(c).empty());
    change(c);
    return !problem_of(c).empty();
  };
  constexpr auto kSame = PosteriorTask::same_different, kWhich = PosteriorTask::which;
  CHECK(broken(kSame, [](PosteriorConfiguration& c) { c.levels = {0}; }));
  CHECK(broken(kSame, [](PosteriorConfiguration& c) { c.levels[0] = 10; }));
  CHECK(broken(kSame, [](PosteriorConfiguration& c) { c.levels[3] = -5; }));
  CHECK(broken(kSame, [](PosteriorConfiguration& c) { c.levels[3] = c.levels[4]; }));
  CHECK(broken(kWhich, [](PosteriorConfiguration& c) { c.levels[3] = NAN; }));
  CHECK(broken(kWhich, [](PosteriorConfiguration& c) { c.standard = INFINITY; }));
  CHECK(broken(kSame, [](PosteriorConfiguration& c) { c.ln_s.clear(); }));
  CHECK(broken(kSame, [](PosteriorConfiguration& c) { std::swap(c.ln_s[0], c.ln_s[1]); }));
  CHECK(broken(kSame, [](PosteriorConfiguration& c) { c.ln_s.back() = 1200; }));
  CHECK(broken(kSame, [](PosteriorConfiguration& c) { c.lapse[2] = 1; }));
  CHECK(broken(kSame, [](PosteriorConfiguration& c) { c.lapse_weights.pop_back(); }));
  CHECK(broken(kSame, [](PosteriorConfiguration& c) { c.lapse_weights = {0, 0, 0}; }));
  CHECK(broken(kSame, [](PosteriorConfiguration& c) { c.ln_s_prior.sd = 0; }));
  CHECK(broken(kWhich, [](PosteriorConfiguration& c) { c.shift_prior = {5000, 1}; }));
  CHECK(broken(kSame, [](PosteriorConfiguration& c) {
    for (int i = 0; i < 20000; ++i) c.shift.push_back(10 + i);
  }));
  CHECK_FALSE(posterior_slot_from('B', kSame));
  CHECK_FALSE(posterior_slot_from('S', kWhich));
  CHECK_FALSE(posterior_slot_from('x', kSame));
}

}  // namespace
}  // namespace jnd
