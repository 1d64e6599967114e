#include "data/results/study_hierarchical.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace jnd {

namespace {

// Where participants and conditions with trials stand among those that the model counts; -1 without trials.
struct ModelPlaces {
  std::vector<int> of_threshold;  // the participant of each row of StudyAnalysis::thresholds
  std::vector<int> of_condition;
  std::vector<int> conditions;  // by the model's place: the protocol's
  int participants = 0;
};

// The answers at each difference; those to equal stimuli stand at a difference of 0, a row for each series.
struct ModelAnswers {
  ModelPlaces places;
  std::vector<HierarchicalCell> cells;
};

// Delivered differences are hardly twice the same, and the fit takes as long as there are different ones.
double level_of(const CellResult& cell, double step) {
  return cell.difference_source == DifferenceSource::nominal ? cell.difference
                                                             : step * std::round(cell.difference / step);
}

double step_of(const StudyAnalysis& analysis) {
  double largest = 0;
  for (const CellResult& cell : analysis.cells) largest = std::max(largest, cell.difference);
  return largest / kDeliveredSteps;
}

std::int64_t trials_of(const Counts& counts) noexcept {
  return counts.n_diff + counts.n_same;
}

ModelAnswers answers_of(const StudyAnalysis& analysis, const Protocol& protocol) {
  ModelAnswers answers;
  ModelPlaces& places = answers.places;
  const std::size_t series = protocol.series.size();
  const double step = step_of(analysis);
  places.of_condition.assign(protocol.conditions.size(), -1);
  for (const CellResult& cell : analysis.cells)
    if (trials_of(cell.counts) > 0) places.of_condition[static_cast<std::size_t>(cell.condition)] = 0;
  for (std::size_t condition = 0; condition < places.of_condition.size(); ++condition) {
    if (places.of_condition[condition] < 0) continue;
    places.of_condition[condition] = static_cast<int>(places.conditions.size());
    places.conditions.push_back(static_cast<int>(condition));
  }
  // Rows of a participant stand together.
  const std::vector<ThresholdResult>& rows = analysis.thresholds;
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t end = first;
    while (end < rows.size() && rows[end].participant == rows[first].participant) ++end;
    bool any = false;
    for (std::size_t i = first * series; i < end * series; ++i) {
      const CellResult& cell = analysis.cells[i];
      const Counts& counts = cell.counts;
      if (trials_of(counts) == 0) continue;
      any = true;
      const int condition = places.of_condition[static_cast<std::size_t>(cell.condition)];
      const auto add = [&](double level, int positive, int trials) {
        if (trials > 0)
          answers.cells.push_back({places.participants, condition, level, static_cast<double>(positive),
                                   static_cast<double>(trials - positive)});
      };
      add(level_of(cell, step), counts.hits, counts.n_diff);
      add(0, counts.false_alarms, counts.n_same);
    }
    places.of_threshold.insert(places.of_threshold.end(), end - first, any ? places.participants : -1);
    places.participants += any ? 1 : 0;
    first = end;
  }
  return answers;
}

bool has_trials(const StudyAnalysis& analysis, std::size_t threshold, std::size_t series) {
  return std::any_of(analysis.cells.begin() + static_cast<std::ptrdiff_t>(threshold * series),
                     analysis.cells.begin() + static_cast<std::ptrdiff_t>((threshold + 1) * series),
                     [](const CellResult& cell) { return trials_of(cell.counts) > 0; });
}

// What is known before anything is fitted: who answered, and the separate estimates.
void lay_out(StudyHierarchical& model, const StudyAnalysis& analysis, const Protocol& protocol) {
  const std::size_t conditions = protocol.conditions.size(), series = protocol.series.size();
  for (std::size_t condition = 0; condition < conditions; ++condition)
    model.conditions.push_back({.condition = static_cast<int>(condition)});
  for (std::size_t row = 0; row < analysis.thresholds.size(); ++row) {
    const ThresholdResult& threshold = analysis.thresholds[row];
    HierarchicalPerson person;
    person.participant = threshold.participant;
    person.group = threshold.group;
    person.condition = threshold.condition;
    person.separate_status = threshold.jnd.status;
    if (threshold.jnd.status == JndStatus::ok) person.separate = threshold.jnd.jnd;
    if (has_trials(analysis, row, series))
      ++model.conditions[static_cast<std::size_t>(threshold.condition)].participants;
    model.people.push_back(std::move(person));
  }
  for (const CellResult& cell : analysis.cells) model.trials += trials_of(cell.counts);
}

HierarchicalSpread spread_of(SpreadStatus status, double sd) {
  const bool known = status == SpreadStatus::ok || status == SpreadStatus::zero;
  return {status, known ? sd : kNaN};
}

void add_conditions(StudyHierarchical& model, const HierarchicalFit& fit, const ModelPlaces& places,
                    const Protocol& protocol) {
  for (std::size_t i = 0; i < places.conditions.size(); ++i) {
    const ConditionMean& found = fit.conditions[i];
    HierarchicalCondition& one = model.conditions[static_cast<std::size_t>(places.conditions[i])];
    one.status = found.status;
    one.jnd = std::exp(found.mu);
    one.ci_low = std::exp(found.ends.low);
    one.ci_high = std::exp(found.ends.high);
    one.weber = one.jnd / protocol.stimulus.reference;
    one.criterion = found.criterion;
  }
}

void add_ratios(StudyHierarchical& model, const std::vector<ConditionDifference>& differences,
                const ModelPlaces& places) {
  const auto rows = by_participant(model.people, model.conditions.size());
  for (const ConditionDifference& found : differences) {
    HierarchicalRatio& one = model.ratios.emplace_back();
    one.a = places.conditions[found.a];
    one.b = places.conditions[found.b];
    for (const ParticipantRows<HierarchicalPerson>& row : rows) {
      const auto counts = [&row](int condition) {
        const HierarchicalPerson* person = row.of[static_cast<std::size_t>(condition)];
        return person != nullptr && person->status != ShrunkenStatus::missing;
      };
      if (counts(one.a) && counts(one.b)) ++one.participants;
    }
    one.defined = !std::isnan(found.difference);
    one.ratio = std::exp(found.difference);
    one.ci_low = std::exp(found.ends.low);
    one.ci_high = std::exp(found.ends.high);
    one.lr = found.lr;
    one.p = found.p;
  }
}

void add_people(StudyHierarchical& model, const std::vector<PersonEstimate>& people, const StudyAnalysis& analysis,
                const Protocol& protocol, const ModelPlaces& places) {
  const bool alike = model.alike();  // what integrals round is no difference between people
  for (std::size_t row = 0; row < model.people.size(); ++row) {
    if (!has_trials(analysis, row, protocol.series.size())) continue;
    HierarchicalPerson& one = model.people[row];
    const auto condition = static_cast<std::size_t>(places.of_condition[static_cast<std::size_t>(one.condition)]);
    const PersonEstimate& found =
        people[static_cast<std::size_t>(places.of_threshold[row]) * places.conditions.size() + condition];
    one.alone_status = found.status;
    one.alone = std::exp(found.alone);
    one.criterion = found.criterion;
    one.status = ShrunkenStatus::no_group_jnd;
    if (model.conditions[static_cast<std::size_t>(one.condition)].status != SlopeStatus::ok) continue;
    one.status = ShrunkenStatus::ok;
    one.jnd = alike ? model.conditions[static_cast<std::size_t>(one.condition)].jnd : std::exp(found.mean);
    one.ln_sd = alike ? 0 : found.sd;
  }
}

// The same for every study of the same answers.
constexpr std::uint64_t kCheckSeed = 1;

void add_check(StudyHierarchical& model, const ModelAnswers& answers, const HierarchicalPlace& place,
               DifferenceSource by) {
  if (by != DifferenceSource::nominal || static_cast<std::size_t>(model.participants) > kMostInDetail) return;
  model.check = predictive_check(answers.cells, {.response = *model.response}, place, kPredictiveDraws, kCheckSeed);
  for (PredictiveRow& row : model.check->rows)
    row.condition = static_cast<std::size_t>(answers.places.conditions[row.condition]);
}

StudyHierarchical& refuse(StudyHierarchical& model, HierarchicalStatus status, std::string reason) {
  model.status = status;
  model.reason = std::move(reason);
  return model;
}

}  // namespace

std::optional<ResponseModel> registered_observer(const AnalysisPlan& plan) {
  if (plan.model == "yes-no") return ResponseModel::yes_no;
  if (plan.model == "differencing") return ResponseModel::differencing;
  return std::nullopt;
}

StudyHierarchical study_hierarchical(const StudyAnalysis& analysis, const Protocol& protocol) {
  StudyHierarchical model;
  lay_out(model, analysis, protocol);
  const ModelAnswers answers = answers_of(analysis, protocol);
  model.participants = answers.places.participants;
  model.response = registered_observer(protocol.analysis);
  if (!model.response)
    return refuse(model, HierarchicalStatus::not_offered,
                  fmt::format("there is none of the registered model of d', {}", protocol.analysis.model));
  if (static_cast<std::size_t>(model.participants) > kMostInDetail && !protocol.analysis.hierarchical)
    return refuse(model, HierarchicalStatus::too_many_people,
                  fmt::format("it is left out above {} participants; jnd calc hierarchical takes the trials of jnd "
                              "export",
                              kMostInDetail));
  if (std::none_of(answers.cells.begin(), answers.cells.end(), [](const auto& cell) { return cell.level > 0; }))
    return refuse(model, HierarchicalStatus::no_answers, "no trial with different stimuli counts");

  HierarchicalAnalysis fitted(answers.cells, {.response = *model.response});
  const HierarchicalFit& fit = fitted.fit();
  if (!fit.maximum.converged || (fit.df > 0 && !fit.common.converged))
    return refuse(model, HierarchicalStatus::not_converged, "the search for the largest likelihood did not settle");
  model.status = HierarchicalStatus::ok;
  model.persons = spread_of(fit.tu, fit.maximum.place.tu);
  model.by_condition = spread_of(fit.tv, fit.maximum.place.tv);
  model.criteria = spread_of(fit.tw, fit.maximum.place.tw);
  fitted.add_intervals();
  add_conditions(model, fit, answers.places, protocol);
  add_people(model, fitted.people(), analysis, protocol, answers.places);
  add_ratios(model, fitted.differences(), answers.places);
  model.equal_lr = fit.lr;
  model.equal_p = fit.p;
  model.equal_df = fit.df;
  add_check(model, answers, fit.maximum.place, analysis.by);
  return model;
}

std::string_view status_word(const StudyHierarchical& model, const HierarchicalCondition& row) noexcept {
  return model.status == HierarchicalStatus::ok ? word_of(kSlopeStatusWords, row.status)
                                                : word_of(kHierarchicalStatusWords, model.status);
}

}  // namespace jnd
