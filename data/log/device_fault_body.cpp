// device.fault: the cause of a stop and the last ticks before it, as a table with named columns.
#include <algorithm>
#include <cmath>

#include "data/log/event_body.h"
#include "data/log/presentation_body.h"

namespace jnd {

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
