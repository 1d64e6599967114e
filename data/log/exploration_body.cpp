#include "data/log/exploration_body.h"

#include "data/log/body_numbers.h"
#include "data/log/event_body.h"
#include "data/log/presentation_body.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

Json head_of(const ExplorationRecord& record) {
  return {{"index", record.slot.index},          {"attempt", record.attempt},      {"block", record.slot.block},
          {"condition", record.condition},       {"object", record.object},        {"devices", record.devices},
          {"planned_s", record.slot.duration_s}, {"duration_s", record.duration_s}};
}

}  // namespace

ExplorationRecord exploration_of(const Protocol& protocol, const ExplorationSlot& slot, int attempt) {
  const Condition& condition = protocol.conditions[static_cast<std::size_t>(slot.condition)];
  ExplorationRecord record;
  record.slot = slot;
  record.attempt = attempt;
  record.condition = condition.name;
  record.object = protocol.explore->objects[static_cast<std::size_t>(slot.object)];
  record.devices = condition.devices;
  return record;
}

Json to_body(const ExplorationRecord& record, Unit unit) {
  Json body = head_of(record);
  body["condition_place"] = record.slot.condition;
  body["object_place"] = record.slot.object;
  if (record.ended_early) body["ended_early"] = true;
  if (!record.words.empty()) body["words"] = record.words;
  body["presentations"] = Json::array();
  for (const Presentation& piece : record.presentations)
    body["presentations"].push_back(presentation_body(piece, unit));
  return body;
}

Json voided_body(const ExplorationRecord& record, Unit unit, std::string_view reason, bool counts, bool will_repeat) {
  Json body = head_of(record);
  body["reason"] = reason;
  body["counts"] = counts;
  body["will_repeat"] = will_repeat;
  if (!record.words.empty()) body["words"] = record.words;
  if (record.presentations.empty() || record.presentations.back().fault == Fault::none) return body;
  const Presentation& last = record.presentations.back();
  body["last_presentation"] = presentation_body(last, unit);
  if (!last.last_ticks.empty()) {
    const Trial place{.index = record.slot.index, .condition = record.slot.condition, .unit = unit};
    body["device_fault"] =
        device_fault_body(place, record.attempt, static_cast<int>(record.presentations.size()) - 1, last);
  }
  return body;
}

ExplorationRecord exploration_from(const Json& body, Unit unit) {
  ExplorationRecord record;
  record.slot.index = whole_at(body, "index");
  record.slot.block = whole_at(body, "block");
  record.slot.condition = whole_at(body, "condition_place");
  record.slot.object = whole_at(body, "object_place");
  record.slot.duration_s = number_at(body, "planned_s");
  record.attempt = whole_at(body, "attempt");
  record.condition = body.at("condition").get<std::string>();
  record.object = body.at("object").get<std::string>();
  record.devices = body.at("devices").get<bool>();
  record.duration_s = number_at(body, "duration_s");
  record.ended_early = body.value("ended_early", false);
  record.words = body.value("words", std::string());
  for (const Json& piece : body.at("presentations")) record.presentations.push_back(presentation_from(piece, unit));
  return record;
}

}  // namespace jnd
