#include "protocols/planning/planned_precision.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "analysis/numerics/words.h"
#include "protocols/planning/allotment.h"
#include "protocols/tasks/task.h"

namespace jnd {

namespace {

constexpr double kForceWeber = 0.315, kVibrationWeber = 0.39, kKinaestheticWeber = 0.23;

double weber_of(const Cues& cues) noexcept {
  double precision = 0;
  if (cues.force) precision += 1 / (kForceWeber * kForceWeber);
  if (cues.vibration) precision += 1 / (kVibrationWeber * kVibrationWeber);
  if (cues.kinaesthetic) precision += 1 / (kKinaestheticWeber * kKinaestheticWeber);
  return precision > 0 ? 1 / std::sqrt(precision) : kVibrationWeber;  // without any cue: as the worst
}

// Draws of a participant in one condition and series: some seconds. A larger study is drawn less often; what follows
// from the number of studies is printed with it.
constexpr double kMostDraws = 1e7;
constexpr int kFewestExperiments = 1000;

int experiments_of(const PrecisionQuestion& question) {
  const double draws = static_cast<double>(question.jnds.size() * question.design.differences.size()) *
                       static_cast<double>(question.participants);
  return std::clamp(static_cast<int>(kMostDraws / draws), kFewestExperiments, question.experiments);
}

const Cues* cues_of(const Protocol& protocol, std::string_view condition) noexcept {
  for (const Condition& one : protocol.conditions)
    if (one.name == condition) return &one.cues;
  return nullptr;
}

}  // namespace

std::string_view to_string(JndSource source) noexcept {
  constexpr auto kWords = words<JndSource>(
      {{"published", JndSource::published}, {"assumed", JndSource::assumed}, {"asked", JndSource::asked}});
  return word_of(kWords, source);
}

PlannedJnd planned_jnd(const Protocol& protocol, std::string_view condition) {
  for (const PublishedValue& value : protocol.published)
    if (value.condition == condition && value.quantity == "jnd" && value.value > 0)
      return {value.value, JndSource::published};
  const Cues* const cues = cues_of(protocol, condition);
  return {weber_of(cues == nullptr ? Cues{} : *cues) * protocol.stimulus.reference, JndSource::assumed};
}

bool has_precision(const Protocol& protocol) noexcept {
  return !protocol.series.empty() && task_of(protocol.task.kind).evidence(protocol) == Evidence::counts;
}

CountsDesign counts_design(const Protocol& protocol) {
  CountsDesign design;
  for (const Series& series : protocol.series)
    design.differences.push_back(plain_distance(series.pair[0], series.pair[1]));
  design.trials = protocol.design.trials_per_cell;
  design.class_sizes = protocol.design.sampling == Sampling::balanced ? ClassSizes::balanced : ClassSizes::random;
  design.correction = correction_from(protocol.analysis.correction).value_or(Correction::loglinear);
  return design;
}

PrecisionQuestion precision_question(const Protocol& protocol) {
  PrecisionQuestion question;
  question.design = counts_design(protocol);
  for (const Condition& condition : protocol.conditions)
    question.jnds.push_back(planned_jnd(protocol, condition.name).value);
  for (const Contrast& contrast : protocol.analysis.contrasts) question.contrasts.push_back({contrast.a, contrast.b});
  if (question.contrasts.empty()) {
    const int conditions = static_cast<int>(protocol.conditions.size());
    for (int a = 0; a < conditions; ++a)
      for (int b = a + 1; b < conditions; ++b)
        if (anyone_has_both(protocol, a, b)) question.contrasts.push_back({a, b});
  }
  question.participants = protocol.design.participants;
  if (!everyone_has_all(protocol)) question.participants = std::max(1, question.participants / group_count(protocol));
  question.experiments = experiments_of(question);
  return question;
}

std::string precision_note(const Protocol& protocol) {
  const AnalysisPlan& analysis = protocol.analysis;
  std::string note;
  if (analysis.model != "yes-no" || analysis.jnd_method != "least_squares")
    note =
        fmt::format("the figures are for least-squares JNDs of yes-no d'; the protocol registers {} with the {} model",
                    analysis.jnd_method, analysis.model);
  if (analysis.by_delivered)
    note += fmt::format("{}the figures are for the nominal differences; the protocol registers the delivered ones",
                        note.empty() ? "" : "; ");
  if (analysis.hierarchical)
    note +=
        fmt::format("{}the figures are for separate JNDs; the protocol registers contrasts of the hierarchical model",
                    note.empty() ? "" : "; ");
  if (!everyone_has_all(protocol))
    note += fmt::format("{}groups get different conditions: the figures are for the participants of one",
                        note.empty() ? "" : "; ");
  return note;
}

}  // namespace jnd
