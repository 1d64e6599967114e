#include "devices/hid/report_words.h"

#include <array>
#include <cstring>
#include <span>

#include <fmt/format.h>

namespace jnd {

namespace {

// A field of a report: filled up with zeros, without one where it is full.
std::string field_text(std::span<const char> field) {
  return {field.data(), strnlen(field.data(), field.size())};
}

std::string_view word(std::span<const std::string_view> words, unsigned index) noexcept {
  return index < words.size() ? words[index] : std::string_view("unknown");
}

std::string words_of(std::span<const std::string_view> words, unsigned bits) {
  std::string text;
  for (unsigned bit = 0; bit < words.size(); ++bit)
    if ((bits & (1U << bit)) != 0) text += (text.empty() ? "" : ", ") + std::string(words[bit]);
  return text;
}

constexpr std::array<std::string_view, 6> kFingers = {"any", "thumb", "index", "middle", "ring", "little"};
constexpr std::array<std::string_view, 3> kModels = {"unknown", "3RRS fingertip device", "tracker"};
constexpr std::array<std::string_view, 3> kStates = {"at rest", "active", "stopped"};
constexpr std::array<std::string_view, 5> kPages = {"identity", "limits", "geometry", "force table", "certificate"};
constexpr std::array<std::string_view, 7> kFaults = {"no commands in time (its watchdog)",
                                                     "a sensor does not answer",
                                                     "an actuator does not follow",
                                                     "too hot",
                                                     "battery too low",
                                                     "its stop button",
                                                     "an internal error"};
constexpr std::array<std::string_view, 9> kLimits = {
    "force", "rise of the force", "tilt", "direction", "workspace", "vibration", "burst", "stiffness", "soft start"};
constexpr std::array<std::string_view, 8> kCapabilities = {
    "force", "tilt", "vibration", "damping", "tracking", "buttons", "keeps its calibration", "a model in software"};

}  // namespace

std::string serial_of(const jnd_identity& identity) {
  return field_text(identity.serial);
}

std::string calibration_id_of(const jnd_identity& identity) {
  return field_text(identity.calibration_id);
}

std::string calibration_id_of(const jnd_certificate& certificate) {
  return field_text(certificate.calibration_id);
}

std::string date_text(std::uint32_t yyyymmdd) {
  if (yyyymmdd == 0) return {};
  return fmt::format("{:04}-{:02}-{:02}", yyyymmdd / 10000, yyyymmdd / 100 % 100, yyyymmdd % 100);
}

std::string firmware_text(const jnd_identity& identity) {
  return fmt::format("{}.{}.{}", identity.firmware[0], identity.firmware[1], identity.firmware[2]);
}

std::string_view finger_word(unsigned finger) noexcept {
  return word(kFingers, finger);
}

std::string_view model_word(unsigned model) noexcept {
  return word(kModels, model);
}

std::string_view state_word(unsigned state) noexcept {
  return word(kStates, state);
}

std::string_view page_word(unsigned page) noexcept {
  return word(kPages, page);
}

std::string fault_words(unsigned bits) {
  return words_of(kFaults, bits);
}

std::string limit_words(unsigned bits) {
  return words_of(kLimits, bits);
}

std::string capability_words(unsigned bits) {
  return words_of(kCapabilities, bits);
}

}  // namespace jnd
