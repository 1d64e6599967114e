// Reads one JSON object member by member, says everything that is wrong with it, and forgets no key.
//
// Each read names a key, so that finish() knows which keys the object may have: it reports the others with the nearest
// known one, and keys that are given twice. A read that fails adds a Diagnostic and returns a harmless value; the
// caller goes on and throws InputError at the end, so that a user sees all mistakes of a file at once.
//
//   std::vector<Diagnostic> diagnostics;
//   const JsonNode root = parse_json(bytes, file);
//   JsonReader reader(root, diagnostics, file);
//   const double sigma = reader.number("sigma", {.min = 0, .unit = "N/m"});
//   const double lapse = reader.number_or("lapse", 0, {.min = 0, .max = 1});
//   const int format = reader.integer("format", {.min = 1, .max = 1});
//   const std::string title = reader.text("title", {.max_length = 200});
//   const Strategy strategy = reader.one_of<Strategy>("strategy", {{"magnitude", Strategy::magnitude}, ...});
//   if (const JsonNode* hand = reader.object_or_null("hand")) {
//     JsonReader part(*hand, diagnostics, file);
//     profile.depth_m = part.number("press_depth_m", {.min = 0, .max = 0.02, .unit = "m"});
//     part.finish();
//   }
//   reader.finish();
//   if (!diagnostics.empty()) throw InputError(diagnostics);
#pragma once

#include <array>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_document.h"

namespace jnd {

// What a number may be; both ends belong to the range unless `above` is set. unit is for messages only.
struct NumberLimits {
  double min = -kInf;
  double max = kInf;
  bool above = false;  // min itself is not allowed
  std::string_view unit = "";
};

// The same for whole numbers (16, 16.0 or 1e3).
struct IntegerLimits {
  int min = std::numeric_limits<int>::min();
  int max = std::numeric_limits<int>::max();
  std::string_view unit = "";
};

// What a text may be. Control characters and direction overrides are never allowed: texts reach terminals and CSV
// files. Only a page may have several lines.
struct TextLimits {
  std::size_t max_length = 500;  // characters (code points)
  bool may_be_empty = false;
  bool page = false;  // line feeds are allowed
};

class JsonReader {
 public:
  // A node that is not an object is reported at once; then all reads return their harmless values silently.
  // node and diagnostics must outlive the reader. file is only for messages.
  JsonReader(const JsonNode& node, std::vector<Diagnostic>& diagnostics, std::string file);

  // Required members: a missing one is an error. After an error: 0, empty, false, the first choice.
  double number(std::string_view key, const NumberLimits& limits = {});
  int integer(std::string_view key, const IntegerLimits& limits = {});
  bool boolean(std::string_view key);
  std::string text(std::string_view key, const TextLimits& limits = {});

  // Members with a default: it is returned where the member is missing, and after an error.
  double number_or(std::string_view key, double fallback, const NumberLimits& limits = {});
  int integer_or(std::string_view key, int fallback, const IntegerLimits& limits = {});
  bool boolean_or(std::string_view key, bool fallback);
  std::string text_or(std::string_view key, std::string fallback, const TextLimits& limits = {});

  // Members that may be missing: none then, and after an error.
  std::optional<double> optional_number(std::string_view key, const NumberLimits& limits = {});
  std::optional<int> optional_integer(std::string_view key, const IntegerLimits& limits = {});
  std::optional<std::string> optional_text(std::string_view key, const TextLimits& limits = {});

  // Enumerations: the member is one of the words; another one is an error that lists them and names the nearest.
  template <typename T>
  using Words = std::vector<std::pair<std::string_view, T>>;
  template <typename T>
  T one_of(std::string_view key, const Words<T>& words) {
    const std::optional<std::size_t> place = word(key, names_of(words), {}, true);
    return words[place.value_or(0)].second;
  }
  template <typename T, std::size_t N>
  T one_of(std::string_view key, const std::array<std::pair<std::string_view, T>, N>& words) {
    return one_of<T>(key, Words<T>(words.begin(), words.end()));
  }
  template <typename T>
  T one_of_or(std::string_view key, const Words<T>& words, T fallback) {
    const std::optional<std::size_t> place = word(key, names_of(words), {}, false);
    return place ? words[*place].second : fallback;
  }
  // The place of the word in `words`. later: words that are known but that this version cannot do, reported as such.
  std::optional<std::size_t> word(std::string_view key, const std::vector<std::string_view>& words,
                                  const std::vector<std::string_view>& later, bool required);

  // Members that are objects or arrays; null where missing or of another kind (which is reported).
  const JsonNode* object(std::string_view key);
  const JsonNode* object_or_null(std::string_view key);
  const JsonNode* array(std::string_view key, std::size_t min_items = 0, std::size_t max_items = 1000);
  const JsonNode* array_or_null(std::string_view key, std::size_t min_items = 0, std::size_t max_items = 1000);

  // Any kind of member, to be checked by the caller; null where missing.
  const JsonNode* member(std::string_view key);
  // Members that have no meaning here: each is an error, and known.
  void refuse(std::span<const std::string_view> keys, const std::string& message, const std::string& suggestion);
  void refuse(std::initializer_list<std::string_view> keys, const std::string& message, const std::string& suggestion) {
    refuse(std::span(keys.begin(), keys.size()), message, suggestion);
  }
  // A key that is allowed and not used, such as "$schema".
  void ignore(std::string_view key) { (void)member(key); }

  // An error of the caller's own at a node, at a member of this object (at the object itself where it is missing).
  void error(const JsonNode& at, std::string message, std::string suggestion = "");
  void error(std::string_view key, std::string message, std::string suggestion = "");

  // Reports keys that no read named, and keys given twice. Call it last.
  void finish();

  const JsonNode& node() const noexcept { return node_; }
  // The keys that reads have named so far, in that order.
  const std::vector<std::string>& known_keys() const noexcept { return known_; }

 private:
  template <typename T>
  static std::vector<std::string_view> names_of(const Words<T>& words) {
    std::vector<std::string_view> names;
    for (const auto& entry : words) names.push_back(entry.first);
    return names;
  }
  const JsonNode* find(std::string_view key, bool required, std::string_view what);
  std::optional<double> read_number(std::string_view key, const NumberLimits& limits, bool required);
  std::optional<int> read_integer(std::string_view key, const IntegerLimits& limits, bool required);
  std::optional<bool> read_boolean(std::string_view key, bool required);
  std::optional<std::string> read_text(std::string_view key, const TextLimits& limits, bool required);
  const JsonNode* read_object(std::string_view key, bool required);
  const JsonNode* read_array(std::string_view key, std::size_t min_items, std::size_t max_items, bool required);

  const JsonNode& node_;
  std::vector<Diagnostic>& diagnostics_;
  std::string file_;
  bool usable_;
  std::vector<std::string> known_;
};

// The same checks for values that are not members, such as elements of arrays.
std::optional<double> number_of(const JsonNode& node, const NumberLimits& limits, std::vector<Diagnostic>& diagnostics,
                                const std::string& file);
std::optional<int> integer_of(const JsonNode& node, const IntegerLimits& limits, std::vector<Diagnostic>& diagnostics,
                              const std::string& file);
std::optional<std::string> text_of(const JsonNode& node, const TextLimits& limits, std::vector<Diagnostic>& diagnostics,
                                   const std::string& file);
std::optional<std::size_t> word_of(const JsonNode& node, const std::vector<std::string_view>& words,
                                   const std::vector<std::string_view>& later, std::vector<Diagnostic>& diagnostics,
                                   const std::string& file);
Diagnostic diagnostic_at(const JsonNode& node, const std::string& file, std::string message,
                         std::string suggestion = "");

// Where an error may be looked for: is there no diagnostic at this JSON path, under it, or at one that contains it?
// Checks across members use it, so that one mistake is reported once.
bool is_sound(const std::vector<Diagnostic>& diagnostics, std::string_view path);

// For messages: the text in quotes, control characters escaped, cut after 60 characters.
std::string in_quotes(std::string_view text);
// The path of a member, as JsonNode::path has it.
std::string member_path(std::string_view parent, std::string_view key);
// The nearest of the words by edit distance, where one is near enough to be meant; else empty.
std::string nearest_word(std::string_view word, const std::vector<std::string_view>& words);
// "; did you mean 'analyze'?", where one of the words is near enough; else empty.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& words);
// "a, b or c", each in quotes.
std::string listed(const std::vector<std::string_view>& words);
// A number as a person writes it: the shortest decimals that give it back.
std::string plain(double value);

}  // namespace jnd
