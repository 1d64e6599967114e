#include "runner/words/word_table.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "protocols/input/json_document.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/number_from.h"
#include "protocols/input/read_file.h"

namespace jnd {

namespace {

// "{1:.0f}"
struct Place {
  std::string_view number, format;
};

// None where a brace has no partner.
std::optional<std::vector<Place>> places_in(std::string_view text) {
  std::vector<Place> places;
  for (std::size_t from = text.find_first_of("{}"); from != std::string_view::npos;
       from = text.find_first_of("{}", from)) {
    const std::size_t to = text.find_first_of("{}", from + 1);
    if (text[from] != '{' || to == std::string_view::npos || text[to] != '}') return std::nullopt;
    const std::string_view inside = text.substr(from + 1, to - from - 1);
    const std::size_t colon = std::min(inside.find(':'), inside.size());
    places.push_back({inside.substr(0, colon), inside.substr(colon)});
    from = to + 1;
  }
  return places;
}

bool all_numbered(const std::vector<Place>& places) {
  return std::none_of(places.begin(), places.end(), [](const Place& place) { return place.number.empty(); });
}

bool none_numbered(const std::vector<Place>& places) {
  return std::all_of(places.begin(), places.end(), [](const Place& place) { return place.number.empty(); });
}

// Each of the English places once, with its format.
bool numbers_fit(const std::vector<Place>& english, const std::vector<Place>& translation) {
  std::vector<bool> used(english.size(), false);
  for (const Place& place : translation) {
    const std::optional<std::size_t> number = number_from<std::size_t>(place.number);
    if (!number || *number >= english.size() || used[*number] || english[*number].format != place.format) return false;
    used[*number] = true;
  }
  return true;
}

}  // namespace

std::string misfit_of(std::string_view english, std::string_view translation) {
  const auto wanted = places_in(english), given = places_in(translation);
  if (!wanted) return "a brace of the English words has no partner";
  if (!given) return "a brace has no partner";
  if (wanted->size() != given->size())
    return fmt::format("{} places for values, where the English words have {}", given->size(), wanted->size());
  if (given->empty()) return {};
  const auto same_format = [](const Place& a, const Place& b) { return a.format == b.format; };
  const bool fits = none_numbered(*given) ? std::equal(wanted->begin(), wanted->end(), given->begin(), same_format)
                                          : all_numbered(*given) && numbers_fit(*wanted, *given);
  return fits ? std::string() : "its places for values are not those of the English words";
}

WordTable read_word_table(const std::filesystem::path& file) {
  std::vector<Diagnostic> diagnostics;
  const JsonNode root = parse_json(read_input_file(file), file.string());
  JsonReader reader(root, diagnostics, file.string());
  reader.integer("format", {.min = 1, .max = 1});
  WordTable table;
  table.language = reader.text("language");
  reader.text("name");
  if (const JsonNode* words = reader.object("words"))
    for (std::size_t i = 0; i < words->keys.size(); ++i) {
      const JsonNode& translation = words->items[i];
      const auto text = text_of(translation, {}, diagnostics, file.string());
      if (!text) continue;
      if (const std::string misfit = misfit_of(words->keys[i], *text); !misfit.empty())
        diagnostics.push_back(diagnostic_at(translation, file.string(), misfit, "write every place as in the key"));
      if (!table.words.emplace(words->keys[i], *text).second)
        diagnostics.push_back(diagnostic_at(translation, file.string(), "these words are there twice", "remove one"));
    }
  reader.finish();
  if (!diagnostics.empty()) throw InputError(diagnostics);
  return table;
}

}  // namespace jnd
