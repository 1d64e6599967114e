// Reads what is registered about results and sources: the members "source", "published", "assumed" and "analysis".
#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "protocols/course/prescription.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/reading/protocol_reading.h"

namespace jnd {
namespace {

void collect_paths(const JsonNode& node, std::vector<std::string_view>& paths) {
  paths.push_back(node.path);
  for (const JsonNode& item : node.items) collect_paths(item, paths);
}

void read_exclusions(const JsonNode& node, ProtocolReading& reading) {
  Exclusions& exclude = reading.protocol.analysis.exclude;
  JsonReader reader(node, reading.errors, reading.file);
  exclude.response_time_below_s = reader.optional_number("response_time_below_s", {.min = 0, .max = 60, .unit = "s"});
  exclude.response_time_above_s =
      reader.optional_number("response_time_above_s", {.min = 0, .max = 600, .above = true, .unit = "s"});
  exclude.saturated_share_above = reader.optional_number("saturated_share_above", {.min = 0, .max = 1});
  exclude.off_prescription = reader.boolean_or("off_prescription", false);
  if (exclude.off_prescription && !judges_exploration(reading.protocol) && reading.sound("$.trial") &&
      reading.sound("$.conditions"))
    reader.error("off_prescription", "there are no limits that a trial could break",
                 "add \"limits\" to $.trial.prescription, or remove it");
  reader.finish();
  if (exclude.response_time_below_s && exclude.response_time_above_s &&
      *exclude.response_time_below_s >= *exclude.response_time_above_s) {
    reader.error("response_time_above_s",
                 fmt::format("{} s is not above response_time_below_s, {} s: every trial would be excluded",
                             plain(*exclude.response_time_above_s), plain(*exclude.response_time_below_s)));
  }
}

void read_contrasts(const JsonNode& list, ProtocolReading& reading) {
  std::set<std::pair<int, int>> seen;
  for (const JsonNode& item : list.items) {
    if (item.kind != JsonNode::Kind::array || item.items.size() != 2) {
      reading.error(item, "a contrast is a list of two conditions", "such as [\"S\", \"V\"]: S minus V");
      continue;
    }
    const auto a = condition_place(item.items[0], reading);
    const auto b = condition_place(item.items[1], reading);
    if (!a || !b) continue;
    if (*a == *b) {
      reading.error(item, fmt::format("compares {} with itself", in_quotes(item.items[0].text)), "name two conditions");
      continue;
    }
    if (!seen.insert(std::minmax(*a, *b)).second) reading.error(item, "this contrast is given twice", "remove one");
    reading.protocol.analysis.contrasts.push_back({*a, *b});
  }
}

void read_tests(const JsonNode& node, ProtocolReading& reading) {
  GroupTestPlan& tests = reading.protocol.analysis.tests;
  JsonReader reader(node, reading.errors, reading.file);
  if (reading.has_pairs())
    tests.outcome = reader.one_of_or<Outcome>(
        "on", {{"slope", Outcome::slope}, {"jnd", Outcome::jnd}, {"log-jnd", Outcome::log_jnd}}, tests.outcome);
  else
    tests.outcome =
        reader.one_of_or<Outcome>("on", {{"value", Outcome::jnd}, {"logarithm", Outcome::log_jnd}}, tests.outcome);
  tests.omnibus = reader.one_of_or<Omnibus>(
      "omnibus", {{"anova", Omnibus::anova}, {"friedman", Omnibus::friedman}, {"none", Omnibus::none}}, tests.omnibus);
  tests.post_hoc = reader.one_of_or<PostHoc>("post_hoc",
                                             {{"holm-t", PostHoc::holm_t},
                                              {"games-howell", PostHoc::games_howell},
                                              {"tukey", PostHoc::tukey},
                                              {"wilcoxon", PostHoc::wilcoxon}},
                                             tests.post_hoc);
  read_between_test(reader, reading);
  tests.alpha = reader.optional_number("alpha", {.min = 0, .max = 0.5, .above = true}).value_or(tests.alpha);
  reader.finish();
}

// Which estimates there are: a JND by a line through d' needs a d' of each series, which the differencing model has
// only by maximum likelihood over all series.
void check_model_and_method(const JsonNode& node, JsonReader& reader, ProtocolReading& reading) {
  const AnalysisPlan& analysis = reading.protocol.analysis;
  if (const JsonNode* model = node.find("model"); model == nullptr || !reading.sound(model->path)) return;
  if (const JsonNode* method = node.find("jnd"); method == nullptr || !reading.sound(method->path)) return;
  if (analysis.model == "differencing" && analysis.jnd_method != "ml")
    reader.error("jnd", fmt::format("{} does not go with the differencing model", in_quotes(analysis.jnd_method)),
                 "write \"ml\": the joint fit of all series");
  if (analysis.model == "independent-observation" && analysis.jnd_method != "least_squares")
    reader.error("jnd",
                 fmt::format("{} does not go with the independent-observation model", in_quotes(analysis.jnd_method)),
                 "write \"least_squares\"");
  if (analysis.model == "independent-observation" && analysis.correction == "none")
    reader.error("correction", "rates of 0 and 1 have no d' in the independent-observation model",
                 "write \"loglinear\" or \"half\"");
  if (analysis.common_criterion && analysis.jnd_method != "ml")
    reader.error("criterion", "a common criterion is part of the joint fit only",
                 "write \"jnd\": \"ml\", or remove it");
}

// The contrasts by one model of everybody's answers, which has tests of its own.
void read_group(const JsonNode& node, JsonReader& reader, ProtocolReading& reading) {
  AnalysisPlan& analysis = reading.protocol.analysis;
  const int spreads = reader.one_of_or<int>(
      "group", {{"separate", 0}, {"hierarchical", 1}, {"hierarchical, spread by condition", 2}}, 0);
  analysis.hierarchical = spreads > 0;
  analysis.own_spreads = spreads > 1;
  if (!analysis.hierarchical) return;
  const TaskKind kind = reading.protocol.task.kind;
  const std::optional<AnswerModel> answers = reading.task().answer_model(reading.protocol);
  if (!answers && reading.has_pairs())
    reader.error("group", "the hierarchical model of a procedure is not of independent observation",
                 "write \"model\": \"yes-no\" or \"differencing\", or remove it");
  else if (!answers)
    reader.error("group", fmt::format("there is no hierarchical model of the task {}", in_quotes(to_string(kind))),
                 "remove it");
  if (answers && !reading.has_pairs()) {
    const bool weber = analysis.outcome == "weber";
    if (analysis.outcome != answers->jnd && !weber)
      reader.error("group",
                   fmt::format("the hierarchical model compares conditions by the {}, not by the {}", answers->jnd,
                               analysis.outcome),
                   fmt::format("write \"outcome\": {}, or remove it", in_quotes(answers->jnd)));
    if (reading.protocol.series.size() > 1)
      reader.error("group", "the hierarchical model compares conditions at one standard, and there are several",
                   "remove it");
    if (analysis.lapse_free)
      reader.error("group", "the hierarchical model has a fixed lapse rate",
                   "write \"lapse\" as a number, or remove it");
  }
  if (const JsonNode* tests = node.find("tests"); tests != nullptr && tests->find("post_hoc") != nullptr)
    reader.error("group", "the hierarchical model tests the contrasts by likelihood ratio: there is no other post_hoc",
                 "remove \"post_hoc\", or this");
}

void read_unfinished_tracks(JsonReader& reader, ProtocolReading& reading) {
  using Use = UnfinishedTracks;
  reading.protocol.analysis.unfinished_tracks =
      reader.one_of_or<Use>("unfinished_tracks", {{"leave_out", Use::leave_out}, {"use", Use::use}}, Use::leave_out);
  const bool reversals =
      reading.procedure() != nullptr && threshold_source(reading.protocol) == ThresholdSource::reversals;
  if (reader.member("unfinished_tracks") != nullptr && !reversals && reading.sound(kProcedurePath))
    reader.error("unfinished_tracks", "there is no staircase whose reversals are averaged", "remove it");
}

// The question of a published rating.
void look_at_question(JsonReader& reader, const PublishedValue& value, ProtocolReading& reading) {
  if (value.question.empty()) return;
  const auto& questions = reading.protocol.questions;
  const auto asked = std::find_if(questions.begin(), questions.end(),
                                  [&](const Question& question) { return question.id == value.question; });
  if (value.quantity != "rating")
    reader.error("question", "belongs to a rating", "remove it, or write \"quantity\": \"rating\"");
  else if (asked == questions.end())
    reader.error("question", fmt::format("there is no question {}", in_quotes(value.question)),
                 "write the id of one of $.questions");
  else if (value.standard >= 0 && asked->when != Question::When::after_series)
    reader.error("standard", fmt::format("{} is not asked after each series", in_quotes(value.question)), "remove it");
}

// Of free interaction: there are ratings alone, so what belongs to d' has no meaning.
void read_analysis_of_ratings(JsonReader& reader, ProtocolReading& reading) {
  reader.refuse({"model", "correction", "jnd", "criterion", "stiffness", "unfinished_tracks", "group", "exclude",
                 "outcome", "standard", "jnd_convention", "lapse"},
                "has no meaning with the paradigm \"explore\"", "remove it: there are no trials");
  if (const JsonNode* contrasts = reader.array_or_null("contrasts", 0, 190)) read_contrasts(*contrasts, reading);
  if (const JsonNode* tests = reader.object_or_null("tests")) {
    JsonReader part(*tests, reading.errors, reading.file);
    part.refuse({"on", "omnibus", "post_hoc", "between"}, "has no meaning with the paradigm \"explore\"",
                "remove it: ratings are compared by Wilcoxon's signed-rank test");
    double& alpha = reading.protocol.analysis.tests.alpha;
    alpha = part.optional_number("alpha", {.min = 0, .max = 0.5, .above = true}).value_or(alpha);
    part.finish();
  }
  reader.finish();
}

// The member "standard", where there are several: a place in Protocol::series, or -1.
int read_standard(JsonReader& reader, const ProtocolReading& reading) {
  if (reading.has_pairs() || reading.explores() || !has_valued_standards(reading.protocol)) {
    reader.refuse({"standard"}, "belongs to tasks with standards", "remove it");
    return -1;
  }
  JsonReader::Words<int> places;
  for (const Series& series : reading.protocol.series)
    places.emplace_back(series.name, static_cast<int>(places.size()));
  if (places.empty()) return (void)reader.member("standard"), -1;  // they are reported
  return reader.one_of_or<int>("standard", places, -1);
}

// Of the tasks whose estimates are the task's own.
void read_analysis_of_task(const JsonNode& node, JsonReader& reader, ProtocolReading& reading) {
  AnalysisPlan& analysis = reading.protocol.analysis;
  const std::string task(to_string(reading.protocol.task.kind));
  reader.refuse({"model", "correction", "jnd", "criterion", "stiffness"},
                fmt::format("belongs to the task \"same-different\", not to {}", in_quotes(task)),
                "remove it: \"outcome\" says what is compared");
  JsonReader::Words<std::string> keys;
  const auto outcomes = measured_outcomes(reading.protocol);
  for (const TaskOutcome& outcome : outcomes) keys.emplace_back(outcome.key, std::string(outcome.key));
  analysis.outcome = reader.one_of_or<std::string>("outcome", keys, std::string(outcomes.front().key));
  analysis.standard = read_standard(reader, reading);
  analysis.jnd_convention = reader.one_of_or<std::string>(
      "jnd_convention", {{"75 %", "75 %"}, {"84 %", "84 %"}, {"d'=1", "d'=1"}}, analysis.jnd_convention);
  if (const JsonNode* lapse = reader.member("lapse")) {
    analysis.lapse_free = lapse->kind == JsonNode::Kind::string && lapse->text == "free";
    if (!analysis.lapse_free)
      analysis.lapse = number_of(*lapse, {.min = 0, .max = 0.1}, reading.errors, reading.file).value_or(0);
  }
  read_unfinished_tracks(reader, reading);
  read_group(node, reader, reading);
  if (const JsonNode* exclude = reader.object_or_null("exclude")) read_exclusions(*exclude, reading);
  if (const JsonNode* contrasts = reader.array_or_null("contrasts", 0, 190)) read_contrasts(*contrasts, reading);
  analysis.tests.outcome = Outcome::jnd;
  if (const JsonNode* tests = reader.object_or_null("tests")) read_tests(*tests, reading);
  reader.finish();
}

}  // namespace

void read_source(const JsonNode& node, ProtocolReading& reading) {
  Source& source = reading.protocol.source;
  JsonReader reader(node, reading.errors, reading.file);
  source.citation = reader.text("citation", {.max_length = 1000});
  source.doi = reader.text_or("doi", "", {.max_length = 200});
  if (!source.doi.empty() && (source.doi.substr(0, 3) != "10." || source.doi.find('/') == std::string::npos ||
                              source.doi.find(' ') != std::string::npos)) {
    reader.error("doi", in_quotes(source.doi) + " is not a DOI",
                 "write it as 10.1109/TOH.2017.2755015, without https://");
  }
  reader.finish();
}

namespace {

// What a paper may print of such a study.
JsonReader::Words<std::string> published_quantities(const ProtocolReading& reading) {
  if (reading.has_pairs() || reading.explores()) return {{"jnd", "jnd"}, {"weber", "weber"}, {"rating", "rating"}};
  JsonReader::Words<std::string> words;
  for (const TaskOutcome& outcome : measured_outcomes(reading.protocol))
    words.emplace_back(outcome.key, std::string(outcome.key));
  words.emplace_back("rating", "rating");
  return words;
}

}  // namespace

void read_published(const JsonNode& list, ProtocolReading& reading) {
  std::set<std::tuple<std::string, int, std::string, std::string>> seen;
  for (const JsonNode& item : list.items) {
    PublishedValue value;
    JsonReader reader(item, reading.errors, reading.file);
    value.condition = reader.text("condition", {.max_length = 100});
    if (const JsonNode* condition = item.find("condition"); condition != nullptr && reading.sound(condition->path))
      (void)condition_place(*condition, reading);
    value.standard = read_standard(reader, reading);
    value.quantity = reader.one_of<std::string>("quantity", published_quantities(reading));
    const Unit unit = reading.protocol.stimulus.unit;
    NumberLimits limits{.min = 0, .max = value_limits(reading.protocol).max, .above = true, .unit = to_string(unit)};
    if (!reading.has_pairs()) limits = {.min = -1e9, .max = 1e9};
    if (value.quantity == "weber") limits = {.min = 0, .max = 100, .above = true};
    if (value.quantity == "rating") limits = {.min = -100, .max = 100};
    value.value = reader.number("value", limits);
    value.ci95_half_width = reader.optional_number("ci95_half_width", {.min = 0, .max = 20000});
    value.sd = reader.optional_number("sd", {.min = 0, .max = 20000});
    value.question = reader.text_or("question", "", {.max_length = 100});
    look_at_question(reader, value, reading);
    value.note = reader.text_or("note", "", {.max_length = 500});
    reader.finish();
    if (reading.sound(item.path) &&
        !seen.insert({value.condition, value.standard, value.quantity, value.question}).second)
      reading.error(item, fmt::format("the {} of {} is given twice", value.quantity, in_quotes(value.condition)),
                    "remove one");
    reading.protocol.published.push_back(std::move(value));
  }
}

void read_assumed(const JsonNode& list, ProtocolReading& reading) {
  std::vector<std::string_view> paths;
  collect_paths(reading.root, paths);
  for (const JsonNode& item : list.items) {
    Assumption assumption;
    JsonReader reader(item, reading.errors, reading.file);
    assumption.path = reader.text("path", {.max_length = 200});
    assumption.why = reader.text("why", {.max_length = 1000});
    reader.finish();
    if (!assumption.path.empty() && std::find(paths.begin(), paths.end(), assumption.path) == paths.end()) {
      const std::string near = nearest_word(assumption.path, paths);
      reader.error("path", fmt::format("there is no {} in this file", in_quotes(assumption.path)),
                   near.empty() ? "a path looks like \"$.trial.gap_s\" or \"$.series[0].pair\""
                                : fmt::format("did you mean {}?", in_quotes(near)));
    }
    reading.protocol.assumed.push_back(std::move(assumption));
  }
}

void read_analysis(const JsonNode& node, ProtocolReading& reading) {
  AnalysisPlan& analysis = reading.protocol.analysis;
  JsonReader reader(node, reading.errors, reading.file);
  if (reading.explores()) return read_analysis_of_ratings(reader, reading);
  if (!reading.has_pairs()) return read_analysis_of_task(node, reader, reading);
  reader.refuse({"outcome", "standard", "jnd_convention", "lapse"}, "has no meaning with the task \"same-different\"",
                "remove it: \"model\" and \"jnd\" say it");
  analysis.model = reader.one_of<std::string>(
      "model",
      {{"yes-no", "yes-no"}, {"differencing", "differencing"}, {"independent-observation", "independent-observation"}});
  analysis.correction =
      reader.one_of<std::string>("correction", {{"none", "none"}, {"loglinear", "loglinear"}, {"half", "half"}});
  analysis.jnd_method = reader.one_of<std::string>("jnd", {{"least_squares", "least_squares"},
                                                           {"ml", "ml"},
                                                           {"weighted", "weighted"},
                                                           {"inverse_mean_slope", "inverse_mean_slope"},
                                                           {"mean_of_ratios", "mean_of_ratios"}});
  analysis.common_criterion = reader.one_of_or<bool>("criterion", {{"per-series", false}, {"common", true}}, false);
  check_model_and_method(node, reader, reading);
  analysis.by_delivered = reader.one_of_or<bool>("stiffness", {{"nominal", false}, {"delivered", true}}, false);
  read_unfinished_tracks(reader, reading);
  read_group(node, reader, reading);
  if (const JsonNode* exclude = reader.object_or_null("exclude")) read_exclusions(*exclude, reading);
  if (const JsonNode* contrasts = reader.array_or_null("contrasts", 0, 190)) read_contrasts(*contrasts, reading);
  if (const JsonNode* tests = reader.object_or_null("tests")) read_tests(*tests, reading);
  reader.finish();
}

}  // namespace jnd
