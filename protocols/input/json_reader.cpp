#include "protocols/input/json_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "protocols/input/json_syntax.h"
#include "protocols/input/utf8.h"

namespace jnd {

namespace {

std::string_view name_of(JsonNode::Kind kind) noexcept {
  switch (kind) {
    case JsonNode::Kind::null:
      return "null";
    case JsonNode::Kind::boolean:
      return "true or false";
    case JsonNode::Kind::number:
      return "a number";
    case JsonNode::Kind::string:
      return "a text";
    case JsonNode::Kind::array:
      return "a list";
    case JsonNode::Kind::object:
      return "an object";
  }
  return "";
}

// "the number 5", "the text "5"", "a list": what stands in the file.
std::string found(const JsonNode& node) {
  if (node.kind == JsonNode::Kind::number) return "the number " + node.text;
  if (node.kind == JsonNode::Kind::string) return "the text " + in_quotes(node.text);
  if (node.kind == JsonNode::Kind::boolean) return node.boolean ? "true" : "false";
  return std::string(name_of(node.kind));
}

std::string range_text(double min, double max, bool above, std::string_view unit) {
  const std::string of_unit = unit.empty() ? "" : " " + std::string(unit);
  if (min == max) return plain(min) + of_unit;
  if (std::isfinite(min) && std::isfinite(max)) {
    return above ? fmt::format("above {} and at most {}{}", plain(min), plain(max), of_unit)
                 : fmt::format("from {} to {}{}", plain(min), plain(max), of_unit);
  }
  if (std::isfinite(min)) return fmt::format("{} {}{}", above ? "above" : "at least", plain(min), of_unit);
  return fmt::format("at most {}{}", plain(max), of_unit);
}

// "; 4 mm are 0.004 m": where the number is in range once it is taken for one of a unit that people use as often.
std::string in_smaller_unit(double number, const NumberLimits& limits, bool whole) {
  const auto fits = [&](double value) {
    return value <= limits.max && (limits.above ? value > limits.min : value >= limits.min);
  };
  if (!whole && limits.unit.empty() && limits.min >= 0 && limits.max == 1 && fits(number / 100))
    return fmt::format("; {} % are {}", plain(number), plain(number / 100));
  if ((limits.unit == "m" || limits.unit == "s") && fits(number / 1000))
    return fmt::format("; {} m{} are {} {}", plain(number), limits.unit, plain(number / 1000), limits.unit);
  return {};
}

// The character at `at` if it is one that may not stand in a text: its code point, else 0.
std::uint32_t forbidden_character(std::string_view text, std::size_t at) noexcept {
  const auto byte = [text](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  if (byte(at) < 0x20 || byte(at) == 0x7F) return byte(at) == 0 ? 0xFFFFFFFFU : byte(at);
  if (byte(at) == 0xC2 && byte(at + 1) < 0xA0) return byte(at + 1);  // C1 controls
  if (byte(at) == 0xE2) {
    const std::uint32_t code = 0x2000U | ((byte(at + 1) & 0x3FU) << 6U) | (byte(at + 2) & 0x3FU);
    if ((code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069)) return code;
  }
  return 0;
}

// whole: of a whole number, which is no share.
std::optional<double> read_number(const JsonNode& node, const NumberLimits& limits, bool whole,
                                  std::vector<Diagnostic>& diagnostics, const std::string& file) {
  const std::string unit = limits.unit.empty() ? "" : fmt::format(" in {}", limits.unit);
  if (node.kind != JsonNode::Kind::number) {
    diagnostics.push_back(diagnostic_at(node, file, fmt::format("must be a number{}, not {}", unit, found(node)),
                                        node.kind == JsonNode::Kind::string ? "write it without quotes" : ""));
    return std::nullopt;
  }
  const bool too_low = limits.above ? node.number <= limits.min : node.number < limits.min;
  if (too_low || node.number > limits.max) {
    const std::string range = whole && limits.max == limits.min + 1
                                  ? fmt::format("{} or {}", plain(limits.min), plain(limits.max))
                                  : range_text(limits.min, limits.max, limits.above, limits.unit);
    diagnostics.push_back(
        diagnostic_at(node, file, fmt::format("{} is out of range", node.text),
                      fmt::format("must be {}{}", range, in_smaller_unit(node.number, limits, whole))));
    return std::nullopt;
  }
  return node.number;
}

}  // namespace

std::optional<double> number_of(const JsonNode& node, const NumberLimits& limits, std::vector<Diagnostic>& diagnostics,
                                const std::string& file) {
  return read_number(node, limits, false, diagnostics, file);
}

std::optional<std::string> text_of(const JsonNode& node, const TextLimits& limits, std::vector<Diagnostic>& diagnostics,
                                   const std::string& file) {
  const auto fail = [&](std::string message, std::string suggestion) {
    diagnostics.push_back(diagnostic_at(node, file, std::move(message), std::move(suggestion)));
    return std::nullopt;
  };
  if (node.kind != JsonNode::Kind::string)
    return fail("must be a text, not " + found(node), "texts stand in double quotes");
  if (node.text.empty() && !limits.may_be_empty) return fail("is empty", "write something, or leave the member out");
  const std::size_t length = count_characters(node.text);
  if (length > limits.max_length)
    return fail(fmt::format("has {} characters", length), fmt::format("at most {} are allowed", limits.max_length));
  for (std::size_t at = 0; at < node.text.size(); ++at) {
    if (limits.page && node.text[at] == '\n') continue;
    if (const std::uint32_t code = forbidden_character(node.text, at); code != 0) {
      return fail(fmt::format("holds the control character U+{:04X}", code == 0xFFFFFFFFU ? 0 : code),
                  limits.page ? "\\n begins a new line; there are no other control characters in a text"
                              : "texts are single lines without control characters");
    }
  }
  if (node.text.find_first_not_of(" \n") == std::string::npos && !node.text.empty())
    return fail("is blank", "write something, or leave the member out");
  return node.text;
}

std::optional<int> integer_of(const JsonNode& node, const IntegerLimits& limits, std::vector<Diagnostic>& diagnostics,
                              const std::string& file) {
  if (node.kind == JsonNode::Kind::number && !node.integer) {
    diagnostics.push_back(diagnostic_at(node, file, fmt::format("must be a whole number, not {}", node.text),
                                        "write it without a fraction"));
    return std::nullopt;
  }
  const NumberLimits range{static_cast<double>(limits.min), static_cast<double>(limits.max), false, limits.unit};
  const std::optional<double> value = read_number(node, range, true, diagnostics, file);
  return value ? std::optional<int>(static_cast<int>(*value)) : std::nullopt;
}

std::optional<std::size_t> word_of(const JsonNode& node, const std::vector<std::string_view>& words,
                                   const std::vector<std::string_view>& later, std::vector<Diagnostic>& diagnostics,
                                   const std::string& file) {
  const auto fail = [&](std::string message, std::string suggestion) {
    diagnostics.push_back(diagnostic_at(node, file, std::move(message), std::move(suggestion)));
    return std::nullopt;
  };
  if (node.kind != JsonNode::Kind::string)
    return fail("must be a text, not " + found(node), "must be " + listed(words));
  const auto at = std::find(words.begin(), words.end(), node.text);
  if (at != words.end()) return static_cast<std::size_t>(at - words.begin());
  if (std::find(later.begin(), later.end(), node.text) != later.end())
    return fail(in_quotes(node.text) + " is not available in this version", "available: " + listed(words));
  const std::string near = nearest_word(node.text, words);
  return fail(in_quotes(node.text) + " is not known",
              near.empty() ? "must be " + listed(words)
                           : fmt::format("did you mean {}? known: {}", in_quotes(near), listed(words)));
}

JsonReader::JsonReader(const JsonNode& node, std::vector<Diagnostic>& diagnostics, std::string file)
    : node_(node), diagnostics_(diagnostics), file_(std::move(file)), usable_(node.kind == JsonNode::Kind::object) {
  if (!usable_) error(node, fmt::format("must be an object {{...}}, not {}", found(node)));
}

const JsonNode* JsonReader::find(std::string_view key, bool required, std::string_view what) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  if (!usable_) return nullptr;
  const JsonNode* node = node_.find(key);
  if (node == nullptr && required) {
    Diagnostic missing =
        diagnostic_at(node_, file_, fmt::format("{} is missing", in_quotes(key)), fmt::format("add {}", what));
    missing.path = member_path(node_.path, key);
    diagnostics_.push_back(std::move(missing));
  }
  return node;
}

const JsonNode* JsonReader::member(std::string_view key) {
  return find(key, false, "");
}

std::optional<double> JsonReader::read_number(std::string_view key, const NumberLimits& limits, bool required) {
  const bool bounded = std::isfinite(limits.min) || std::isfinite(limits.max);
  const JsonNode* node = find(
      key, required,
      "a number" + (bounded ? " " + range_text(limits.min, limits.max, limits.above, limits.unit) : std::string()));
  return node == nullptr ? std::nullopt : number_of(*node, limits, diagnostics_, file_);
}

std::optional<int> JsonReader::read_integer(std::string_view key, const IntegerLimits& limits, bool required) {
  const NumberLimits range{static_cast<double>(limits.min), static_cast<double>(limits.max), false, limits.unit};
  const JsonNode* node = find(key, required, "a whole number, " + range_text(range.min, range.max, false, limits.unit));
  return node == nullptr ? std::nullopt : integer_of(*node, limits, diagnostics_, file_);
}

std::optional<bool> JsonReader::read_boolean(std::string_view key, bool required) {
  const JsonNode* node = find(key, required, "true or false");
  if (node == nullptr) return std::nullopt;
  if (node->kind != JsonNode::Kind::boolean) {
    error(*node, "must be true or false, not " + found(*node));
    return std::nullopt;
  }
  return node->boolean;
}

std::optional<std::string> JsonReader::read_text(std::string_view key, const TextLimits& limits, bool required) {
  const JsonNode* node = find(key, required, "a text");
  return node == nullptr ? std::nullopt : text_of(*node, limits, diagnostics_, file_);
}

double JsonReader::number(std::string_view key, const NumberLimits& limits) {
  return read_number(key, limits, true).value_or(0);
}
int JsonReader::integer(std::string_view key, const IntegerLimits& limits) {
  return read_integer(key, limits, true).value_or(0);
}
bool JsonReader::boolean(std::string_view key) {
  return read_boolean(key, true).value_or(false);
}
std::string JsonReader::text(std::string_view key, const TextLimits& limits) {
  return read_text(key, limits, true).value_or("");
}
double JsonReader::number_or(std::string_view key, double fallback, const NumberLimits& limits) {
  return read_number(key, limits, false).value_or(fallback);
}
int JsonReader::integer_or(std::string_view key, int fallback, const IntegerLimits& limits) {
  return read_integer(key, limits, false).value_or(fallback);
}
bool JsonReader::boolean_or(std::string_view key, bool fallback) {
  return read_boolean(key, false).value_or(fallback);
}
std::string JsonReader::text_or(std::string_view key, std::string fallback, const TextLimits& limits) {
  return read_text(key, limits, false).value_or(std::move(fallback));
}
std::optional<double> JsonReader::optional_number(std::string_view key, const NumberLimits& limits) {
  return read_number(key, limits, false);
}
std::optional<int> JsonReader::optional_integer(std::string_view key, const IntegerLimits& limits) {
  return read_integer(key, limits, false);
}
std::optional<std::string> JsonReader::optional_text(std::string_view key, const TextLimits& limits) {
  return read_text(key, limits, false);
}

std::optional<std::size_t> JsonReader::word(std::string_view key, const std::vector<std::string_view>& words,
                                            const std::vector<std::string_view>& later, bool required) {
  const JsonNode* node = find(key, required, listed(words));
  return node == nullptr ? std::nullopt : word_of(*node, words, later, diagnostics_, file_);
}

const JsonNode* JsonReader::read_object(std::string_view key, bool required) {
  const JsonNode* node = find(key, required, "an object {...}");
  if (node == nullptr) return nullptr;
  if (node->kind == JsonNode::Kind::object) return node;
  error(*node, fmt::format("must be an object {{...}}, not {}", found(*node)));
  return nullptr;
}

const JsonNode* JsonReader::read_array(std::string_view key, std::size_t min_items, std::size_t max_items,
                                       bool required) {
  const JsonNode* node = find(key, required, "a list [...]");
  if (node == nullptr) return nullptr;
  if (node->kind != JsonNode::Kind::array) {
    error(*node, fmt::format("must be a list [...], not {}", found(*node)));
    return nullptr;
  }
  if (node->items.size() < min_items || node->items.size() > max_items) {
    error(*node, fmt::format("has {} element{}", node->items.size(), node->items.size() == 1 ? "" : "s"),
          min_items == max_items ? fmt::format("must have {}", min_items)
                                 : fmt::format("must have {} to {}", min_items, max_items));
    return nullptr;
  }
  return node;
}

const JsonNode* JsonReader::object(std::string_view key) {
  return read_object(key, true);
}
const JsonNode* JsonReader::object_or_null(std::string_view key) {
  return read_object(key, false);
}
const JsonNode* JsonReader::array(std::string_view key, std::size_t min_items, std::size_t max_items) {
  return read_array(key, min_items, max_items, true);
}
const JsonNode* JsonReader::array_or_null(std::string_view key, std::size_t min_items, std::size_t max_items) {
  return read_array(key, min_items, max_items, false);
}

void JsonReader::error(const JsonNode& at, std::string message, std::string suggestion) {
  diagnostics_.push_back(diagnostic_at(at, file_, std::move(message), std::move(suggestion)));
}

void JsonReader::error(std::string_view key, std::string message, std::string suggestion) {
  const JsonNode* node = node_.find(key);
  Diagnostic diagnostic =
      diagnostic_at(node == nullptr ? node_ : *node, file_, std::move(message), std::move(suggestion));
  diagnostic.path = member_path(node_.path, key);
  diagnostics_.push_back(std::move(diagnostic));
}

void JsonReader::refuse(std::span<const std::string_view> keys, const std::string& message,
                        const std::string& suggestion) {
  for (const std::string_view key : keys)
    if (member(key) != nullptr) error(key, message, suggestion);
}

void JsonReader::finish() {
  if (!usable_) return;
  const std::vector<std::string_view> known(known_.begin(), known_.end());
  for (std::size_t i = 0; i < node_.keys.size(); ++i) {
    const std::string& key = node_.keys[i];
    const std::pair<int, int>& place = node_.key_places[i];
    const auto report = [&](std::string message, std::string suggestion) {
      diagnostics_.push_back(
          {file_, place.first, place.second, member_path(node_.path, key), std::move(message), std::move(suggestion)});
    };
    const auto first = std::find(node_.keys.begin(), node_.keys.end(), key) - node_.keys.begin();
    if (first != static_cast<std::ptrdiff_t>(i)) {
      report(fmt::format("the key {} is given twice", in_quotes(key)),
             fmt::format("it stands on line {} already", node_.key_places[static_cast<std::size_t>(first)].first));
    } else if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
      const std::string near = nearest_word(key, known);
      report(fmt::format("the key {} is not known", in_quotes(key)),
             near.empty() ? "known here: " + listed(known) : fmt::format("did you mean {}?", in_quotes(near)));
    }
  }
}

// The words of messages: quoting, listing, nearest words, paths and plain numbers (declared in json_reader.h).

namespace {

// Among more words the nearest one is not looked for: hostile files must not cost minutes.
constexpr std::size_t kMostCandidates = 2000;

// Levenshtein distance in which swapping two neighbours counts once, upper and lower case alike.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  std::vector<std::vector<std::size_t>> table(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) table[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) table[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t differs = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
      table[i][j] = std::min({table[i - 1][j] + 1, table[i][j - 1] + 1, table[i - 1][j - 1] + differs});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
        table[i][j] = std::min(table[i][j], table[i - 2][j - 2] + 1);
    }
  }
  return table[a.size()][b.size()];
}

bool is_plain_key(std::string_view key) noexcept {
  return !key.empty() && key.size() <= 64 && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '$';
  });
}

// Line separators and overrides of the writing direction, which would disguise a message: their code point, else 0.
std::uint32_t direction_override(std::string_view text, std::size_t at) noexcept {
  if (at + 2 >= text.size() || static_cast<unsigned char>(text[at]) != 0xE2) return 0;
  const auto bits = [text](std::size_t i) { return static_cast<unsigned char>(text[i]) & 0x3FU; };
  const std::uint32_t code = 0x2000U | (bits(at + 1) << 6U) | bits(at + 2);
  return (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069) ? code : 0;
}

}  // namespace

Diagnostic diagnostic_at(const JsonNode& node, const std::string& file, std::string message, std::string suggestion) {
  return {file, node.line, node.column, node.path, std::move(message), std::move(suggestion)};
}

bool is_sound(const std::vector<Diagnostic>& diagnostics, std::string_view path) {
  const auto contains = [](std::string_view outer, std::string_view inner) {
    return inner.substr(0, outer.size()) == outer &&
           (inner.size() == outer.size() || inner[outer.size()] == '.' || inner[outer.size()] == '[');
  };
  return std::none_of(diagnostics.begin(), diagnostics.end(), [&](const Diagnostic& diagnostic) {
    return contains(path, diagnostic.path) || contains(diagnostic.path, path);
  });
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMost = 60;
  std::string result = "\"";
  std::size_t shown = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (!is_continuation(text[i]) && shown++ == kMost) {
      result += "...";
      break;
    }
    const bool c1 = byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
    if (byte < 0x20 || byte == 0x7F) {
      result += fmt::format("\\u{:04x}", byte);
    } else if (c1) {
      result += fmt::format("\\u{:04x}", static_cast<unsigned char>(text[++i]));
    } else if (const std::uint32_t code = direction_override(text, i); code != 0) {
      result += fmt::format("\\u{:04x}", code);
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result + "\"";
}

std::string member_path(std::string_view parent, std::string_view key) {
  return is_plain_key(key) ? fmt::format("{}.{}", parent, key) : fmt::format("{}[{}]", parent, in_quotes(key));
}

std::string nearest_word(std::string_view word, const std::vector<std::string_view>& words) {
  if (word.size() > 64) return "";
  std::string_view best;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;  // a third of the letters may be wrong
  if (words.size() > kMostCandidates) return "";
  for (const std::string_view candidate : words) {
    const std::size_t longer = std::max(word.size(), candidate.size()),
                      shorter = std::min(word.size(), candidate.size());
    if (longer - shorter >= least) continue;  // the distance is no less than that
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  if (!best.empty()) return std::string(best);
  // Units that were left out, such as "gap" for "gap_s".
  for (const std::string_view candidate : words)
    if (word.size() >= 3 && candidate.substr(0, word.size() + 1) == std::string(word) + "_")
      return std::string(candidate);
  return "";
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& words) {
  const std::string near = nearest_word(word, {words.begin(), words.end()});
  return near.empty() ? "" : fmt::format("; did you mean '{}'?", near);
}

std::string listed(const std::vector<std::string_view>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += in_quotes(words[i]);
  }
  return text;
}

std::string plain(double value) {
  std::array<char, 32> buffer{};
  // Fixed notation reads better for everything a lab would write; the rest gets an exponent.
  const bool fixed = value == 0 || (std::abs(value) >= 1e-4 && std::abs(value) < 1e15);
  const auto result = fixed
                          ? std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed)
                          : std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

}  // namespace jnd
