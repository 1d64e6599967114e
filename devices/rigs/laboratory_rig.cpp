#include "devices/rigs/laboratory_rig.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "protocols/course/prescription.h"
#include "protocols/input/input_error.h"

namespace jnd {
namespace {

std::map<std::string, RigParameterValue> parameters_of(const Condition& condition) {
  std::map<std::string, RigParameterValue> parameters;
  for (const auto& [name, value] : condition.parameters) {
    if (const double* number = std::get_if<double>(&value))
      parameters[name] = *number;
    else if (const bool* flag = std::get_if<bool>(&value))
      parameters[name] = std::string(*flag ? "true" : "false");
    else
      parameters[name] = std::get<std::string>(value);
  }
  return parameters;
}

}  // namespace

RigDemand rig_demand(const Protocol& protocol) {
  RigDemand demand{.quantity = protocol.stimulus.quantity, .unit = std::string(to_string(protocol.stimulus.unit))};
  std::set<double> values;
  for (const Series& series : protocol.series) {
    values.insert(series.pair.begin(), series.pair.end());
    values.insert(series.levels.begin(), series.levels.end());
    if (series.standard != 0) values.insert(series.standard);
  }
  demand.values.assign(values.begin(), values.end());
  for (const Condition& condition : protocol.conditions) demand.conditions.push_back(parameters_of(condition));
  return demand;
}

RigInfo laboratory_rig_info(const ExternalSettings& settings) {
  return {.name = fmt::format("external: {}", in_words(settings)),
          .mode = "",
          .tracker = "",
          .sha256 = "",
          .simulated = false};
}

LaboratoryRig::LaboratoryRig(const ExternalSettings& settings, const Protocol& protocol, Clock& clock)
    : protocol_(protocol), clock_(clock), rig_(settings, clock), info_(laboratory_rig_info(settings)) {
  if (!rig_.await_hello(settings.time_outs.hello_s)) throw DeviceError(rig_.missing());
  const RigHello hello = rig_.hello().value();
  const std::vector<std::string> problems = rig_problems(rig_demand(protocol), hello);
  if (!problems.empty()) {
    std::string text = "the rig cannot present what the protocol asks:";
    for (const std::string& problem : problems) text += "\n  " + problem;
    throw InputError(text);
  }
  info_.name = fmt::format("{} {}", hello.name, hello.version);
  info_.simulated = hello.model;
}

Presentation LaboratoryRig::present(const PresentRequest& request) {
  if (!stop.latched()) rig_.stop.clear();
  // Who stops the session stops the rig: it has a latch of its own, because its thread outlives presentations.
  const std::jthread passing_on([this](const std::stop_token& over) {
    while (!over.stop_requested()) {
      if (stop.latched()) rig_.stop.latch(stop.source());
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  RenderRequest asked;
  asked.id = request.id;
  asked.quantity = protocol_.stimulus.quantity;
  asked.unit = to_string(protocol_.stimulus.unit);
  asked.value = request.stimulus.stiffness;
  if (request.condition != nullptr) asked.parameters = parameters_of(*request.condition);
  asked.exploration.ends = request.contacts > 0 ? RigExplorationEnd::contacts
                           : request.enough     ? RigExplorationEnd::stop
                                                : RigExplorationEnd::time;
  asked.exploration.duration_s = request.explore_s;
  asked.exploration.contacts = request.contacts;
  if (request.condition != nullptr) {
    const Prescription* const prescription = prescription_of(protocol_, *request.condition);
    if (prescription != nullptr && prescription->pace_hz > 0) asked.exploration.pace_hz = prescription->pace_hz;
  }
  asked.exploration.no_contact_s = request.no_contact_time_out_s;
  asked.time_out_s = request.explore_s + request.no_contact_time_out_s;
  std::optional<std::int64_t> touched_ns;
  const auto hear = [&](const RigEvent& event) {
    if (!touched_ns && std::holds_alternative<RigContact>(event.what)) touched_ns = event.time_ns;
    if (look_) look_({.contact = touched_ns.has_value()});
  };
  // What its own time does not end is over with explore_s at the latest.
  const auto enough = [&] {
    if (!touched_ns) return false;
    if (clock_.now_ns() - *touched_ns >= std::llround(1e9 * request.explore_s)) return true;
    return request.enough && request.enough();
  };
  const bool by_time = asked.exploration.ends == RigExplorationEnd::time;
  const Rendered rendered = rig_.render(asked, hear, by_time ? std::function<bool()>() : enough);
  Presentation presentation = presentation_of(rendered, stop.source());
  if (!rendered.done) return presentation;
  const RigDone& done = *rendered.done;
  if (done.outcome == RigOutcome::no_contact) presentation.fault = Fault::no_contact;
  presentation.delivered = done.delivered;
  for (const auto& [name, value] : done.channels) presentation.measured[name] = value;
  for (const auto& [name, value] : done.peaks) presentation.measured["peak_" + name] = value;
  presentation.measured["contacts"] = done.contacts;
  return presentation;
}

void LaboratoryRig::neutral() noexcept {
  try {
    rig_.stop_with(RigStop::interrupted);
  } catch (...) {
    // A rig that cannot be told is ended by its own silence.
  }
}

RigConnections LaboratoryRig::connections() const {
  const ExternalReport report = rig_.report();
  DeviceLinkReport link;
  link.serial = report.hello ? report.hello->serial : report.source;
  link.firmware = report.hello ? report.hello->version : "";
  link.is_model = report.hello && report.hello->model;
  link.connected = report.connected;
  link.trouble = report.trouble;
  link.reconnections = std::max(0, report.starts - 1);
  return {.devices = {link}, .tracker = std::nullopt};
}

}  // namespace jnd
