// A thread that listens to a HID device: it finds the device, owns its handle from open to close, hands every report
// on with the time of its arrival, and looks for the device again after it was unplugged.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <thread>

#include "devices/clock.h"
#include "devices/hid/hid_bus.h"

namespace jnd {

// Called by the reader's thread only.
class HidListener {
 public:
  virtual ~HidListener() = default;
  // The device is open. The handle may be written to, and read from, within this call; written to also from report().
  // Throw DeviceError to refuse the device: the reader closes it, tries the next that is wanted, and this one again
  // after a second.
  virtual void connected(const HidInfo& /*info*/, HidHandle& /*handle*/) {}
  // time_ns: on the reader's clock, taken at once after the report came.
  virtual void report(std::span<const std::uint8_t> bytes, std::int64_t time_ns) noexcept = 0;
  // Unplugged, refused, or not to be opened; `why` for people. Called before its handle is closed.
  virtual void lost(const std::string& /*why*/) {}
};

class HidReader {
 public:
  // bus, listener and clock must outlive the reader. Returns at once; the device may come later. realtime_priority: of
  // SCHED_FIFO where the login may; 0: an ordinary thread. clock: of the reports' times; null: the monotonic clock.
  HidReader(HidBus& bus, HidSelector wanted, HidListener& listener, int realtime_priority = 0,
            const Clock* clock = nullptr);
  // Within 100 ms and the time that a call of the listener or of the bus takes just then.
  ~HidReader();
  HidReader(const HidReader&) = delete;
  HidReader& operator=(const HidReader&) = delete;

 private:
  void serve() noexcept;
  void look();
  bool listen(const HidInfo& info);
  void hear(HidHandle& handle);
  void wait_ms(int milliseconds) const;

  HidBus& bus_;
  HidSelector wanted_;
  HidListener& listener_;
  SteadyClock steady_;
  const Clock& clock_;
  std::map<std::string, std::int64_t> refused_;  // path -> when it may be tried again, ns of steady_
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace jnd
