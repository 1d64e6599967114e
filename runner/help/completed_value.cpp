#include "runner/help/completed_value.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <sstream>

#include "protocols/input/resources.h"

namespace jnd {

namespace {

struct Kind {
  const char* value;                // the name of what is taken
  const char* files;                // as in CompletedValue
  std::optional<Resource> shipped;  // its names too
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> table = {
      {"STUDY", "*.sqlite", {}},
      {"STUDIES", "*.sqlite", {}},
      {"DAMAGED", "*", {}},
      {"FILE", "*", {}},
      {"FOLDER", "/", {}},
      {"PROTOCOL", "*.json", Resource::protocol},
      {"OLD", "*.json", Resource::protocol},
      {"NEW", "*.json", Resource::protocol},
      {"PROFILE", "*.json", Resource::profile},
      {"RIG", "*.json", Resource::device_spec},
  };
  return table;
}

// "*" holds all files, folders are offered on the way to every file.
std::string both(const std::string& a, const std::string& b) {
  if (a.empty() || a == b) return b;
  return b.empty() ? a : "*";
}

void add(CompletedValue& to, CompletedValue value) {
  to.words.insert(to.words.end(), value.words.begin(), value.words.end());
  to.files = both(to.files, value.files);
}

CompletedValue of_part(const std::string& part) {
  for (const Kind& kind : kinds())
    if (part == kind.value)
      return {kind.shipped ? shipped_names(*kind.shipped) : std::vector<std::string>(), kind.files};
  const bool is_word = !part.empty() && std::islower(static_cast<unsigned char>(part.front())) != 0;
  return is_word ? CompletedValue{{part}, ""} : CompletedValue{};
}

}  // namespace

CompletedValue completed_value(const OptionPage& option) {
  if (!option.words.empty()) return {option.words, ""};
  CompletedValue value;
  std::istringstream parts(option.value);
  for (std::string part; std::getline(parts, part, '|');) add(value, of_part(part));
  return value;
}

CompletedValue completed_arguments(const CommandPage& page) {
  CompletedValue all;
  for (const OptionPage& argument : page.arguments) add(all, completed_value(argument));
  std::sort(all.words.begin(), all.words.end());
  all.words.erase(std::unique(all.words.begin(), all.words.end()), all.words.end());
  return all;
}

}  // namespace jnd
