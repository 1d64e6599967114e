#include "analysis/hierarchical/hierarchical_fit.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <map>
#include <mutex>
#include <numeric>
#include <set>
#include <thread>
#include <utility>

#include "analysis/numerics/stop_request.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

constexpr double kFirstSpread = 0.3, kFirstSpreadWithin = 0.15;  // where a search begins
// Of drawn studies: a likelihood of that fineness errs by about 1e-4 of ln L, and by much less in its slopes.
constexpr double kRoughFineness = 0.8, kRoughlyNegligible = 1e-4;
// Of ln L: what nodes may err by, how much denser they are to tell, and how dense at most.
constexpr double kExact = 1e-6, kDenser = 1.5, kDensest = 3.5;
constexpr int kMostRestarts = 6;  // because a larger likelihood was come upon
// Of HierarchicalLikelihood::work(), of which a second has about 1e9: for the search of everything, which takes up no other
// start beyond the half of it, and for complete(), of which means and criteria have a half and everything else the other,
// each number its share.
constexpr double kMostOfFit = 8e9, kMostOfStarts = 4e9, kMostOfAll = 11e9, kOfTest = 0.3;

double trials_of(std::span<const HierarchicalCell> cells) {
  return std::accumulate(cells.begin(), cells.end(), 0.0,
                         [](double sum, const HierarchicalCell& cell) { return sum + cell.counts().trials(); });
}

std::vector<HierarchicalCell> of_condition(std::span<const HierarchicalCell> cells, std::size_t condition) {
  std::vector<HierarchicalCell> chosen;
  for (const HierarchicalCell& cell : cells)
    if (cell.condition == static_cast<int>(condition)) chosen.push_back(cell);
  return chosen;
}

}  // namespace

std::string hierarchical_assumptions(bool own_tv) {
  return "Assumed: ln JND differs between people, and their criteria do, as normal distributions do, by " +
         std::string(spreads_assumed(own_tv)) + ", and nobody's answers change during the study.";
}

SlopeStatus counted_status(std::span<const HierarchicalCell> cells) {
  double positive = 0, negative = 0, highest_negative = -kInf, lowest_positive = kInf;
  std::set<double> levels;
  for (const HierarchicalCell& cell : cells) {
    if (cell.counts().trials() == 0) continue;
    levels.insert(cell.level);
    positive += cell.positive;
    negative += cell.negative;
    if (cell.positive > 0) lowest_positive = std::min(lowest_positive, cell.level);
    if (cell.negative > 0) highest_negative = std::max(highest_negative, cell.level);
  }
  if (levels.empty()) return SlopeStatus::missing;
  if (positive == 0 || negative == 0) return SlopeStatus::one_answer;
  if (levels.size() == 1) return SlopeStatus::one_level;
  return highest_negative < lowest_positive ? SlopeStatus::perfect : SlopeStatus::ok;
}

HierarchicalAnalysis::HierarchicalAnalysis(std::vector<HierarchicalCell> cells, const HierarchicalModel& model,
                                           SearchEffort effort, const HierarchicalPlace* near)
    : cells_(cells),
      answered_(std::move(cells)),
      model_(model),
      effort_(effort),
      range_(search_range(answered_, model.response)),
      fineness_(effort == SearchEffort::drawn ? kRoughFineness : 1) {
  leave_out();
  find_spreads();
  const std::size_t conditions = fit_.conditions.size();
  form_ = HierarchicalForm::common(conditions);
  int means = 0;
  for (std::size_t c = 0; c < conditions; ++c) {
    form_.of[c] = !kept(c) ? -1 : model.one_mean ? 0 : means++;
    form_.held_criteria.push_back(!kept(c));
  }
  const auto estimated = [](SpreadStatus status) { return status == SpreadStatus::ok; };
  form_.tu = estimated(fit_.tu);
  form_.tv = estimated(fit_.tv);
  form_.tw = estimated(fit_.tw);
  form_.rho = model.rho && form_.tu && form_.tw;
  form_.lowest = range_.lowest();
  form_.highest = range_.highest();
  form_.lowest_criterion = range_.lowest_criterion;
  form_.highest_criterion = range_.highest_criterion;
  form_.shared = fit_.shared = model.estimated.identified(cells_);
  fit_.maximum = first_place(near);
  search_.emplace(cells_, model.response, model.shared, fineness_, range_.criterion_unit);
  if (std::none_of(kept_.begin(), kept_.end(), [](bool one) { return one; })) {
    fit_.maximum.converged = true;
    return;
  }
  search(near);
}

// Conditions whose counts tell that there is no JND: their likelihood is largest at an end, whatever the others are.
void HierarchicalAnalysis::leave_out() {
  std::size_t conditions = 0, participants = 0;
  for (const HierarchicalCell& cell : cells_) {
    conditions = std::max(conditions, static_cast<std::size_t>(cell.condition) + 1);
    participants = std::max(participants, static_cast<std::size_t>(cell.participant) + 1);
  }
  fit_.participants = participants;
  fit_.trials = trials_of(cells_);
  fit_.conditions.resize(conditions);
  for (std::size_t c = 0; c < conditions; ++c) {
    fit_.conditions[c].status = counted_status(of_condition(cells_, c));
    kept_.push_back(fit_.conditions[c].status == SlopeStatus::ok);
  }
  for (HierarchicalCell& cell : cells_)
    if (!kept(static_cast<std::size_t>(cell.condition)))
      cell.positive = cell.negative = cell.sure_positive = cell.sure_negative = 0;
}

void HierarchicalAnalysis::find_spreads() {
  std::set<std::pair<int, int>> seen;
  std::set<int> people;
  for (const HierarchicalCell& cell : cells_)
    if (cell.counts().trials() > 0) {
      seen.emplace(cell.participant, cell.condition);
      people.insert(cell.participant);
    }
  const auto status = [](bool asked, bool identified) {
    if (!asked) return SpreadStatus::not_asked;
    return identified ? SpreadStatus::ok : SpreadStatus::not_identified;
  };
  fit_.tu = status(model_.tu, people.size() > 1);
  fit_.tw = status(model_.tw, people.size() > 1);
  fit_.tv = status(model_.tv, people.size() > 1 && seen.size() > people.size());
  fit_.rho = status(model_.rho, people.size() > 1);
}

HierarchicalMaximum HierarchicalAnalysis::climbed(const HierarchicalForm& form, const HierarchicalMaximum& from) {
  return search_->climbed(form, from, kMostOfFit - spent_,
                          effort_ == SearchEffort::drawn ? kRoughlyNegligible : kNegligible);
}

HierarchicalMaximum HierarchicalAnalysis::first_place(const HierarchicalPlace* near) const {
  HierarchicalMaximum start;
  start.shared = first_shared(fit_.shared, model_.shared);
  HierarchicalPlace& place = start.place;
  const std::size_t conditions = fit_.conditions.size();
  if (near != nullptr) place = *near;
  place.mu.resize(conditions);
  place.kappa.resize(conditions);
  for (std::size_t c = 0; c < conditions; ++c) {
    if (!kept(c)) {
      place.mu[c] = place.kappa[c] = 0;
    } else if (near == nullptr) {
      const PooledMaximum pooled = pooled_maximum(of_condition(cells_, c), model_.response, model_.shared, range_);
      place.mu[c] = pooled.ln_s;
      place.kappa[c] = pooled.criterion;
    }
    if (kept(c)) place.mu[c] = std::clamp(place.mu[c], form_.lowest, form_.highest);
  }
  const auto first = [near](bool free, double known, double otherwise) {
    return !free ? 0 : near != nullptr ? known : otherwise;
  };
  place.tu = first(form_.tu, place.tu, kFirstSpread);
  place.tv = first(form_.tv, place.tv, kFirstSpreadWithin);
  place.tw = first(form_.tw, place.tw, kFirstSpread * range_.criterion_unit);
  place.own_tv.assign(model_.own_tv && form_.tv ? conditions : 0, place.tv);
  if (!form_.rho) place.rho = 0;
  return start;
}

// Whether people differ may show only beyond a spread where they seem not to: there ln L is level at 0. And what has
// fewer spreads may lie higher.
void HierarchicalAnalysis::ask_spreads(const HierarchicalForm& form, HierarchicalMaximum& best) {
  constexpr std::array kAsked = {0.03, 0.12, 0.5};
  const std::size_t spreads = free_spreads(form, best.place).size();
  for (std::size_t round = 0, asked = 0; asked < spreads && round < 4 * spreads; ++round) {
    ++asked;
    HierarchicalMaximum start = best;
    const auto [spread, unit] = free_spreads(form, start.place, range_.criterion_unit)[round % spreads];
    if (*spread > 0) {
      *spread = 0;
      if (search_->improve(form, start, best, kMostOfStarts - spent_)) asked = 0;
      continue;
    }
    for (const double one : kAsked) {
      *spread = one * unit;
      search_->likelihood().set_shared(start.shared);
      if (!(search_->likelihood().at(start.place).log_likelihood > best.log_likelihood + kNegligible)) continue;
      if (search_->improve(form, start, best, kMostOfStarts - spent_)) asked = 0;
      break;
    }
  }
}

// Of a form, from a place near its largest likelihood or not so near.
HierarchicalMaximum HierarchicalAnalysis::largest(const HierarchicalForm& form, HierarchicalMaximum first, bool many) {
  first.curvature.clear();
  HierarchicalMaximum best = climbed(form, first);
  if (effort_ == SearchEffort::drawn) return best;
  for (const HierarchicalMaximum& start : with_other_spreads(form, first, range_.criterion_unit))
    search_->improve(form, start, best, kMostOfStarts - spent_);
  for (const double aside : {-1.0, 1.0}) {
    if (!many) break;
    HierarchicalMaximum start = first;
    for (std::size_t c = 0; c < start.place.mu.size(); ++c) {
      if (!kept(c)) continue;
      start.place.mu[c] = std::clamp(start.place.mu[c] + aside, form_.lowest, form_.highest);
      start.place.kappa[c] =
          pooled_maximum(of_condition(cells_, c), model_.response, model_.shared, range_, start.place.mu[c]).criterion;
    }
    search_->improve(form, start, best, kMostOfStarts - spent_);
  }
  ask_spreads(form, best);
  return best;
}

// Everything, with nodes as dense as the study needs.
void HierarchicalAnalysis::search(const HierarchicalPlace* near) {
  HierarchicalMaximum best = largest(form_, first_place(near), true);
  const auto means = std::count(kept_.begin(), kept_.end(), true);
  fit_.df = means > 1 && !model_.one_mean ? static_cast<int>(means) - 1 : 0;
  if (effort_ == SearchEffort::drawn) {
    fit_.maximum = std::move(best);
    settle();
    return;
  }
  for (;;) {
    HierarchicalSearch denser(cells_, model_.response, best.shared, kDenser * fineness_, range_.criterion_unit);
    const double now = best.log_likelihood, then = denser.likelihood().at(best.place).log_likelihood;
    fit_.exact = std::abs(then - now) < kExact;
    if (fit_.exact || kDenser * fineness_ > kDensest) break;
    fineness_ *= kDenser;
    spent_ += search_->work();
    search_ = std::move(denser);
    best = largest(form_, best, false);
  }
  search_from(std::move(best));
}

HierarchicalForm HierarchicalAnalysis::equal_means() const {
  HierarchicalForm common = form_;
  for (int& one : common.of) one = std::min(one, 0);
  return common;
}

void HierarchicalAnalysis::search_from(HierarchicalMaximum best) {
  for (int restart = 0;; ++restart) {
    fit_.maximum = best;
    if (fit_.df == 0) break;
    const HierarchicalForm common = equal_means();
    fit_.common = largest(common, start_of(common, best), false);
    if (fit_.common.log_likelihood <= best.log_likelihood + kTold || restart == kMostRestarts) break;
    best = largest(form_, fit_.common, false);
  }
  settle();
}

// Statuses, and the test of one mean, of the maxima as they are.
void HierarchicalAnalysis::settle() {
  const HierarchicalPlace& found = fit_.maximum.place;
  const auto spread = [](SpreadStatus& status, double value, double largest) {
    if (status == SpreadStatus::not_asked || status == SpreadStatus::not_identified) return;
    status = value == 0 ? SpreadStatus::zero : value > largest * (1 - 1e-6) ? SpreadStatus::at_limit : SpreadStatus::ok;
  };
  spread(fit_.tu, found.tu, kLargestSpread);
  spread(fit_.tw, found.tw / range_.criterion_unit, kLargestSpreadOfCriteria);
  if (found.own_tv.empty()) spread(fit_.tv, found.tv, kLargestSpread);
  for (std::size_t c = 0; c < found.own_tv.size(); ++c) {
    ConditionMean& one = fit_.conditions[c];
    one.tv = kept(c) ? found.own_tv[c] : kNaN;
    one.tv_status = SpreadStatus::ok;
    spread(one.tv_status, one.tv, kLargestSpread);
    if (!kept(c)) one.tv_status = SpreadStatus::not_identified;
    fit_.tv = SpreadStatus::by_condition;
  }
  if (fit_.rho != SpreadStatus::not_asked) {
    const bool told = found.tu > 0 && found.tw > 0;
    if (!told) fit_.maximum.place.rho = 0;
    fit_.rho = !told                                                    ? SpreadStatus::not_identified
               : std::abs(found.rho) > kLargestCorrelation * (1 - 1e-6) ? SpreadStatus::at_limit
                                                                        : SpreadStatus::ok;
  }
  for (std::size_t c = 0; c < fit_.conditions.size(); ++c) {
    if (!kept(c)) continue;
    const auto at_end = [&](double ln_s) {
      if (model_.one_mean || effort_ == SearchEffort::drawn) return -kInf;
      const HierarchicalForm form = form_.with_mean(c, ln_s);
      return climbed(form, start_of(form, fit_.maximum)).log_likelihood;
    };
    ConditionMean& one = fit_.conditions[c];
    one.status = status_of(found.mu[c], fit_.maximum.log_likelihood, at_end);
    one.mu = one.status == SlopeStatus::ok ? found.mu[c] : kNaN;
    one.criterion = found.kappa[c];
  }
  if (fit_.df == 0 || effort_ == SearchEffort::drawn) return;
  fit_.lr = std::max(0.0, 2 * (fit_.maximum.log_likelihood - fit_.common.log_likelihood));
  fit_.p = chi2_upper(fit_.lr, fit_.df);
}

// Where a search begins from a place whose means the form may move: far, and the criteria there are no longer near the
// best.
HierarchicalMaximum HierarchicalAnalysis::start_of(const HierarchicalForm& form,
                                                   const HierarchicalMaximum& from) const {
  constexpr double kFar = 0.5;
  HierarchicalMaximum start = from;
  start.place = moved(form, from.place);
  for (std::size_t c = 0; c < start.place.mu.size(); ++c)
    if (kept(c) && std::abs(start.place.mu[c] - from.place.mu[c]) > kFar)
      start.place.kappa[c] =
          pooled_maximum(of_condition(cells_, c), model_.response, from.shared, range_, start.place.mu[c]).criterion;
  return start;
}

// at_end(ln s): the largest ln L with that mean. Answers that are as likely at an end of what is searched tell no JND.
template <typename AtEnd>
SlopeStatus HierarchicalAnalysis::status_of(double ln_s, double log_likelihood, const AtEnd& at_end) const {
  constexpr double kAsLikely = 1e-4, kNear = 1.2;  // an end is looked at from so near
  if (ln_s > range_.greatest - kNear &&
      (ln_s > range_.greatest || at_end(range_.highest()) > log_likelihood - kAsLikely))
    return SlopeStatus::no_sensitivity;
  if (ln_s < range_.least + kNear && (ln_s < range_.least || at_end(range_.lowest()) > log_likelihood - kAsLikely))
    return SlopeStatus::ceiling;
  return SlopeStatus::ok;
}

namespace {

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
  bool of_condition = false;  // its mean, or criterion
  double tested = kNaN;       // a value whose drop is wanted
  bool interval = true;
  ProfileEnds* ends = nullptr;
  double drop = kNaN;
  std::function<void(const Task&)> done{};
  std::optional<HierarchicalMaximum> better{};
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
    tasks.push_back({.number = mean_number(c), .of_condition = true, .ends = &one.ends});
    if (choice && one.status == SlopeStatus::ok && !form_.held_criteria[c])
      tasks.push_back({.number = criterion_number(c), .of_condition = true, .ends = &one.criterion_ends});
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

const HierarchicalFit& HierarchicalAnalysis::complete(const HierarchicalWish& wish, int threads) {
  double left = kMostOfAll;
  wished_.intervals = wished_.intervals || wish.intervals;
  wished_.shared = wished_.shared || wish.shared;
  if (!wish.pairs.empty()) wished_.pairs = wish.pairs;
  for (int restart = 0;; ++restart) {
    std::vector<Task> tasks = tasks_of(restart == 0 ? wish : wished_);
    if (tasks.empty()) return fit_;
    const auto means = std::count_if(tasks.begin(), tasks.end(), [](const Task& one) { return one.of_condition; });
    const auto others = static_cast<std::ptrdiff_t>(tasks.size()) - means;
    const double half = left / (means > 0 && others > 0 ? 2 : 1);
    std::atomic<std::size_t> next{0};
    int done = 0;
    double spent = 0;  // whole numbers: in whatever order
    std::mutex mutex;
    std::exception_ptr failure;
    const auto work = [&] {
      try {
        for (std::size_t i = next++; i < tasks.size(); i = next++) {
          Task& task = tasks[i];
          HierarchicalSearch search = *search_;  // what it knows already is work that it need not do
          const double before = search.work(), share = half / static_cast<double>(task.of_condition ? means : others);
          Profile profile(search, fit_.maximum, task.number);
          try {
            if (!std::isnan(task.tested)) task.drop = profile.drop(task.tested, before + kOfTest * share);
            if (task.interval) *task.ends = profile.ends(before + share);
          } catch (BetterMaximum& found) {
            task.better = std::move(found.maximum);
          }
          const std::lock_guard lock(mutex);
          spent += search.work() - before;
          ++done;
          if (work_progress()) work_progress()(done, static_cast<int>(tasks.size()));
        }
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = tasks.size();
      }
    };
    {
      std::vector<std::jthread> workers;
      for (int i = 1; i < std::min(threads, static_cast<int>(tasks.size())); ++i) workers.emplace_back(work);
      work();
    }
    if (failure) std::rethrow_exception(failure);
    const HierarchicalMaximum* better = nullptr;
    for (const Task& task : tasks)
      if (task.better && (better == nullptr || task.better->log_likelihood > better->log_likelihood))
        better = &*task.better;
    if (better == nullptr || restart == kMostRestarts) {
      for (const Task& task : tasks) {
        if (task.better) *task.ends = {kNaN, kNaN, EndsStatus::not_converged};
        if (task.done && !std::isnan(task.drop)) task.done(task);
      }
      return fit_;
    }
    left = std::max(0.0, left - spent);
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
  HierarchicalMaximum from = start;
  from.curvature.clear();
  return std::max(0.0, fit_.maximum.log_likelihood - climbed(form, from).log_likelihood);
}

double HierarchicalAnalysis::equal_lr() {
  if (fit_.df == 0 || effort_ == SearchEffort::thorough) return fit_.lr;
  const HierarchicalForm common = equal_means();
  HierarchicalMaximum start = start_of(common, fit_.maximum);
  start.curvature.clear();
  return std::max(0.0, 2 * (fit_.maximum.log_likelihood - climbed(common, start).log_likelihood));
}

std::vector<double> HierarchicalAnalysis::covariance() {
  const std::vector<double> of_means =
      covariance_of_means(search_->likelihood(), form_, fit_.maximum, range_.criterion_unit);
  if (of_means.empty()) return {};
  const std::size_t conditions = fit_.conditions.size();
  const auto means = static_cast<std::size_t>(1 + *std::max_element(form_.of.begin(), form_.of.end()));
  std::vector<double> out(conditions * conditions, kNaN);
  for (std::size_t a = 0; a < conditions; ++a)
    for (std::size_t b = 0; b < conditions; ++b)
      if (form_.of[a] >= 0 && form_.of[b] >= 0)
        out[a * conditions + b] =
            of_means[static_cast<std::size_t>(form_.of[a]) * means + static_cast<std::size_t>(form_.of[b])];
  return out;
}

std::vector<PersonEstimate> HierarchicalAnalysis::people() {
  const std::size_t conditions = fit_.conditions.size();
  std::vector<std::vector<HierarchicalCell>> cells(fit_.participants * conditions);
  for (const HierarchicalCell& cell : answered_)
    cells[static_cast<std::size_t>(cell.participant) * conditions + static_cast<std::size_t>(cell.condition)].push_back(
        cell);
  std::vector<PersonEstimate> people;
  search_->likelihood().set_shared(fit_.maximum.shared);
  const std::vector<PersonPosterior> posteriors = search_->likelihood().posteriors(fit_.maximum.place);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    PersonEstimate& one = people.emplace_back();
    if (kept(i % conditions)) {
      one.mean = posteriors[i / conditions].mean[i % conditions];
      one.sd = posteriors[i / conditions].sd[i % conditions];
      one.criterion = fit_.maximum.place.kappa[i % conditions] + posteriors[i / conditions].w;
    }
    one.status = counted_status(cells[i]);
    if (one.status != SlopeStatus::ok) continue;
    const PooledMaximum alone = pooled_maximum(cells[i], model_.response, fit_.maximum.shared, range_);
    const auto at_end = [&](double ln_s) {
      return pooled_maximum(cells[i], model_.response, fit_.maximum.shared, range_, ln_s).log_likelihood;
    };
    one.status = status_of(alone.ln_s, alone.log_likelihood, at_end);
    if (one.status == SlopeStatus::ok) one.alone = alone.ln_s;
  }
  return people;
}

}  // namespace jnd
