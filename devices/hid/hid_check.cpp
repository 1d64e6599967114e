// Which HID devices are connected, which of them are ours, and whether this login may use them.
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <map>

#include <fmt/format.h>
#include <unistd.h>

#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/udev_rule.h"
#include "devices/machine/machine_checks.h"
#include "protocols/input/number_from.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

struct Node {
  std::string label;       // "hidraw0 (Fingertip, serial FT-0001)"
  unsigned usage = 0;      // of jnd's usage page; 0: none of ours
  bool described = false;  // its report descriptor could be read
  bool usable = false;
  std::array<std::uint16_t, 3> id{};  // bus, vendor, product; zero: not known
};

// Its nodes by number; what is not "hidraw" and a number is none.
std::map<int, fs::path> hidraw_nodes(const fs::path& folder) {
  constexpr std::string_view kPrefix = "hidraw";
  std::map<int, fs::path> nodes;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(kPrefix)) continue;
    if (const auto number = number_from<int>(std::string_view(name).substr(kPrefix.size())))
      nodes[*number] = entry->path();
  }
  return nodes;
}

// "0003:00001209:00005AFE": bus, vendor, product.
std::array<std::uint16_t, 3> id_of(std::string_view text) {
  std::array<std::uint16_t, 3> id{};
  for (std::uint16_t& part : id) {
    unsigned long value = 0;
    const auto [stop, wrong] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if (wrong != std::errc() || value > 0xFFFF) return {};
    part = static_cast<std::uint16_t>(value);
    text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    if (!text.empty()) text.remove_prefix(1);
  }
  return id;
}

// The usage of a report descriptor that begins with jnd's usage page; 0 where it does not.
unsigned usage_of(std::string_view descriptor) {
  constexpr std::array<char, 4> kOurs = {0x06, JND_USAGE_PAGE & 0xFF, static_cast<char>(JND_USAGE_PAGE >> 8), 0x09};
  if (descriptor.size() < 5 || !descriptor.starts_with(std::string_view(kOurs.data(), kOurs.size()))) return 0;
  return static_cast<unsigned char>(descriptor[4]);
}

Node node_at(const fs::path& root, const std::string& name, const fs::path& path) {
  Node node;
  const fs::path device = root / "sys/class/hidraw" / name / "device";
  std::string title, serial;
  std::ifstream properties(device / "uevent");
  for (std::string line; std::getline(properties, line);) {
    if (line.starts_with("HID_NAME=")) title = line.substr(9);
    if (line.starts_with("HID_UNIQ=")) serial = line.substr(9);
    if (line.starts_with("HID_ID=")) node.id = id_of(std::string_view(line).substr(7));
  }
  std::ifstream file(device / "report_descriptor", std::ios::binary);
  const std::string descriptor{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  node.described = !descriptor.empty();
  node.usage = usage_of(descriptor);
  node.usable = access(path.c_str(), R_OK | W_OK) == 0;
  node.label = name;
  if (node.usage == JND_USAGE_FINGERTIP) title = "fingertip device " + serial;
  if (node.usage == JND_USAGE_TRACKER) title = "tracker " + serial;
  if (!title.empty()) node.label += fmt::format(" ({})", title);
  return node;
}

void add_to(std::string& list, const std::string& label) {
  list += (list.empty() ? "" : ", ") + label;
}

}  // namespace

Check check_hid(const fs::path& root) {
  Check check{.what = "HID devices", .verdict = Verdict::ok};
  const auto nodes = hidraw_nodes(root / "dev");
  if (nodes.empty()) {
    check.found = "none connected (simulated devices need none)";
    return check;
  }
  std::string ours, usable, refused, others, rules;
  for (const auto& [number, path] : nodes) {
    const Node node = node_at(root, path.filename().string(), path);
    if (node.usable) {
      add_to(node.usage != 0 ? ours : usable, node.label);
      continue;
    }
    // A keyboard that this login may not read is as it should be; what does not say what it is may be one of ours.
    add_to(node.usage == 0 && node.described ? others : refused, node.label);
    if (node.usage == 0 && node.described) continue;
    const std::string rule = udev_rule(node.id[1], node.id[2], node.id[0] == 0 ? kUsbBus : node.id[0]);
    if (node.id[1] != 0 && rules.find(rule) == std::string::npos) rules += (rules.empty() ? "" : " and ") + rule;
  }
  check.found = fmt::format("{} connected", nodes.size());
  if (!ours.empty()) check.found += "; of jnd and usable: " + ours;
  if (!usable.empty()) check.found += "; usable: " + usable;
  if (!others.empty()) check.found += "; not usable, which matters for a button box only: " + others;
  if (refused.empty()) return check;
  check.verdict = Verdict::warn;
  check.found += "; not readable and writable by this login: " + refused;
  if (rules.empty())
    rules =
        "KERNEL==\"hidraw*\", SUBSYSTEM==\"hidraw\", KERNELS==\"0003:VENDOR:PRODUCT.*\", "
        "MODE=\"0660\", GROUP=\"plugdev\", TAG+=\"uaccess\" with the numbers of jnd device list";
  check.what_to_do = fmt::format(
      "put the line {} into {}, run sudo udevadm control --reload and connect the device again", rules, kUdevRulesPath);
  return check;
}

}  // namespace jnd
