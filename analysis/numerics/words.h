// The words of an enumeration, as files, options and reports have them: one table says what is written and what is read.
//
//   constexpr auto kWords = words<Judgement>({{"same", Judgement::same}, {"different", Judgement::different}});
//   word_of(kWords, Judgement::same)  // "same"
//   value_of(kWords, "same")          // Judgement::same
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

namespace jnd {

template <typename Enum, std::size_t N>
using WordTable = std::array<std::pair<std::string_view, Enum>, N>;

template <typename Enum, std::size_t N>
constexpr WordTable<Enum, N> words(const std::pair<std::string_view, Enum> (&list)[N]) {
  return std::to_array(list);
}

// Empty where the table has none.
template <typename Enum, std::size_t N>
constexpr std::string_view word_of(const WordTable<Enum, N>& words, Enum value) noexcept {
  for (const auto& [word, its_value] : words)
    if (its_value == value) return word;
  return {};
}

template <typename Enum, std::size_t N>
constexpr std::optional<Enum> value_of(const WordTable<Enum, N>& words, std::string_view text) noexcept {
  for (const auto& [word, its_value] : words)
    if (word == text) return its_value;
  return std::nullopt;
}

}  // namespace jnd
