#include "runner/words/words.h"

#include <algorithm>
#include <string>
#include <vector>

#include "protocols/input/resources.h"
#include "runner/words/word_table.h"

namespace jnd {

namespace {

WordTable& table() {
  static WordTable words;
  return words;
}

// Of "de-AT" first "de-AT", then "de"; empty where there is neither.
std::string table_for(std::string_view language) {
  const std::vector<std::string> names = shipped_names(Resource::language);
  for (std::string name(language); !name.empty();) {
    const auto alike = [&name](const std::string& one) {
      return std::equal(one.begin(), one.end(), name.begin(), name.end(), [](char a, char b) {
        return (a | ' ') == (b | ' ');  // upper and lower case alike
      });
    };
    if (const auto found = std::find_if(names.begin(), names.end(), alike); found != names.end()) return *found;
    const std::size_t at = name.rfind('-');
    name.erase(at == std::string::npos ? 0 : at);
  }
  return {};
}

}  // namespace

bool use_language(std::string_view language) {
  table() = {};
  const std::string name = table_for(language);
  if (name.empty()) return false;
  table() = read_word_table(find_resource(Resource::language, name));
  return true;
}

std::string_view translated(std::string_view english) noexcept {
  const auto found = table().words.find(english);
  return found == table().words.end() ? english : std::string_view(found->second);
}

}  // namespace jnd
