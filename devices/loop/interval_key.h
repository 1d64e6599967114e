// One number for an interval of a trial, so that every draw made in it is keyed by it: a session that is resumed, or a
// trial that is repeated, draws what it would have drawn anyway.
#pragma once

#include <cstdint>

#include "devices/rig.h"

namespace jnd {

// The part of a RandomStream. sub: such as a finger, 0..255. Unique for attempts and intervals below 256.
constexpr std::uint64_t interval_part(const IntervalId& id, int sub) noexcept {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(id.trial)) << 24U) |
         (static_cast<std::uint64_t>(id.attempt & 0xFF) << 16U) |
         (static_cast<std::uint64_t>(id.interval & 0xFF) << 8U) | static_cast<std::uint64_t>(sub & 0xFF);
}

}  // namespace jnd
