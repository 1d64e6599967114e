#include "devices/external/rig_messages.h"

#include <nlohmann/json.hpp>

#include "protocols/input/json_text.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

std::string line_of(const Json& message) {
  return json_text(message) + "\n";
}

Json to_json(const RigExploration& exploration) {
  Json json = {{"ends", word_of(kRigExplorationEndWords, exploration.ends)}};
  if (exploration.ends == RigExplorationEnd::time) {
    json["duration_s"] = exploration.duration_s;
    json["from"] = exploration.from_contact ? "contact" : "start";
  }
  if (exploration.ends == RigExplorationEnd::contacts) json["contacts"] = exploration.contacts;
  if (exploration.no_contact_s > 0) json["no_contact_s"] = exploration.no_contact_s;
  if (exploration.pace_hz) json["pace_hz"] = *exploration.pace_hz;
  for (const auto& [measure, ends] : exploration.limits) json["limits"][measure] = ends;
  return json;
}

Json to_json(const std::map<std::string, RigParameterValue>& parameters) {
  Json json = Json::object();
  for (const auto& [name, value] : parameters)
    std::visit([&, &key = name](const auto& its) { json[key] = its; }, value);
  return json;
}

std::string request_line(std::string_view type, std::uint64_t id, const RenderRequest& request) {
  Json json = {{"type", type},
               {"id", id},
               {"trial", request.id.trial},
               {"attempt", request.id.attempt},
               {"interval", request.id.interval},
               {"quantity", request.quantity},
               {"unit", request.unit},
               {"value", request.value},
               {"parameters", to_json(request.parameters)},
               {"exploration", to_json(request.exploration)},
               {"time_out_s", request.time_out_s}};
  if (request.beside) json["beside"] = *request.beside;
  if (request.beside_parameters) json["beside_parameters"] = to_json(*request.beside_parameters);
  return line_of(json);
}

}  // namespace

std::string hello_line(std::string_view program_version) {
  return line_of({{"type", "hello"}, {"protocol", kExternalProtocol}, {"name", "jnd"}, {"version", program_version}});
}

std::string prepare_line(std::uint64_t id, const RenderRequest& request) {
  return request_line("prepare", id, request);
}

std::string present_line(std::uint64_t id, const RenderRequest& request) {
  return request_line("present", id, request);
}

std::string ask_line(std::uint64_t id, const std::vector<std::string>& answers) {
  return line_of({{"type", "ask"}, {"id", id}, {"answers", answers}});
}

std::string stop_line(std::uint64_t id, RigStop reason) {
  Json message = {{"type", "stop"}};
  if (id != 0) message["id"] = id;
  message["reason"] = word_of(kRigStopWords, reason);
  return line_of(message);
}

std::string alive_line(std::uint64_t n) {
  return line_of({{"type", "alive"}, {"n", n}});
}

std::string bye_line() {
  return line_of({{"type", "bye"}});
}

}  // namespace jnd
