// jnd device learn-buttons: which bits of a button box's reports mean what, asked of a person who presses them.
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "data/files/draft.h"
#include "devices/device_error.h"
#include "devices/hid/hidapi_bus.h"
#include "runner/device_commands/button_dialogue.h"
#include "runner/device_commands/device_commands.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

struct LearnButtonsOptions {
  std::string file;    // to write; it must not exist
  std::string device;  // path, such as "/dev/hidraw0"; empty: the only one, or asked for
  bool with_stop = false;
  int debounce_ms = 10;
};

void say_at_once(const std::string& line) {
  fmt::print("{}\n", printable(line));
  std::fflush(stdout);  // also into a pipe, whose reader waits for it
}

// A line of standard input; none at its end, and after a signal.
std::optional<std::string> read_line() {
  std::string line;
  for (char character = 0; !interrupts().end;) {
    const ssize_t got = ::read(STDIN_FILENO, &character, 1);
    if (got < 0 && errno == EINTR) continue;
    if (got != 1) return std::nullopt;
    if (character == '\n') return line;
    line += character;
  }
  return std::nullopt;
}

std::string listed(const std::vector<HidInfo>& devices, bool numbered) {
  std::string text;
  for (std::size_t i = 0; i < devices.size(); ++i)
    text += fmt::format("{}{}{}", i == 0 ? "" : "\n", numbered ? fmt::format("{:>3}  ", i + 1) : "  ",
                        described(devices[i]));
  return text;
}

// None where the input ends before one is chosen.
std::optional<HidInfo> chosen_device(HidBus& bus, const std::string& path) {
  const std::vector<HidInfo> devices = devices_with_buttons(bus);
  if (devices.empty())
    throw DeviceError(
        "no HID device is connected, or none can be seen by this login: plug the button box in (jnd doctor says what "
        "the login may use)");
  if (!path.empty()) {
    for (const HidInfo& info : devices)
      if (info.path == path) return info;
    throw DeviceError(fmt::format("{} is no HID device; connected:\n{}", path, listed(devices, false)));
  }
  if (devices.size() == 1) return devices.front();
  if (!is_terminal(STDIN_FILENO))
    throw UsageError(
        fmt::format("several HID devices are connected; name one with --device PATH:\n{}", listed(devices, false)));
  fmt::print("{}\n", printable_lines(listed(devices, true)));
  for (;;) {
    fmt::print("Which one? 1 to {}: ", devices.size());
    std::fflush(stdout);
    const std::optional<std::string> line = read_line();
    if (!line) return std::nullopt;
    std::size_t number = 0;
    const auto [stop, failed] = std::from_chars(line->data(), line->data() + line->size(), number);
    if (failed == std::errc() && stop == line->data() + line->size() && number >= 1 && number <= devices.size())
      return devices[number - 1];
  }
}

// As the kernel shows it; false where it does not: then bytes are counted all the same, as they come.
bool reports_numbered(const std::string& path) {
  const std::filesystem::path device = std::filesystem::path(path).filename();
  std::ifstream file(std::filesystem::path("/sys/class/hidraw") / device / "device" / "report_descriptor",
                     std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
  const std::vector<std::uint8_t> descriptor(text.begin(), text.end());
  return numbers_reports(descriptor);
}

UsageError taken(const std::string& file) {
  return UsageError(fmt::format("{} exists already; choose another name", file));
}

int command_device_learn_buttons(const LearnButtonsOptions& options) {
  const HoldInterrupts hold;
  HidapiBus bus;
  // Before the first press.
  std::error_code error;
  const std::filesystem::file_status there = std::filesystem::symlink_status(options.file, error);
  if (!std::filesystem::status_known(there)) throw cannot_write(options.file, error.value());
  if (std::filesystem::exists(there)) throw taken(options.file);
  Draft file(options.file, Draft::What::file, Draft::Access::everyone);
  const std::optional<HidInfo> info = chosen_device(bus, options.device);
  if (!info) return exit_code::kInterrupted;
  say_at_once(fmt::format("Learning the buttons of {}. Ctrl-C gives up.", described(*info)));
  const LearnerSetup setup{*info, reports_numbered(info->path), options.with_stop, options.debounce_ms};
  const std::optional<ButtonMapping> mapping =
      learn_buttons(bus, setup, say_at_once, [] { return interrupts().end.load(); });
  if (!mapping) {
    say_at_once("Given up; nothing was written.");
    return exit_code::kInterrupted;
  }
  file.write(to_json(*mapping));
  if (!file.publish()) throw taken(options.file);
  fmt::print("{} written. Use it:  jnd run PROTOCOL --study STUDY --buttons {}\n", printable(options.file),
             shell_word(options.file));
  if (info->usage_page == 0x01 && (info->usage == 0x06 || info->usage == 0x07))
    fmt::print(
        "This is a keyboard: its keys also type into the operator's console. Take keys that mean nothing there, such "
        "as digits.\n");
  return exit_code::kDone;
}

}  // namespace

void add_device_learn_buttons(CommandTree& device) {
  const auto [command, options] =
      device.add("learn-buttons", "Learn which buttons of a gamepad, keypad or pedal mean same and different",
                 "jnd device learn-buttons --to pedals.json --stop", command_device_learn_buttons);
  command.add_option("--to", options.file, "the mapping to write, for jnd run --buttons; it must not exist").required();
  command.add_option("--device", options.device,
                     "its path, such as /dev/hidraw0 (default: the only one, or asked for)");
  command.add_flag("--stop", options.with_stop, "also a button that stops the devices at any time");
  command.add_option("--debounce", options.debounce_ms, "how long a contact may bounce, ms (default: 10)")
      .range(0, 200);
}

}  // namespace jnd
