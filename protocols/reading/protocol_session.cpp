// Reads what surrounds the trials: the members "practice" and "breaks".
#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "protocols/reading/protocol_reading.h"

namespace jnd {
namespace {

// With which standard; where there is one, or none, it need not be said.
void read_practice_standard(JsonReader& reader, Practice& practice, ProtocolReading& reading) {
  const bool several = reading.protocol.series.size() > 1;
  if (several)
    (void)reader.text("standard", {.max_length = 100});
  else
    reader.ignore("standard");
  if (const JsonNode* standard = reader.node().find("standard"); standard != nullptr && reading.sound(standard->path))
    practice.series = series_place(*standard, reading).value_or(0);
  reader.refuse({"series"}, "has no meaning beside standards", "write \"standard\" and the name of one");
}

void read_practice_series(JsonReader& reader, Practice& practice, ProtocolReading& reading) {
  if (!reading.has_pairs()) {
    reader.refuse({"difference"}, "belongs to a design with a procedure", "remove it: the levels are practised");
    return read_practice_standard(reader, practice, reading);
  }
  (void)reader.text("series", {.max_length = 100});
  if (const JsonNode* series = reader.node().find("series"); series != nullptr && reading.sound(series->path))
    practice.series = series_place(*series, reading).value_or(0);
  reader.refuse({"difference"}, "belongs to a design with a procedure", "remove it: \"series\" names the pair");
}

void read_practice_difference(JsonReader& reader, Practice& practice, ProtocolReading& reading) {
  const Unit unit = reading.protocol.stimulus.unit;
  if (!reading.has_pairs()) {
    practice.difference = reader.number("difference", {.min = 0, .max = 1e9, .above = true, .unit = to_string(unit)});
    return read_practice_standard(reader, practice, reading);
  }
  const double reference = reading.protocol.stimulus.reference, softest = stiffness_limits(unit).min;
  practice.difference = reader.number("difference", {.min = 0, .max = 20000, .above = true, .unit = to_string(unit)});
  const bool sound = reading.sound(reader.node().path + ".difference") && reading.sound("$.stimulus.reference");
  if (sound && reference - *practice.difference < softest)
    reader.error("difference",
                 fmt::format("a comparison {} {} softer than the reference, {}, is too soft",
                             plain(*practice.difference), to_string(unit), plain(reference)),
                 fmt::format("at most {}", plain(reference - softest)));
  reader.refuse({"series"}, "has no meaning beside $.design.procedure",
                "remove it: \"difference\" says how much softer the comparison is");
}

}  // namespace

void read_practice(const JsonNode& node, ProtocolReading& reading) {
  Practice practice;
  JsonReader reader(node, reading.errors, reading.file);
  if (reading.has_pairs()) reader.refuse({"standard"}, "belongs to tasks with standards", "remove it");
  practice.trials = reader.integer("trials", {.min = 1, .max = 200});
  if (reading.adaptive())
    read_practice_difference(reader, practice, reading);
  else
    read_practice_series(reader, practice, reading);
  if (const JsonNode* conditions = reader.array_or_null("conditions", 1, 20)) {
    for (const JsonNode& item : conditions->items) {
      const auto place = condition_place(item, reading);
      if (!place) continue;
      if (std::find(practice.conditions.begin(), practice.conditions.end(), *place) != practice.conditions.end())
        reading.error(item, in_quotes(item.text) + " is named twice", "name each condition once; they take turns");
      practice.conditions.push_back(*place);
    }
  } else {
    practice.conditions.resize(reading.protocol.conditions.size());
    std::iota(practice.conditions.begin(), practice.conditions.end(), 0);
  }
  practice.criterion_correct = reader.number("criterion_correct", {.min = 0, .max = 1});
  practice.max_rounds = reader.integer("max_rounds", {.min = 1, .max = 20});
  practice.feedback = reader.one_of_or<Feedback>(
      "feedback", {{"none", Feedback::none}, {"correctness", Feedback::correctness}}, Feedback::correctness);
  reader.finish();
  reading.protocol.practice = std::move(practice);
}

void read_breaks(const JsonNode& list, ProtocolReading& reading) {
  using After = Break::After;
  for (const JsonNode& item : list.items) {
    Break pause;
    JsonReader reader(item, reading.errors, reading.file);
    pause.after =
        reader.one_of<After>("after", {{"block", After::block}, {"series", After::series}, {"trials", After::trials}});
    if (!reading.sound(item.path + ".after")) {
      reader.ignore("trials");
    } else if (pause.after == After::trials) {
      pause.trials = reader.integer("trials", {.min = 1, .max = 10000});
    } else if (reader.member("trials") != nullptr) {
      reader.error("trials", "has no meaning in a break after each " + item.find("after")->text,
                   "remove it, or write \"after\": \"trials\"");
    }
    pause.duration_s = reader.number("duration_s", {.min = 0, .max = 3600, .unit = "s"});
    pause.say = reader.text_or("say", "", {.max_length = 200});
    reader.finish();
    reading.protocol.breaks.push_back(std::move(pause));
  }
}

}  // namespace jnd
