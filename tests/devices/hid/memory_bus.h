// A HID bus in memory, with the firmware behind it and everything that can go wrong between: unplugged, reports lost,
// damaged and repeated, writes that block, clocks that drift.
//
// Its time is its own: a thread lets it run at about the machine's pace, a millisecond at a time; while a control loop
// sleeps on it, the loop drives it, and every millisecond ends when all that was sent has been read. So what a loop
// does here does not depend on how busy the machine is. Where the bus cannot know whether another thread will come, it
// counts its own looks, a millisecond apart: a machine that holds up the other thread holds up the looks, too.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "devices/clock.h"
#include "devices/hid/hid_bus.h"
#include "tests/devices/hid/memory_device.h"

namespace jnd::testing {

class MemoryBus final : public HidBus, public Clock {
 public:
  MemoryBus();
  ~MemoryBus() override;
  MemoryBus(const MemoryBus&) = delete;
  MemoryBus& operator=(const MemoryBus&) = delete;

  std::vector<HidInfo> list() override;
  std::unique_ptr<HidHandle> open(const std::string& path) override;

  std::int64_t now_ns() const noexcept override { return now_ns_.load(); }
  std::int64_t utc_ns() const noexcept override { return now_ns_.load(); }
  // In every millisecond waits for a command to each device, as a loop sends them: for long where one has just come.
  void sleep_until_ns(std::int64_t deadline) noexcept override;
  void pass_ms(int milliseconds);  // the same without commands
  void wait_ms(int milliseconds);  // until so much of the bus's own time has passed by itself

  // Devices are numbered from 0. spec: of the platform.
  int add(const jnd_fingertip_config& config, const DeviceSpec& spec);
  void unplug(int device);
  void plug(int device);  // on another path, after power-up
  void lose(int device, int reports);
  void damage(int device, int reports);
  void repeat(int device, int reports);    // each comes twice
  void block_writes(int device, bool on);  // commands only; as hidraw, each for 5 s at most
  void set_drift(int device, double ppm);
  void refuse_opening(bool on);  // as for a login without rights
  // A look at the firmware, or a change of it.
  template <typename Act>
  auto with(int device, Act&& act) {
    const std::lock_guard lock(mutex_);
    return act(*slots_[static_cast<std::size_t>(device)]->device);
  }
  std::int64_t sent(int device);  // reports by the device since it was added, lost ones included
  std::int64_t lost(int device);  // of those

 private:
  struct Handle;
  struct Slot {
    std::unique_ptr<MemoryDevice> device;
    std::string path;
    bool plugged = true;
    int lose = 0, damage = 0, repeat = 0;
    bool blocks = false;
    double drift = 0;
    std::int64_t sent = 0, lost = 0;
    std::int64_t commands = 0, commands_before = 0;  // written, by the last millisecond
    bool commanded = false;                          // in the last millisecond
    std::vector<Handle*> handles;
  };
  class MemoryHandle;

  using Lock = std::unique_lock<std::mutex>;
  // Until it is ready, or so much of the bus's own time has passed.
  template <typename Ready>
  void await(Lock& lock, int milliseconds, const Ready& ready) {
    const std::int64_t end_ns = now_ns() + std::int64_t{milliseconds} * 1'000'000;
    changed_.wait(lock, [&] { return ready() || now_ns() >= end_ns; });
  }
  // Until it is ready, or after so many looks.
  template <typename Ready>
  bool look(Lock& lock, int times, const Ready& ready) {
    for (int i = 0; i < times; ++i)
      if (changed_.wait_for(lock, std::chrono::milliseconds(1), ready)) return true;
    return ready();
  }

  std::uint64_t device_us(const Slot& slot) const noexcept;
  void deliver(Slot& slot, const HidReport& report);
  void run() noexcept;
  void millisecond();
  void drive(bool commands) noexcept;
  bool all_read() const;
  void forget_readers();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::unique_ptr<Slot>> slots_;
  std::atomic<std::int64_t> now_ns_{1'000'000'000'000};
  // The thread leaves time to the test that drives it, and for a while after.
  int driving_ = 0;
  int rests_ = 0;  // looks of the thread, until time runs by itself again
  bool refuses_ = false;
  int next_path_ = 0;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace jnd::testing
