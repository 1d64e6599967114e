// What the reports of a device say, in words for people.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "devices/hid/firmware/jnd_report.h"

namespace jnd {

std::string serial_of(const jnd_identity& identity);
std::string calibration_id_of(const jnd_identity& identity);        // empty: never calibrated
std::string calibration_id_of(const jnd_certificate& certificate);  // the same
std::string date_text(std::uint32_t yyyymmdd);                      // "2026-03-01"; empty for 0
std::string firmware_text(const jnd_identity& identity);            // "1.0.0"

std::string_view finger_word(unsigned finger) noexcept;  // of jnd_finger: "thumb"; "any"
std::string_view model_word(unsigned model) noexcept;    // of jnd_model: "3RRS fingertip device"
std::string_view state_word(unsigned state) noexcept;    // of jnd_state: "at rest"
std::string fault_words(unsigned bits);                  // of jnd_fault_bit, with commas; empty: none
std::string limit_words(unsigned bits);                  // of jnd_limit_bit
std::string capability_words(unsigned bits);             // of jnd_capability
std::string_view page_word(unsigned page) noexcept;      // of jnd_page_number: "identity"

}  // namespace jnd
