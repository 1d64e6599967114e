// Reads what is presented and how a trial goes: the members "rig", "trial" and "stimulus".
#include <algorithm>

#include <fmt/format.h>

#include "protocols/protocol_reading.h"

namespace jnd {
namespace {

void read_fingers(const JsonNode& list, ProtocolReading& reading) {
  static const std::vector<std::string_view> kFingers = {"thumb", "index", "middle", "ring", "little"};
  std::vector<std::string>& fingers = reading.protocol.rig.fingers;
  for (const JsonNode& item : list.items) {
    const auto place = word_of(item, kFingers, {}, reading.errors, reading.file);
    if (!place) continue;
    const std::string finger(kFingers[*place]);
    if (std::find(fingers.begin(), fingers.end(), finger) != fingers.end())
      reading.error(item, in_quotes(finger) + " is named twice", "name two different fingers, or one");
    fingers.push_back(finger);
  }
}

CueSignal read_cue(JsonReader& cues, std::string_view key, ProtocolReading& reading) {
  CueSignal signal;
  const JsonNode* node = cues.object(key);
  if (node == nullptr) return signal;
  JsonReader reader(*node, reading.errors, reading.file);
  signal.kind = reader.one_of<std::string>("kind", {{"sound", "sound"}, {"tap", "tap"}, {"none", "none"}});
  signal.say = reader.text_or("say", "", {.max_length = 200});
  reader.finish();
  return signal;
}

// The console keeps these for itself.
constexpr std::string_view kReservedKeys = "pqx";

char read_key(JsonReader& keys, std::string_view key, char fallback, ProtocolReading& reading) {
  const std::string text = keys.text(key, {.max_length = 20});
  const JsonNode* node = keys.node().find(key);
  if (text.empty() || node == nullptr) return fallback;
  const auto is_letter_or_digit = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  };
  if (text.size() != 1 || !is_letter_or_digit(text[0])) {
    reading.error(*node, in_quotes(text) + " is not a key", "must be one ASCII letter or digit");
    return fallback;
  }
  if (kReservedKeys.find(text[0]) != std::string_view::npos) {
    reading.error(*node, in_quotes(text) + " is reserved",
                  "p pauses, q quits and x stops the devices; take another key");
    return fallback;
  }
  return text[0];
}

void read_keys(const JsonNode& node, ProtocolReading& reading) {
  Timeline& timeline = reading.protocol.timeline;
  JsonReader reader(node, reading.errors, reading.file);
  timeline.key_same = read_key(reader, "same", 's', reading);
  timeline.key_different = read_key(reader, "different", 'd', reading);
  reader.finish();
  if (reading.sound(node.path) && timeline.key_same == timeline.key_different)
    reader.error("different", "is the key for \"same\" too", "the two answers need different keys");
}

}  // namespace

void read_rig(const JsonNode& node, ProtocolReading& reading) {
  RigRequest& rig = reading.protocol.rig;
  JsonReader reader(node, reading.errors, reading.file);
  rig.device = reader.one_of<std::string>("device", {{"rrs3", "rrs3"}});
  if (const JsonNode* fingers = reader.array("fingers", 1, 2)) read_fingers(*fingers, reading);
  if (reader.word("tracker", {"hand"}, {"hid", "pipe", "replay"}, true)) rig.tracker = "hand";
  rig.separation_m = reader.number("separation_m", {.min = 0.02, .max = 0.5, .unit = "m"});
  rig.sphere_radius_m = reader.number("sphere_radius_m", {.min = 0.005, .max = 0.2, .unit = "m"});
  reader.finish();
  if (reading.sound("$.rig.separation_m") && reading.sound("$.rig.sphere_radius_m") &&
      2 * rig.sphere_radius_m >= rig.separation_m) {
    reader.error("sphere_radius_m",
                 fmt::format("a sphere of {} m does not fit between devices {} m apart", plain(2 * rig.sphere_radius_m),
                             plain(rig.separation_m)),
                 "the fingers must be able to begin outside it: make it smaller than half of separation_m");
  }
}

void read_trial(const JsonNode& node, ProtocolReading& reading) {
  Timeline& timeline = reading.protocol.timeline;
  JsonReader reader(node, reading.errors, reading.file);
  timeline.explore_s = reader.number("explore_s", {.min = 0.5, .max = 60, .unit = "s"});
  timeline.no_contact_time_out_s = reader.number("no_contact_time_out_s", {.min = 1, .max = 120, .unit = "s"});
  timeline.gap_s = reader.number("gap_s", {.min = 0, .max = 60, .unit = "s"});
  timeline.between_trials_s = reader.number("between_trials_s", {.min = 0, .max = 120, .unit = "s"});
  timeline.answer_time_out_s = reader.number("answer_time_out_s", {.min = 1, .max = 600, .unit = "s"});
  timeline.max_attempts = reader.integer("max_attempts", {.min = 1, .max = 10});
  if (const JsonNode* cues = reader.object("cues")) {
    JsonReader part(*cues, reading.errors, reading.file);
    timeline.first_cue = read_cue(part, "first", reading);
    timeline.second_cue = read_cue(part, "second", reading);
    timeline.question_cue = read_cue(part, "question", reading);
    part.finish();
  }
  if (const JsonNode* keys = reader.object("keys")) read_keys(*keys, reading);
  reader.finish();
}

void read_stimulus(const JsonNode& node, ProtocolReading& reading) {
  StimulusSpec& stimulus = reading.protocol.stimulus;
  JsonReader reader(node, reading.errors, reading.file);
  stimulus.quantity = reader.one_of<std::string>("quantity", {{"stiffness", "stiffness"}});
  const JsonNode* unit = reader.member("unit");
  if (unit != nullptr && unit->kind == JsonNode::Kind::string && unit->text == "N/mm") {
    reader.error(*unit, "\"N/mm\" is not known", "write \"N/m\" and multiply every stiffness by 1000");
  } else if (unit != nullptr && unit->kind == JsonNode::Kind::string && unit->text == "kN/m") {
    reader.error(*unit, "\"kN/m\" is not known", "write \"N/m\" and multiply every stiffness by 1000");
  } else {
    stimulus.unit = reader.one_of<std::string>("unit", {{"N/m", "N/m"}});
  }
  stimulus.reference_n_per_m = reader.number("reference", {.min = 1, .max = 20000, .unit = "N/m"});
  stimulus.expected_press_m = reader.number("expected_press_m", {.min = 0.0005, .max = 0.03, .unit = "m"});
  stimulus.on_saturation =
      reader.one_of<OnSaturation>("on_saturation", {{"flag", OnSaturation::flag}, {"repeat", OnSaturation::repeat}});
  reader.finish();
}

}  // namespace jnd
