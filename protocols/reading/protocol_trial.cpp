// Reads how a trial goes: the member "trial".
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "protocols/course/prescription.h"
#include "protocols/reading/protocol_reading.h"
#include "protocols/reading/translation.h"
#include "protocols/tasks/task.h"

namespace jnd {
namespace {

CueSignal read_cue(JsonReader& cues, std::string_view key, ProtocolReading& reading) {
  CueSignal signal;
  const JsonNode* node = cues.object(key);
  if (node == nullptr) return signal;
  JsonReader reader(*node, reading.errors, reading.file);
  signal.kind = reader.one_of<std::string>("kind", {{"sound", "sound"}, {"tap", "tap"}, {"none", "none"}});
  if (signal.kind == "tap" && !reading.protocol.rig.built_in() && !reading.protocol.rig.device.empty())
    reader.error(
        "kind", fmt::format("\"tap\" is a burst of our own devices, not of {}", in_quotes(reading.protocol.rig.device)),
        "write \"sound\", or \"none\"");
  signal.say = reader.text_or("say", "", {.max_length = 200});
  reader.finish();
  return signal;
}

// The console keeps these for itself.
constexpr std::string_view kReservedKeys = "pqxX";

// What Caps Lock makes of a letter; 0 where it is none.
char with_caps_lock(char key) {
  const bool letter = (key >= 'a' && key <= 'z') || (key >= 'A' && key <= 'Z');
  return letter ? static_cast<char>(key ^ 0x20) : '\0';
}

char read_key(JsonReader& keys, const std::string& key, char fallback, ProtocolReading& reading) {
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

// The answers of a task: its classes, each in as many degrees of sureness as are asked, the surest of the first class
// first and the surest of the last one last where there are two.
std::vector<AnswerChoice> answers_of(const TaskSpec& task) {
  std::vector<AnswerChoice> answers;
  const int degrees = std::max(task.sureness_levels, 1);
  for (int said = 0; said < static_cast<int>(task.classes.size()); ++said) {
    for (int step = 0; step < degrees; ++step) {
      const int sureness = said == 0 ? degrees - step : step + 1;
      const std::string& word = task.classes[static_cast<std::size_t>(said)];
      answers.push_back({task.sureness_levels == 0 ? word : fmt::format("{}-{}", word, sureness), 0, said,
                         task.sureness_levels == 0 ? 0 : sureness});
    }
  }
  return answers;
}

void read_keys(const JsonNode& node, ProtocolReading& reading) {
  std::vector<AnswerChoice>& answers = reading.protocol.task.answers;
  JsonReader reader(node, reading.errors, reading.file);
  for (AnswerChoice& answer : answers) answer.key = read_key(reader, answer.word, answer.key, reading);
  reader.finish();
  if (!reading.sound(node.path)) return;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const auto warn = [&](const std::string& other) {
      reading.warn_at(member_path(node.path, answers[i].word),
                      fmt::format("Caps Lock turns the key for {} into this one", other), "take another letter");
    };
    if (answers[i].key == 'P') warn("the pause");
    if (answers[i].key == 'Q') warn("the end of the session");
    for (std::size_t j = 0; j < i; ++j) {
      if (answers[i].key == with_caps_lock(answers[j].key)) warn(in_quotes(answers[j].word));
      if (answers[i].key != answers[j].key) continue;
      reader.error(answers[i].word, fmt::format("is the key for {} too", in_quotes(answers[j].word)),
                   answers.size() == 2 ? "the two answers need different keys" : "every answer needs a key of its own");
      break;
    }
  }
}

// Which answers there are, and their keys.
void read_answers(JsonReader& reader, ProtocolReading& reading) {
  TaskSpec& task = reading.protocol.task;
  task.answers = answers_of(task);
  if (task.answers.empty()) {
    reader.refuse({"keys"}, "has no meaning where the answer is a number", "remove it: the number is typed");
    return;
  }
  if (const JsonNode* keys = reader.object("keys")) read_keys(*keys, reading);
}

void read_interval_cues(const JsonNode& node, ProtocolReading& reading) {
  constexpr std::array<std::string_view, kMostIntervals> kPlaces = {"first", "second", "third"};
  Timeline& timeline = reading.protocol.timeline;
  const auto intervals = static_cast<std::size_t>(felt_intervals(reading.protocol.task));
  JsonReader part(node, reading.errors, reading.file);
  for (std::size_t i = 0; i < kPlaces.size(); ++i) {
    if (i < intervals)
      timeline.interval_cues[i] = read_cue(part, kPlaces[i], reading);
    else if (part.member(kPlaces[i]) != nullptr)
      part.error(kPlaces[i],
                 fmt::format("has no meaning where a trial has {} interval{}{}", intervals, intervals == 1 ? "" : "s",
                             reading.protocol.task.together ? ", felt side by side" : ""),
                 "remove it");
  }
  timeline.question_cue = read_cue(part, "question", reading);
  part.finish();
}

Prescription::Limit read_limit(const JsonNode& node, ProtocolReading& reading) {
  Prescription::Limit limit;
  JsonReader reader(node, reading.errors, reading.file);
  JsonReader::Words<std::string> words;
  for (const PrescribedMeasure& measure : kPrescribedMeasures)
    words.emplace_back(measure.name, std::string(measure.name));
  limit.measure = reader.one_of<std::string>("measure", words);
  const auto* const measure = std::find_if(kPrescribedMeasures.begin(), kPrescribedMeasures.end(),
                                           [&](const PrescribedMeasure& one) { return one.name == limit.measure; });
  const NumberLimits bounds{.min = 0, .max = measure->most, .unit = measure->unit};
  limit.low = reader.number_or("low", 0, bounds);
  limit.high = reader.number("high", bounds);
  reader.finish();
  if (reading.sound(node.path) && limit.low > limit.high)
    reader.error("high", fmt::format("{} is below low, {}", plain(limit.high), plain(limit.low)),
                 "nothing could be between them: change one");
  return limit;
}

// What a limit's measure may be of this rig: a specimen measures nothing.
void read_limits(JsonReader& reader, Prescription& prescription, ProtocolReading& reading) {
  const JsonNode* list = reader.array_or_null("limits", 1, kPrescribedMeasures.size());
  if (list == nullptr) return;
  if (reading.protocol.rig.device == kSpecimenRig) {
    reading.error(*list, "nothing measures how specimens are felt", "remove it: the operator watches");
    return;
  }
  for (const JsonNode& item : list->items) {
    const Prescription::Limit limit = read_limit(item, reading);
    const bool known = std::any_of(prescription.limits.begin(), prescription.limits.end(),
                                   [&](const Prescription::Limit& other) { return other.measure == limit.measure; });
    if (known && reading.sound(item.path))
      reading.error(item, fmt::format("there are two limits on {}", limit.measure), "one of each measure: join them");
    prescription.limits.push_back(limit);
  }
}

}  // namespace

Prescription read_prescription(const JsonNode& node, ProtocolReading& reading) {
  Prescription prescription;
  JsonReader reader(node, reading.errors, reading.file);
  prescription.say = reader.text_or("say", "", kSayLimits);
  prescription.pace_hz = reader.optional_number("pace_hz", {.min = 0.2, .max = 5, .unit = "Hz"}).value_or(0);
  read_limits(reader, prescription, reading);
  prescription.on_breach = reader.one_of_or<OnSaturation>(
      "on_breach", {{"flag", OnSaturation::flag}, {"repeat", OnSaturation::repeat}}, OnSaturation::flag);
  if (node.find("on_breach") != nullptr && prescription.limits.empty() && reading.sound(node.path))
    reader.error("on_breach", "has no meaning without limits", "add \"limits\", or remove it");
  reader.finish();
  if (reading.sound(node.path) && prescription.say.empty() && prescription.pace_hz == 0 && prescription.limits.empty())
    reading.error(node, "prescribes nothing", "give \"say\", \"pace_hz\" or \"limits\", or remove it");
  return prescription;
}

namespace {

// What ends an interval, and what is to be done in it.
void read_exploration(JsonReader& reader, ProtocolReading& reading) {
  Timeline& timeline = reading.protocol.timeline;
  timeline.interval_end = reader.one_of_or<IntervalEnd>(
      "interval_end", {{"time", IntervalEnd::time}, {"contacts", IntervalEnd::contacts}, {"key", IntervalEnd::key}},
      IntervalEnd::time);
  const bool by_contacts = timeline.interval_end == IntervalEnd::contacts;
  if (by_contacts)
    timeline.contacts = reader.integer("contacts", {.min = 1, .max = 100});
  else if (reader.member("contacts") != nullptr)
    reader.error("contacts", "has no meaning unless contacts end an interval",
                 "write \"interval_end\": \"contacts\", or remove it");
  if (by_contacts && reading.protocol.rig.device == kSpecimenRig)
    reader.error("interval_end", "nothing counts the contacts with a specimen",
                 "write \"key\": the operator counts, and presses it");
  if (const JsonNode* prescription = reader.object_or_null("prescription"))
    timeline.prescription = read_prescription(*prescription, reading);
}

}  // namespace

void read_trial(const JsonNode& node, ProtocolReading& reading) {
  Timeline& timeline = reading.protocol.timeline;
  JsonReader reader(node, reading.errors, reading.file);
  timeline.explore_s = reader.number("explore_s", {.min = 0.5, .max = 60, .unit = "s"});
  read_exploration(reader, reading);
  timeline.no_contact_time_out_s = reader.number("no_contact_time_out_s", {.min = 1, .max = 120, .unit = "s"});
  timeline.gap_s = felt_intervals(reading.protocol.task) > 1
                       ? reader.number("gap_s", {.min = 0, .max = 60, .unit = "s"})
                       : reader.number_or("gap_s", 0, {.min = 0, .max = 60, .unit = "s"});
  timeline.between_trials_s = reader.number("between_trials_s", {.min = 0, .max = 120, .unit = "s"});
  timeline.answer_time_out_s = reader.number("answer_time_out_s", {.min = 1, .max = 600, .unit = "s"});
  timeline.max_attempts = reader.integer("max_attempts", {.min = 1, .max = 10});
  if (const JsonNode* cues = reader.object("cues")) read_interval_cues(*cues, reading);
  read_answers(reader, reading);
  reader.finish();
}

}  // namespace jnd
