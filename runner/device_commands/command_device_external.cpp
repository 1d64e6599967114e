#include "runner/device_commands/command_device_external.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "devices/external/conformance.h"
#include "devices/external/rig_probe.h"
#include "devices/rigs/rig_file.h"
#include "protocols/input/utf8.h"
#include "runner/device_commands/device_output.h"
#include "runner/device_commands/hid_devices.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

bool may_present(const RigHello& hello, bool yes) {
  if (hello.model) return true;
  return may_press(
      fmt::format("{} will present the lowest and the highest value that it can. Touch it with nothing but "
                  "what may be pressed.",
                  printable(hello.name)),
      yes, false);
}

nlohmann::ordered_json json_of(const Checks& checks) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  int number = 0;
  for (const Check& check : checks)
    list.push_back({{"number", ++number},
                    {"device", "external"},
                    {"what", std::string(check.what.substr(check.what.find_first_not_of(' ')))},
                    {"measured", check.found},
                    {"expected", check.limit},
                    {"ok", check.passed()},
                    {"slow", check.verdict == Verdict::warn},
                    {"judged", check.verdict != Verdict::not_judged}});
  return list;
}

// A table cell; --json has the whole.
std::string cell(const std::string& text) {
  constexpr std::size_t kMostCell = 64;
  return printable(text.size() <= kMostCell ? text : text.substr(0, character_boundary(text, kMostCell - 3)) + "...");
}

void print_checks(const Checks& checks, const std::string& name) {
  using Align = TextTable::Align;
  TextTable table({"", name, "measured", "expected", ""},
                  {Align::right, Align::left, Align::left, Align::left, Align::left});
  int number = 0;
  for (const Check& check : checks)
    table.add({fmt::format("{}", ++number), check.what, cell(check.found), cell(check.limit),
               check.passed() ? std::string(to_string(check.verdict)) : bold(warn("FAILED"))});
  fmt::print("{}", table.text());
}

}  // namespace

ExternalSettings external_settings_of(const std::string& rig_file, const std::string& command) {
  if (rig_file.empty() == command.empty())
    throw UsageError("jnd device test external needs --rig FILE or --command \"PROGRAM ARGUMENTS\", one of the two");
  if (!rig_file.empty()) {
    RigFile file = load_rig_file(rig_file);
    if (!file.external)
      throw InputError(fmt::format("{} names no external rig: it has no \"external\"", printable(rig_file)));
    return std::move(*file.external);
  }
  ExternalSettings settings;
  std::istringstream words(command);
  for (std::string word; words >> word;) settings.command.push_back(word);
  if (settings.command.empty()) throw UsageError("--command names no program");
  return settings;
}

int external_rig_test(const ExternalSettings& settings, bool json, bool yes) {
  Conformance result;
  try {
    result = check_conformance(settings, interrupt_requested(),
                               [&](const RigHello& hello) { return may_present(hello, yes); });
  } catch (const ProbeInterrupted& interrupted) {
    print_message("{}: {}\n", printable(in_words(settings)), interrupted.what());
    return exit_code::kInterrupted;
  }
  const auto count = [&](Verdict verdict) {
    return std::count_if(result.checks.begin(), result.checks.end(),
                         [&](const Check& check) { return check.verdict == verdict; });
  };
  const auto failed = count(Verdict::bad), slow = count(Verdict::warn), said = count(Verdict::not_judged);
  const int code = failed == 0 ? exit_code::kDone : exit_code::kDevice;
  if (json) {
    const bool greeted = result.hello.has_value();
    print_json({{"rig", greeted ? nlohmann::ordered_json(result.hello->name) : nullptr},
                {"source", in_words(settings)},
                {"simulated", greeted && result.hello->model},
                {"ok", failed == 0},
                {"checks", json_of(result.checks)}});
    return code;
  }
  print_checks(result.checks, result.hello ? printable(result.hello->name) : "external rig");
  fmt::print("{}{}{}\n",
             bold(failed == 0 ? fmt::format("all {} judged checks ok", slow + count(Verdict::ok))
                              : fmt::format("{} of {} checks FAILED: do not use this rig", failed,
                                            failed + slow + count(Verdict::ok))),
             slow == 0 ? "" : fmt::format("; {} slow, which a session allows", slow),
             said == 0 ? "" : fmt::format("; {} not judged", said));
  return code;
}

}  // namespace jnd
