// Reads what surrounds the trials: the members "practice", "breaks" and "questions".
#include <algorithm>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "protocols/protocol_reading.h"

namespace jnd {
namespace {

void read_rating(JsonReader& reader, Question& question, ProtocolReading& reading) {
  const int lowest = reader.integer("min", {.min = -100, .max = 100});
  const int highest = reader.integer("max", {.min = -100, .max = 100});
  question.min = lowest;
  question.max = highest;
  question.low_label = reader.text("low", {.max_length = 100});
  question.high_label = reader.text("high", {.max_length = 100});
  const std::string& path = reader.node().path;
  if (reading.sound(path + ".min") && reading.sound(path + ".max") && lowest >= highest)
    reader.error("max", fmt::format("{} is not above min, {}", highest, lowest), "a rating goes from min up to max");
}

void read_number_question(JsonReader& reader, Question& question, ProtocolReading& reading) {
  question.min = reader.number("min", {.min = -1e6, .max = 1e6});
  question.max = reader.number("max", {.min = -1e6, .max = 1e6});
  const std::string& path = reader.node().path;
  if (reading.sound(path + ".min") && reading.sound(path + ".max") && question.min >= question.max)
    reader.error("max", fmt::format("{} is not above min, {}", plain(question.max), plain(question.min)));
}

void read_options(JsonReader& reader, Question& question, ProtocolReading& reading) {
  const JsonNode* options = reader.array("options", 2, 50);
  if (options == nullptr) return;
  for (const JsonNode& item : options->items) {
    const auto option = text_of(item, {.max_length = 100}, reading.errors, reading.file);
    if (!option) continue;
    if (std::find(question.options.begin(), question.options.end(), *option) != question.options.end())
      reading.error(item, fmt::format("the option {} is given twice", in_quotes(*option)), "options must differ");
    question.options.push_back(*option);
  }
}

// Members that belong to another kind of question would be silently without effect.
void refuse_others(JsonReader& reader, std::string_view kind, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys)
    if (reader.member(key) != nullptr)
      reader.error(key, fmt::format("has no meaning in a {} question", kind), "remove it, or change the kind");
}

Question read_question(const JsonNode& node, ProtocolReading& reading) {
  using When = Question::When;
  using Kind = Question::Kind;
  Question question;
  JsonReader reader(node, reading.errors, reading.file);
  question.id = reader.text("id", {.max_length = 32});
  const bool good_id = std::all_of(question.id.begin(), question.id.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  if (!good_id) reader.error("id", in_quotes(question.id) + " cannot be an id", "letters, digits, _ and -, at most 32");
  question.when = reader.one_of<When>("when", {{"before-session", When::before_session},
                                               {"after-condition", When::after_condition},
                                               {"after-series", When::after_series},
                                               {"after-session", When::after_session}});
  const std::vector<std::string_view> kinds = {"rating", "number", "choice", "text"};
  const auto kind = reader.word("kind", kinds, {}, true);
  question.text = reader.text("text", {.max_length = 500});
  question.per_condition = reader.boolean_or("per_condition", false);
  question.required = reader.boolean_or("required", true);
  if (!kind) {
    for (const std::string_view key : {"min", "max", "low", "high", "options"}) reader.ignore(key);
  } else {
    question.kind = static_cast<Kind>(*kind);
    switch (question.kind) {
      case Kind::rating:
        read_rating(reader, question, reading);
        refuse_others(reader, "rating", {"options"});
        break;
      case Kind::number:
        read_number_question(reader, question, reading);
        refuse_others(reader, "number", {"low", "high", "options"});
        break;
      case Kind::choice:
        read_options(reader, question, reading);
        refuse_others(reader, "choice", {"min", "max", "low", "high"});
        break;
      case Kind::text:
        refuse_others(reader, "text", {"min", "max", "low", "high", "options"});
        break;
    }
  }
  if (question.per_condition && question.when != When::after_session && reading.sound(node.path + ".when"))
    reader.error("per_condition", "only a question after the session can be asked for each condition",
                 "remove it, or ask \"after-session\"");
  reader.finish();
  return question;
}

void read_practice_series(JsonReader& reader, Practice& practice, ProtocolReading& reading) {
  (void)reader.text("series", {.max_length = 100});
  if (const JsonNode* series = reader.node().find("series"); series != nullptr && reading.sound(series->path))
    practice.series = series_place(*series, reading).value_or(0);
  if (reader.member("difference") != nullptr)
    reader.error("difference", "belongs to a design with a procedure", "remove it: \"series\" names the pair");
}

void read_practice_difference(JsonReader& reader, Practice& practice, ProtocolReading& reading) {
  const StiffnessUnit unit = reading.protocol.stimulus.unit;
  const double reference = reading.protocol.stimulus.reference, softest = stiffness_limits(unit).min;
  practice.difference = reader.number("difference", {.min = 0, .max = 20000, .above = true, .unit = to_string(unit)});
  const bool sound = reading.sound(reader.node().path + ".difference") && reading.sound("$.stimulus.reference");
  if (sound && reference - *practice.difference < softest)
    reader.error("difference",
                 fmt::format("a comparison {} {} softer than the reference, {}, is too soft",
                             plain(*practice.difference), to_string(unit), plain(reference)),
                 fmt::format("at most {}", plain(reference - softest)));
  if (reader.member("series") != nullptr)
    reader.error("series", "has no meaning beside $.design.procedure",
                 "remove it: \"difference\" says how much softer the comparison is");
}

}  // namespace

void read_practice(const JsonNode& node, ProtocolReading& reading) {
  Practice practice;
  JsonReader reader(node, reading.errors, reading.file);
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

void read_questions(const JsonNode& list, ProtocolReading& reading) {
  std::set<std::string> ids;
  for (const JsonNode& item : list.items) {
    Question question = read_question(item, reading);
    if (!question.id.empty() && !ids.insert(question.id).second)
      reading.error(*item.find("id"), fmt::format("the id {} is taken already", in_quotes(question.id)),
                    "ids must differ");
    reading.protocol.questions.push_back(std::move(question));
  }
}

}  // namespace jnd
