// Members of the codec's structures as the vectors write them: numbers in decimal, arrays comma-separated, texts as
// they are.
#pragma once

#include <charconv>
#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include "tests/devices/hid/firmware/codec_members.h"

namespace jnd::codec {

using Members = std::map<std::string, std::string>;

namespace detail {

template <typename Number>
Number number_of(std::string_view text) {
  using Parsed = std::conditional_t<std::is_same_v<Number, bool>, unsigned, Number>;
  Parsed value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || (std::is_same_v<Number, bool> && value > 1))
    throw std::runtime_error("no number of this type: " + std::string(text));
  return static_cast<Number>(value);
}

template <typename Number>
std::string text_of(const Number& value) {
  return std::to_string(value);
}

template <typename Element, std::size_t kCount>
std::string text_of(const Element (&values)[kCount]) {
  std::string text;
  if constexpr (std::is_same_v<Element, char>) {
    for (std::size_t i = 0; i < kCount && values[i] != 0; ++i) text += values[i];
  } else {
    for (const Element value : values) text += (text.empty() ? "" : ",") + std::to_string(value);
  }
  return text;
}

template <typename Number>
void set_from_text(std::string_view text, Number& value) {
  value = number_of<Number>(text);
}

template <typename Element, std::size_t kCount>
void set_from_text(std::string_view text, Element (&values)[kCount]) {
  if constexpr (std::is_same_v<Element, char>) {
    if (text.size() > kCount) throw std::runtime_error("too long: " + std::string(text));
    for (std::size_t i = 0; i < kCount; ++i) values[i] = i < text.size() ? text[i] : '\0';
  } else {
    for (std::size_t i = 0; i < kCount; ++i) {
      const std::size_t comma = text.find(',');
      if ((comma == std::string_view::npos) != (i + 1 == kCount))
        throw std::runtime_error("not as many elements: " + std::string(text));
      values[i] = number_of<Element>(text.substr(0, comma));
      text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    }
  }
}

}  // namespace detail

template <typename Record>
Members members_of(Record record) {
  Members members;
  visit_members(record, [&](const char* name, const auto& value) { members[name] = detail::text_of(value); });
  return members;
}

// Throws std::runtime_error where a member is missing, unknown or no value of its type.
template <typename Record>
Record record_of(const Members& members) {
  Record record{};
  std::size_t used = 0;
  visit_members(record, [&](const char* name, auto& value) {
    detail::set_from_text(members.at(name), value);
    ++used;
  });
  if (used != members.size()) throw std::runtime_error("an unknown member");
  return record;
}

}  // namespace jnd::codec
