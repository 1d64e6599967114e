#include "data/log/event_body.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/words.h"
#include "data/log/body_numbers.h"
#include "data/log/presentation_body.h"
#include "data/log/storage_error.h"
#include "protocols/input/json_text.h"
#include "protocols/tasks/task.h"

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

// "stimulus_1_n_per_m"; of other quantities than stiffness "stimulus_1": the unit stands beside it.
std::string stimulus_key(std::size_t interval, Unit unit) {
  if (unit == Unit::n_per_m || unit == Unit::n_per_rad)
    return fmt::format("stimulus_{}_{}", interval + 1, unit.suffix());
  return fmt::format("stimulus_{}", interval + 1);
}

void add_trial(Json& body, const Trial& trial, int attempt) {
  body["index"] = trial.index;
  body["attempt"] = attempt;
  body["block"] = trial.block;
  body["practice"] = trial.practice;
  body["round"] = trial.round;
  body["series_place"] = trial.series;
  body["condition_place"] = trial.condition;
  body["task"] = to_string(trial.task);
  body["unit"] = to_string(trial.unit);
  body["standard"] = trial.standard;
  for (std::size_t i = 0; i < trial.stimuli.size(); ++i) body[stimulus_key(i, trial.unit)] = trial.stimuli[i];
  if (const std::string key(task_of(trial.task).first_class_key()); !key.empty()) body[key] = trial.target == 0;
  body["target"] = trial.target < 0 ? Json(nullptr) : Json(trial.target);
  if (trial.track > 0) body["track"] = trial.track;
  if (trial.side >= 0) body["side"] = trial.side;
  if (trial.standard_place >= 0) body["standard_place"] = trial.standard_place;
}

constexpr std::size_t kMostOfUnit = 64;  // bytes; protocols have 16 characters

// A number, or the word and the place of what was said.
void read_answer(const Json& body, TrialRecord& record) {
  Answer& answer = record.answer;
  const Json& said = body.at("answer");
  if (said.is_number()) {
    answer.said = -1;
    answer.number = said.get<double>();
  } else {
    record.answer_word = said.get<std::string>();
    answer.said = whole_at(body, "said");
  }
  answer.sureness = whole_or(body, "sureness", 0);
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
  const Answer& answer = record.answer;
  if (answer.number) {
    body["answer"] = *answer.number;
  } else {
    body["answer"] = record.answer_word;
    body["said"] = answer.said;
  }
  if (answer.sureness > 0) body["sureness"] = answer.sureness;
  if (!record.settings.empty()) body["settings"] = record.settings;
  if (!record.breach.empty()) body["breach"] = record.breach;
  const std::optional<bool> correct = is_correct(record.trial, answer);
  body["correct"] = correct ? Json(*correct) : Json(nullptr);
  body["entered_by"] = to_string(record.answer.entered_by);
  body["response_time_s"] = record.answer.response_time_s;
  body["duration_s"] = record.duration_s;
  body["saturated_share"] = largest_saturated_share(record);
  const Unit unit = record.trial.unit;
  body["presentations"] = Json::array();
  for (const Presentation& presentation : record.presentations)
    body["presentations"].push_back(presentation_body(presentation, unit));
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
    read_answer(body, record);
    if (const auto settings = body.find("settings"); settings != body.end())
      record.settings = settings->get<std::vector<double>>();
    if (const auto breach = body.find("breach"); breach != body.end()) record.breach = breach->get<std::string>();
    const auto who = body.at("entered_by").get<std::string>();
    const std::optional<EnteredBy> entered_by = entered_by_from(who);
    if (!entered_by) throw StorageError(fmt::format("answer entered by unknown \"{}\"", who));
    record.answer.entered_by = *entered_by;
    record.answer.response_time_s = number_at(body, "response_time_s");
    record.duration_s = number_at(body, "duration_s");
    const Json& presentations = body.at("presentations");
    if (presentations.size() != record.trial.stimuli.size())
      throw StorageError(fmt::format("a trial of {} intervals has {} presentations", record.trial.stimuli.size(),
                                     presentations.size()));
    record.presentations.clear();
    for (const Json& one : presentations) record.presentations.push_back(presentation_from(one, record.trial.unit));
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
    const auto task = body.at("task").get<std::string>();
    const std::optional<TaskKind> kind = task_kind_from(task);
    if (!kind) throw StorageError(fmt::format("unknown task \"{}\"", task));
    trial.task = *kind;
    const auto unit = body.at("unit").get<std::string>();
    if (unit.size() > kMostOfUnit) throw StorageError("a unit of more than 64 bytes");
    trial.unit = Unit::named(unit);
    trial.standard = number_at(body, "standard");
    trial.stimuli = Intervals({number_at(body, stimulus_key(0, trial.unit).c_str())});
    for (std::size_t i = 1; i < kMostIntervals; ++i)
      if (const std::string key = stimulus_key(i, trial.unit); body.contains(key))
        trial.stimuli.push_back(number_at(body, key.c_str()));
    const Json& target = body.at("target");
    trial.target = target.is_null() ? -1 : whole(target);
    if (const std::string key(task_of(trial.task).first_class_key());
        !key.empty() && body.at(key).get<bool>() != (trial.target == 0))
      throw StorageError(fmt::format("\"{}\" and \"target\" contradict each other", key));
    if (body.contains("track")) trial.track = whole_at(body, "track");
    trial.side = whole_or(body, "side", -1);
    trial.standard_place = whole_or(body, "standard_place", -1);
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
  return json_text(body);
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
