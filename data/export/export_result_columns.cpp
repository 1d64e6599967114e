// Columns of the files that hold results: cells, report, group, contrasts; and of answers, sessions and the dictionary.
#include <cmath>

#include "data/export/column_makers.h"
#include "data/export/export_tables.h"
#include "protocols/version.h"

namespace jnd {

namespace {

constexpr const char* kKinds = "real pilot simulated";

std::string condition_name(const Protocol& protocol, int condition) {
  return csv_text(protocol.conditions.at(static_cast<std::size_t>(condition)).name);
}

std::string caution_names(const JndEstimate& estimate) {
  std::string names;
  for (const Caution caution : estimate.cautions) names.append(names.empty() ? "" : " ").append(to_string(caution));
  return names;
}

// A field that carries the study's unit in its name, and the unit for the dictionary.
std::string in_unit(const std::string& name, const Protocol& protocol) {
  return name + std::string(name_suffix(protocol.stimulus.unit));
}

std::string unit_of(const Protocol& protocol) {
  return std::string(to_string(protocol.stimulus.unit));
}

// The convention behind a number stands in every row that holds one.
template <typename Row>
void add_convention(std::vector<CsvColumn<Row>>& columns, const Protocol& protocol, bool with_method) {
  columns.push_back({"difference_source", "the stiffness differences behind the JND: as asked, or as delivered", "",
                     with_method ? "nominal delivered mixed" : "nominal delivered",
                     [](const Row& r) { return std::string(to_string(r.difference_source)); }});
  // The d' of a cell is the yes-no model's whatever is registered: models.csv and the thresholds have the others.
  columns.push_back({"model", "model of d'", "", with_method ? "yes-no differencing independent-observation" : "yes-no",
                     [m = with_method ? protocol.analysis.model : std::string("yes-no")](const Row&) { return m; }});
  columns.push_back({"correction", "correction of rates of 0 and 1", "", "none loglinear half",
                     [c = protocol.analysis.correction](const Row&) { return c; }});
  if (with_method)
    columns.push_back({"method", "how the JND comes from d' at several differences", "",
                       "least_squares ml weighted inverse_mean_slope mean_of_ratios",
                       [m = protocol.analysis.jnd_method](const Row&) { return m; }});
  columns.push_back({"protocol_sha256", "SHA-256 of the protocol's bytes", "", "",
                     [sha = protocol.sha256](const Row&) { return sha; }});
}

template <typename Row, typename Estimate>
void add_mean(std::vector<CsvColumn<Row>>& columns, const std::string& prefix, const std::string& suffix,
              const std::string& meaning, const std::string& unit, Estimate estimate) {
  const auto add = [&](const char* part, const std::string& text, auto member) {
    columns.push_back({prefix + part + suffix, text + meaning, unit, "",
                       [estimate, member](const Row& r) { return csv_number(estimate(r).*member); }});
  };
  columns.push_back({"n_" + prefix.substr(0, prefix.size() - 1), "participants in the mean of " + meaning, "", "",
                     [estimate](const Row& r) { return csv_number(estimate(r).n); }});
  add("mean", "mean of ", &MeanEstimate::mean);
  add("sd", "standard deviation (n - 1) of ", &MeanEstimate::sd);
  add("ci95_low", "lower end of the 95 % interval (Student t) of the mean of ", &MeanEstimate::ci_low);
  add("ci95_high", "upper end of the 95 % interval (Student t) of the mean of ", &MeanEstimate::ci_high);
}

}  // namespace

std::vector<CsvColumn<CellResult>> cell_columns(const Protocol& protocol) {
  using R = CellResult;
  std::vector<CsvColumn<R>> columns = {
      {"participant", "code of the participant", "", "", [](const R& r) { return csv_text(r.participant); }},
      {"kind", "kind of the sessions", "", kKinds, [](const R& r) { return std::string(to_string(r.kind)); }},
      {"condition", "feedback condition", "", "",
       [&protocol](const R& r) { return condition_name(protocol, r.condition); }},
      {"series", "series", "", "",
       [&protocol](const R& r) { return csv_text(protocol.series.at(static_cast<std::size_t>(r.series)).name); }},
      {in_unit("difference_", protocol), "stiffness difference of the series, as asked", unit_of(protocol), "",
       [&protocol](const R& r) {
         const auto& pair = protocol.series.at(static_cast<std::size_t>(r.series)).pair;
         return csv_number(std::abs(pair[1] - pair[0]));
       }},
      {in_unit("delivered_difference_", protocol),
       "mean delivered difference |k2 - k1| of the counted trials with different stimuli; empty without one",
       unit_of(protocol), "", [](const R& r) { return csv_number(r.delivered_difference.mean); }},
      {"n_delivered", "trials in that mean", "", "", [](const R& r) { return csv_number(r.delivered_difference.n); }},
      {"n_without_fit", "trials left out of it: no stiffness could be fitted in one of their intervals", "", "",
       [](const R& r) { return csv_number(r.without_fit); }},
      {in_unit("delivered_softer_", protocol), "mean delivered stiffness where the softer one was asked",
       unit_of(protocol), "", [](const R& r) { return csv_number(r.delivered[0].mean); }},
      {"n_softer", "intervals in that mean", "", "", [](const R& r) { return csv_number(r.delivered[0].n); }},
      {in_unit("delivered_stiffer_", protocol), "mean delivered stiffness where the stiffer one was asked",
       unit_of(protocol), "", [](const R& r) { return csv_number(r.delivered[1].mean); }},
      {"n_stiffer", "intervals in that mean", "", "", [](const R& r) { return csv_number(r.delivered[1].n); }},
      {"n_diff", "counted trials with different stimuli", "", "",
       [](const R& r) { return csv_number(r.counts.n_diff); }},
      {"hits", "of them answered different", "", "", [](const R& r) { return csv_number(r.counts.hits); }},
      {"n_same", "counted trials with equal stimuli", "", "", [](const R& r) { return csv_number(r.counts.n_same); }},
      {"false_alarms", "of them answered different", "", "",
       [](const R& r) { return csv_number(r.counts.false_alarms); }},
      {"excluded", "trials left out by registered rules", "", "", [](const R& r) { return csv_number(r.excluded); }},
      {"missing", "planned trials without an answer", "", "", [](const R& r) { return csv_number(r.missing); }},
      {"raw_hit_rate", "hits / n_diff", "", "", [](const R& r) { return csv_number(r.yes_no.raw_hit_rate); }},
      {"raw_false_alarm_rate", "false_alarms / n_same", "", "",
       [](const R& r) { return csv_number(r.yes_no.raw_false_alarm_rate); }},
      {"hit_rate", "corrected hit rate", "", "", [](const R& r) { return csv_number(r.yes_no.hit_rate); }},
      {"false_alarm_rate", "corrected false-alarm rate", "", "",
       [](const R& r) { return csv_number(r.yes_no.false_alarm_rate); }},
      {"z_hit", "normal quantile of hit_rate", "", "", [](const R& r) { return csv_number(r.yes_no.z_hit); }},
      {"z_false_alarm", "normal quantile of false_alarm_rate", "", "",
       [](const R& r) { return csv_number(r.yes_no.z_false_alarm); }},
      {"dprime", "d' = z_hit - z_false_alarm", "", "", [](const R& r) { return csv_number(r.yes_no.dprime); }},
      {"dprime_se", "standard error of dprime (Gourevitch and Galanter 1967)", "", "",
       [](const R& r) { return csv_number(r.yes_no.se); }},
      {"dprime_ci95_low", "lower end of its 95 % interval, dprime - 1.96 dprime_se", "", "",
       [](const R& r) { return csv_number(r.yes_no.ci_low); }},
      {"dprime_ci95_high", "upper end", "", "", [](const R& r) { return csv_number(r.yes_no.ci_high); }},
      {"criterion", "c = -(z_hit + z_false_alarm) / 2; positive: tends to say same", "", "",
       [](const R& r) { return csv_number(r.yes_no.criterion); }},
      {"status", "whether the row holds information", "", "ok no_information missing",
       [](const R& r) { return std::string(to_string(r.yes_no.status)); }}};
  add_convention(columns, protocol, false);
  return columns;
}

std::vector<CsvColumn<ThresholdResult>> report_columns(const Protocol& protocol) {
  using R = ThresholdResult;
  std::vector<CsvColumn<R>> columns = {
      {"participant", "code of the participant", "", "", [](const R& r) { return csv_text(r.participant); }},
      {"kind", "kind of the sessions", "", kKinds, [](const R& r) { return std::string(to_string(r.kind)); }},
      {"condition", "feedback condition", "", "",
       [&protocol](const R& r) { return condition_name(protocol, r.condition); }},
      {"series_used", "series in the fit", "", "", [](const R& r) { return csv_number(r.jnd.series_used); }},
      {in_unit("slope_per_", protocol), "slope of d' on the stiffness difference, through the origin",
       protocol.stimulus.unit == StiffnessUnit::n_per_m ? "m/N" : "rad/N", "",
       [](const R& r) { return csv_number(r.jnd.slope); }},
      {in_unit("jnd_", protocol), "just-noticeable difference: 1 / slope; empty where status says why",
       unit_of(protocol), "", [](const R& r) { return csv_number(r.jnd.jnd); }},
      {in_unit("jnd_ci95_low_", protocol),
       "lower end of its 95 % interval: bootstrap of least squares, profile likelihood of ml; empty for other methods",
       unit_of(protocol), "", [](const R& r) { return csv_number(r.jnd.ci_low); }},
      {in_unit("jnd_ci95_high_", protocol), "upper end; Inf where no sensitivity cannot be ruled out",
       unit_of(protocol), "", [](const R& r) { return csv_number(r.jnd.ci_high); }},
      {"weber", in_unit("jnd_", protocol) + " / " + in_unit("reference_", protocol), "", "",
       [](const R& r) { return csv_number(r.jnd.weber); }},
      {in_unit("reference_", protocol), "base of the Weber fraction", unit_of(protocol), "",
       [k = protocol.stimulus.reference](const R&) { return csv_number(k); }},
      {"status", "what the estimate is", "", kJndStatuses,
       [](const R& r) { return std::string(to_string(r.jnd.status)); }},
      {"cautions", "remarks, separated by blanks; none of them excludes anything", "",
       "extrapolated floor few_trials series_missing", [](const R& r) { return caution_names(r.jnd); }},
      {"median_response_time_s", "median of the times that the participant entered; empty without one", "s", "",
       [](const R& r) { return csv_number(r.median_response_time_s); }},
      {"mean_trial_s", "mean time of a counted trial; empty without one", "s", "",
       [](const R& r) { return csv_number(r.mean_trial_s); }}};
  add_convention(columns, protocol, true);
  return columns;
}

std::vector<CsvColumn<GroupResult>> group_columns(const Protocol& protocol, SessionKind kind) {
  using R = GroupResult;
  std::vector<CsvColumn<R>> columns = {
      {"condition", "feedback condition", "", "",
       [&protocol](const R& r) { return condition_name(protocol, r.condition); }},
      {"kind", "kind of the sessions", "", kKinds, [kind](const R&) { return std::string(to_string(kind)); }},
      {"participants", "participants with a row in this condition (N)", "", "",
       [](const R& r) { return csv_number(r.jnd.n); }}};
  add_mean(columns, "jnd_", in_unit("_", protocol), "the JND over status ok", unit_of(protocol),
           [](const R& r) { return r.jnd.mean_jnd; });
  columns.push_back(
      {"n_median", "participants in the median", "", "", [](const R& r) { return csv_number(r.jnd.median_n); }});
  columns.push_back({in_unit("jnd_median_", protocol), "median JND; Inf or empty where its status says why",
                     unit_of(protocol), "", [](const R& r) { return csv_number(r.jnd.median_jnd); }});
  columns.push_back({"jnd_median_status", kMedianStatus, "", kJndStatuses,
                     [](const R& r) { return std::string(to_string(r.jnd.median_status)); }});
  add_mean(columns, "log_jnd_", "", "ln(JND / (" + unit_of(protocol) + ")) over status ok", "",
           [](const R& r) { return r.jnd.mean_log_jnd; });
  columns.push_back(
      {"n_slope", "participants with a finite slope", "", "", [](const R& r) { return csv_number(r.jnd.slope_n); }});
  columns.push_back({in_unit("inverse_mean_slope_", protocol),
                     "1 / mean slope over all finite slopes; empty where that is not positive", unit_of(protocol), "",
                     [](const R& r) { return csv_number(r.jnd.inverse_mean_slope); }});
  add_mean(columns, "weber_", "", "the Weber fraction over status ok", "", [](const R& r) { return r.jnd.mean_weber; });
  columns.push_back({"n_ok", "participants with status ok", "", "", [](const R& r) {
                       return csv_number(r.jnd.n - r.jnd.no_sensitivity - r.jnd.ceiling - r.jnd.no_information);
                     }});
  columns.push_back({"n_no_sensitivity", "participants with status no_sensitivity", "", "",
                     [](const R& r) { return csv_number(r.jnd.no_sensitivity); }});
  columns.push_back(
      {"n_ceiling", "participants with status ceiling", "", "", [](const R& r) { return csv_number(r.jnd.ceiling); }});
  columns.push_back({"n_no_information", "participants with status no_information", "", "",
                     [](const R& r) { return csv_number(r.jnd.no_information); }});
  add_convention(columns, protocol, true);
  return columns;
}

std::vector<CsvColumn<ContrastRow>> contrast_columns(const Protocol& protocol, SessionKind kind) {
  using R = ContrastRow;
  std::vector<CsvColumn<R>> columns = {
      {"condition_a", "first condition", "", "", [&protocol](const R& r) { return condition_name(protocol, r.a); }},
      {"condition_b", "second condition", "", "", [&protocol](const R& r) { return condition_name(protocol, r.b); }},
      {"kind", "kind of the sessions", "", kKinds, [kind](const R&) { return std::string(to_string(kind)); }},
      {"outcome", "the scale of every number in the row", "", "slope jnd log_jnd threshold",
       [](const R& r) { return r.outcome; }},
      {"unit", "unit of the differences in the row; empty where they have none", "", "",
       [](const R& r) { return r.unit; }},
      {"registered", "1 on the scale of the registered tests; 0 where the JND stands beside it", "", "0 1",
       [](const R& r) { return csv_flag(r.registered); }},
      {"participants", "participants (N)", "", "", [](const R& r) { return csv_number(r.participants); }}};
  add_mean(columns, "difference_", "", "a - b within the participants who have both", "",
           [](const R& r) { return r.difference; });
  columns.push_back({"p", "of the registered contrast, corrected as registered; empty where not registered or refused",
                     "", "", [](const R& r) { return csv_number(r.p); }});
  if (!protocol.design.procedure) add_convention(columns, protocol, true);
  return columns;
}

std::vector<CsvColumn<ExportAnswer>> answer_columns() {
  using R = ExportAnswer;
  return {
      {"participant", "code of the participant", "", "", [](const R& r) { return csv_text(r.session.participant); }},
      {"session", "session of the answer", "", "", [](const R& r) { return csv_text(r.session.id); }},
      {"session_number", "which of the participant's sessions, from 1", "", "",
       [](const R& r) { return csv_number(r.session.number); }},
      {"kind", "kind of the session", "", kKinds, [](const R& r) { return std::string(to_string(r.session.kind)); }},
      {"utc", "when the answer was saved, ISO 8601", "", "", [](const R& r) { return r.utc; }},
      {"question", "identifier of the question", "", "", [](const R& r) { return csv_text(r.question); }},
      {"asked", "when it is asked", "", "before_session after_condition after_series after_session",
       [](const R& r) { return csv_text(r.asked); }},
      {"condition", "the condition that it is about; empty where it is about none", "", "",
       [](const R& r) { return csv_text(r.condition); }},
      {"after_trial", "main trials planned before it; 0 before and after the session", "", "",
       [](const R& r) { return csv_number(r.after_trial); }},
      {"answered", "0 where a question that is not required was left out", "", "0 1",
       [](const R& r) { return csv_flag(r.answered); }},
      {"answer", "the answer as given", "", "", [](const R& r) { return csv_text(r.answer); }},
      {"text", "the question as asked", "", "", [](const R& r) { return csv_text(r.text); }}};
}

std::vector<CsvColumn<SessionInfo>> session_columns(const std::string& seed, const std::string& study_head,
                                                    const Protocol& protocol) {
  using R = SessionInfo;
  return {
      {"participant", "code of the participant", "", "", [](const R& r) { return csv_text(r.participant); }},
      {"participant_number", "number of the plan", "", "", [](const R& r) { return csv_number(r.participant_number); }},
      {"session", "identifier of the session", "", "", [](const R& r) { return csv_text(r.id); }},
      {"session_number", "which of the participant's sessions, from 1", "", "",
       [](const R& r) { return csv_number(r.number); }},
      {"kind", "kind of the session", "", kKinds, [](const R& r) { return std::string(to_string(r.kind)); }},
      {"language", "language of the participant; empty where none was chosen", "", "",
       [](const R& r) { return csv_text(r.language); }},
      {"excluded", "whether the participant was excluded: nothing of theirs is in the other files", "", "0 1",
       [](const R& r) { return csv_flag(r.excluded); }},
      {"state", "whether it is finished", "", "open closed", [](const R& r) { return r.state; }},
      {"responder", "who or what answered", "", "", [](const R& r) { return csv_text(r.responder); }},
      {"started", "when it was opened, ISO 8601", "", "", [](const R& r) { return csv_text(r.started); }},
      {"ended", "when it was closed, ISO 8601; empty while open", "", "", [](const R& r) { return csv_text(r.ended); }},
      {"trials_done", "main trials answered", "", "", [](const R& r) { return csv_number(r.trials_done); }},
      {"trials_voided", "attempts voided, practice included", "", "",
       [](const R& r) { return csv_number(r.trials_voided); }},
      {"trials_total", "main trials planned", "", "", [](const R& r) { return csv_number(r.trials_total); }},
      {"head", "hash of its last event: names everything before it", "", "", [](const R& r) { return r.head; }},
      {"study_head",
       "hash of the last event of the study's own chain: names every exclusion, unblinding and closing before it", "",
       "", [study_head](const R&) { return study_head; }},
      {"seed", "seed of the study; empty while it is sealed", "", "", [seed](const R&) { return seed; }},
      {"protocol", "name of the protocol", "", "", [n = protocol.name](const R&) { return csv_text(n); }},
      {"protocol_sha256", "SHA-256 of the protocol's bytes", "", "", [sha = protocol.sha256](const R&) { return sha; }},
      {"exported_by", "version of the program that wrote these files", "", "",
       [](const R&) { return std::string("jnd ") + kVersion; }}};
}

std::vector<CsvColumn<DictionaryRow>> dictionary_columns() {
  using R = DictionaryRow;
  return {
      {"file", "file of the export; sub-* stands for every participant's folder", "", "",
       [](const R& r) { return r.file; }},
      {"column", "column of the file", "", "", [](const R& r) { return r.column; }},
      {"meaning", "what it holds", "", "", [](const R& r) { return csv_text(r.meaning); }},
      {"unit", "unit of numbers; empty for text, counts, shares and flags", "", "", [](const R& r) { return r.unit; }},
      {"levels", "values that text and flags can have, separated by blanks", "", "",
       [](const R& r) { return r.levels; }}};
}

}  // namespace jnd
