// What a fit is asked for once it is found: intervals and tests, each a profile of one number.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <numeric>
#include <optional>
#include <thread>
#include <utility>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/numerics/stop_request.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

// A number takes about so many evaluations, and hardly ever more than so many times as many; its test may take up to that
// share of its work.
constexpr double kEvaluationsOfNumber = 80, kTimesAsMany = 3, kOfTest = 0.3;
constexpr double kFurthestFactor = 3;  // in ln s: a factor of 20
constexpr double kFurthestBias = 6;    // in units of the criterion, a quarter of the range of levels: 1.5 of them

}  // namespace

HeldNumber HierarchicalAnalysis::mean_number(std::size_t condition) const {
  HeldNumber number;
  number.estimate = fit_.maximum.place.mu[condition];
  number.lowest = std::max(range_.lowest(), number.estimate - kFurthestFactor);
  number.highest = std::min(range_.highest(), number.estimate + kFurthestFactor);
  number.hold = [this, condition](double value, const HierarchicalMaximum& from) {
    HierarchicalForm form = form_;
    if (model_.one_mean) {
      std::fill(form.of.begin(), form.of.end(), -1);
      std::fill(form.offset.begin(), form.offset.end(), value);
    } else {
      form = form.with_mean(condition, value);
    }
    return HeldSearch{form, start_of(form, from)};
  };
  number.slope = [this, condition](HierarchicalLikelihood&, const HierarchicalMaximum& there) {
    return model_.one_mean ? std::accumulate(there.slope.mu.begin(), there.slope.mu.end(), 0.0)
                           : there.slope.mu[condition];
  };
  return number;
}

HeldNumber HierarchicalAnalysis::criterion_number(std::size_t condition) const {
  HeldNumber number;
  number.estimate = fit_.maximum.place.kappa[condition];
  number.unit = range_.criterion_unit;
  number.lowest = number.estimate - kFurthestBias * number.unit;
  number.highest = number.estimate + kFurthestBias * number.unit;
  number.hold = [this, condition](double value, const HierarchicalMaximum& from) {
    HeldSearch held{form_, from};
    held.form.held_criteria[condition] = true;
    held.start.place.kappa[condition] = value;
    return held;
  };
  number.slope = [condition](HierarchicalLikelihood&, const HierarchicalMaximum& there) {
    return there.slope.kappa[condition];
  };
  return number;
}

HeldNumber HierarchicalAnalysis::difference_number(std::size_t a, std::size_t b) const {
  HeldNumber number;
  number.estimate = fit_.maximum.place.mu[a] - fit_.maximum.place.mu[b];
  const double widest = range_.highest() - range_.lowest();
  number.lowest = std::max(-widest, number.estimate - kFurthestFactor);
  number.highest = std::min(widest, number.estimate + kFurthestFactor);
  // As int: so much fits into a function without memory of its own.
  number.hold = [this, a = static_cast<int>(a), b = static_cast<int>(b)](double value,
                                                                         const HierarchicalMaximum& from) {
    const HierarchicalForm form =
        form_.with_difference(static_cast<std::size_t>(a), static_cast<std::size_t>(b), value);
    return HeldSearch{form, start_of(form, from)};
  };
  number.slope = [a](HierarchicalLikelihood&, const HierarchicalMaximum& there) { return there.slope.mu[a]; };
  return number;
}

HeldNumber HierarchicalAnalysis::shared_number(SharedParameter which) const {
  const SharedLimits limits = limits_of(which, range_.criterion_unit);
  HeldNumber number;
  number.estimate = value_of(fit_.maximum.shared, which);
  number.lowest = limits.low;
  number.highest = limits.high;
  if (at_least_zero(which)) {
    number.open_low = 0;
    number.unit = 0.1;
  } else if (of_criterion(which)) {
    number.unit = range_.criterion_unit;
  }
  number.hold = [this, which](double value, const HierarchicalMaximum& from) {
    HeldSearch held{form_, from};
    held.form.shared = held.form.shared.with(which, false);
    value_of(held.start.shared, which) = value;
    return held;
  };
  number.slope = [which](HierarchicalLikelihood& likelihood, const HierarchicalMaximum& there) {
    likelihood.set_shared(there.shared);
    return likelihood.at(there.place, SharedForm{}.with(which)).by_shared[static_cast<std::size_t>(which)];
  };
  return number;
}

// One number's part of complete(): what it takes from the likelihood, and where what it finds goes.
struct HierarchicalAnalysis::Task {
  HeldNumber number{};
  double tested = kNaN;  // a value whose drop is wanted
  bool interval = true;
  ProfileEnds* ends = nullptr;
  double drop = kNaN;
  std::function<void(const Task&)> done{};
  std::optional<HierarchicalMaximum> better{};
  double share = 0;  // of the work, that it had

  bool finished() const {
    const bool all = (std::isnan(tested) || !std::isnan(drop)) && ends->status != EndsStatus::out_of_work;
    return all || better.has_value();
  }
};

std::vector<std::pair<std::size_t, std::size_t>> HierarchicalAnalysis::pairs() const {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < fit_.conditions.size() && !model_.one_mean; ++a)
    for (std::size_t b = a + 1; b < fit_.conditions.size(); ++b) pairs.emplace_back(a, b);
  return pairs;
}

std::vector<HierarchicalAnalysis::Task> HierarchicalAnalysis::tasks_of(const HierarchicalWish& wish) {
  std::vector<Task> tasks;
  const bool choice = model_.response == ResponseModel::choice;
  for (std::size_t c = 0; c < fit_.conditions.size() && wish.intervals; ++c) {
    ConditionMean& one = fit_.conditions[c];
    one.ends = one.criterion_ends = {};
    if (!kept(c)) continue;
    tasks.push_back({.number = mean_number(c), .ends = &one.ends});
    if (choice && one.status == SlopeStatus::ok && !form_.held_criteria[c])
      tasks.push_back({.number = criterion_number(c), .ends = &one.criterion_ends});
  }
  if (!wish.pairs.empty()) fit_.differences.clear();
  fit_.differences.reserve(wish.pairs.size());
  for (const auto& [a, b] : wish.pairs) {
    ConditionDifference& one = fit_.differences.emplace_back();
    one.a = a;
    one.b = b;
    one.difference = fit_.conditions[a].mu - fit_.conditions[b].mu;
    if (!kept(a) || !kept(b)) continue;
    tasks.push_back({.number = difference_number(a, b),
                     .tested = 0,
                     .interval = !std::isnan(one.difference),
                     .ends = &one.ends,
                     .done = [&one](const Task& task) {
                       one.lr = 2 * task.drop;
                       one.p = chi2_upper(one.lr, 1);
                     }});
  }
  if (wish.shared) fit_.shared_estimates.clear();
  fit_.shared_estimates.reserve(kSharedParameters.size());
  for (const SharedParameter which : kSharedParameters) {
    if (!wish.shared || !model_.estimated.has(which)) continue;
    SharedEstimate& one = fit_.shared_estimates.emplace_back();
    one.parameter = which;
    one.status = SharedStatus::not_identified;
    if (!fit_.shared.has(which)) continue;
    const SharedLimits limits = limits_of(which, range_.criterion_unit);
    one.value = value_of(fit_.maximum.shared, which);
    one.status = one.value == limits.high || (one.value == limits.low && limits.low != 0) ? SharedStatus::at_limit
                 : one.value == limits.low                                                ? SharedStatus::zero
                                                                                          : SharedStatus::ok;
    tasks.push_back({.number = shared_number(which),
                     .tested = limits.low > 0 ? kNaN : 0,  // there is no test of 0
                     .ends = &one.ends,
                     .done = [&one, low = limits.low](const Task& task) {
                       if (low > 0) return;
                       one.lr = 2 * task.drop;
                       one.p = chi2_upper(one.lr, 1);
                       if (low == 0) one.p = one.status == SharedStatus::zero ? 1 : one.p / 2;
                     }});
  }
  return tasks;
}

// The test and the interval of one number; what they took.
double HierarchicalAnalysis::complete_one(Task& task, double share) const {
  task.share = share;
  HierarchicalSearch search = *search_;  // what it knows already is work that it need not do
  const double before = search.work();
  Profile profile(search, fit_.maximum, task.number);
  try {
    if (!std::isnan(task.tested)) task.drop = profile.drop(task.tested, before + kOfTest * share);
    if (task.interval) *task.ends = profile.ends(before + share);
  } catch (BetterMaximum& found) {
    task.better = std::move(found.maximum);
  }
  return search.work() - before;
}

// As many of the numbers, the first first, as can be finished with the work that is left, and then with what these left;
// and those that took more than their share once more with at least twice as much. Returns how much was taken.
double HierarchicalAnalysis::complete_all(std::vector<Task>& tasks, double left, int threads) {
  const double before = search_->work();
  search_->likelihood().set_shared(fit_.maximum.shared);
  search_->likelihood().at(fit_.maximum.place, form_.shared);
  const double of_number = kEvaluationsOfNumber * (search_->work() - before);
  double spent = 0;  // whole numbers: in whatever order
  int done = 0;
  std::vector<Task*> waiting;
  for (Task& task : tasks) waiting.push_back(&task);
  while (!waiting.empty() && left - spent > of_number) {
    const double share = std::max((left - spent) / static_cast<double>(waiting.size()),
                                  std::min(left - spent, kTimesAsMany * of_number));
    if (2 * waiting.front()->share > share) break;
    const std::size_t now = std::min(waiting.size(), static_cast<std::size_t>((left - spent) / share));
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::exception_ptr failure;
    const auto work = [&] {
      try {
        for (std::size_t i = next++; i < now; i = next++) {
          const double took = complete_one(*waiting[i], share);
          const std::lock_guard lock(mutex);
          spent += took;
          done += waiting[i]->finished() ? 1 : 0;
          if (work_progress()) work_progress()(done, static_cast<int>(tasks.size()));
        }
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = now;
      }
    };
    {
      std::vector<std::jthread> workers;
      for (int i = 1; i < std::min(threads, static_cast<int>(now)); ++i) workers.emplace_back(work);
      work();
    }
    if (failure) std::rethrow_exception(failure);
    std::rotate(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(now), waiting.end());
    std::erase_if(waiting, [](const Task* one) { return one->finished(); });
  }
  return spent;
}

// Of what was given up: the interval and the test of it by the curvature of ln L at its maximum.
void HierarchicalAnalysis::complete_by_curvature(std::vector<Task>& tasks) {
  const auto given_up = [](const Task& task) { return task.interval && !task.finished(); };
  if (fit_.maximum.curvature.empty() || std::none_of(tasks.begin(), tasks.end(), given_up)) return;
  HierarchicalMaximum best = fit_.maximum;
  best.curvature = observed_information(search_->likelihood(), form_, best, search_->unit());
  constexpr double kBeside = 1e-3, kQuantile = 1.959963984540054;  // of 97.5 %
  for (Task& task : tasks) {
    const HeldNumber& number = task.number;
    if (!given_up(task) || number.estimate <= number.lowest || number.estimate >= number.highest) continue;
    const double larger = kBeside * number.unit;
    const auto [form, beside] = number.hold(number.estimate + larger, best);
    const double error = standard_error(form, best, beside, larger, search_->unit());
    if (std::isnan(error)) continue;
    *task.ends = {number.estimate - kQuantile * error, number.estimate + kQuantile * error, EndsStatus::by_curvature};
    task.drop = std::pow((number.estimate - task.tested) / error, 2) / 2;
  }
}

const HierarchicalFit& HierarchicalAnalysis::complete(const HierarchicalWish& wish, int threads) {
  wished_.intervals = wished_.intervals || wish.intervals;
  wished_.shared = wished_.shared || wish.shared;
  if (!wish.pairs.empty()) wished_.pairs = wish.pairs;
  wished_.most_work = wish.most_work;
  for (int restart = 0;; ++restart) {
    std::vector<Task> tasks = tasks_of(restart == 0 ? wish : wished_);
    for (Task& task : tasks)
      if (task.interval) task.ends->status = EndsStatus::out_of_work;  // until it is done
    completed_ += complete_all(tasks, wish.most_work - spent_ - search_->work() - completed_, threads);
    const HierarchicalMaximum* better = nullptr;
    for (const Task& task : tasks)
      if (task.better && (better == nullptr || task.better->log_likelihood > better->log_likelihood))
        better = &*task.better;
    if (better == nullptr || restart == kMostRestarts) {
      complete_by_curvature(tasks);
      for (const Task& task : tasks) {
        if (task.better) *task.ends = {kNaN, kNaN, EndsStatus::not_converged};
        if (task.done && !std::isnan(task.drop)) task.done(task);
      }
      return fit_;
    }
    search_from(largest(form_, *better, false));
  }
}

template <typename Number>
double HierarchicalAnalysis::drop_of(const Number& number, double value) {
  for (int restart = 0;; ++restart) {
    try {
      return Profile(*search_, fit_.maximum, number()).drop(value);
    } catch (const BetterMaximum& found) {
      if (restart == kMostRestarts) return 0;
      search_from(largest(form_, found.maximum, false));
      complete(HierarchicalWish(wished_));
    }
  }
}

double HierarchicalAnalysis::drop_of_mean(std::size_t condition, double mu) {
  return kept(condition) ? drop_of([&] { return mean_number(condition); }, mu) : kNaN;
}

double HierarchicalAnalysis::drop_of_difference(std::size_t a, std::size_t b, double difference) {
  if (!kept(a) || !kept(b)) return kNaN;
  if (effort_ == SearchEffort::thorough) return drop_of([&] { return difference_number(a, b); }, difference);
  const auto [form, start] = difference_number(a, b).hold(difference, fit_.maximum);
  return std::max(0.0, fit_.maximum.log_likelihood - climbed(form, start).log_likelihood);
}

double HierarchicalAnalysis::equal_lr() {
  if (fit_.df == 0 || effort_ == SearchEffort::thorough) return fit_.lr;
  const HierarchicalForm common = equal_means();
  const HierarchicalMaximum found = climbed(common, start_of(common, fit_.maximum));
  return std::max(0.0, 2 * (fit_.maximum.log_likelihood - found.log_likelihood));
}

}  // namespace jnd
