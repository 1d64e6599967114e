// Which run of the machine this is, and how long it has lasted: what tells, after an interruption, how long it was.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace jnd {

// Linux's identity of this run of the machine: new at every start, the same for all programs. From
// root/proc/sys/kernel/random/boot_id; empty where it cannot be read or is not one.
std::string boot_id(const std::filesystem::path& root = "/");

// Since the machine started, the time in which it was suspended included (CLOCK_BOOTTIME). The clock of sessions
// (SteadyClock, CLOCK_MONOTONIC) stands still while a machine is suspended: what this is ahead of it is the time
// suspended since the start.
std::int64_t since_boot_ns() noexcept;

}  // namespace jnd
