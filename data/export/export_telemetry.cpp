#include "data/export/export_telemetry.h"

#include <fmt/format.h>

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
  return {
      {"time_s", "since the first tick of the file", "s", "",
       [](const R& r) {
         return csv_number(static_cast<double>(r.tick->time_ns - r.telemetry->ticks.front().time_ns) / 1e9);
       }},
      {"time_ns", "of the control loop's monotonic clock", "ns", "",
       [](const R& r) { return csv_number(r.tick->time_ns); }},
      {"lateness_ns", "how late the tick began; 0 on the simulated clock", "ns", "",
       [](const R& r) { return csv_number(r.tick->lateness_ns); }},
      {"finger", "finger that the device acts on", "", "",
       [&protocol](const R& r) {
         const auto finger =
             static_cast<std::size_t>(r.telemetry->channels[static_cast<std::size_t>(r.tick->channel)].finger);
         return finger < protocol.rig.fingers.size() ? csv_text(protocol.rig.fingers[finger])
                                                     : fmt::format("finger {}", finger + 1);
       }},
      {"channel", "what the device acts on: the pulp or the joint", "", "cutaneous kinaesthetic",
       [](const R& r) {
         return std::string(to_string(r.telemetry->channels[static_cast<std::size_t>(r.tick->channel)].channel));
       }},
      {"limits", "limits of the governor that acted, separated by blanks", "", levels,
       [limit_names](const R& r) { return limit_words(r.tick->limits, limit_names); }},
      {"penetration_" + length, "penetration of the contact", length, "",
       [](const R& r) { return csv_number(r.tick->penetration); }},
      {"asked_n", "force that the contact asks for", "N", "", [](const R& r) { return csv_number(r.tick->asked_n); }},
      {"given_n", "force that the governor let through", "N", "",
       [](const R& r) { return csv_number(r.tick->given_n); }},
      {"measured_n", "force that the device measured", "N", "",
       [](const R& r) { return csv_number(r.tick->measured_n); }},
      {"vibration_g", "amplitude of the vibration given", "g", "",
       [](const R& r) { return csv_number(r.tick->vibration_g); }},
      {"travel_m", "height of the platform; empty for a joint", "m", "",
       [](const R& r) { return of_joint(r) ? std::string() : csv_number(r.tick->travel); }},
      {"travel_rad", "angle of the joint; empty for a platform", "rad", "",
       [](const R& r) { return of_joint(r) ? csv_number(r.tick->travel) : std::string(); }},
      {"finger_x_m", "position of the fingertip in the world, x", "m", "",
       [](const R& r) { return csv_number(r.tick->finger_m[0]); }},
      {"finger_y_m", "position of the fingertip in the world, y", "m", "",
       [](const R& r) { return csv_number(r.tick->finger_m[1]); }},
      {"finger_z_m", "position of the fingertip in the world, z", "m", "",
       [](const R& r) { return csv_number(r.tick->finger_m[2]); }}};
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
  return {{"heard_s", "when the sample came, since the interval began", "s", "",
           [](const R& r) { return csv_number(r.sample->heard_s); }},
          {"rig_s", "when it was measured, on the rig's own clock", "s", "",
           [](const R& r) { return csv_number(r.sample->rig_s); }},
          {"channel", "what was measured, as the rig names it", "", "",
           [channel](const R& r) { return csv_text(channel(r).name); }},
          {"unit", "unit of the value", "", "", [channel](const R& r) { return csv_text(channel(r).unit); }},
          {"value", "what was measured, in its unit", "", "", [](const R& r) { return csv_number(r.sample->value); }}};
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
