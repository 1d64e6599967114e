#include "data/log/presentation_body.h"

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "data/log/body_numbers.h"
#include "data/log/storage_error.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

// The keys that carry the study's unit.
struct UnitKeys {
  explicit UnitKeys(Unit unit)
      : stiffness(key_with("stiffness_", name_suffix(unit))),
        stiffness_se(key_with("stiffness_se_", name_suffix(unit))),
        deepest_penetration(key_with("deepest_penetration_", length_suffix(unit))),
        mean_speed(key_with("mean_speed_", length_suffix(unit)) + "_per_s") {}
  std::string stiffness, stiffness_se, deepest_penetration, mean_speed;
};

const UnitKeys& keys_of(Unit unit) {
  static const UnitKeys n_per_m(Unit::n_per_m), n_per_rad(Unit::n_per_rad);
  return unit == Unit::n_per_m ? n_per_m : n_per_rad;
}

Json finger_body(const FingerPresentation& finger, Unit unit) {
  const UnitKeys& keys = keys_of(unit);
  Json body{{"finger", finger.finger},
            {"channel", to_string(finger.channel)},
            {keys.stiffness, number_or_null(finger.stiffness)},
            {keys.stiffness_se, number_or_null(finger.stiffness_se)},
            {"fit_samples", finger.fit_samples},
            {"peak_force_n", finger.peak_force_n},
            {keys.deepest_penetration, finger.deepest_penetration},
            {"work_j", finger.work_j},
            {keys.mean_speed, finger.mean_speed},
            {"contacts", finger.contacts},
            {"dwell_s", finger.dwell_s},
            {"saturated_share", finger.saturated_share},
            {"vibration_g", finger.vibration_g},
            {"vibration_clamped", finger.vibration_clamped}};
  if (finger.joint_stiffness_n_m_per_rad) body["joint_stiffness_n_m_per_rad"] = *finger.joint_stiffness_n_m_per_rad;
  for (const Intervention& one : finger.interventions)
    body["interventions"].push_back(
        {{"limit", one.limit}, {"ticks", one.ticks}, {"asked", one.asked}, {"given", one.given}});
  return body;
}

std::optional<double> optional_at(const Json& body, const char* key) {
  const auto found = body.find(key);
  if (found == body.end() || found->is_null()) return std::nullopt;
  return found->get<double>();
}

FingerPresentation finger_from(const Json& body, Unit unit, int place) {
  const UnitKeys& keys = keys_of(unit);
  FingerPresentation finger;
  finger.finger = whole_or(body, "finger", place);
  if (const auto channel = body.find("channel"); channel != body.end()) {
    const std::optional<Channel> known = channel_from(channel->get_ref<const std::string&>());
    if (!known) throw StorageError(fmt::format("unknown channel {}", channel->dump()));
    finger.channel = *known;
  }
  if (const Json& stiffness = body.at(keys.stiffness); !stiffness.is_null()) finger.stiffness = stiffness.get<double>();
  finger.stiffness_se = optional_at(body, keys.stiffness_se.c_str());
  finger.joint_stiffness_n_m_per_rad = optional_at(body, "joint_stiffness_n_m_per_rad");
  finger.fit_samples = whole_at<std::int64_t>(body, "fit_samples");
  finger.peak_force_n = number_at(body, "peak_force_n");
  finger.deepest_penetration = number_at(body, keys.deepest_penetration.c_str());
  finger.work_j = number_at(body, "work_j");
  finger.mean_speed = number_at(body, keys.mean_speed.c_str());
  finger.contacts = whole_at(body, "contacts");
  finger.dwell_s = number_at(body, "dwell_s");
  finger.saturated_share = number_at(body, "saturated_share");
  finger.vibration_g = number_at(body, "vibration_g");
  finger.vibration_clamped = body.at("vibration_clamped").get<bool>();
  if (const auto interventions = body.find("interventions"); interventions != body.end())
    for (const Json& one : *interventions)
      finger.interventions.push_back({one.at("limit").get<std::string>(), whole_at<std::int64_t>(one, "ticks"),
                                      number_at(one, "asked"), number_at(one, "given")});
  return finger;
}

}  // namespace

double number_at(const Json& body, const char* key) {
  const Json& value = body.at(key);
  return value.is_null() ? kNaN : value.get<double>();
}

Json number_or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

std::string key_with(const char* name, std::string_view suffix) {
  return std::string(name).append(suffix);
}

Json presentation_body(const Presentation& presentation, Unit unit) {
  Json fingers = Json::array();
  for (const FingerPresentation& finger : presentation.fingers) fingers.push_back(finger_body(finger, unit));
  const bool contact = presentation.first_contact_s >= 0;
  Json body{{"first_contact_s", contact ? Json(presentation.first_contact_s) : Json(nullptr)},
            {"duration_s", presentation.duration_s},
            {"ticks", presentation.ticks},
            {"overruns", presentation.overruns},
            {"lateness_p50_us", presentation.lateness_p50_us},
            {"lateness_p99_us", presentation.lateness_p99_us},
            {"lateness_max_us", presentation.lateness_max_us}};
  // On the simulated clock no tick is late, and thousands of trials would repeat that.
  if (presentation.lateness_max_us > 0) body["lateness_histogram"] = presentation.lateness_histogram;
  body["fault"] = to_string(presentation.fault);
  if (!presentation.stopped_by.empty()) body["stopped_by"] = presentation.stopped_by;
  if (presentation.delivered) body["delivered"] = *presentation.delivered;
  if (!presentation.measured.empty()) body["measured"] = presentation.measured;
  body["fingers"] = std::move(fingers);
  return body;
}

Presentation presentation_from(const Json& body, Unit unit) {
  Presentation presentation;
  if (!body.at("first_contact_s").is_null()) presentation.first_contact_s = body.at("first_contact_s").get<double>();
  presentation.duration_s = number_at(body, "duration_s");
  presentation.ticks = whole_at<std::int64_t>(body, "ticks");
  presentation.overruns = whole_at<std::int64_t>(body, "overruns");
  presentation.lateness_p50_us = number_at(body, "lateness_p50_us");
  presentation.lateness_p99_us = number_at(body, "lateness_p99_us");
  presentation.lateness_max_us = number_at(body, "lateness_max_us");
  if (const auto histogram = body.find("lateness_histogram"); histogram != body.end()) {
    if (histogram->size() != presentation.lateness_histogram.size())
      throw StorageError(fmt::format("a lateness histogram of {} numbers, not {}", histogram->size(),
                                     presentation.lateness_histogram.size()));
    presentation.lateness_histogram = histogram->get<decltype(presentation.lateness_histogram)>();
  }
  presentation.delivered = optional_at(body, "delivered");
  if (const auto measured = body.find("measured"); measured != body.end())
    presentation.measured = measured->get<std::map<std::string, double>>();
  const auto fault = body.at("fault").get<std::string>();
  const std::optional<Fault> known = fault_from(fault);
  if (!known) throw StorageError(fmt::format("unknown fault \"{}\"", fault));
  presentation.fault = *known;
  if (const auto who = body.find("stopped_by"); who != body.end()) presentation.stopped_by = who->get<std::string>();
  for (const Json& finger : body.at("fingers"))
    presentation.fingers.push_back(finger_from(finger, unit, static_cast<int>(presentation.fingers.size())));
  return presentation;
}

}  // namespace jnd
