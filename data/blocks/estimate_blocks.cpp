// What was measured of every participant, and of the group.
#include <cmath>

#include <fmt/format.h>

#include "data/blocks/common_fields.h"
#include "data/blocks/result_blocks.h"
#include "data/fields/number_text.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/level_source.h"

namespace jnd {

namespace {

std::string tracks_words(const TrackCount& tracks) {
  if (tracks.used > 0 && tracks.used < tracks.all) return fmt::format("{} of {} tracks used", tracks.used, tracks.all);
  return tracks.unfinished > 0 ? fmt::format("{} of {} tracks unfinished", tracks.unfinished, tracks.all) : "";
}

// The convention behind a number stands in every row that holds one.
template <typename Row>
void add_convention(Fields<Row>& fields, const StudyResults& results, const Protocol& protocol) {
  if (results.task.cells.empty()) {
    fields.push_back(protocol_field<Row>(protocol));
    return;
  }
  fields.push_back(common<Row>("difference_source", [](const Row& r) { return r.difference_source; },
                               {.levels = "nominal delivered mixed"}));
  fields.push_back(common<Row>("model", [m = protocol.analysis.model](const Row&) { return m; },
                               {.levels = "yes-no differencing independent-observation"}));
  fields.push_back(common<Row>("correction", [c = protocol.analysis.correction](const Row&) { return c; },
                               {.levels = "none loglinear half"}));
  fields.push_back(common<Row>("method", [m = results.task.pairs.method.method](const Row&) { return m; }));
  fields.push_back(protocol_field<Row>(protocol));
}

// "JND: yes-no d' of loglinear rates, ..."; of the other tasks what the registered outcome means.
std::string method_note(const StudyResults& results, const Protocol& protocol) {
  const TaskResults& task = results.task;
  if (task.cells.empty()) {
    const TaskOutcome& outcome = task.outcomes[task.registered];
    return fmt::format("{}: {}", outcome.title, outcome.meaning);
  }
  return fmt::format("JND: {}, through the origin of the {} stiffness differences; Weber fraction = JND / {:g} {}",
                     describe(task.pairs.method), to_string(task.pairs.by), protocol.stimulus.reference,
                     to_string(protocol.stimulus.unit));
}

std::string interval_note(const TaskResults& task) {
  if (task.cells.empty()) return "";
  if (is_maximum_likelihood(task.pairs.method.method)) return "; 95 % CI: profile likelihood";
  if (!task.pairs.intervals) return "";
  return task.pairs.method.method == JndMethod::least_squares ? "; 95 % CI: parametric bootstrap, 2000 replicates"
                                                              : "; no interval for this method";
}

// What lies so far beyond the levels is nothing but that: a JND beyond it cannot be told from any other.
double limit_of(const Protocol& protocol, const TaskOutcome& outcome, std::string& text) {
  if (!outcome.positive || outcome.unit != to_string(protocol.stimulus.unit)) return 0;
  const double largest = largest_difference(protocol);
  if (!(largest > 0)) return 0;
  text = fmt::format("12 x {:g} {}", largest, outcome.unit);
  return 12 * largest;
}

Block estimates_block(const StudyResults& results, const Protocol& protocol) {
  using R = TaskEstimateRow;
  using F = Field<R>;
  const TaskResults& task = results.task;
  const bool several = judged_standard_count(protocol) > 1;
  Fields<R> fields = {common<R>("participant", &R::participant), common<R>("kind", &R::kind, {.levels = kSessionKinds}),
                      condition_field<R>(protocol, [](const R& r) { return r.condition; })};
  add_standard_fields(fields, protocol, [](const R& r) { return r.standard; });
  fields.insert(fields.end(), {common<R>("trials", &R::trials), common<R>("excluded", &R::excluded),
                               common<R>("missing", &R::missing),
                               common<R>("status", [](const R& r) { return r.estimates.status; })});
  Block block;
  block.columns = {{"participant"}};
  if (!protocol.groups.empty()) block.columns.push_back({"group"});
  block.columns.push_back({"condition"});
  if (several) block.columns.push_back({"standard"});
  block.columns.push_back({"trials"});
  for (std::size_t i = 0; i < task.outcomes.size(); ++i) {
    const TaskOutcome& outcome = task.outcomes[i];
    const std::string key(outcome.key), title(outcome.title);
    std::string limit_text;
    FieldTraits traits{.unit = outcome.unit};
    traits.limit = limit_of(protocol, outcome, limit_text);
    traits.limit_text = limit_text;
    traits.factor = outcome.may_lack ? slope_step(protocol) : 1;
    const std::string shown = outcome.may_lack
                                  ? fmt::format("d' per {} {}", slope_step(protocol), to_string(protocol.stimulus.unit))
                              : outcome.unit.empty() ? title
                                                     : fmt::format("{} {}", title, outcome.unit);
    traits.title = shown;
    if (outcome.of_standard) traits.shown = Shown::percent;
    fields.push_back(F(
        key, outcome.meaning, [i](const R& r) { return r.estimates.values[i].value.value_or(kNaN); }, traits));
    fields.push_back(F(
        key + "_ci_low", "lower end of the 95 % interval of " + key + "; empty where it has none",
        [i](const R& r) { return r.estimates.values[i].low.value_or(kNaN); }, traits));
    fields.push_back(F(
        key + "_ci_high", "upper end of that of " + key + "; Inf where the answers leave it open",
        [i](const R& r) { return r.estimates.values[i].high.value_or(kNaN); }, traits));
    if (outcome.own_status)
      fields.push_back(F(key + "_status", "ok, or why " + key + " is empty", [i](const R& r) {
        return r.estimates.values[i].value ? std::string("ok") : reason_without(r.estimates, i);
      }));
    block.columns.push_back({key});
    if (i == task.registered || key == "jnd") block.columns.push_back(range(key + "_ci_low", key + "_ci_high"));
  }
  if (!levels_given(protocol) && tracks_have_thresholds(protocol)) {
    fields.push_back(F("tracks_used", "tracks that a threshold of the tracks rests on",
                       [](const R& r) { return r.estimates.tracks.used; }));
    fields.push_back(F("tracks_unfinished",
                       "tracks with fewer reversals than are averaged; methods.md says what becomes of them",
                       [](const R& r) { return r.estimates.tracks.unfinished; }));
  }
  if (!task.cells.empty()) {
    fields.push_back(F("series_used", "series in the fit", [](const R& r) { return r.estimates.series_used; }));
    fields.push_back(F("reference", "base of the Weber fraction",
                       [k = protocol.stimulus.reference](const R&) { return k; },
                       {.unit = to_string(protocol.stimulus.unit)}));
    fields.push_back(F("cautions", "names of cautions, separated by blanks; none of them excludes anything",
                       [](const R& r) { return fmt::format("{}", fmt::join(r.estimates.cautions, " ")); },
                       {.levels = "extrapolated floor few_trials series_missing", .several = true}));
  }
  fields.push_back(F("median_response_time_s", "median of the times that the participant entered; empty without one",
                     &R::median_response_time_s, {.unit = "s"}));
  fields.push_back(F("mean_trial_s", "mean time of a counted trial; empty without one", &R::mean_trial_s,
                     {.unit = "s", .title = "s per trial"}));
  add_convention(fields, results, protocol);
  add_group_field(fields, protocol, [](const R& r) { return r.group; });
  fields.push_back(F("remarks", "",
                     [&task](const R& r) {
                       std::string text = r.estimates.status == "ok" ? "" : r.estimates.status;
                       for (const std::string& caution : r.estimates.cautions)
                         if (caution != "few_trials")
                           text = joined(text, caution);  // of a short design it is everybody's
                       if (r.excluded > 0) text = joined(text, fmt::format("{} excluded", r.excluded));
                       if (r.missing > 0 && task.cells.empty())
                         text = joined(text, fmt::format("{} not done", r.missing));
                       text = joined(text, tracks_words(r.estimates.tracks));
                       return joined(text, source_caution(r.difference_source, task));
                     },
                     {.title = "cautions", .place = Place::table}));
  block.id = "estimates";
  block.section = Section::participants;
  block.title = "Participants";
  block.note = method_note(results, protocol) + interval_note(task);
  block.columns.push_back({"mean_trial_s"});
  block.columns.push_back({"remarks"});
  return std::move(block.with(fields, task.estimates));
}

// How a threshold of tracks is told, by what it rests on: the key of its standard deviation, and what that is.
std::pair<std::string, std::string> deviation_of(ThresholdSource source) {
  switch (source) {
    case ThresholdSource::reversals:
      return {"sd", ""};
    case ThresholdSource::quest:
      return {"sd_log10", "standard deviation of the posterior of log10 of the threshold"};
    case ThresholdSource::answers:
      break;
  }
  return {"sd_ln", "standard deviation of the posterior of ln JND"};
}

std::string tracks_note(const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  switch (threshold_source(protocol)) {
    case ThresholdSource::reversals:
      return fmt::format("threshold: mean of the last {} reversals of each track, at {:.1f} %",
                         procedure.averaged_reversals / 2 * 2, 100 * adaptive_target(procedure).value_or(kNaN));
    case ThresholdSource::quest:
      return fmt::format("threshold: 10 to the mean of the posterior of log10, at {:.1f} %",
                         100 * adaptive_target(procedure).value_or(kNaN));
    case ThresholdSource::answers:
      break;
  }
  return "threshold: the JND by the posterior of all answers; sd: of its logarithm";
}

Block tracks_block(const StudyResults& results, const Protocol& protocol) {
  using R = TrackRow;
  using F = Field<R>;
  const ThresholdSource source = threshold_source(protocol);
  const std::string unit(to_string(protocol.stimulus.unit));
  const auto [sd_key, sd_meaning] = deviation_of(source);
  const auto of = [](auto member) {
    return [member](const R& r) { return r.threshold ? std::optional((*r.threshold).*member) : std::nullopt; };
  };
  Fields<R> fields = {common<R>("participant", &R::participant), common<R>("kind", &R::kind, {.levels = kSessionKinds}),
                      condition_field<R>(protocol, [](const R& r) { return r.condition; })};
  add_standard_fields(fields, protocol, [](const R& r) { return r.standard; });
  fields.insert(
      fields.end(),
      {F("track", "track of the condition, from 1; empty for all of them",
         [](const R& r) { return r.track == 0 ? std::nullopt : std::optional(r.track); }),
       F("finished", "1 where the stopping rule was met", &R::finished, {.levels = "0 1"}),
       common<R>("trials", &R::trials), common<R>("hits", &R::hits),
       F("catch_trials", "answered trials without a difference or a signal", &R::catch_trials, {.title = "catch"}),
       common<R>("false_alarms", &R::false_alarms, {.title = "false alarms"}),
       F("threshold",
         "what the tracks come to, in the unit of the levels; of a status other than ok what there is so far; empty where there is "
         "nothing, and where the answers of a condition have an estimate together alone",
         of(&AdaptiveThreshold::threshold), {.unit = unit, .title = "threshold " + unit}),
       sd_key == "sd" ? common<R>("sd", of(&AdaptiveThreshold::sd)) : F(sd_key, sd_meaning, of(&AdaptiveThreshold::sd)),
       common<R>("ci_low", of(&AdaptiveThreshold::low)), common<R>("ci_high", of(&AdaptiveThreshold::high)),
       common<R>("n", of(&AdaptiveThreshold::n)),
       common<R>(
           "status",
           [](const R& r) {
             return r.threshold ? std::string(to_string(r.threshold->status)) : std::string("no_threshold");
           },
           {.levels = "ok too_few_reversals no_trials pinned_at_clamp too_few_answers pinned_at_grid no_threshold"}),
       F("levels", "of a track: the levels that were presented, in order, separated by blanks", &R::levels,
         {.unit = unit}),
       F("reversals", "of a staircase's track: the levels of its reversals", &R::reversals, {.unit = unit})});
  if (source == ThresholdSource::answers) {
    const auto course = [](double TrackPosterior::*member) {
      return [member](const R& r) {
        std::vector<double> values;
        for (const TrackPosterior& one : r.course) values.push_back(one.*member);
        return values;
      };
    };
    fields.push_back(F("course", "the JND by the posterior after each of these levels", course(&TrackPosterior::jnd)));
    fields.push_back(F("course_ci_low", "lower ends of its middle 95 %", course(&TrackPosterior::low)));
    fields.push_back(F("course_ci_high", "upper ends", course(&TrackPosterior::high)));
  }
  add_group_field(fields, protocol, [](const R& r) { return r.group; });
  fields.push_back(F("which", "", [](const R& r) { return r.track == 0 ? "all" : std::to_string(r.track); },
                     {.title = "track", .place = Place::table}));
  fields.push_back(F("remarks", "",
                     [](const R& r) {
                       const std::string status = r.threshold ? std::string(to_string(r.threshold->status)) : "";
                       return joined(joined(status == "ok" ? "" : status, r.finished ? "" : "not finished"),
                                     r.threshold ? tracks_words(r.threshold->tracks) : "");
                     },
                     {.title = "cautions", .place = Place::table}));
  Block block;
  block.id = "tracks";
  block.section = Section::participants;
  block.title = "Tracks";
  block.note = tracks_note(protocol);
  block.columns = {{"participant"}, {"condition"}};
  if (judged_standard_count(protocol) > 1) block.columns.push_back({"standard"});
  for (const char* key : {"which", "trials", "hits"}) block.columns.push_back({key});
  block.columns.push_back(share("false_alarms", "catch_trials", "false alarms", "/"));
  block.columns.push_back({"n"});
  block.columns.push_back({"threshold"});
  if (source == ThresholdSource::answers) block.columns.push_back(range("ci_low", "ci_high"));
  block.columns.push_back({sd_key});
  block.columns.push_back({"remarks"});
  return std::move(block.with(fields, results.task.tracks));
}

std::vector<std::string> left_out_notes(const StudyResults& results, const Protocol& protocol) {
  const TaskResults& task = results.task;
  const std::vector<JudgedStandard> standards = judged_standards(protocol);
  std::vector<std::string> notes;
  for (const TaskGroupRow& row : task.group) {
    if (row.outcome != task.registered && task.outcomes[row.outcome].key != "jnd") continue;
    std::string condition = condition_of(protocol, row.condition);
    if (standards.size() > 1) condition += " at " + standards[static_cast<std::size_t>(row.standard)].name;
    int left_out = 0;
    std::string why;
    for (const auto& [status, n] : row.without) {
      left_out += n;
      why = joined(why, fmt::format("{} {}", n, status));
    }
    const int kept = row.median_n - row.mean.n;
    if (left_out > 0)
      notes.push_back(fmt::format("{}, {}: the mean leaves out {} of {} ({}){}", condition,
                                  task.outcomes[row.outcome].title, left_out, row.participants, why,
                                  kept > 0 ? fmt::format("; the median keeps {} of them", kept) : ""));
    if (const std::string caution = source_caution(row.difference_source, task);
        !caution.empty() && row.participants > 0 && row.outcome == 0)
      notes.push_back(fmt::format("{}: {}: nothing was delivered that has a stiffness to fit", condition, caution));
  }
  for (const auto& [reason, trials] : task.exclusions)
    notes.push_back(fmt::format("excluded by the registered rule {}: {} trials", reason, trials));
  return notes;
}

Block group_block(const StudyResults& results, const Protocol& protocol) {
  using R = TaskGroupRow;
  using F = Field<R>;
  const TaskResults& task = results.task;
  const auto outcome = [&task](const R& r) -> const TaskOutcome& { return task.outcomes[r.outcome]; };
  const auto source = [&protocol, outcome](const R& r) {
    return published_value(protocol, condition_of(protocol, r.condition), r.standard, outcome(r).key);
  };
  Fields<R> fields = {condition_field<R>(protocol, [](const R& r) { return r.condition; })};
  add_standard_fields(fields, protocol, [](const R& r) { return r.standard; });
  fields.insert(fields.end(), {kind_field<R>(results.attendance.kind),
                               common<R>("outcome", [outcome](const R& r) { return std::string(outcome(r).key); }),
                               common<R>("unit", [outcome](const R& r) { return outcome(r).unit; }),
                               common<R>("registered",
                                         [&task, one = protocol.analysis.standard](const R& r) {
                                           return r.outcome == task.registered && (one < 0 || r.standard == one);
                                         },
                                         {.levels = "0 1"}),
                               common<R>("participants", &R::participants)});
  add_mean_fields(fields, [](const R& r) -> const MeanEstimate& { return r.mean; });
  const auto raised = [](double MeanEstimate::*member) {
    return [member](const R& r) { return std::exp(r.logarithms.*member); };
  };
  fields.insert(
      fields.end(),
      {F("geometric_mean", "exp of the mean of the logarithms; empty of what may be below 0",
         raised(&MeanEstimate::mean), {.title = "geometric"}),
       F("geometric_ci_low", "lower end of its 95 % interval: exp of Student's of the logarithms",
         raised(&MeanEstimate::ci_low)),
       F("geometric_ci_high", "upper end of that of the geometric mean", raised(&MeanEstimate::ci_high)),
       F("geometric_sd", "exp of the standard deviation of the logarithms: a factor", raised(&MeanEstimate::sd)),
       F("inverse_mean", "of a slope: 1 / mean, the JND of the mean slope; empty unless that is positive",
         &R::inverse_mean),
       common<R>("ci_within_low", &R::within_low), common<R>("ci_within_high", &R::within_high),
       F("n_within", "participants in that interval: with a value under every condition", &R::within_n),
       common<R>("median", &R::median), F("n_median", "participants in the median", &R::median_n),
       F("without", "those without a value: how many, and their status", [](const R& r) {
         std::string text;
         for (const auto& [status, n] : r.without) text = joined(text, fmt::format("{} {}", n, status));
         return text;
       })});
  const bool catch_trials = catch_share(protocol) > 0;
  if (catch_trials)
    fields.push_back(
        common<R>("false_alarm_rate", &R::false_alarm_rate, {.title = "false alarms", .shown = Shown::percent}));
  if (!protocol.published.empty()) {
    fields.push_back(common<R>("published",
                               [source](const R& r) {
                                 const PublishedValue* value = source(r);
                                 return value == nullptr ? std::nullopt : std::optional(value->value);
                               },
                               {.shown = Shown::given}));
    fields.push_back(F("published_half_width", "half the width of its published 95 % interval",
                       [source](const R& r) {
                         const PublishedValue* value = source(r);
                         return value == nullptr ? std::nullopt : value->ci95_half_width;
                       },
                       {.shown = Shown::given}));
  }
  add_convention(fields, results, protocol);
  // Beside the JND, or the threshold, that the answer shows.
  const auto weber = std::find_if(task.outcomes.begin(), task.outcomes.end(),
                                  [](const TaskOutcome& one) { return one.key == "weber"; });
  const std::ptrdiff_t weber_place = weber - task.outcomes.begin();
  const std::string_view answer = task.cells.empty() ? task.outcomes[task.registered].key : "jnd";
  const bool has_weber = weber != task.outcomes.end() && (answer == "jnd" || answer == "threshold");
  if (has_weber)
    fields.push_back(F(
        "weber", "",
        [weber_place](const R& r) { return (&r + (weber_place - static_cast<std::ptrdiff_t>(r.outcome)))->mean.mean; },
        {.title = "Weber", .shown = Shown::percent, .place = Place::table}));
  fields.push_back(F("measure", "",
                     [outcome](const R& r) {
                       const TaskOutcome& of = outcome(r);
                       return of.unit.empty() ? std::string(of.title) : fmt::format("{} {}", of.title, of.unit);
                     },
                     {.place = Place::table}));
  Block block;
  block.id = "group";
  block.section = Section::participants;
  block.title = fmt::format("Group ({}, {})", to_string(results.attendance.kind),
                            counted(results.attendance.participants, "participant"));
  block.note = method_note(results, protocol) + "; means with Student's 95 % interval";
  block.footnotes = left_out_notes(results, protocol);
  // The response model has a criterion of its own.
  if (task_of(protocol.task.kind).evidence(protocol) == Evidence::tracks &&
      threshold_source(protocol) != ThresholdSource::answers)
    block.footnotes.emplace_back(
        "a threshold moves with the criterion: compare conditions where the false alarms are alike");
  if (task_of(protocol.task.kind).evidence(protocol) == Evidence::tracks && !catch_trials)
    block.footnotes.emplace_back("without catch trials there is no false-alarm rate, and no d'");
  const bool several = judged_standard_count(protocol) > 1;
  const auto begin = [&](std::vector<TableColumn>& columns, bool with_measure) {
    columns = {{"condition"}};
    if (several) columns.push_back({"standard"});
    if (with_measure) columns.push_back({"measure"});
    columns.push_back(share("n", "participants", "n used"));
    columns.push_back({"mean"});
    columns.push_back(range("ci_low", "ci_high"));
    columns.push_back({"median"});
  };
  begin(block.columns, true);
  begin(block.answer.columns, false);
  block.columns.push_back({"geometric_mean"});
  block.columns.push_back({"sd"});
  if (!task.cells.empty()) block.columns.push_back({"inverse_mean", {}, {}, "1/mean"});
  if (has_weber) block.answer.columns.push_back({"weber"});
  if (catch_trials) {
    block.columns.push_back({"false_alarm_rate"});
    block.answer.columns.push_back({"false_alarm_rate"});
  }
  if (!protocol.published.empty()) {
    for (std::vector<TableColumn>* columns : {&block.columns, &block.answer.columns})
      columns->push_back(share("published", "published_half_width", "published", " ± "));
  }
  return std::move(block.with(fields, task.group));
}

}  // namespace

std::string source_caution(DifferenceSource source, const TaskResults& task) {
  if (task.cells.empty() || source == task.pairs.by) return {};
  return source == DifferenceSource::mixed ? "nominal differences in part" : "nominal difference";
}

Blocks estimate_blocks(const StudyResults& results, const Protocol& protocol) {
  const TaskResults& task = results.task;
  if (task.outcomes.empty() || task.estimates.empty()) return {};
  Block group = group_block(results, protocol);
  const TaskOutcome& registered = task.outcomes[task.registered];
  // The JND of pairs, whatever is tested: it is what a reader looks for first.
  const bool jnd_first = !task.cells.empty();
  const TaskOutcome& first = jnd_first ? task.outcomes[1] : registered;
  group.answer.title = fmt::format("{}{}{} by condition", first.title, first.unit.empty() ? "" : " ", first.unit);
  group.answer.note =
      jnd_first ? method_note(results, protocol) : fmt::format("{}; mean with Student's 95 % interval", first.meaning);
  group.answer.only = "answer";
  group.fields.push_back(Field<TaskGroupRow>(
      "answer", "", [place = jnd_first ? 1 : task.registered](const TaskGroupRow& r) { return r.outcome == place; },
      {.place = Place::table}));
  Blocks blocks;
  blocks.push_back(estimates_block(results, protocol));
  if (!task.tracks.empty()) blocks.push_back(tracks_block(results, protocol));
  blocks.push_back(std::move(group));
  for (Block& block : count_blocks(results, protocol)) blocks.push_back(std::move(block));
  return blocks;
}

}  // namespace jnd
