#include "tests/devices/hid/memory_bus.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include <fmt/format.h>

#include "devices/device_error.h"

namespace jnd::testing {

namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::size_t kUnread = 63;  // hidraw keeps the oldest
constexpr int kBlocked_ms = 5000;
constexpr int kBusy = 1000;  // looks at what is still to be done

}  // namespace

struct MemoryBus::Handle {
  std::deque<HidReport> unread;
  bool reads = false;    // a thread does
  bool waiting = false;  // in a read, for more
};

class MemoryBus::MemoryHandle final : public HidHandle {
 public:
  MemoryHandle(MemoryBus& bus, Slot& slot) : bus_(bus), slot_(slot), path_(slot.path) {
    slot_.handles.push_back(&inside_);
  }
  ~MemoryHandle() override {
    const std::lock_guard lock(bus_.mutex_);
    std::erase(slot_.handles, &inside_);
    bus_.changed_.notify_all();
  }

  int read(std::span<std::uint8_t> bytes, int timeout_ms) noexcept override {
    Lock lock(bus_.mutex_);
    inside_.reads = true;
    const auto ready = [this] { return !inside_.unread.empty() || gone(); };
    if (!ready() && timeout_ms > 0) {
      inside_.waiting = true;
      bus_.changed_.notify_all();
      bus_.await(lock, timeout_ms, ready);
      inside_.waiting = false;
    }
    if (gone()) return kHidGone;
    if (inside_.unread.empty()) return kHidTimeOut;
    const HidReport report = inside_.unread.front();
    inside_.unread.pop_front();
    const std::size_t count = std::min(bytes.size(), report.size());
    std::copy_n(report.begin(), count, bytes.begin());
    return static_cast<int>(count);
  }

  bool write(std::span<const std::uint8_t> bytes) noexcept override {
    Lock lock(bus_.mutex_);
    const bool command = !bytes.empty() && bytes[0] == JND_REPORT_COMMAND;
    if (command && slot_.blocks) bus_.await(lock, kBlocked_ms, [this] { return !slot_.blocks || gone(); });
    if (gone() || (command && slot_.blocks)) return false;
    slot_.device->receive(bytes.data(), bytes.size(), bus_.device_us(slot_));
    if (command) ++slot_.commands;
    bus_.changed_.notify_all();
    return true;
  }

  std::string error() const override { return "device disconnected"; }

 private:
  bool gone() const { return !slot_.plugged || slot_.path != path_; }

  MemoryBus& bus_;
  Slot& slot_;
  std::string path_;
  Handle inside_;
};

MemoryBus::MemoryBus() : thread_([this] { run(); }) {}

MemoryBus::~MemoryBus() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::vector<HidInfo> MemoryBus::list() {
  const std::lock_guard lock(mutex_);
  std::vector<HidInfo> found;
  HidInfo other;  // of another device
  other.path = "/dev/hidraw-keyboard";
  other.usage_page = 1;
  other.usage = 6;
  found.push_back(other);
  for (const auto& slot : slots_) {
    if (!slot->plugged) continue;
    HidInfo info;
    info.path = slot->path;
    info.usage_page = JND_USAGE_PAGE;
    info.usage = JND_USAGE_FINGERTIP;
    const char* serial = slot->device->config.identity.serial;
    info.serial = std::string(serial, strnlen(serial, JND_SERIAL_SIZE));
    found.push_back(info);
  }
  return found;
}

std::unique_ptr<HidHandle> MemoryBus::open(const std::string& path) {
  const std::lock_guard lock(mutex_);
  for (const auto& slot : slots_) {
    if (!slot->plugged || slot->path != path) continue;
    if (refuses_) throw DeviceError(fmt::format("this login may not use {}", path));
    return std::make_unique<MemoryHandle>(*this, *slot);
  }
  throw DeviceError(fmt::format("{} is not there", path));
}

std::uint64_t MemoryBus::device_us(const Slot& slot) const noexcept {
  const double us = 1e-3 * static_cast<double>(now_ns_.load() - 999'000'000'000) * (1 + 1e-6 * slot.drift);
  return static_cast<std::uint64_t>(std::llround(us));
}

// Under the lock.
void MemoryBus::deliver(Slot& slot, const HidReport& sent) {
  const bool telemetry = sent[0] == JND_REPORT_TELEMETRY;
  HidReport report = sent;
  int times = 1;
  if (telemetry) {
    ++slot.sent;
    if (slot.lose > 0) {
      --slot.lose;
      ++slot.lost;
      return;
    }
    if (slot.damage > 0) {
      --slot.damage;
      ++slot.lost;
      report[20] = static_cast<std::uint8_t>(report[20] ^ 0x10U);
    }
    if (slot.repeat > 0) {
      --slot.repeat;
      times = 2;
    }
  }
  for (Handle* handle : slot.handles)
    for (int i = 0; i < times; ++i)
      if (handle->unread.size() < kUnread) handle->unread.push_back(report);
}

bool MemoryBus::all_read() const {
  for (const auto& slot : slots_)
    for (const Handle* handle : slot->handles)
      if (handle->reads && (!handle->waiting || !handle->unread.empty())) return false;
  return true;
}

// Under the lock.
void MemoryBus::millisecond() {
  now_ns_.fetch_add(kMillisecond_ns);
  for (const auto& slot : slots_)
    if (slot->plugged) slot->device->step(device_us(*slot));
  changed_.notify_all();
}

// On a busy machine a thread that reads may be kept from it for longer than its reports have room.
void MemoryBus::run() noexcept {
  Lock lock(mutex_);
  while (!ends_) {
    (void)look(lock, 1, [this] { return ends_; });
    if (driving_ > 0 || ends_) continue;
    if (rests_ > 0) {
      --rests_;
      continue;
    }
    if (!look(lock, kBusy, [this] { return all_read() || driving_ > 0 || ends_; })) forget_readers();
    if (driving_ == 0 && !ends_) millisecond();
  }
}

// They read no more.
void MemoryBus::forget_readers() {
  for (const auto& slot : slots_)
    for (Handle* handle : slot->handles) handle->reads = handle->waiting;
}

void MemoryBus::drive(bool commands) noexcept {
  constexpr int kRests = 200;
  constexpr int kIdle = 20;  // a device without commands yet, or no more, does not keep the loop for long
  const auto await_commands = [this](Lock& lock, int times, bool of_commanded) {
    (void)look(lock, times, [this, of_commanded] {
      return std::all_of(slots_.begin(), slots_.end(), [of_commanded](const auto& slot) {
        return !slot->plugged || slot->blocks || slot->commanded != of_commanded ||
               slot->commands > slot->commands_before;
      });
    });
  };
  Lock lock(mutex_);
  ++driving_;
  if (commands) {
    await_commands(lock, kBusy, true);
    await_commands(lock, kIdle, false);
  }
  for (const auto& slot : slots_) {
    slot->commanded = slot->commands > slot->commands_before;
    slot->commands_before = slot->commands;
  }
  millisecond();
  (void)look(lock, kBusy, [this] { return all_read(); });
  --driving_;
  rests_ = kRests;
}

void MemoryBus::sleep_until_ns(std::int64_t deadline) noexcept {
  while (now_ns() < deadline) drive(true);
}

void MemoryBus::pass_ms(int milliseconds) {
  for (int i = 0; i < milliseconds; ++i) drive(false);
}

void MemoryBus::wait_ms(int milliseconds) {
  Lock lock(mutex_);
  await(lock, milliseconds, [] { return false; });
}

int MemoryBus::add(const jnd_fingertip_config& config, const DeviceSpec& spec) {
  const std::lock_guard lock(mutex_);
  auto slot = std::make_unique<Slot>();
  slot->device = std::make_unique<MemoryDevice>(config, spec);
  slot->path = fmt::format("/dev/hidraw{}", next_path_++);
  slot->device->deliver = [this, raw = slot.get()](const HidReport& report) { deliver(*raw, report); };
  slots_.push_back(std::move(slot));
  return static_cast<int>(slots_.size()) - 1;
}

void MemoryBus::unplug(int device) {
  const std::lock_guard lock(mutex_);
  Slot& slot = *slots_[static_cast<std::size_t>(device)];
  slot.plugged = false;
  for (Handle* handle : slot.handles) handle->unread.clear();
  changed_.notify_all();
}

void MemoryBus::plug(int device) {
  const std::lock_guard lock(mutex_);
  Slot& slot = *slots_[static_cast<std::size_t>(device)];
  slot.plugged = true;
  slot.path = fmt::format("/dev/hidraw{}", next_path_++);
  slot.device->power_up();
  changed_.notify_all();
}

void MemoryBus::lose(int device, int reports) {
  const std::lock_guard lock(mutex_);
  slots_[static_cast<std::size_t>(device)]->lose = reports;
}

void MemoryBus::damage(int device, int reports) {
  const std::lock_guard lock(mutex_);
  slots_[static_cast<std::size_t>(device)]->damage = reports;
}

void MemoryBus::repeat(int device, int reports) {
  const std::lock_guard lock(mutex_);
  slots_[static_cast<std::size_t>(device)]->repeat = reports;
}

void MemoryBus::block_writes(int device, bool on) {
  const std::lock_guard lock(mutex_);
  slots_[static_cast<std::size_t>(device)]->blocks = on;
  changed_.notify_all();
}

void MemoryBus::set_drift(int device, double ppm) {
  const std::lock_guard lock(mutex_);
  slots_[static_cast<std::size_t>(device)]->drift = ppm;
}

void MemoryBus::refuse_opening(bool on) {
  const std::lock_guard lock(mutex_);
  refuses_ = on;
}

std::int64_t MemoryBus::sent(int device) {
  const std::lock_guard lock(mutex_);
  return slots_[static_cast<std::size_t>(device)]->sent;
}

std::int64_t MemoryBus::lost(int device) {
  const std::lock_guard lock(mutex_);
  return slots_[static_cast<std::size_t>(device)]->lost;
}

}  // namespace jnd::testing
