// jnd device test SERIAL|PATH: a real device, every line of it measured.
#include "runner/device_commands/command_device_hid.h"

#include <algorithm>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/report_words.h"
#include "runner/device_commands/device_output.h"
#include "runner/device_commands/hid_devices.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

constexpr double kStream_s = 2;

// Returns what the device says of itself.
jnd_identity test_fingertip(HidHandle& handle, const HidInfo& info, const std::string& name, bool press,
                            Checks& checks) {
  const DeviceDescription device = describe(handle, name);
  refuse_if_driven(device, name);
  SteadyClock clock;
  BenchLink link(handle, clock, spec_of(device.limits, device.geometry, kTestForce_n), interrupt_requested());
  check_description(info, device.identity, device.limits, checks);
  check_stream(link, device.identity, kStream_s, checks);
  check_round_trip(link, checks);
  check_watchdog(link, device.identity, checks);
  check_refusals(link, device.identity, checks);
  if (press) {
    check_force(link, checks);
    check_vibration(link, checks);
  } else {
    checks.push_back({.what = "force and vibration",
                      .verdict = Verdict::not_judged,
                      .found = "not tried",
                      .limit = "consent, or --yes"});
  }
  check_rest(link, checks);
  return device.identity;
}

jnd_identity test_tracker(HidHandle& handle, const HidInfo& info, const std::string& name, Checks& checks) {
  SteadyClock clock;
  const jnd_identity identity = PageExchange(handle, name).identity();
  checks.push_back(measured("serial number", serial_of(identity), info.serial, serial_of(identity) == info.serial));
  check_poses(handle, clock, kStream_s, interrupt_requested(), checks);
  return identity;
}

std::string verdict_word(const Check& check) {
  return check.passed() ? std::string(to_string(check.verdict)) : bold(warn("FAILED"));
}

}  // namespace

int hid_device_test(HidBus& bus, const std::string& name, bool json, bool yes) {
  const HidInfo info = find_device(bus, name);
  const bool press = !is_tracker(info) &&
                     may_press(fmt::format("{} will press with up to {:g} N and vibrate. Put a finger or a reference "
                                           "before its platform, and nothing else.",
                                           printable(name), kTestForce_n),
                               yes, false);
  Checks checks;
  jnd_identity identity{};
  try {
    with_device(bus, info, [&](HidHandle& handle) {
      identity = is_tracker(info) ? test_tracker(handle, info, name, checks)
                                  : test_fingertip(handle, info, name, press, checks);
    });
  } catch (const BenchInterrupted& interrupted) {
    print_message("{}: {}\n", printable(name), interrupted.what());
    return exit_code::kInterrupted;
  }
  const auto failed = std::count_if(checks.begin(), checks.end(), [](const Check& check) { return !check.passed(); });
  const auto said = std::count_if(checks.begin(), checks.end(),
                                  [](const Check& check) { return check.verdict == Verdict::not_judged; });
  const int code = failed == 0 ? exit_code::kDone : exit_code::kDevice;
  if (json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Check& check : checks)
      list.push_back({{"device", name},
                      {"what", check.what},
                      {"measured", check.found},
                      {"expected", check.limit},
                      {"ok", check.passed()},
                      {"judged", check.verdict != Verdict::not_judged}});
    print_json({{"device", name},
                {"path", info.path},
                {"simulated", (identity.capabilities & JND_IS_MODEL) != 0},
                {"ok", failed == 0},
                {"checks", list}});
    return code;
  }
  using Align = TextTable::Align;
  TextTable table({name, "measured", "expected", ""}, {Align::left, Align::left, Align::left, Align::left});
  for (const Check& check : checks)
    table.add({check.what, printable(check.found), printable(check.limit), verdict_word(check)});
  fmt::print("{}\n{}{}\n", table.text(),
             bold(failed == 0 ? fmt::format("all {} judged checks ok", checks.size() - static_cast<std::size_t>(said))
                              : fmt::format("{} of {} checks FAILED: do not use this device", failed, checks.size())),
             said == 0 ? "" : fmt::format("; {} not judged", said));
  return code;
}

}  // namespace jnd
