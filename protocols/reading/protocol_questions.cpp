// Reads what is asked and filled in: the members "questions" and "checklist".
#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>

#include "protocols/reading/protocol_reading.h"
#include "protocols/reading/translation.h"

namespace jnd {
namespace {

using When = Question::When;

struct NamedKind {
  std::string_view name;
  Question::Kind kind;
};
using Kinds = std::array<NamedKind, 4>;
constexpr Kinds kOfQuestions = {{{"rating", Question::Kind::rating},
                                 {"number", Question::Kind::number},
                                 {"choice", Question::Kind::choice},
                                 {"text", Question::Kind::text}}};
constexpr Kinds kOfChecklist = {{{"confirm", Question::Kind::confirm},
                                 {"number", Question::Kind::number},
                                 {"choice", Question::Kind::choice},
                                 {"text", Question::Kind::text}}};

void read_rating(JsonReader& reader, Question& question, ProtocolReading& reading) {
  const int lowest = reader.integer("min", {.min = -100, .max = 100});
  const int highest = reader.integer("max", {.min = -100, .max = 100});
  question.min = lowest;
  question.max = highest;
  question.low_label = reader.text("low", kLabelLimits);
  question.high_label = reader.text("high", kLabelLimits);
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
    const auto option = text_of(item, kLabelLimits, reading.errors, reading.file);
    if (!option) continue;
    if (std::find(question.options.begin(), question.options.end(), *option) != question.options.end())
      reading.error(item, fmt::format("the option {} is given twice", in_quotes(*option)), "options must differ");
    question.options.push_back(*option);
  }
}

// kind and what depends on it. what: "question" or "item", for messages. scales: may it have the ends of a scale?
void read_kind(JsonReader& reader, const Kinds& kinds, std::string_view what, bool scales, Question& question,
               ProtocolReading& reading) {
  std::vector<std::string_view> names, others = {"min", "max", "options"};
  for (const NamedKind& kind : kinds) names.push_back(kind.name);
  if (scales) others.insert(others.end(), {"low", "high"});
  const auto place = reader.word("kind", names, {}, true);
  if (!place) {
    for (const std::string_view key : others) reader.ignore(key);
    return;
  }
  question.kind = kinds[*place].kind;
  std::vector<std::string_view> own;
  if (question.kind == Question::Kind::rating) {
    read_rating(reader, question, reading);
    own = {"min", "max", "low", "high"};
  } else if (question.kind == Question::Kind::number) {
    read_number_question(reader, question, reading);
    own = {"min", "max"};
  } else if (question.kind == Question::Kind::choice) {
    read_options(reader, question, reading);
    own = {"options"};
  }
  // Members that belong to another kind would be silently without effect.
  for (const std::string_view key : others) {
    if (std::find(own.begin(), own.end(), key) == own.end() && reader.member(key) != nullptr)
      reader.error(key, fmt::format("has no meaning in a {} {}", kinds[*place].name, what),
                   "remove it, or change the kind");
  }
}

Question read_question(const JsonNode& node, ProtocolReading& reading) {
  Question question;
  JsonReader reader(node, reading.errors, reading.file);
  question.id = read_id(reader, "id");
  question.when = reader.one_of<When>("when", {{"before-session", When::before_session},
                                               {"after-condition", When::after_condition},
                                               {"after-series", When::after_series},
                                               {"after-session", When::after_session}});
  if (reader.member("group") != nullptr) question.group = read_id(reader, "group");
  read_kind(reader, kOfQuestions, "question", true, question, reading);
  question.text = reader.text("text", kQuestionLimits);
  question.per_condition = reader.boolean_or("per_condition", false);
  question.required = reader.boolean_or("required", true);
  if (question.per_condition && question.when != When::after_session && reading.sound(node.path + ".when"))
    reader.error("per_condition", "only a question after the session can be asked for each condition",
                 "remove it, or ask \"after-session\"");
  reader.finish();
  return question;
}

Question read_checklist_item(const JsonNode& node, ProtocolReading& reading) {
  Question item;
  item.when = When::before_session;
  JsonReader reader(node, reading.errors, reading.file);
  item.id = read_id(reader, "id");
  read_kind(reader, kOfChecklist, "item", false, item, reading);
  item.text = reader.text("text", kQuestionLimits);
  item.required = reader.boolean_or("required", true);
  reader.finish();
  return item;
}

}  // namespace

std::string read_id(JsonReader& reader, std::string_view key) {
  std::string id = reader.text(key, {.max_length = 32});
  const bool good = std::all_of(id.begin(), id.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  if (!good) reader.error(key, in_quotes(id) + " cannot be an id", "letters, digits, _ and -, at most 32");
  return id;
}

void read_questions(const JsonNode& list, ProtocolReading& reading) {
  for (const JsonNode& item : list.items) reading.protocol.questions.push_back(read_question(item, reading));
}

void read_checklist(const JsonNode& list, ProtocolReading& reading) {
  for (const JsonNode& item : list.items) reading.protocol.checklist.push_back(read_checklist_item(item, reading));
}

void lint_question_ids(ProtocolReading& reading) {
  std::set<std::string> ids;
  const auto look = [&](const std::vector<Question>& questions, std::string_view list) {
    for (std::size_t i = 0; i < questions.size(); ++i) {
      const std::string path = fmt::format("$.{}[{}].id", list, i);
      if (!questions[i].id.empty() && !ids.insert(questions[i].id).second && reading.sound(path))
        reading.error_at(path, fmt::format("the id {} is taken already", in_quotes(questions[i].id)),
                         "ids must differ, those of questions and of the checklist together");
    }
  };
  look(reading.protocol.questions, "questions");
  look(reading.protocol.checklist, "checklist");
}

}  // namespace jnd
