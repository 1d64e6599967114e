// The words of messages: quoting, listing, nearest words, paths and plain numbers (declared in json_reader.h).
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "protocols/input/json_reader.h"

namespace jnd {
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
    const bool begins_character = (byte & 0xC0U) != 0x80U;
    if (begins_character && shown++ == kMost) {
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
