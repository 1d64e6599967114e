#include "runner/opening/readiness.h"

#include <algorithm>

#include <fmt/format.h>

#include "devices/clock.h"
#include "runner/opening/readiness_buttons.h"
#include "runner/opening/readiness_items.h"
#include "runner/terminal/terminal.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

Check left_out(const char* name) {
  return {.what = name, .verdict = Verdict::ok, .found = "not tested in a quick rehearsal"};
}

// What no reason sets aside.
bool final_item(const Check& item) {
  return item.what == kStorageItem || item.what == kParticipantItem;
}

}  // namespace

Readiness check_readiness(const ReadinessInput& input) {
  const std::int64_t utc_ns = SteadyClock().utc_ns();
  const std::vector<SessionInfo> sessions = input.study.sessions();
  const double needed = input.rig.telemetry() == nullptr ? 0 : telemetry_bytes(input.protocol, input.plan, input.spec);
  Readiness readiness;
  auto& items = readiness.items;
  items.push_back(check_session_storage(input.study_path, needed, input.kind));
  if (input.rig.connections().tracker)  // before the devices: without poses these can only stop
    items.push_back(input.fast ? left_out("tracker") : check_tracker(input.rig));
  items.push_back(input.fast ? left_out("devices") : check_devices(input.spec, input.rig));
  items.push_back(check_description(input.spec));
  items.push_back(check_calibration(input.spec, utc_ns));
  if (!input.spec.devices.empty())
    items.push_back(input.fast ? left_out("loop") : check_loop_jitter(input.rig.realtime().policy));
  items.push_back(check_keyboard(input.keyboard_is_terminal));
  if (input.buttons != nullptr) items.push_back(check_buttons(*input.buttons));
  if (input.rig.buttons() != nullptr)
    items.push_back(
        {.what = "buttons", .verdict = Verdict::ok, .found = "the rig's own: what is pressed there answers"});
  items.push_back(check_study(input.study));
  items.push_back(check_plan_balance(input.protocol, input.plan));
  items.push_back(
      check_participant(sessions, input.participant, input.kind, input.plan, input.protocol.design.sessions));
  items.push_back(input.fast ? left_out("clock") : check_clock(sessions, utc_ns));
  for (const Check& item : items) {
    if (item.verdict != Verdict::bad) continue;
    if (input.kind != SessionKind::real && !final_item(item)) continue;
    readiness.blocked = true;
    readiness.overridable = readiness.overridable && !final_item(item);
  }
  return readiness;
}

nlohmann::ordered_json readiness_body(const Readiness& readiness, const std::string& overridden_because) {
  nlohmann::ordered_json items = nlohmann::ordered_json::array();
  for (const Check& item : readiness.items)
    items.push_back({{"what", item.what},
                     {"verdict", to_string(item.verdict)},
                     {"found", item.found},
                     {"what_to_do", item.what_to_do}});
  nlohmann::ordered_json body = {{"items", std::move(items)}, {"blocked", readiness.blocked}, {"overridden", nullptr}};
  if (readiness.blocked && !overridden_because.empty()) body["overridden"] = overridden_because;
  return body;
}

std::string readiness_text(const Readiness& readiness) {
  std::string text, limits;
  for (const Check& item : readiness.items) {
    if (item.verdict == Verdict::ok) {
      if (item.what == kLimitsItem) limits = tr("Limits: {}.", printable(item.found)) + "\n";
      continue;
    }
    text += fmt::format("{} {}: {}\n", item.verdict == Verdict::bad ? tr("BAD") : tr("warning"), item.what,
                        printable(item.found));
    if (!item.what_to_do.empty()) text += fmt::format("  -> {}\n", printable(item.what_to_do));
  }
  if (text.empty()) {
    for (const Check& item : readiness.items) text += (text.empty() ? "" : ", ") + item.what;
    return tr("Ready: {}.", text) + "\n" + limits;
  }
  text += limits;
  if (readiness.blocked && !readiness.overridable)
    text += tr("No reason sets this aside: answers could be lost, or the participant is not to take part.") + "\n";
  return text;
}

}  // namespace jnd
