#include "data/event_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "data/storage_error.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json finger_body(const FingerPresentation& finger) {
  return Json{{"stiffness_n_per_m", number_or_null(finger.stiffness_n_per_m)},
              {"fit_samples", finger.fit_samples},
              {"peak_force_n", finger.peak_force_n},
              {"deepest_penetration_m", finger.deepest_penetration_m},
              {"work_j", finger.work_j},
              {"mean_speed_m_per_s", finger.mean_speed_m_per_s},
              {"contacts", finger.contacts},
              {"dwell_s", finger.dwell_s},
              {"saturated_share", finger.saturated_share},
              {"vibration_g", finger.vibration_g},
              {"vibration_clamped", finger.vibration_clamped}};
}

Json presentation_body(const Presentation& presentation) {
  Json fingers = Json::array();
  for (const FingerPresentation& finger : presentation.fingers) fingers.push_back(finger_body(finger));
  const bool contact = presentation.first_contact_s >= 0;
  return Json{{"first_contact_s", contact ? Json(presentation.first_contact_s) : Json(nullptr)},
              {"duration_s", presentation.duration_s},
              {"ticks", presentation.ticks},
              {"overruns", presentation.overruns},
              {"lateness_p50_us", presentation.lateness_p50_us},
              {"lateness_p99_us", presentation.lateness_p99_us},
              {"lateness_max_us", presentation.lateness_max_us},
              {"fault", to_string(presentation.fault)},
              {"fingers", std::move(fingers)}};
}

void add_trial(Json& body, const Trial& trial, int attempt) {
  body["index"] = trial.index;
  body["attempt"] = attempt;
  body["block"] = trial.block;
  body["practice"] = trial.practice;
  body["round"] = trial.round;
  body["series_place"] = trial.series;
  body["condition_place"] = trial.condition;
  body["stimulus_1_n_per_m"] = trial.stimuli_n_per_m[0];
  body["stimulus_2_n_per_m"] = trial.stimuli_n_per_m[1];
  body["same"] = trial.same;
}

// JSON has no NaN: a number that could not be computed was stored as null.
double number_at(const Json& body, const char* key) {
  const Json& value = body.at(key);
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

Fault fault_from(const std::string& text) {
  for (const Fault fault : {Fault::none, Fault::no_contact, Fault::stale_pose, Fault::non_finite, Fault::device_lost,
                            Fault::emergency_stop, Fault::interrupted})
    if (text == to_string(fault)) return fault;
  throw StorageError(fmt::format("unknown fault \"{}\"", text));
}

FingerPresentation finger_from(const Json& body) {
  FingerPresentation finger;
  if (!body.at("stiffness_n_per_m").is_null()) finger.stiffness_n_per_m = body.at("stiffness_n_per_m").get<double>();
  finger.fit_samples = body.at("fit_samples").get<std::int64_t>();
  finger.peak_force_n = number_at(body, "peak_force_n");
  finger.deepest_penetration_m = number_at(body, "deepest_penetration_m");
  finger.work_j = number_at(body, "work_j");
  finger.mean_speed_m_per_s = number_at(body, "mean_speed_m_per_s");
  finger.contacts = body.at("contacts").get<int>();
  finger.dwell_s = number_at(body, "dwell_s");
  finger.saturated_share = number_at(body, "saturated_share");
  finger.vibration_g = number_at(body, "vibration_g");
  finger.vibration_clamped = body.at("vibration_clamped").get<bool>();
  return finger;
}

Presentation presentation_from(const Json& body) {
  Presentation presentation;
  if (!body.at("first_contact_s").is_null()) presentation.first_contact_s = body.at("first_contact_s").get<double>();
  presentation.duration_s = number_at(body, "duration_s");
  presentation.ticks = body.at("ticks").get<std::int64_t>();
  presentation.overruns = body.at("overruns").get<std::int64_t>();
  presentation.lateness_p50_us = number_at(body, "lateness_p50_us");
  presentation.lateness_p99_us = number_at(body, "lateness_p99_us");
  presentation.lateness_max_us = number_at(body, "lateness_max_us");
  presentation.fault = fault_from(body.at("fault").get<std::string>());
  for (const Json& finger : body.at("fingers")) presentation.fingers.push_back(finger_from(finger));
  return presentation;
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
  body["presentations"] = {presentation_body(record.presentations[0]), presentation_body(record.presentations[1])};
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
    record.attempt = body.at("attempt").get<int>();
    record.series_name = body.at("series").get<std::string>();
    record.condition_name = body.at("condition").get<std::string>();
    const auto answer = body.at("answer").get<std::string>();
    const std::optional<Judgement> judgement = judgement_from(answer);
    if (!judgement) throw StorageError(fmt::format("unknown answer \"{}\"", answer));
    record.answer.judgement = *judgement;
    const auto who = body.at("entered_by").get<std::string>();
    if (who != to_string(EnteredBy::participant) && who != to_string(EnteredBy::operator_))
      throw StorageError(fmt::format("answer entered by unknown \"{}\"", who));
    record.answer.entered_by = who == to_string(EnteredBy::participant) ? EnteredBy::participant : EnteredBy::operator_;
    record.answer.response_time_s = number_at(body, "response_time_s");
    record.duration_s = number_at(body, "duration_s");
    const Json& presentations = body.at("presentations");
    if (presentations.size() != 2) throw StorageError("a trial has two presentations");
    for (std::size_t i = 0; i < 2; ++i) record.presentations[i] = presentation_from(presentations.at(i));
    return record;
  } catch (const Json::exception& error) {
    throw StorageError(fmt::format("the body is not a completed trial: {}", error.what()));
  }
}

Trial trial_from(const Json& body) {
  try {
    Trial trial;
    trial.index = body.at("index").get<int>();
    trial.block = body.at("block").get<int>();
    trial.practice = body.at("practice").get<bool>();
    trial.round = body.at("round").get<int>();
    trial.series = body.at("series_place").get<int>();
    trial.condition = body.at("condition_place").get<int>();
    trial.stimuli_n_per_m = {number_at(body, "stimulus_1_n_per_m"), number_at(body, "stimulus_2_n_per_m")};
    trial.same = body.at("same").get<bool>();
    return trial;
  } catch (const Json::exception& error) {
    throw StorageError(fmt::format("the body is not a trial: {}", error.what()));
  }
}

Json voided_body(const Trial& trial, int attempt, std::string_view reason) {
  Json body;
  add_trial(body, trial, attempt);
  body["reason"] = reason;
  return body;
}

Json voided_body(const Protocol& protocol, const Trial& trial, int attempt, std::string_view reason) {
  Json body;
  add_trial(body, trial, attempt);
  body["series"] = protocol.series.at(static_cast<std::size_t>(trial.series)).name;
  body["condition"] = protocol.conditions.at(static_cast<std::size_t>(trial.condition)).name;
  body["reason"] = reason;
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

std::string question_key(std::string_view id, std::string_view condition, int after_trial) {
  std::string key(id);
  if (!condition.empty()) key.append("/").append(condition);
  if (after_trial > 0) key.append("@").append(std::to_string(after_trial));
  return key;
}

std::string_view to_string(Question::When when) noexcept {
  switch (when) {
    case Question::When::before_session:
      return "before_session";
    case Question::When::after_condition:
      return "after_condition";
    case Question::When::after_series:
      return "after_series";
    case Question::When::after_session:
      return "after_session";
  }
  return "";
}

std::string_view to_string(Question::Kind kind) noexcept {
  switch (kind) {
    case Question::Kind::rating:
      return "rating";
    case Question::Kind::number:
      return "number";
    case Question::Kind::choice:
      return "choice";
    case Question::Kind::text:
      return "text";
  }
  return "";
}

std::string body_text(const Json& body) {
  return body.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace jnd
