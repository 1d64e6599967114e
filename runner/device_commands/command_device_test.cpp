// jnd device test: a self-test that a technician reads, every line of it measured on the rig.
#include <algorithm>

#include <fmt/format.h>

#include "devices/self_test/device_bench.h"
#include "runner/device_commands/command_device_external.h"
#include "runner/device_commands/command_device_hid.h"
#include "runner/device_commands/device_commands.h"
#include "runner/device_commands/device_output.h"
#include "runner/device_commands/hid_devices.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

struct TestOptions {
  std::string rig;       // or a real device, by serial number or path; or "external"
  std::string rig_file;  // of an external rig; or whose devices that are programs are looked for too
  std::string command;   // of an external rig
  bool json = false;
  bool yes = false;  // a real device may press without being asked for
};

int command_device_test(const TestOptions& options) {
  const HoldInterrupts hold;
  if (options.rig == "external")
    return external_rig_test(external_settings_of(options.rig_file, options.command), options.json, options.yes);
  if (!options.command.empty()) throw UsageError("--command is for jnd device test external");
  if (!names_a_rig(options.rig)) {
    const std::unique_ptr<HidBus> bus = bus_for(options.rig, options.rig_file);
    return hid_device_test(*bus, options.rig, options.json, options.yes);
  }
  const RigSpec rig = rig_named(options.rig);
  const Checks checks = self_test_of(rig);
  const auto failed = std::count_if(checks.begin(), checks.end(), [](const Check& check) { return !check.passed(); });
  const int code = failed == 0 ? exit_code::kDone : exit_code::kDevice;
  if (options.json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Check& check : checks)
      list.push_back({{"device", check.device},
                      {"what", check.what},
                      {"measured", check.found},
                      {"expected", check.limit},
                      {"ok", check.passed()}});
    print_json({{"rig", rig.name}, {"simulated", true}, {"sha256", rig.sha256}, {"ok", failed == 0}, {"checks", list}});
    return code;
  }
  fmt::print("{}: {}\n  simulated, SHA-256 {}\n", bold(printable(rig.name)), printable(rig.title), rig.sha256);
  using Align = TextTable::Align;
  for (std::size_t i = 0; i < checks.size();) {
    TextTable table({checks[i].device, "measured", "expected", ""},
                    {Align::left, Align::left, Align::left, Align::left});
    const std::string device = checks[i].device;
    bool first = true;
    for (; i < checks.size() && (first || checks[i].device == device); ++i, first = false)
      table.add({checks[i].what, checks[i].found, checks[i].limit, checks[i].passed() ? "ok" : bold(warn("FAILED"))});
    fmt::print("\n{}", table.text());
  }
  fmt::print("\n{}\n",
             bold(failed == 0 ? fmt::format("all {} checks ok", checks.size())
                              : fmt::format("{} of {} checks FAILED: do not use this rig", failed, checks.size())));
  return code;
}

}  // namespace

void add_device_test(CommandTree& device) {
  const auto [command, options] =
      device.add("test", "Self-test of a rig, or test of a connected device or of a laboratory's own rig",
                 "jnd device test rrs3\n  jnd device test FT-0001\n  jnd device test external --rig my-rig.json",
                 command_device_test);
  command
      .add_option("RIG", options.rig,
                  "a rig's name, a file that describes one, a device's serial number or path, or \"external\"")
      .required();
  command.add_option("--rig", options.rig_file,
                     "a rig file: where an external rig is; or its devices that are programs are looked for too");
  command.add_option("--command", options.command, "external: the rig's program and arguments, apart by blanks");
  command.add_flag("--yes", options.yes,
                   "a real device may press (0.5 N) and vibrate, a real rig present, without being asked for");
  command.add_flag("--json", options.json, "machine-readable");
}

}  // namespace jnd
