// What a virtual device is told to do wrong, in words and at times: `--at 2.5 unplug 300`, lines of a control file, or
// a script of lines that begin with their time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace jnd {

enum class OrderKind {
  unplug,         // amount: milliseconds until it is back, 0: for good
  freeze,         // amount: milliseconds without a step of the firmware
  drop,           // amount: telemetry reports that are not sent, though they are numbered
  damage,         // amount: telemetry reports with a wrong CRC
  wrong_version,  // speaks version 9 only
  stuck_sensor,   // the force sensor stays where it is
  nan_sensor,     // the force sensor says what is no number
  hot,            // 80 degrees
  low_battery,    // 3 %
  stop_button,
  button,      // button: 1..8
  press,       // button; amount: milliseconds that it is held
  lose,        // the tracker no longer sees the fingers
  slow_clock,  // amount: parts per million that the device's clock is slow; negative: fast
  offset,      // amount: seconds that the device's clock jumps ahead
  status,      // one line of JSON
  quit
};

struct DeviceOrder {
  OrderKind kind = OrderKind::status;
  double amount = 0;
  int button = 0;
  bool on = true;       // of what can be switched
  std::string words{};  // as it was written; for the log
};

// "unplug 300", "stop-button off". Throws InputError with what is wrong and the words there are.
DeviceOrder parse_order(std::string_view text);

// What each word means, a line each; for --help.
std::string order_help();

struct TimedOrder {
  std::int64_t at_ns = 0;  // since the start
  DeviceOrder order;
};

// "2.5 unplug 300": seconds since the start, then an order. Throws InputError.
TimedOrder parse_timed_order(std::string_view text);

// Orders that wait for their time. Those of one time come in the order they were added in.
class FaultScript {
 public:
  void add(const TimedOrder& order);
  // A line an order; blank lines and what follows a # are left out. Throws InputError that names the line.
  void add_lines(std::string_view text);

  std::optional<std::int64_t> next_ns() const;
  // The next order that is due at this time, taken out.
  std::optional<DeviceOrder> take(std::int64_t now_ns);

 private:
  std::vector<TimedOrder> orders_;  // by time, the earliest last
};

}  // namespace jnd
