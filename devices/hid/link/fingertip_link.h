// Everything about the connection to one fingertip device: a thread that listens to it, a thread that writes to it, and
// between them and the control loop two slots that keep the newest only.
//
// Each thread has a handle of its own, so that a write that the device does not take (the kernel waits up to 5 s) holds
// up neither the telemetry nor the loop. Nothing is ever repeated: where commands stop, the device's watchdog acts.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "devices/clock.h"
#include "devices/fingertip_device.h"
#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/hid_bus.h"
#include "devices/hid/hid_reader.h"
#include "devices/hid/report_counter.h"
#include "devices/loop/interval_summary.h"
#include "devices/loop/newest_slot.h"
#include "devices/machine/clock_sync.h"
#include "devices/rig.h"
#include "protocols/rigs/device_description.h"
#include "protocols/vocabulary.h"

namespace jnd {

// When the last commands were written, to compare with their echoes.
// Thread rule: one thread notes, one looks up. Nothing allocates or waits.
class WrittenTimes {
 public:
  static constexpr std::size_t kKept = 256;

  // sequence: not 0.
  void note(std::uint32_t sequence, std::int64_t time_ns) noexcept {
    Entry& entry = entries_[sequence % kKept];
    entry.sequence.store(0, std::memory_order_release);
    entry.time_ns.store(time_ns, std::memory_order_release);
    entry.sequence.store(sequence, std::memory_order_release);
  }
  // False where it was never noted, or long ago.
  bool find(std::uint32_t sequence, std::int64_t& time_ns) const noexcept {
    const Entry& entry = entries_[sequence % kKept];
    if (sequence == 0 || entry.sequence.load(std::memory_order_acquire) != sequence) return false;
    const std::int64_t found = entry.time_ns.load(std::memory_order_acquire);
    if (entry.sequence.load(std::memory_order_acquire) != sequence) return false;
    time_ns = found;
    return true;
  }
  void clear() noexcept {
    for (Entry& entry : entries_) entry.sequence.store(0, std::memory_order_release);
  }

 private:
  struct Entry {
    std::atomic<std::uint32_t> sequence{0};
    std::atomic<std::int64_t> time_ns{0};
  };
  std::array<Entry, kKept> entries_{};
};

// Which device, and what it must be able to do.
struct LinkTarget {
  std::string serial;  // of its identity page
  std::string finger;  // that wears it, as in $.rig.fingers
  DeviceSpec spec;
  bool damps = false;  // the protocol's contacts have a viscosity
};

// The newest telemetry.
struct LinkTelemetry {
  jnd_telemetry telemetry{};
  std::int64_t time_ns = 0;      // on the link's clock: when its readings were true
  std::uint32_t connection = 0;  // of which it came; 0: there was none yet
  std::uint32_t engagement = 0;  // of the last command that the device had accepted
};

// A command on its way from the loop to the thread that writes it.
struct PostedCommand {
  std::uint64_t number = 0;
  std::uint32_t engagement = 0;
  jnd_command command{};
};

class FingertipLink final : public RigLink, private HidListener {
 public:
  // Returns at once; the device may come later. Bus and clock (the loop's) must outlive the link. realtime_priority of
  // both threads: 0: ordinary ones.
  FingertipLink(HidBus& bus, LinkTarget target, const Clock& clock, int realtime_priority = 0);
  // Waits for a write that the device does not take: up to 5 s with hidraw.
  ~FingertipLink() override;
  FingertipLink(const FingertipLink&) = delete;
  FingertipLink& operator=(const FingertipLink&) = delete;

  // The loop's part: nothing allocates, locks or waits. Thread rule: one thread at a time.
  // Above 0: the connection, counted from 1, over which telemetry comes and commands go.
  std::uint32_t connection() const noexcept { return ready_.load(std::memory_order_acquire); }
  LinkTelemetry newest() const noexcept { return newest_.look(); }
  // Mode rest, at once, and from now on a new engagement, whose number this returns: whatever command comes next, the
  // device gets mode rest before it, so that it forgets an earlier stop.
  std::uint32_t engage() noexcept;
  // To be written as soon as the thread comes to it, unless a newer one comes first. The sequence is the link's.
  void send(const jnd_command& command) noexcept;

  // Any thread; may wait for another one's few lines.
  DeviceLinkReport report() const override;
  // In the operator's words, a fault that the device has just now too; empty: nothing is missing.
  std::string missing() const override;
  void stop_with(EmergencyStop* stop) noexcept override { stop_.store(stop); }
  // Commands that a newer one replaced before they could be written.
  std::int64_t overwritten() const noexcept { return overwritten_.load(); }
  // Of the clocks' agreement: how often one of them was set.
  int clock_steps() const;

 private:
  class Writer;

  void connected(const HidInfo& info, HidHandle& handle) override;
  void report(std::span<const std::uint8_t> bytes, std::int64_t time_ns) noexcept override;
  void lost(const std::string& why) override;
  void take(const jnd_telemetry& telemetry, std::int64_t time_ns) noexcept;
  void assign(std::uint32_t connection, const std::string& path);
  void wake() noexcept;
  void post(const jnd_command& command) noexcept;
  void write_commands() noexcept;
  bool wanted(const HidInfo& info) const;

  HidBus& bus_;
  const LinkTarget target_;
  const Clock& clock_;

  // Loop to writer.
  PostedCommand posting_;  // the loop's own
  NewestSlot<PostedCommand> posted_;
  std::atomic<std::uint32_t> wake_{0};  // counts whatever the writer has to look at
  // Reader to writer: the connection that it should write to.
  std::atomic<std::uint32_t> assigned_{0};
  std::atomic<std::uint32_t> writing_{0};  // the connection that it does write to
  std::atomic<bool> ends_{false};
  // Writer to reader.
  WrittenTimes written_;
  std::atomic<std::uint64_t> engaged_{0};  // engagement << 32 | number of its first command
  std::atomic<std::int64_t> sent_{0}, overwritten_{0};
  std::atomic<EmergencyStop*> stop_{nullptr};
  // Reader to loop.
  mutable NewestSlot<LinkTelemetry> newest_;  // the loop may interrupt the reader at any moment
  std::atomic<unsigned> faults_{0};           // that the device has just now, for other threads
  std::atomic<std::uint32_t> ready_{0};

  // The reader's own.
  std::uint32_t connections_ = 0;
  std::uint32_t last_echo_ = 0;

  mutable std::mutex mutex_;  // of everything below
  std::string path_;          // of the connection assigned_
  DeviceLinkReport described_;
  std::string write_trouble_;
  ReportCounter counter_;
  ClockSync sync_;
  LatenessHistogram latency_;
  std::int64_t damaged_ = 0;
  std::uint16_t rejected_now_ = 0;  // as the device said last
  std::uint16_t stop_faults_ = 0;   // when it last stopped itself

  std::thread writer_;
  std::unique_ptr<HidReader> reader_;  // last: it calls this object until it is destroyed
};

// A fingertip device over USB HID, as the control loop sees it.

// Thread rule: the control loop's thread; neutral also by the thread that owns the rig while no loop runs. Nothing
// waits.
class HidFingertip final : public FingertipDevice {
 public:
  // The link must outlive it.
  HidFingertip(FingertipLink& link, RenderingMode mode) noexcept : link_(link), mode_(mode) {}

  // lost: not connected. Reconnections do not count within an engagement: who was unplugged stays lost.
  DeviceStatus engage(std::int64_t now_ns) noexcept override;
  // The newest telemetry, whose age is the loop's to judge. lost: also where its commands do not arrive. stopped: the
  // device stopped itself since engage, or does not become active.
  DeviceStatus read(std::int64_t now_ns, DeviceReading& reading) noexcept override;
  // A command with a number that is none is not sent: the device gets mode rest.
  DeviceStatus write(const DeviceCommand& command, std::int64_t now_ns) noexcept override;
  void neutral() noexcept override;

 private:
  bool lost() const noexcept { return connection_ == 0 || link_.connection() != connection_; }

  FingertipLink& link_;
  RenderingMode mode_;
  std::uint32_t connection_ = 0, engagement_ = 0;
  std::int64_t engaged_ns_ = 0;
  bool was_active_ = false;  // in this engagement
};

}  // namespace jnd
