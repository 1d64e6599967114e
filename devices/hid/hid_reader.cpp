#include "devices/hid/hid_reader.h"

#include <array>
#include <chrono>
#include <exception>
#include <utility>

#include "devices/device_error.h"
#include "devices/machine/io_thread.h"

namespace jnd {

namespace {

constexpr int kRead_ms = 50;        // longest wait for a report: how soon the destructor is heard
constexpr int kLookEvery_ms = 200;  // listing takes milliseconds of the kernel's time
constexpr std::int64_t kAgain_ns = 1'000'000'000;
constexpr std::size_t kLongest = 1024;  // a longer report is cut: none of ours is
constexpr int kMostDrained = 256;       // then the destructor is looked for again

}  // namespace

HidReader::HidReader(HidBus& bus, HidSelector wanted, HidListener& listener, int realtime_priority, const Clock* clock)
    : bus_(bus), wanted_(std::move(wanted)), listener_(listener), clock_(clock != nullptr ? *clock : steady_) {
  thread_ = start_io_thread([this] { serve(); }, realtime_priority);
}

HidReader::~HidReader() {
  ends_.store(true);
  thread_.join();
}

void HidReader::wait_ms(int milliseconds) const {
  constexpr int kSlice_ms = 20;
  for (int waited = 0; waited < milliseconds && !ends_.load(); waited += kSlice_ms)
    std::this_thread::sleep_for(std::chrono::milliseconds(kSlice_ms));
}

void HidReader::serve() noexcept {
  while (!ends_.load()) {
    try {
      look();
    } catch (const std::exception& error) {  // the bus cannot list just now
      listener_.lost(error.what());
    }
    wait_ms(kLookEvery_ms);
  }
}

// One look round; listens to the first device that is wanted, until that is gone.
void HidReader::look() {
  for (const HidInfo& info : bus_.list()) {
    if (ends_.load()) return;
    if (!wanted_(info)) continue;
    const auto refused = refused_.find(info.path);
    if (refused != refused_.end() && steady_.now_ns() < refused->second) continue;
    if (listen(info)) {
      refused_.erase(info.path);
      return;
    }
    refused_[info.path] = steady_.now_ns() + kAgain_ns;
  }
}

// False: it could not be opened, or was refused.
bool HidReader::listen(const HidInfo& info) {
  std::unique_ptr<HidHandle> handle;
  try {
    handle = bus_.open(info.path);
    listener_.connected(info, *handle);
  } catch (const DeviceError& error) {
    listener_.lost(error.what());
    return false;
  }
  hear(*handle);
  return true;
}

void HidReader::hear(HidHandle& handle) {
  std::array<std::uint8_t, kLongest> bytes{};
  while (!ends_.load()) {
    int count = handle.read(bytes, kRead_ms);
    // What else waits, before anything else is done: the newest is what matters.
    for (int drained = 0; count > 0 && drained < kMostDrained; ++drained) {
      listener_.report(std::span(bytes).first(static_cast<std::size_t>(count)), clock_.now_ns());
      count = handle.read(bytes, 0);
    }
    if (count < 0) {
      listener_.lost("unplugged: " + handle.error());
      return;
    }
  }
}

}  // namespace jnd
