#include "devices/rigs/laboratory_rig.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "protocols/course/prescription.h"
#include "protocols/input/input_error.h"
#include "protocols/tasks/task.h"

namespace jnd {
namespace {

std::map<std::string, RigParameterValue> parameters_of(const Condition& condition, bool of_standard) {
  std::map<std::string, ParameterValue> all = of_standard ? condition.standard_parameters : condition.parameters;
  all.insert(condition.parameters.begin(), condition.parameters.end());  // those that are not otherwise
  std::map<std::string, RigParameterValue> parameters;
  for (const auto& [name, value] : all) {
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
  if (protocol.task.together) demand.places = 2;
  if (felt_intervals(protocol.task) > 1 || task_of(protocol.task.kind).adjusts())
    demand.gap_s = protocol.timeline.gap_s;
  for (const Condition& condition : protocol.conditions) {
    demand.conditions.push_back(parameters_of(condition, false));
    if (const Prescription* const prescription = prescription_of(protocol, condition))
      for (const Prescription::Limit& limit : prescription->limits) demand.measures.push_back(limit.measure);
    if (!condition.standard_parameters.empty()) demand.conditions.push_back(parameters_of(condition, true));
  }
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
    : protocol_(protocol),
      clock_(clock),
      time_outs_(settings.time_outs),
      rig_(settings, clock, stop),
      info_(laboratory_rig_info(settings)) {
  if (!rig_.await_hello(settings.time_outs.hello_s)) throw DeviceError(rig_.missing());
  const RigHello hello = rig_.hello().value();
  const std::vector<std::string> problems = rig_problems(rig_demand(protocol), hello);
  if (!problems.empty()) {
    std::string text = "the rig cannot present what the protocol asks:";
    for (const std::string& problem : problems) text += "\n  " + problem;
    throw InputError(text);
  }
  for (const RigChannel& channel : hello.measures) measures_.push_back({channel.name, channel.unit});
  has_buttons_ = hello.answers;
  holds_ = hello.holds;
  ready_s_ = hello.ready_s;
  info_.name = fmt::format("{} {}", hello.name, hello.version);
  info_.simulated = hello.model;
}

RenderRequest LaboratoryRig::asked_of(const PresentRequest& request) const {
  RenderRequest asked;
  asked.id = request.id;
  asked.quantity = protocol_.stimulus.quantity;
  asked.unit = to_string(protocol_.stimulus.unit);
  asked.value = request.stimulus.stiffness;
  asked.beside = request.beside;
  if (const Condition* const condition = request.condition) {
    asked.parameters = parameters_of(*condition, request.of_standard);
    if (request.beside && !condition->standard_parameters.empty())
      asked.beside_parameters = parameters_of(*condition, request.beside_of_standard);
  }
  asked.exploration.ends = request.contacts > 0                                  ? RigExplorationEnd::contacts
                           : protocol_.timeline.interval_end == IntervalEnd::key ? RigExplorationEnd::stop
                                                                                 : RigExplorationEnd::time;
  asked.exploration.duration_s = request.explore_s;
  asked.exploration.contacts = request.contacts;
  if (request.condition != nullptr) {
    const Prescription* const prescription = prescription_of(protocol_, *request.condition);
    if (prescription != nullptr && prescription->pace_hz > 0) asked.exploration.pace_hz = prescription->pace_hz;
    if (prescription != nullptr)
      for (const Prescription::Limit& limit : prescription->limits)
        asked.exploration.limits[limit.measure] = {limit.low, limit.high};
  }
  asked.exploration.no_contact_s = request.no_contact_time_out_s;
  asked.time_out_s = request.explore_s + request.no_contact_time_out_s;
  return asked;
}

std::int64_t LaboratoryRig::prepare(const PresentRequest& request) {
  if (!holds_ || stop.latched()) return 0;
  RenderRequest asked = asked_of(request);
  if (prepared_ && prepared_->is_for(asked) && rig_.prepares(prepared_->id)) return prepared_->due_ns;
  if (prepared_) rig_.let_go();
  prepared_.reset();
  (void)rig_.wait(0);  // what came before is not of this presentation
  std::string why;     // present() says it
  const std::uint64_t id = rig_.prepare(asked, why);
  if (id == 0) return 0;
  const double ready_s = std::max(ready_s_, time_outs_.ready_s);
  prepared_ = Prepared{std::move(asked), id, clock_.now_ns() + std::llround(1e9 * ready_s)};
  return prepared_->due_ns;
}

Presentation LaboratoryRig::present(const PresentRequest& request) {
  const RenderRequest asked = asked_of(request);
  std::optional<Prepared> prepared = std::exchange(prepared_, std::nullopt);
  if (prepared && !prepared->is_for(asked)) {
    rig_.let_go();
    prepared.reset();
  }
  trace_ = {.channels = measures_, .samples = {}, .dropped = 0};
  const std::int64_t began_ns = clock_.now_ns();
  const std::int64_t dropped_before = rig_.report().traffic.dropped;
  std::optional<std::int64_t> touched_ns;
  const auto hear = [&](const RigEvent& event) {
    if (!touched_ns && std::holds_alternative<RigContact>(event.what)) touched_ns = event.time_ns;
    if (const auto* told = std::get_if<RigTelemetry>(&event.what))
      keep(*told, 1e-9 * static_cast<double>(event.time_ns - began_ns));
    if (look_) look_({.contact = touched_ns.has_value()});
  };
  // What its own time does not end is over with explore_s at the latest.
  const auto enough = [&] {
    if (!touched_ns) return false;
    if (clock_.now_ns() - *touched_ns >= std::llround(1e9 * request.explore_s)) return true;
    return request.enough && request.enough();
  };
  const bool by_time = asked.exploration.ends == RigExplorationEnd::time;
  const std::function<bool()> ends = by_time ? std::function<bool()>() : enough;
  // A rig that holds was told to prepare() before; what it is asked for unprepared, such as after a new start, it is told now.
  const Rendered rendered = prepared ? rig_.render_prepared(prepared->id, hear, ends) : rig_.render(asked, hear, ends);
  trace_.dropped = rig_.report().traffic.dropped - dropped_before;
  Presentation presentation = presentation_of(rendered, stop.source());
  if (!rendered.done) return presentation;
  const RigDone& done = *rendered.done;
  if (done.outcome == RigOutcome::no_contact) presentation.fault = Fault::no_contact;
  presentation.delivered = done.delivered;
  if (request.beside) presentation.delivered_beside = done.delivered_beside;
  for (const auto& [name, value] : done.channels) presentation.measured[name] = value;
  for (const auto& [name, value] : done.peaks) presentation.measured["peak_" + name] = value;
  presentation.measured["contacts"] = done.contacts;
  return presentation;
}

void LaboratoryRig::ask(const std::vector<std::string>& answers) {
  withdraw();
  answers_ = answers;
  asked_ns_ = clock_.now_ns();
  question_ = rig_.ask(answers);
}

std::optional<RigButtons::Pressed> LaboratoryRig::pressed() {
  if (question_ == 0) return std::nullopt;
  std::optional<Pressed> pressed;
  for (const RigEvent& event : rig_.wait(0)) {
    if (const auto* voided = std::get_if<RigVoid>(&event.what); voided != nullptr && voided->id == question_)
      question_ = 0;
    const auto* const answer = std::get_if<RigAnswer>(&event.what);
    if (answer == nullptr || answer->id != question_) continue;
    question_ = 0;
    const auto place = std::find(answers_.begin(), answers_.end(), answer->answer);
    // By the rig's own clock where that can be: a press came after the question, and before it was heard.
    const std::int64_t since_ns = std::llround(1e9 * answer->after_s.value_or(-1));
    const std::int64_t said_ns = asked_ns_ + since_ns;
    if (place != answers_.end())
      pressed = {static_cast<std::size_t>(place - answers_.begin()),
                 since_ns >= 0 && said_ns <= event.time_ns ? said_ns : event.time_ns};
  }
  return pressed;
}

void LaboratoryRig::withdraw() {
  if (std::exchange(question_, 0) != 0) rig_.stop_with(RigStop::interrupted);
}

void LaboratoryRig::keep(const RigTelemetry& telemetry, double heard_s) {
  for (const auto& [name, value] : telemetry.values) {
    const auto channel = std::find_if(measures_.begin(), measures_.end(),
                                      [&key = name](const Trace::Channel& one) { return one.name == key; });
    if (channel != measures_.end())
      trace_.samples.push_back({heard_s, telemetry.time_s, static_cast<int>(channel - measures_.begin()), value});
  }
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
  link.slowest_presenting_ms = report.traffic.slowest_presenting_ms;
  link.slowest_waiting_ms = report.traffic.slowest_waiting_ms;
  return {.devices = {link}, .tracker = std::nullopt};
}

}  // namespace jnd
