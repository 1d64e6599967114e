#include "data/results/study_hierarchical.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/posterior_model.h"

namespace jnd {

namespace {

// What one participant answered in one condition and at one standard, with what is known before anything is fitted.
struct AnsweredCell {
  HierarchicalPerson person;
  std::vector<LevelCount> counts;
};

int trials_of(const std::vector<LevelCount>& counts) noexcept {
  int trials = 0;
  for (const LevelCount& one : counts) trials += one.positive + one.negative;
  return trials;
}

// Rows of a participant stand together.
std::vector<int> numbers_of(const std::vector<AnsweredCell>& cells) {
  std::vector<int> numbers(cells.size(), -1);  // among those with trials
  int number = -1;
  std::string_view last;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (trials_of(cells[i].counts) == 0) continue;
    if (number < 0 || cells[i].person.participant != last) ++number;
    last = cells[i].person.participant;
    numbers[i] = number;
  }
  return numbers;
}

// The fit of a study, laid out from its cells and read back into them.
class StudyFit {
 public:
  StudyFit(std::vector<AnsweredCell> cells, const Protocol& protocol)
      : cells_(std::move(cells)), protocol_(protocol), standards_(judged_standards(protocol)) {
    offered_ = task_of(protocol.task.kind).answer_model(protocol);
    if (offered_) answer_model_ = *offered_;
    lay_out();
  }

  // given_levels: those of the protocol.
  StudyHierarchical fitted(std::string separate, bool given_levels);

 private:
  bool choices() const noexcept { return answer_model_.response == ResponseModel::choice; }
  double standard_of(int standard) const { return standards_[static_cast<std::size_t>(standard)].value; }
  // What a level is divided by: of several standards, which may lie far apart, the standard.
  double unit_of(int standard) const { return model_.several_standards ? standard_of(standard) : 1; }
  std::size_t place(const HierarchicalPerson& person) const noexcept {
    return row_of(model_, protocol_, person.condition, person.standard);
  }

  void lay_out();
  std::string refusal();
  std::vector<std::string> names() const;
  std::vector<HierarchicalCell> cells_of_fit() const;
  void add_spreads(const HierarchicalFit& fit);
  void set_conditions(std::vector<HierarchicalCondition>& rows, const std::vector<ConditionMean>& found) const;
  void add_variants(const std::vector<HierarchicalCell>& cells, const HierarchicalModel& of, const VariantWork& work);
  std::vector<std::pair<std::size_t, std::size_t>> pairs() const;
  void add_ratios(const std::vector<ConditionDifference>& differences);
  void add_people(const std::vector<PersonEstimate>& people);
  void add_check(const std::vector<HierarchicalCell>& cells, const HierarchicalModel& of,
                 const HierarchicalPlace& place);
  int in_both(std::size_t a, std::size_t b) const;

  std::vector<AnsweredCell> cells_;
  const Protocol& protocol_;
  std::optional<AnswerModel> offered_;
  AnswerModel answer_model_;
  std::vector<JudgedStandard> standards_;  // rows of a condition
  StudyHierarchical model_;
  std::vector<int> number_;               // of the participant of each cell, in the fit; -1 without trials
  std::vector<int> to_fit_;               // by row of a condition: its place in the fit; -1 without trials
  std::vector<std::size_t> fitted_rows_;  // by place in the fit
};

void StudyFit::lay_out() {
  for (std::size_t condition = 0; condition < protocol_.conditions.size(); ++condition)
    for (std::size_t standard = 0; standard < standards_.size(); ++standard)
      model_.conditions.push_back({.condition = static_cast<int>(condition), .standard = static_cast<int>(standard)});
  number_ = numbers_of(cells_);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    model_.trials += trials_of(cells_[i].counts);
    model_.participants = std::max(model_.participants, number_[i] + 1);
    if (number_[i] >= 0) ++model_.conditions[place(cells_[i].person)].participants;
  }
  for (std::size_t row = 0; row < model_.conditions.size(); ++row) {
    const bool any = model_.conditions[row].participants > 0;
    to_fit_.push_back(any ? static_cast<int>(fitted_rows_.size()) : -1);
    if (any) fitted_rows_.push_back(row);
  }
  if (offered_) model_.response = answer_model_.response;
  model_.lapse = answer_model_.lapse;
  model_.jnd_of_s = answer_model_.jnd_of_s;
  model_.pse_at_standard = answer_model_.pse_at_standard;
  model_.several_standards = standards_.size() > 1;
  for (const JudgedStandard& one : standards_) model_.several_standards = model_.several_standards && one.value > 0;
}

// Why there is no fit; empty where there is one.
std::string StudyFit::refusal() {
  model_.status = HierarchicalStatus::not_offered;
  if (!offered_) return fmt::format("there is none of the registered model of d', {}", protocol_.analysis.model);
  model_.status = HierarchicalStatus::too_many_people;
  if (static_cast<std::size_t>(model_.participants) > kMostInDetail && !protocol_.analysis.hierarchical)
    return fmt::format("it is left out above {} participants; jnd calc hierarchical takes the trials of jnd export",
                       kMostInDetail);
  model_.status = HierarchicalStatus::no_answers;
  double low = kInf, high = -kInf;
  for (const AnsweredCell& cell : cells_)
    for (const LevelCount& one : cell.counts) {
      low = std::min(low, one.level);
      high = std::max(high, one.level);
    }
  if (choices() && !model_.pse_at_standard) {
    if (!(low < high)) return "the comparisons of all trials that count have one level";
  } else if (!(choices() && low < 0) && !(high > 0)) {
    return !task_of(protocol_.task.kind).has_pairs() ? "no trial counts whose level is not the standard"
                                                     : "no trial with different stimuli counts";
  }
  model_.status = HierarchicalStatus::ok;
  return "";
}

// Of the conditions in the fit.
std::vector<std::string> StudyFit::names() const {
  std::vector<std::string> names;
  for (const std::size_t row : fitted_rows_) {
    const HierarchicalCondition& one = model_.conditions[row];
    names.push_back(protocol_.conditions[static_cast<std::size_t>(one.condition)].name);
    if (standards_.size() > 1) names.back() += ", " + standards_[static_cast<std::size_t>(one.standard)].name;
  }
  return names;
}

std::vector<HierarchicalCell> StudyFit::cells_of_fit() const {
  std::vector<HierarchicalCell> cells;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const HierarchicalPerson& person = cells_[i].person;
    std::vector<HierarchicalCell> own;
    for (const LevelCount& one : cells_[i].counts) {
      const double level = one.level / unit_of(person.standard);
      auto known = std::find_if(own.begin(), own.end(), [&](const HierarchicalCell& cell) {
        return cell.level == level && cell.second_half == one.second_half;
      });
      if (known == own.end())
        known = own.insert(own.end(), {number_[i], to_fit_[place(person)], level, 0, 0, one.second_half});
      known->positive += one.positive;
      known->negative += one.negative;
      known->sure_positive += one.sure_positive;
      known->sure_negative += one.sure_negative;
    }
    for (const HierarchicalCell& cell : own) {
      if (model_.pse_at_standard)
        add_without_bias(cells, cell);
      else
        cells.push_back(cell);
    }
  }
  return cells;
}

HierarchicalSpread spread_of(SpreadStatus status, double sd) {
  const bool unknown = status == SpreadStatus::not_identified || status == SpreadStatus::not_asked;
  return {status, unknown ? kNaN : sd};
}

void StudyFit::add_spreads(const HierarchicalFit& fit) {
  model_.persons = spread_of(fit.tu, fit.maximum.place.tu);
  model_.by_condition = spread_of(fit.tv, fit.tv == SpreadStatus::by_condition ? kNaN : fit.maximum.place.tv);
  model_.criteria = spread_of(fit.tw, fit.maximum.place.tw);
}

// rows: of model_.conditions.
void StudyFit::set_conditions(std::vector<HierarchicalCondition>& rows, const std::vector<ConditionMean>& found) const {
  for (std::size_t i = 0; i < found.size(); ++i) {
    const ConditionMean& mean = found[i];
    HierarchicalCondition& one = rows[fitted_rows_[i]];
    const double unit = unit_of(one.standard), jnd = answer_model_.jnd_of_s * unit,
                 standard = standard_of(one.standard);
    one.status = mean.status;
    one.spread = spread_of(mean.tv_status, mean.tv);
    one.jnd = jnd * std::exp(mean.mu);
    one.ci_low = jnd * std::exp(mean.ends.low);
    one.ci_high = jnd * std::exp(mean.ends.high);
    one.ci_status = mean.ends.status;
    if (standard > 0) one.weber = one.jnd / standard;
    if (!choices()) one.criterion = mean.criterion;
    if (!choices() || model_.pse_at_standard || mean.status != SlopeStatus::ok) continue;
    one.criterion = unit * mean.criterion;
    one.pse = standard + one.criterion;
    one.pse_low = standard + unit * mean.criterion_ends.low;
    one.pse_high = standard + unit * mean.criterion_ends.high;
    one.pse_status = mean.criterion_ends.status;
  }
}

void StudyFit::add_variants(const std::vector<HierarchicalCell>& cells, const HierarchicalModel& of,
                            const VariantWork& work) {
  for (ModelVariant& found : model_variants(cells, of, work)) {
    HierarchicalVariant& one = model_.variants.emplace_back();
    one.kind = found.kind;
    one.shared = std::move(found.shared);
    for (const HierarchicalCondition& row : model_.conditions)
      one.conditions.push_back(
          {.condition = row.condition, .standard = row.standard, .participants = row.participants});
    set_conditions(one.conditions, found.conditions);
    if (found.kind != VariantKind::lapse) continue;
    if (std::string caution = lapse_caution(one.shared.front()); !caution.empty())
      model_.cautions.push_back(std::move(caution));
  }
}

int StudyFit::in_both(std::size_t a, std::size_t b) const {
  std::vector<int> rows(static_cast<std::size_t>(model_.participants), 0);
  for (std::size_t i = 0; i < cells_.size(); ++i)
    if (number_[i] >= 0 && (place(cells_[i].person) == a || place(cells_[i].person) == b))
      ++rows[static_cast<std::size_t>(number_[i])];
  return static_cast<int>(std::count(rows.begin(), rows.end(), 2));
}

// Of two places in the fit: conditions at one standard.
std::vector<std::pair<std::size_t, std::size_t>> StudyFit::pairs() const {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < fitted_rows_.size(); ++a)
    for (std::size_t b = a + 1; b < fitted_rows_.size(); ++b)
      if (model_.conditions[fitted_rows_[a]].standard == model_.conditions[fitted_rows_[b]].standard)
        pairs.emplace_back(a, b);
  return pairs;
}

void StudyFit::add_ratios(const std::vector<ConditionDifference>& differences) {
  for (const ConditionDifference& found : differences) {
    const HierarchicalCondition& of_a = model_.conditions[fitted_rows_[found.a]];
    HierarchicalRatio& one = model_.ratios.emplace_back();
    one.a = of_a.condition;
    one.b = model_.conditions[fitted_rows_[found.b]].condition;
    one.standard = of_a.standard;
    one.participants = in_both(fitted_rows_[found.a], fitted_rows_[found.b]);
    one.defined = !std::isnan(found.difference);
    one.ratio = std::exp(found.difference);
    one.ci_low = std::exp(found.ends.low);
    one.ci_high = std::exp(found.ends.high);
    one.ci_status = found.ends.status;
    one.lr = found.lr;
    one.p = found.p;
  }
}

void StudyFit::add_people(const std::vector<PersonEstimate>& people) {
  const bool alike = model_.alike();  // what integrals round is no difference between people
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    HierarchicalPerson& one = model_.people[i];
    if (number_[i] < 0) continue;
    const std::size_t row = place(one);
    const HierarchicalCondition& group = model_.conditions[row];
    const PersonEstimate& found =
        people[static_cast<std::size_t>(number_[i]) * fitted_rows_.size() + static_cast<std::size_t>(to_fit_[row])];
    const double unit = unit_of(one.standard), jnd = answer_model_.jnd_of_s * unit;
    one.alone_status = found.status;
    one.alone = jnd * std::exp(found.alone);
    if (!std::isnan(group.criterion)) one.criterion = choices() ? unit * found.criterion : found.criterion;
    one.status = ShrunkenStatus::no_group_jnd;
    if (group.status != SlopeStatus::ok) continue;
    one.status = ShrunkenStatus::ok;
    one.jnd = alike ? group.jnd : jnd * std::exp(found.mean);
    if (!alike) one.ln_sd = found.sd;
  }
}

StudyHierarchical StudyFit::fitted(std::string separate, bool given_levels) {
  model_.separate = std::move(separate);
  for (const AnsweredCell& cell : cells_) model_.people.push_back(cell.person);
  model_.reason = refusal();
  if (model_.status != HierarchicalStatus::ok) return model_;
  HierarchicalModel of;
  of.response = answer_model_.response;
  of.shared.lapse = answer_model_.lapse;
  of.tw = !model_.pse_at_standard;
  of.own_tv = protocol_.analysis.own_spreads;
  std::vector<HierarchicalCell> answered = cells_of_fit();
  model_.gathered = pooled(answered);
  HierarchicalAnalysis fitted(without_halves_and_sureness(answered), of);
  const HierarchicalFit& fit = fitted.fit();
  const double of_fit = fitted.work();
  const int processors = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  fitted.complete({.intervals = true, .pairs = pairs(), .most_work = kCommandWork}, processors);
  if (!fit.maximum.converged) {
    model_.status = HierarchicalStatus::not_converged;
    model_.reason = "the search for the largest likelihood did not settle";
  }
  model_.exact = fit.exact;
  model_.log_likelihood = fit.maximum.log_likelihood;
  model_.cautions = hierarchical_cautions(fit, names(), model_.gathered);
  add_spreads(fit);
  set_conditions(model_.conditions, fit.conditions);
  add_people(fitted.people());
  add_ratios(fit.differences);
  const auto has = [&fit](auto... statuses) {
    return std::any_of(fit.conditions.begin(), fit.conditions.end(),
                       [&](const ConditionMean& one) { return (... || (one.status == statuses)); });
  };
  const auto people = static_cast<std::size_t>(model_.participants);
  if (has(SlopeStatus::ok) && !has(SlopeStatus::no_sensitivity, SlopeStatus::ceiling) && people >= kLeastInVariants &&
      people <= kMostInDetail)
    add_variants(answered, of, {2 * kCommandWork - fitted.work(), 3 * of_fit});
  if (standards_.size() > 1) return model_;
  model_.equal_lr = fit.lr;
  model_.equal_p = fit.p;
  model_.equal_df = fit.df;
  if (given_levels && static_cast<std::size_t>(model_.participants) <= kMostInDetail)
    add_check(fitted.cells(), of, fit.maximum.place);
  return model_;
}

void StudyFit::add_check(const std::vector<HierarchicalCell>& cells, const HierarchicalModel& of,
                         const HierarchicalPlace& place) {
  constexpr std::uint64_t kCheckSeed = 1;  // the same for every study of the same answers
  model_.check = predictive_check(cells, of, place, kPredictiveDraws, kCheckSeed);
  for (PredictiveRow& row : model_.check->rows) row.condition = fitted_rows_[row.condition];
}

JndStatus status_of(SlopeStatus alone) {
  switch (alone) {
    case SlopeStatus::ok:
      return JndStatus::ok;
    case SlopeStatus::no_sensitivity:
      return JndStatus::no_sensitivity;
    case SlopeStatus::ceiling:
    case SlopeStatus::perfect:
      return JndStatus::ceiling;
    default:
      return JndStatus::no_information;
  }
}

// Where what is registered is no JND, the one by the model's own observer is each participant's.
void take_alone(StudyHierarchical& model) {
  for (HierarchicalPerson& one : model.people) {
    if (one.alone_status == SlopeStatus::missing) continue;
    one.separate = one.alone;
    one.separate_status = status_of(one.alone_status);
  }
}

// A task's own statuses, in the words that all studies share.
JndStatus status_of(const TaskEstimate& estimate, const std::string& status) {
  if (estimate.value && std::isfinite(*estimate.value)) return JndStatus::ok;
  if (estimate.beyond != Beyond::no)
    return estimate.beyond == Beyond::above ? JndStatus::no_sensitivity : JndStatus::ceiling;
  return status == "separated" ? JndStatus::ceiling
         : status == "flat"    ? JndStatus::no_sensitivity
                               : JndStatus::no_information;
}

std::string separate_words(const TaskResults& results, bool registered, const Protocol& protocol) {
  if (!results.cells.empty()) return describe(results.pairs.method);
  return registered && has_posterior_threshold(protocol) ? "the posterior of the procedure's own response model"
                                                         : "maximum likelihood";
}

}  // namespace

StudyHierarchical study_hierarchical(const TaskResults& results, const Protocol& protocol) {
  const std::optional<AnswerModel> answers = task_of(protocol.task.kind).answer_model(protocol);
  std::size_t jnd = 0;
  const std::string_view key = answers.value_or(AnswerModel()).jnd;
  while (jnd < results.outcomes.size() && results.outcomes[jnd].key != key) ++jnd;
  const bool registered = jnd < results.outcomes.size();  // what is measured is a JND
  std::vector<AnsweredCell> cells;
  for (const TaskEstimateRow& row : results.estimates) {
    AnsweredCell& cell = cells.emplace_back();
    cell.person.participant = row.participant;
    cell.person.group = row.group;
    cell.person.condition = row.condition;
    cell.person.standard = row.standard;
    cell.counts = row.answers;
    if (!registered) continue;
    const TaskEstimate& estimate = row.estimates.values[jnd];
    cell.person.separate_status = status_of(estimate, row.estimates.status);
    if (cell.person.separate_status == JndStatus::ok) cell.person.separate = *estimate.value;
  }
  const bool given =
      !results.cells.empty() && std::all_of(results.cells.begin(), results.cells.end(), [](const CellResult& cell) {
        return cell.difference_source == DifferenceSource::nominal;
      });
  StudyHierarchical model =
      StudyFit(std::move(cells), protocol).fitted(separate_words(results, registered, protocol), given);
  if (!registered) take_alone(model);
  return model;
}

void add_without_bias(std::vector<HierarchicalCell>& cells, HierarchicalCell cell) {
  cell.positive /= 2;
  cell.negative /= 2;
  cells.push_back(cell);
  cell.level = -cell.level;
  std::swap(cell.positive, cell.negative);
  cells.push_back(cell);
}

std::string hierarchical_assumptions(const StudyHierarchical& model) {
  const bool own = model.by_condition.status == SpreadStatus::by_condition;
  if (model.response != ResponseModel::choice) return hierarchical_assumptions(own);
  return fmt::format(
      "Assumed: ln JND differs between people{} as normal distributions do, by {}, nobody favours an interval or a side, and "
      "nobody's answers change during the study.",
      model.pse_at_standard ? "" : ", and their PSEs do,", spreads_assumed(own));
}

std::string_view status_word(const StudyHierarchical& model, const HierarchicalCondition& row) noexcept {
  return model.fitted() && row.status != SlopeStatus::ok ? word_of(kSlopeStatusWords, row.status)
                                                         : word_of(kHierarchicalStatusWords, model.status);
}

std::size_t row_of(const StudyHierarchical& model, const Protocol& protocol, int condition, int standard) noexcept {
  const std::size_t of_condition = model.conditions.size() / protocol.conditions.size();
  return static_cast<std::size_t>(condition) * of_condition + static_cast<std::size_t>(standard);
}

std::string jnd_title(const Protocol& protocol) {
  const std::optional<AnswerModel> answers = task_of(protocol.task.kind).answer_model(protocol);
  for (const TaskOutcome& outcome : measured_outcomes(protocol))
    if (answers && outcome.key == answers->jnd) return std::string(outcome.title);
  return "JND";
}

}  // namespace jnd
