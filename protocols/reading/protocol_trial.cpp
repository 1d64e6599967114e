// Reads how a trial goes: the member "trial".
#include "protocols/reading/protocol_reading.h"

namespace jnd {
namespace {

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
constexpr std::string_view kReservedKeys = "pqxX";

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
                  "p pauses, q quits and x or X stops the devices; take another key");
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

}  // namespace jnd
