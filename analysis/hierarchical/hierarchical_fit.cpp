#include "analysis/hierarchical/hierarchical_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
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
// Of HierarchicalLikelihood::work(), of which a second has about 1e9: for the climb to a maximum; and for the search, which
// takes up no other start and no denser nodes beyond it.
constexpr double kMostOfFit = 7e9, kMostOfStarts = 6e8;

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
      if (search_->improve(form, {start}, best, kMostOfStarts - spent_)) asked = 0;
      continue;
    }
    for (const double one : kAsked) {
      *spread = one * unit;
      search_->likelihood().set_shared(start.shared);
      if (!(search_->likelihood().at(start.place).log_likelihood > best.log_likelihood + kNegligible)) continue;
      if (search_->improve(form, {start}, best, kMostOfStarts - spent_)) asked = 0;
      break;
    }
  }
}

// Of a form, from a place near its largest likelihood or not so near.
HierarchicalMaximum HierarchicalAnalysis::largest(const HierarchicalForm& form, const HierarchicalMaximum& first,
                                                  bool many) {
  HierarchicalMaximum best = climbed(form, first);
  if (effort_ == SearchEffort::drawn) return best;
  std::vector<HierarchicalMaximum> starts = with_other_spreads(form, first, range_.criterion_unit);
  for (const double aside : {-1.0, 1.0}) {
    if (!many) break;
    HierarchicalMaximum start = first;
    for (std::size_t c = 0; c < start.place.mu.size(); ++c) {
      if (!kept(c)) continue;
      start.place.mu[c] = std::clamp(start.place.mu[c] + aside, form_.lowest, form_.highest);
      start.place.kappa[c] =
          pooled_maximum(of_condition(cells_, c), model_.response, model_.shared, range_, start.place.mu[c]).criterion;
    }
    starts.push_back(std::move(start));
  }
  search_->improve(form, starts, best, kMostOfStarts - spent_);
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
    if (fit_.exact || kDenser * fineness_ > kDensest || work() > kMostOfStarts) break;
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
  }
  if (!found.own_tv.empty()) {
    const bool any = std::any_of(found.own_tv.begin(), found.own_tv.end(), [](double one) { return one > 0; });
    fit_.tv = any ? SpreadStatus::by_condition : SpreadStatus::zero;
    fit_.maximum.place.tv = 0;
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
