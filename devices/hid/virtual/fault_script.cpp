#include "devices/hid/virtual/fault_script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "protocols/input/input_error.h"
#include "protocols/input/number_from.h"

namespace jnd {

namespace {

enum class Takes { nothing, milliseconds, count, number, seconds, on_off, button, button_milliseconds };

struct Word {
  std::string_view word;
  OrderKind kind;
  Takes takes;
  std::string_view form, meaning;
};

constexpr double kPress_ms = 80;  // that a press lasts, unless told otherwise
constexpr double kMost_ms = 3.6e6;

constexpr std::array<Word, 17> kWords = {{
    {"unplug", OrderKind::unplug, Takes::milliseconds, "unplug [MS]", "gone, and back after MS (0: for good)"},
    {"freeze", OrderKind::freeze, Takes::milliseconds, "freeze MS", "the firmware stands still, its torques stay"},
    {"drop", OrderKind::drop, Takes::count, "drop N", "the next N telemetry reports are not sent, though numbered"},
    {"damage", OrderKind::damage, Takes::count, "damage N", "the next N telemetry reports have a wrong CRC"},
    {"wrong-version", OrderKind::wrong_version, Takes::on_off, "wrong-version [on|off]", "speaks version 9 only"},
    {"stuck-sensor", OrderKind::stuck_sensor, Takes::on_off, "stuck-sensor [on|off]", "the force sensor stays put"},
    {"nan-sensor", OrderKind::nan_sensor, Takes::on_off, "nan-sensor [on|off]", "the force sensor says no number"},
    {"hot", OrderKind::hot, Takes::on_off, "hot [on|off]", "80 degrees Celsius"},
    {"low-battery", OrderKind::low_battery, Takes::on_off, "low-battery [on|off]", "3 % left"},
    {"stop-button", OrderKind::stop_button, Takes::on_off, "stop-button [on|off]", "the stop button on the device"},
    {"button", OrderKind::button, Takes::button, "button B [on|off]", "button B, 1 to 8"},
    {"press", OrderKind::press, Takes::button_milliseconds, "press B [MS]", "button B is held for MS (80)"},
    {"lose", OrderKind::lose, Takes::on_off, "lose [on|off]", "the tracker does not see the fingers"},
    {"slow-clock", OrderKind::slow_clock, Takes::number, "slow-clock PPM",
     "the device's clock is slow (below 0: fast)"},
    {"offset", OrderKind::offset, Takes::seconds, "offset S", "the device's clock jumps ahead by S seconds"},
    {"status", OrderKind::status, Takes::nothing, "status", "prints one line of JSON"},
    {"quit", OrderKind::quit, Takes::nothing, "quit", "ends the program"},
}};

std::vector<std::string_view> words_of(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = text.find_first_not_of(kBlank, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kBlank, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

// Empty where the text is no finite number from least to most.
std::optional<double> number_of(std::string_view text, double least, double most) {
  const std::optional<double> value = number_from<double>(text);
  return value && *value >= least && *value <= most ? value : std::nullopt;
}

[[noreturn]] void refuse(std::string_view text, std::string_view why) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  throw InputError(fmt::format("the order \"{}\": {}", text, why));
}

double amount_of(std::string_view text, const Word& word, std::string_view argument, double least, double most) {
  const std::optional<double> value = number_of(argument, least, most);
  if (!value) refuse(text, fmt::format("write \"{}\", a number from {} to {}", word.form, least, most));
  return *value;
}

bool switch_of(std::string_view text, const Word& word, std::string_view argument) {
  if (argument != "on" && argument != "off") refuse(text, fmt::format("write \"{}\"", word.form));
  return argument == "on";
}

int button_of(std::string_view text, const Word& word, std::string_view argument) {
  const double button = amount_of(text, word, argument, 1, 8);
  if (button != std::floor(button)) refuse(text, "buttons are numbered 1 to 8");
  return static_cast<int>(button);
}

void read_arguments(std::string_view text, const Word& word, const std::vector<std::string_view>& arguments,
                    DeviceOrder& order) {
  const std::size_t given = arguments.size();
  const auto expect = [&](std::size_t least, std::size_t most) {
    if (given < least || given > most) refuse(text, fmt::format("write \"{}\"", word.form));
  };
  switch (word.takes) {
    case Takes::nothing:
      expect(0, 0);
      break;
    case Takes::milliseconds:
      expect(word.kind == OrderKind::unplug ? 0 : 1, 1);
      if (given == 1) order.amount = amount_of(text, word, arguments[0], 0, kMost_ms);
      break;
    case Takes::count:
      expect(1, 1);
      order.amount = amount_of(text, word, arguments[0], 0, 1e9);
      if (order.amount != std::floor(order.amount)) refuse(text, "a count has no fraction");
      break;
    case Takes::number:
      expect(1, 1);
      order.amount = amount_of(text, word, arguments[0], -1e5, 1e5);
      break;
    case Takes::seconds:
      expect(1, 1);
      order.amount = amount_of(text, word, arguments[0], 0, 1e9);  // a clock never runs backwards
      break;
    case Takes::on_off:
      expect(0, 1);
      if (given == 1) order.on = switch_of(text, word, arguments[0]);
      break;
    case Takes::button:
      expect(1, 2);
      order.button = button_of(text, word, arguments[0]);
      if (given == 2) order.on = switch_of(text, word, arguments[1]);
      break;
    case Takes::button_milliseconds:
      expect(1, 2);
      order.button = button_of(text, word, arguments[0]);
      order.amount = given == 2 ? amount_of(text, word, arguments[1], 0, kMost_ms) : kPress_ms;
      break;
  }
}

}  // namespace

DeviceOrder parse_order(std::string_view text) {
  const std::vector<std::string_view> words = words_of(text);
  if (words.empty()) refuse(text, "it is empty");
  const auto* const word =
      std::find_if(kWords.begin(), kWords.end(), [&](const Word& each) { return each.word == words[0]; });
  if (word == kWords.end()) {
    std::string known;
    for (const Word& each : kWords) known += fmt::format("{}{}", known.empty() ? "" : ", ", each.word);
    refuse(text, fmt::format("no such word; there are {}", known));
  }
  DeviceOrder order{.kind = word->kind};
  for (const std::string_view each : words) order.words += fmt::format("{}{}", order.words.empty() ? "" : " ", each);
  read_arguments(text, *word, {words.begin() + 1, words.end()}, order);
  return order;
}

std::string order_help() {
  std::string text;
  for (const Word& word : kWords) text += fmt::format("  {:<24}{}\n", word.form, word.meaning);
  return text;
}

TimedOrder parse_timed_order(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r"), text.size());
  const std::size_t end = std::min(text.find_first_of(" \t\r", begin), text.size());
  const std::optional<double> at_s = number_of(text.substr(begin, end - begin), 0, 1e6);
  if (!at_s) refuse(text, "begin with the time in seconds since the start, as in \"2.5 unplug 300\"");
  return {.at_ns = static_cast<std::int64_t>(std::llround(1e9 * *at_s)), .order = parse_order(text.substr(end))};
}

void FaultScript::add(const TimedOrder& order) {
  const auto place = std::partition_point(orders_.begin(), orders_.end(),
                                          [&](const TimedOrder& each) { return each.at_ns > order.at_ns; });
  orders_.insert(place, order);
}

void FaultScript::add_lines(std::string_view text) {
  int number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    line = line.substr(0, line.find('#'));
    ++number;
    at = end + 1;
    if (words_of(line).empty()) continue;
    try {
      add(parse_timed_order(line));
    } catch (const InputError& error) {
      throw InputError(fmt::format("line {}: {}", number, error.what()));
    }
  }
}

std::optional<std::int64_t> FaultScript::next_ns() const {
  if (orders_.empty()) return std::nullopt;
  return orders_.back().at_ns;
}

std::optional<DeviceOrder> FaultScript::take(std::int64_t now_ns) {
  if (orders_.empty() || orders_.back().at_ns > now_ns) return std::nullopt;
  DeviceOrder order = std::move(orders_.back().order);
  orders_.pop_back();
  return order;
}

}  // namespace jnd
