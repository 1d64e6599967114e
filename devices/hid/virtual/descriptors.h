// The report descriptors of the virtual devices; those of a fingertip device and a tracker as in
// devices/hid/PROTOCOL.md.
#pragma once

#include <cstdint>
#include <vector>

namespace jnd {

inline constexpr std::uint16_t kVirtualVendor = 0x1209;  // pid.codes; the products are for tests and examples only
inline constexpr std::uint16_t kVirtualProduct = 0x5AFE;
inline constexpr std::uint16_t kVirtualButtonsProduct = 0x5AFF;

std::vector<std::uint8_t> fingertip_descriptor();
std::vector<std::uint8_t> tracker_descriptor();
// An ordinary gamepad: a stick of two axes, one byte each, and eight buttons in a third; not numbered.
std::vector<std::uint8_t> gamepad_descriptor();

}  // namespace jnd
