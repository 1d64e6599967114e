// Ticks on their way from the control loop to the thread that stores them: a queue that never makes the loop wait.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <boost/lockfree/spsc_queue.hpp>

#include "protocols/tick_record.h"

namespace jnd {

// Thread rule: one thread (the loop's) pushes; one other (main) drains. enabled and the drop count are for both.
class TelemetryRing {
 public:
  // How many records may wait, >= 1. At 1 kHz and two fingers 16384 are eight seconds of main doing something else.
  explicit TelemetryRing(std::size_t capacity) : capacity_(std::max<std::size_t>(capacity, 1)), queue_(capacity_) {}

  // Producer. Never blocks or allocates. Full: the record is dropped and counted. Not enabled: nothing happens.
  void push(const TickRecord& record) noexcept {
    if (!enabled_.load(std::memory_order_relaxed)) return;
    if (!queue_.push(record)) dropped_.fetch_add(1, std::memory_order_relaxed);
  }

  // Consumer: appends all that waits, oldest first; returns how many.
  std::size_t drain(std::vector<TickRecord>& records) {
    return queue_.consume_all([&](const TickRecord& record) { records.push_back(record); });
  }
  // Consumer: how many were dropped since the last call.
  std::int64_t take_dropped() noexcept { return dropped_.exchange(0, std::memory_order_relaxed); }

  bool enabled() const noexcept { return enabled_.load(std::memory_order_relaxed); }
  void enable(bool enabled) noexcept { enabled_.store(enabled, std::memory_order_relaxed); }

  std::size_t capacity() const noexcept { return capacity_; }

 private:
  std::size_t capacity_;
  boost::lockfree::spsc_queue<TickRecord> queue_;
  std::atomic<std::int64_t> dropped_{0};
  std::atomic<bool> enabled_{true};
};

}  // namespace jnd
