// The program's own host code against a device, for as long and as often as asked; counts as JSON on one line.
//
//   link_campaign trips SERIAL N              N requests for the identity page, each answered at the first try
//   link_campaign stream SERIAL FINGER SECONDS  commands at 1 kHz and telemetry through the link of a session
//
// Exit status of trips: 0 where nothing is missing or wrong and no answer took a second; 1 otherwise. Of stream: 0
// where the device was there at the end; whether the counts are right is for who knows what was done to the device.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pthread.h>
#include <sched.h>

#include "devices/clock.h"
#include "devices/device_error.h"
#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/hidapi_bus.h"
#include "devices/hid/link/fingertip_link.h"
#include "devices/hid/page_exchange.h"
#include "devices/hid/report_counter.h"
#include "devices/realtime.h"
#include "protocols/rigs/device_description.h"

namespace jnd {

namespace {

std::unique_ptr<HidHandle> open_serial(HidBus& bus, const std::string& serial) {
  for (const HidInfo& info : bus.list())
    if (info.serial == serial) return bus.open(info.path);
  throw DeviceError(fmt::format("no device of serial number {} is connected", serial));
}

// Nothing is asked twice: what is missing shows.
int round_trips(const std::string& serial, int count) {
  HidapiBus bus;
  const std::unique_ptr<HidHandle> handle = open_serial(bus, serial);
  ReportCounter telemetry;
  std::int64_t strange = 0;
  const auto hear = [&](std::span<const std::uint8_t> bytes) {
    jnd_telemetry one{};
    if (jnd_decode_telemetry(bytes.data(), bytes.size(), &one) == JND_DECODE_OK)
      telemetry.take(one.sequence);
    else
      ++strange;
  };
  PageExchange exchange(*handle, serial, hear, PagePatience{.read_ms = 2000, .write_ms = 2000, .tries = 1});
  const PageData expected = exchange.read(JND_PAGE_IDENTITY);
  const SteadyClock clock;
  std::vector<std::int64_t> took_ns;
  took_ns.reserve(static_cast<std::size_t>(count));
  std::int64_t wrong = 0;
  const std::int64_t began_ns = clock.now_ns();
  for (int trip = 0; trip < count; ++trip) {
    const std::int64_t asked_ns = clock.now_ns();
    if (exchange.read(JND_PAGE_IDENTITY) != expected) ++wrong;
    took_ns.push_back(clock.now_ns() - asked_ns);
  }
  const double took_s = 1e-9 * static_cast<double>(clock.now_ns() - began_ns);
  std::sort(took_ns.begin(), took_ns.end());
  const double longest_s = 1e-9 * static_cast<double>(took_ns.back());
  fmt::print(
      "{{\"round_trips\": {}, \"wrong\": {}, \"seconds\": {:.3f}, \"median_us\": {}, \"longest_us\": {}, "
      "\"telemetry\": {}, \"telemetry_missing\": {}, \"telemetry_old\": {}, \"strange\": {}}}\n",
      count, wrong, took_s, took_ns[took_ns.size() / 2] / 1000, took_ns.back() / 1000, telemetry.taken(),
      telemetry.missing(), telemetry.old(), strange);
  return wrong == 0 && strange == 0 && telemetry.missing() == 0 && telemetry.old() == 0 && longest_s < 1 ? 0 : 1;
}

// What a control loop does with a device, without a finger: a contact that comes and goes twice a second.
DeviceCommand contact_at(double time_s) {
  constexpr double kStiffness_n_per_m = 800, kDepth_m = 0.003, kPresses_per_s = 2;
  DeviceCommand command;
  command.penetration_m = std::max(0.0, kDepth_m * std::sin(2 * std::numbers::pi * kPresses_per_s * time_s));
  command.stiffness_n_per_m = kStiffness_n_per_m;
  command.force_n = kStiffness_n_per_m * command.penetration_m;
  return command;
}

// The loop of a session in little: real deadlines, and how long the device's calls keep it.
struct LoopRecord {
  std::int64_t ticks = 0, skipped = 0, not_ok = 0, stops = 0;
  std::int64_t longest_call_ns = 0, longest_silence_ns = 0;
  double peak_force_n = 0;
};

LoopRecord drive(FingertipLink& link, double seconds) {
  SteadyClock clock;
  HidFingertip device(link, RenderingMode::wrench);
  LoopRecord record;
  constexpr std::int64_t kTick_ns = 1'000'000;
  const std::int64_t began_ns = clock.now_ns();
  const auto end_ns = began_ns + static_cast<std::int64_t>(seconds * 1e9);
  (void)device.engage(began_ns);
  std::int64_t heard_ns = began_ns;
  std::uint32_t last_sequence = 0;
  for (std::int64_t deadline_ns = began_ns; deadline_ns < end_ns;) {
    clock.sleep_until_ns(deadline_ns);
    const std::int64_t now_ns = clock.now_ns();
    DeviceReading reading;
    const DeviceStatus read = device.read(now_ns, reading);
    const DeviceStatus written = device.write(contact_at(1e-9 * static_cast<double>(now_ns - began_ns)), now_ns);
    record.longest_call_ns = std::max(record.longest_call_ns, clock.now_ns() - now_ns);
    record.peak_force_n = std::max(record.peak_force_n, reading.force_n);
    ++record.ticks;
    if (read != DeviceStatus::ok || written != DeviceStatus::ok) {
      ++record.not_ok;
      if (read == DeviceStatus::stopped) ++record.stops;
      (void)device.engage(now_ns);  // as the next presentation would
    }
    if (const std::uint32_t sequence = link.newest().telemetry.sequence; sequence != last_sequence) {
      last_sequence = sequence;
      heard_ns = now_ns;
    }
    record.longest_silence_ns = std::max(record.longest_silence_ns, now_ns - heard_ns);
    const std::int64_t late_ticks = (clock.now_ns() - deadline_ns) / kTick_ns;
    record.skipped += late_ticks;
    deadline_ns += (late_ticks + 1) * kTick_ns;
  }
  device.neutral();
  return record;
}

int stream(const std::string& serial, const std::string& finger, double seconds) {
  HidapiBus bus;
  SteadyClock clock;
  LinkTarget target{.serial = serial, .finger = finger, .spec = load_device_spec("/usr/share/jnd/specs/rrs3.json")};
  // As in a session: the loop above the link's threads, above everything else.
  FingertipLink link(bus, std::move(target), clock, kRealtimePriority - 1);
  const sched_param loop_priority{.sched_priority = kRealtimePriority};
  (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &loop_priority);
  for (int waited_ms = 0; link.connection() == 0; waited_ms += 10) {
    if (waited_ms > 5000) throw DeviceError(link.missing());
    clock.sleep_until_ns(clock.now_ns() + 10'000'000);
  }
  const LoopRecord loop = drive(link, seconds);
  clock.sleep_until_ns(clock.now_ns() + 100'000'000);  // what is on its way arrives
  const DeviceLinkReport report = link.report();
  const nlohmann::ordered_json line = {{"ticks", loop.ticks},
                                       {"skipped", loop.skipped},
                                       {"not_ok", loop.not_ok},
                                       {"stops", loop.stops},
                                       {"longest_call_us", loop.longest_call_ns / 1000},
                                       {"longest_silence_ms", loop.longest_silence_ns / 1'000'000},
                                       {"peak_force_n", loop.peak_force_n},
                                       {"connected", report.connected},
                                       {"trouble", report.trouble},
                                       {"sent", report.sent},
                                       {"overwritten", link.overwritten()},
                                       {"received", report.received},
                                       {"missing", report.missing},
                                       {"damaged", report.damaged},
                                       {"rejected", report.rejected},
                                       {"reconnections", report.reconnections},
                                       {"last_sequence", link.newest().telemetry.sequence},
                                       {"command_sequence", link.newest().telemetry.command_sequence},
                                       {"latency_p50_us", report.latency_p50_us},
                                       {"latency_max_us", report.latency_max_us},
                                       {"clock_drift_ppm", report.clock_drift_ppm}};
  fmt::print("{}\n", line.dump());
  return report.connected ? 0 : 1;
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() == 3 && arguments[0] == "trips") return round_trips(arguments[1], std::stoi(arguments[2]));
  if (arguments.size() == 4 && arguments[0] == "stream")
    return stream(arguments[1], arguments[2], std::stod(arguments[3]));
  fmt::print(stderr, "usage: link_campaign trips SERIAL N | stream SERIAL FINGER SECONDS\n");
  return 2;
}

}  // namespace

}  // namespace jnd

int main(int argc, char** argv) {
  try {
    return jnd::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "link_campaign: {}\n", error.what());
    return 1;
  }
}
