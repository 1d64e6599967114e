#include "analysis/hierarchical/hierarchical_bootstrap.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>

#include "analysis/numerics/binomial.h"
#include "analysis/numerics/experiment_stream.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/stop_request.h"

namespace jnd {

namespace {

constexpr std::uint64_t kPurpose = 0x4869657261726368;

double standard_normal(ExperimentStream& stream) {
  return normal_quantile(open_uniform(stream.next()));
}

// Beta-binomial: each answer is the likelier the more before it were the same (Polya's urn).
double alike_answers(ExperimentStream& stream, double trials, double p, double overdispersion) {
  const double per_answer = overdispersion / (1 - overdispersion);
  double positive = 0;
  for (int before = 0; before < trials; ++before)
    if (open_uniform(stream.next()) * (1 + before * per_answer) < p + positive * per_answer) ++positive;
  return positive;
}

}  // namespace

std::vector<HierarchicalCell> drawn_answers(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                                            const HierarchicalPlace& truth, std::uint64_t seed,
                                            std::uint64_t replicate) {
  struct Person {
    ExperimentStream stream;
    double u = 0, w = 0;
    std::vector<double> v;
  };
  std::vector<Person> people;
  std::vector<HierarchicalCell> drawn(cells.begin(), cells.end());
  for (HierarchicalCell& cell : drawn) {
    const auto number = static_cast<std::size_t>(cell.participant), c = static_cast<std::size_t>(cell.condition);
    while (people.size() <= number) {
      Person& person = people.emplace_back(Person{{seed, kPurpose, replicate, people.size()}, 0, 0, {}});
      const double first = standard_normal(person.stream), second = standard_normal(person.stream);
      person.u = truth.tu * first;
      person.w = truth.tw * (truth.rho * first + std::sqrt(1 - truth.rho * truth.rho) * second);
      for (std::size_t i = 0; i < truth.mu.size(); ++i)
        person.v.push_back(truth.tv_of(i) * standard_normal(person.stream));
    }
    Person& person = people[number];
    const double ln_s = truth.mu[c] + person.u + person.v[c], k = truth.kappa[c] + person.w;
    const double trials = cell.positive + cell.negative, side = cell.second_half ? 0.5 : -0.5;
    const double half_ln_s = ln_s + side * model.shared.drift_ln_s, half_k = k + side * model.shared.drift_criterion;
    const auto draw = [&person](double n, double p) {
      return BinomialSampler(static_cast<int>(n), std::min(p, 1.0)).at(open_uniform(person.stream.next()));
    };
    const LogRates of = log_rates(model.response, cell.level, half_ln_s, half_k, model.shared.lapse);
    const double p = std::min(1.0, std::exp(of.positive));
    cell.positive = model.shared.overdispersion > 0
                        ? alike_answers(person.stream, trials, p, model.shared.overdispersion)
                        : draw(trials, p);
    cell.negative = trials - cell.positive;
    const AnswerChances chances = answer_chances(model.response, cell.level, half_ln_s, half_k, model.shared);
    cell.sure_positive = std::isfinite(model.shared.sure_above)
                             ? draw(cell.positive, chances.sure_positive.chance / std::exp(of.positive))
                             : 0;
    cell.sure_negative = std::isfinite(model.shared.sure_below)
                             ? draw(cell.negative, chances.sure_negative.chance / std::exp(of.negative))
                             : 0;
  }
  return drawn;
}

EqualityBootstrap equality_bootstrap(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                                     const HierarchicalFit& fit, int replicates, std::uint64_t seed, int threads,
                                     const std::function<void(int)>& progress) {
  HierarchicalModel drawn_model = model;
  drawn_model.shared = fit.common.shared;
  std::atomic<int> next{0}, as_large{0};
  int done = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      for (int i = next++; i < replicates; i = next++) {
        stop_if_requested();
        const std::vector<HierarchicalCell> drawn =
            drawn_answers(cells, drawn_model, fit.common.place, seed, static_cast<std::uint64_t>(i));
        HierarchicalAnalysis analysis(drawn, drawn_model, SearchEffort::drawn, &fit.common.place);
        if (analysis.equal_lr() >= fit.lr) ++as_large;
        const std::lock_guard lock(mutex);
        ++done;
        if (progress) progress(done);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      next = replicates;
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < std::clamp(threads, 1, replicates); ++i) workers.emplace_back(work);
  }
  if (failure) std::rethrow_exception(failure);
  return {replicates, as_large, (1.0 + as_large) / (1.0 + replicates)};
}

}  // namespace jnd
