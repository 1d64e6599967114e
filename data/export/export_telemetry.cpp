#include "data/export/export_telemetry.h"

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "data/fields/field.h"

namespace jnd {

namespace {

bool of_joint(const TelemetryRow& row) {
  return row.telemetry->channels[static_cast<std::size_t>(row.tick->channel)].channel == Channel::kinaesthetic;
}

std::string limit_words(std::uint32_t limits, const std::vector<std::string>& names) {
  std::string words;
  for (std::size_t bit = 0; bit < 32; ++bit)
    if ((limits >> bit & 1U) != 0)
      words.append(words.empty() ? "" : " ").append(bit < names.size() ? names[bit] : fmt::format("bit_{}", bit));
  return words;
}

}  // namespace

std::vector<CsvColumn<TelemetryRow>> telemetry_columns(const Protocol& protocol,
                                                       const std::vector<std::string>& limit_names) {
  using R = TelemetryRow;
  const std::string length(length_suffix(protocol.stimulus.unit));
  std::string levels;
  for (const std::string& name : limit_names) levels.append(levels.empty() ? "" : " ").append(name);
  const auto tick = [](auto member) { return [member](const R& r) { return r.tick->*member; }; };
  const auto channel = [](const R& r) -> const auto& {
    return r.telemetry->channels[static_cast<std::size_t>(r.tick->channel)];
  };
  const Fields<R> fields = {
      {"time_s",
       "since the first tick of the file",
       [](const R& r) { return static_cast<double>(r.tick->time_ns - r.telemetry->ticks.front().time_ns) / 1e9; },
       {.unit = "s"}},
      {"time_ns", "of the control loop's monotonic clock", tick(&TickRecord::time_ns), {.unit = "ns"}},
      {"lateness_ns",
       "how late the tick began; 0 on the simulated clock",
       tick(&TickRecord::lateness_ns),
       {.unit = "ns"}},
      {"finger", "finger that the device acts on",
       [&protocol, channel](const R& r) {
         const auto finger = static_cast<std::size_t>(channel(r).finger);
         return finger < protocol.rig.fingers.size() ? protocol.rig.fingers[finger]
                                                     : fmt::format("finger {}", finger + 1);
       }},
      {"channel",
       "what the device acts on: the pulp or the joint",
       [channel](const R& r) { return channel(r).channel; },
       {.levels = "cutaneous kinaesthetic"}},
      {"limits",
       "limits of the governor that acted, separated by blanks",
       [limit_names](const R& r) { return limit_words(r.tick->limits, limit_names); },
       {.levels = levels, .several = true}},
      {"penetration_" + length, "penetration of the contact", tick(&TickRecord::penetration), {.unit = length}},
      {"asked_n", "force that the contact asks for", tick(&TickRecord::asked_n), {.unit = "N"}},
      {"given_n", "force that the governor let through", tick(&TickRecord::given_n), {.unit = "N"}},
      {"measured_n", "force that the device measured", tick(&TickRecord::measured_n), {.unit = "N"}},
      {"vibration_g", "amplitude of the vibration given", tick(&TickRecord::vibration_g), {.unit = "g"}},
      {"travel_m",
       "height of the platform; empty for a joint",
       [](const R& r) { return of_joint(r) ? kNaN : r.tick->travel; },
       {.unit = "m"}},
      {"travel_rad",
       "angle of the joint; empty for a platform",
       [](const R& r) { return of_joint(r) ? r.tick->travel : kNaN; },
       {.unit = "rad"}},
      {"finger_x_m",
       "position of the fingertip in the world, x",
       [](const R& r) { return r.tick->finger_m[0]; },
       {.unit = "m"}},
      {"finger_y_m",
       "position of the fingertip in the world, y",
       [](const R& r) { return r.tick->finger_m[1]; },
       {.unit = "m"}},
      {"finger_z_m",
       "position of the fingertip in the world, z",
       [](const R& r) { return r.tick->finger_m[2]; },
       {.unit = "m"}}};
  return csv_columns(fields);
}

std::vector<TelemetryRow> telemetry_rows(const Telemetry& telemetry) {
  std::vector<TelemetryRow> rows;
  rows.reserve(telemetry.ticks.size());
  for (const TickRecord& tick : telemetry.ticks) rows.push_back({&telemetry, &tick});
  return rows;
}

std::vector<CsvColumn<TraceRow>> trace_columns() {
  using R = TraceRow;
  const auto channel = [](const R& r) -> const Trace::Channel& {
    return r.trace->channels[static_cast<std::size_t>(r.sample->channel)];
  };
  const Fields<R> fields = {
      {"heard_s",
       "when the sample came, since the interval began",
       [](const R& r) { return r.sample->heard_s; },
       {.unit = "s"}},
      {"rig_s",
       "when it was measured, on the rig's own clock",
       [](const R& r) { return r.sample->rig_s; },
       {.unit = "s"}},
      {"channel", "what was measured, as the rig names it", [channel](const R& r) { return channel(r).name; }},
      {"unit", "unit of the value", [channel](const R& r) { return channel(r).unit; }},
      {"value", "what was measured, in its unit", [](const R& r) { return r.sample->value; }}};
  return csv_columns(fields);
}

std::vector<TraceRow> trace_rows(const Trace& trace) {
  std::vector<TraceRow> rows;
  rows.reserve(trace.samples.size());
  for (const Trace::Sample& sample : trace.samples) rows.push_back({&trace, &sample});
  return rows;
}

std::string telemetry_file(std::string_view what, bool trace, int index, int attempt, int interval, int again) {
  return fmt::format("telemetry/{}-{:03}-attempt-{}-interval-{}{}{}.csv", what, index, attempt, interval + 1,
                     trace ? "-trace" : "", again > 1 ? fmt::format("-{}", again) : std::string());
}

}  // namespace jnd
