// Reads what people are told, in which language, and how an interrupted session goes on: the members "instructions",
// "consent", "language", "translations" and "resume".
#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "protocols/reading/protocol_reading.h"
#include "protocols/reading/translation.h"

namespace jnd {
namespace {

constexpr double kMostMinutes = 525600;  // a year
constexpr std::size_t kMostLanguages = 50;

bool is_language(std::string_view text) noexcept {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t parts = 0;
  for (std::size_t begin = 0; begin <= text.size(); ++parts) {
    const std::size_t end = std::min(text.find('-', begin), text.size());
    const std::string_view part = text.substr(begin, end - begin);
    const bool good =
        parts == 0 ? part.size() >= 2 && part.size() <= 3 && std::all_of(part.begin(), part.end(), is_letter)
                   : part.size() >= 2 && part.size() <= 8 &&
                         std::all_of(part.begin(), part.end(), [&](char c) { return is_letter(c) || is_digit(c); });
    if (!good || parts > 3) return false;
    begin = end + 1;
  }
  return true;
}

constexpr std::string_view kLanguageHint = R"(two or three letters, then parts of 2 to 8: "de", "pt-BR", "zh-Hans")";

struct PeopleText {
  std::string text;
  TextLimits limits;
};

// Translated options that are alike could not be told apart.
void look_at_options(const JsonNode& node, const Translation& translation, ProtocolReading& reading) {
  const auto look = [&](const std::vector<Question>& questions, std::string_view list) {
    for (std::size_t i = 0; i < questions.size(); ++i) {
      std::map<std::string, std::string> seen;  // what is shown, and for which option
      for (std::size_t j = 0; j < questions[i].options.size(); ++j) {
        const std::string path = fmt::format("$.{}[{}].options[{}]", list, i, j);
        const auto found = translation.find(path);
        const std::string& shown = found == translation.end() ? questions[i].options[j] : found->second;
        const auto [other, is_new] = seen.emplace(shown, path);
        if (is_new) continue;
        const JsonNode* const written = found == translation.end() ? node.find(other->second) : node.find(path);
        reading.error(written == nullptr ? node : *written,
                      fmt::format("{} would be shown twice as {}", path.substr(0, path.rfind('[')), in_quotes(shown)),
                      "translated options must differ");
      }
    }
  };
  look(reading.protocol.questions, "questions");
  look(reading.protocol.checklist, "checklist");
}

Translation read_translation(const JsonNode& node, const std::map<std::string, PeopleText>& texts,
                             ProtocolReading& reading) {
  Translation translation;
  JsonReader reader(node, reading.errors, reading.file);
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    const std::string& path = node.keys[i];
    reader.ignore(path);
    const auto place = texts.find(path);
    if (place == texts.end()) {
      if (!reading.sound(path)) continue;  // told already
      const bool exists = node_at(reading.root, path) != nullptr;
      reading.errors.push_back({reading.file, node.key_places[i].first, node.key_places[i].second, node.items[i].path,
                                exists ? in_quotes(path) + " is not a text for people"
                                       : fmt::format("there is no {} in this file", in_quotes(path)),
                                R"(texts for people are such as "$.consent", "$.questions[0].text", )"
                                R"("$.questions[0].options[1]" or "$.instructions[0].text")"});
      continue;
    }
    if (auto text = text_of(node.items[i], place->second.limits, reading.errors, reading.file))
      translation[path] = std::move(*text);
  }
  reader.finish();
  look_at_options(node, translation, reading);
  return translation;
}

}  // namespace

void read_instructions(const JsonNode& list, ProtocolReading& reading) {
  using When = Instruction::When;
  std::set<std::string> ids;
  for (const JsonNode& item : list.items) {
    Instruction instruction;
    JsonReader reader(item, reading.errors, reading.file);
    instruction.id = read_id(reader, "id");
    if (!instruction.id.empty() && !ids.insert(instruction.id).second)
      reader.error("id", fmt::format("the id {} is taken already", in_quotes(instruction.id)), "ids must differ");
    instruction.when = reader.one_of<When>("when", {{"before-session", When::before_session},
                                                    {"before-practice", When::before_practice},
                                                    {"before-main", When::before_main}});
    instruction.text = reader.text("text", kPageLimits);
    reader.finish();
    if (instruction.when == When::before_practice && reading.sound(item.path + ".when") &&
        reading.root.find("practice") == nullptr)
      reader.error("when", "there is no practice before which it could be shown",
                   R"(write "before-session" or "before-main", or add "practice")");
    reading.protocol.instructions.push_back(std::move(instruction));
  }
}

void read_resume(const JsonNode& node, ProtocolReading& reading) {
  ResumePolicy& resume = reading.protocol.resume;
  JsonReader reader(node, reading.errors, reading.file);
  const auto in_seconds = [](std::optional<double> minutes) {
    return minutes ? std::optional<double>(60 * *minutes) : std::nullopt;
  };
  resume.longest_gap_s = in_seconds(
      reader.optional_number("longest_gap_min", {.min = 0, .max = kMostMinutes, .above = true, .unit = "min"}));
  resume.practice_after_s =
      in_seconds(reader.optional_number("practice_after_min", {.min = 0, .max = kMostMinutes, .unit = "min"}));
  resume.redo_block = reader.one_of_or<bool>("interrupted_block", {{"go-on", false}, {"redo", true}}, false);
  reader.finish();
}

void read_language(JsonReader& reader, ProtocolReading& reading) {
  std::string language = reader.text_or("language", "en", {.max_length = 35});
  if (is_language(language))
    reading.protocol.language = std::move(language);
  else
    reader.error("language", in_quotes(language) + " is not a language's name", std::string(kLanguageHint));
}

void read_translations(const JsonNode& node, ProtocolReading& reading) {
  Protocol& protocol = reading.protocol;
  std::map<std::string, PeopleText> texts;
  visit_participant_texts(protocol,
                          [&](const std::string& path, const std::string& text, const TextLimits& limits, Audience) {
                            texts[path] = {text, limits};
                          });
  if (node.keys.size() > kMostLanguages)
    return reading.error(node, fmt::format("has {} languages", node.keys.size()),
                         fmt::format("at most {} are possible", kMostLanguages));
  JsonReader reader(node, reading.errors, reading.file);
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    const std::string& language = node.keys[i];
    const auto fail = [&](std::string message, std::string suggestion) {
      reading.errors.push_back({reading.file, node.key_places[i].first, node.key_places[i].second, node.items[i].path,
                                std::move(message), std::move(suggestion)});
    };
    reader.ignore(language);
    if (!is_language(language)) {
      fail(in_quotes(language) + " is not a language's name", std::string(kLanguageHint));
      continue;
    }
    if (same_language(language, protocol.language))
      fail(fmt::format("{} is the language of the protocol itself", in_quotes(language)),
           "a translation is into another one; $.language says which this is");
    const bool again =
        std::any_of(node.keys.begin(), node.keys.begin() + static_cast<std::ptrdiff_t>(i),
                    [&](const std::string& other) { return other != language && same_language(other, language); });
    if (again) fail(fmt::format("{} is given twice", in_quotes(language)), "upper and lower case are alike");
    protocol.translations[language] = read_translation(node.items[i], texts, reading);
  }
  reader.finish();
}

void warn_about_translations(ProtocolReading& reading) {
  for (const auto& [language, translation] : reading.protocol.translations) {
    const std::string missing = left_out_text(reading.protocol, language);
    if (!missing.empty())
      reading.warn_at(member_path("$.translations", language), missing,
                      fmt::format("they stay in {}", reading.protocol.language));
  }
}

}  // namespace jnd
