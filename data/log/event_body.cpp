#include "data/log/event_body.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/words.h"
#include "data/log/body_numbers.h"
#include "data/log/presentation_body.h"
#include "data/log/storage_error.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;
using When = Question::When;
using QuestionKind = Question::Kind;

constexpr auto kWhens = words<When>({{"before_session", When::before_session},
                                     {"after_condition", When::after_condition},
                                     {"after_series", When::after_series},
                                     {"after_session", When::after_session}});
constexpr auto kQuestionKinds = words<QuestionKind>({{"rating", QuestionKind::rating},
                                                     {"number", QuestionKind::number},
                                                     {"choice", QuestionKind::choice},
                                                     {"text", QuestionKind::text},
                                                     {"confirm", QuestionKind::confirm}});

void add_trial(Json& body, const Trial& trial, int attempt) {
  body["index"] = trial.index;
  body["attempt"] = attempt;
  body["block"] = trial.block;
  body["practice"] = trial.practice;
  body["round"] = trial.round;
  body["series_place"] = trial.series;
  body["condition_place"] = trial.condition;
  body[key_with("stimulus_1_", name_suffix(trial.unit))] = trial.stimuli[0];
  body[key_with("stimulus_2_", name_suffix(trial.unit))] = trial.stimuli[1];
  body["same"] = trial.same;
  if (trial.track > 0) body["track"] = trial.track;
}

// Written only where it is false: bodies of voids that count are those of earlier programs.
void add_counts(Json& body, bool counts) {
  if (!counts) body["counts"] = false;
}

}  // namespace

Json to_body(const TrialRecord& record) {
  Json body;
  add_trial(body, record.trial, record.attempt);
  body["series"] = record.series_name;
  body["condition"] = record.condition_name;
  const bool said_same = record.answer.judgement == Judgement::same;
  body["answer"] = to_string(record.answer.judgement);
  body["correct"] = said_same == record.trial.same;
  body["entered_by"] = to_string(record.answer.entered_by);
  body["response_time_s"] = record.answer.response_time_s;
  body["duration_s"] = record.duration_s;
  body["saturated_share"] = largest_saturated_share(record);
  const StiffnessUnit unit = record.trial.unit;
  body["presentations"] = {presentation_body(record.presentations[0], unit),
                           presentation_body(record.presentations[1], unit)};
  return body;
}

double largest_saturated_share(const TrialRecord& record) noexcept {
  double largest = 0;
  for (const Presentation& presentation : record.presentations)
    for (const FingerPresentation& finger : presentation.fingers) largest = std::max(largest, finger.saturated_share);
  return largest;
}

TrialRecord trial_record_from(const Json& body) {
  try {
    TrialRecord record;
    record.trial = trial_from(body);
    record.attempt = whole_at(body, "attempt");
    record.series_name = body.at("series").get<std::string>();
    record.condition_name = body.at("condition").get<std::string>();
    const auto answer = body.at("answer").get<std::string>();
    const std::optional<Judgement> judgement = judgement_from(answer);
    if (!judgement) throw StorageError(fmt::format("unknown answer \"{}\"", answer));
    record.answer.judgement = *judgement;
    const auto who = body.at("entered_by").get<std::string>();
    const std::optional<EnteredBy> entered_by = entered_by_from(who);
    if (!entered_by) throw StorageError(fmt::format("answer entered by unknown \"{}\"", who));
    record.answer.entered_by = *entered_by;
    record.answer.response_time_s = number_at(body, "response_time_s");
    record.duration_s = number_at(body, "duration_s");
    const Json& presentations = body.at("presentations");
    if (presentations.size() != 2) throw StorageError("a trial has two presentations");
    for (std::size_t i = 0; i < 2; ++i)
      record.presentations[i] = presentation_from(presentations.at(i), record.trial.unit);
    return record;
  } catch (const Json::exception& error) {
    throw StorageError(fmt::format("the body is not a completed trial: {}", error.what()));
  }
}

Trial trial_from(const Json& body) {
  try {
    Trial trial;
    trial.index = whole_at(body, "index");
    trial.block = whole_at(body, "block");
    trial.practice = body.at("practice").get<bool>();
    trial.round = whole_at(body, "round");
    trial.series = whole_at(body, "series_place");
    trial.condition = whole_at(body, "condition_place");
    trial.unit = body.contains("stimulus_1_n_per_rad") ? StiffnessUnit::n_per_rad : StiffnessUnit::n_per_m;
    for (std::size_t i = 0; i < 2; ++i)
      trial.stimuli[i] =
          number_at(body, key_with(i == 0 ? "stimulus_1_" : "stimulus_2_", name_suffix(trial.unit)).c_str());
    trial.same = body.at("same").get<bool>();
    if (body.contains("track")) trial.track = whole_at(body, "track");
    return trial;
  } catch (const Json::exception& error) {
    throw StorageError(fmt::format("the body is not a trial: {}", error.what()));
  }
}

Json voided_body(const Trial& trial, int attempt, std::string_view reason, bool counts) {
  Json body;
  add_trial(body, trial, attempt);
  body["reason"] = reason;
  add_counts(body, counts);
  return body;
}

Json voided_body(const Protocol& protocol, const Trial& trial, int attempt, std::string_view reason, bool counts) {
  Json body;
  add_trial(body, trial, attempt);
  body["series"] = protocol.series.at(static_cast<std::size_t>(trial.series)).name;
  body["condition"] = protocol.conditions.at(static_cast<std::size_t>(trial.condition)).name;
  body["reason"] = reason;
  add_counts(body, counts);
  return body;
}

Json question_body(std::string_view id, std::string_view when, std::string_view condition,
                   const std::optional<std::string>& answer, int after_trial) {
  return Json{{"question", id},
              {"when", when},
              {"condition", condition.empty() ? Json(nullptr) : Json(condition)},
              {"answer", answer ? Json(*answer) : Json(nullptr)},
              {"after_trial", after_trial}};
}

Json question_body(const Question& question, std::string_view condition, const std::optional<std::string>& answer,
                   int after_trial) {
  Json body = question_body(question.id, to_string(question.when), condition, answer, after_trial);
  body["kind"] = to_string(question.kind);
  body["text"] = question.text;
  return body;
}

std::string_view to_string(Question::When when) noexcept {
  return word_of(kWhens, when);
}

std::string_view to_string(Question::Kind kind) noexcept {
  return word_of(kQuestionKinds, kind);
}

std::string body_text(const Json& body) {
  return body.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// device.fault: the cause of a stop and the last ticks before it, as a table with named columns.

namespace {

using Json = nlohmann::ordered_json;

bool any_of(const Presentation& presentation, Channel channel) {
  return std::any_of(presentation.fingers.begin(), presentation.fingers.end(),
                     [channel](const FingerPresentation& finger) { return finger.channel == channel; });
}

}  // namespace

Json device_fault_body(const Trial& trial, int attempt, int interval, const Presentation& presentation) {
  // A platform's travel is a height and a joint's an angle: a column for each that the rig has.
  const bool heights = any_of(presentation, Channel::cutaneous), angles = any_of(presentation, Channel::kinaesthetic);
  Json columns = {
      "time_ns", "lateness_ns", "channel",    "limits",     key_with("penetration_", length_suffix(trial.unit)),
      "asked_n", "given_n",     "measured_n", "vibration_g"};
  if (heights) columns.push_back("travel_m");
  if (angles) columns.push_back("travel_rad");
  for (const char* name : {"finger_x_m", "finger_y_m", "finger_z_m"}) columns.push_back(name);

  Json rows = Json::array();
  for (const TickRecord& tick : presentation.last_ticks) {
    Json row = {tick.time_ns, tick.lateness_ns, tick.channel,    tick.limits,     tick.penetration,
                tick.asked_n, tick.given_n,     tick.measured_n, tick.vibration_g};
    const auto place = static_cast<std::size_t>(tick.channel);
    const bool known = tick.channel >= 0 && place < presentation.fingers.size();
    const bool joint = known && presentation.fingers[place].channel == Channel::kinaesthetic;
    if (heights) row.push_back(known && !joint ? Json(tick.travel) : Json(nullptr));
    if (angles) row.push_back(joint ? Json(tick.travel) : Json(nullptr));
    for (const double coordinate : tick.finger_m) row.push_back(coordinate);
    rows.push_back(std::move(row));
  }

  Json channels = Json::array();
  for (const FingerPresentation& finger : presentation.fingers)
    channels.push_back({{"finger", finger.finger}, {"channel", to_string(finger.channel)}});
  return {{"index", trial.index},
          {"attempt", attempt},
          {"interval", interval},
          {"cause", to_string(presentation.fault)},
          {"stopped_by", presentation.stopped_by.empty() ? Json(nullptr) : Json(presentation.stopped_by)},
          {"channels", std::move(channels)},
          {"ticks", {{"columns", std::move(columns)}, {"rows", std::move(rows)}}}};
}

}  // namespace jnd
