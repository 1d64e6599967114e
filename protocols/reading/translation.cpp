#include "protocols/reading/translation.h"

#include <span>

#include <fmt/ranges.h>

#include "protocols/input/input_error.h"

namespace jnd {

namespace {

constexpr std::size_t kTextsNamed = 6;  // in a warning

// The end where the protocol has no such translation.
auto translation_in(const Protocol& protocol, std::string_view language) {
  return std::find_if(protocol.translations.begin(), protocol.translations.end(),
                      [&](const auto& entry) { return same_language(entry.first, language); });
}

}  // namespace

bool same_language(std::string_view a, std::string_view b) noexcept {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

std::vector<std::string> languages_of(const Protocol& protocol) {
  std::vector<std::string> languages = {protocol.language};
  for (const auto& [language, texts] : protocol.translations) languages.push_back(language);
  return languages;
}

Protocol in_language(const Protocol& protocol, std::string_view language) {
  if (same_language(language, protocol.language)) return protocol;
  const auto translation = translation_in(protocol, language);
  if (translation == protocol.translations.end())
    throw InputError(fmt::format("the protocol {} has no texts in {}; it has: {}", in_quotes(protocol.name),
                                 in_quotes(language), fmt::join(languages_of(protocol), ", ")));
  Protocol translated = protocol;
  for (std::vector<Question>* const list : {&translated.questions, &translated.checklist})
    for (Question& question : *list) question.shown = question.options;
  visit_participant_texts(translated, [&](const std::string& path, std::string& text, const TextLimits&, Audience) {
    if (const auto found = translation->second.find(path); found != translation->second.end()) text = found->second;
  });
  return translated;
}

std::vector<std::string> left_out_of(const Protocol& protocol, std::string_view language) {
  std::vector<std::string> paths;
  const auto translation = translation_in(protocol, language);
  if (translation == protocol.translations.end()) return paths;
  visit_participant_texts(protocol,
                          [&](const std::string& path, const std::string&, const TextLimits&, Audience audience) {
                            if (audience == Audience::participant && !translation->second.contains(path))
                              paths.push_back(path);
                          });
  return paths;
}

std::string left_out_text(const Protocol& protocol, std::string_view language) {
  const std::vector<std::string> paths = left_out_of(protocol, language);
  if (paths.empty()) return {};
  const std::size_t named = std::min(paths.size(), kTextsNamed);
  std::string text = fmt::format("leaves out {} text{} of the participant's: {}", paths.size(),
                                 paths.size() == 1 ? "" : "s", fmt::join(std::span(paths).first(named), ", "));
  if (paths.size() > named) text += fmt::format(" and {} more", paths.size() - named);
  return text;
}

}  // namespace jnd
