#include "devices/hid/link/rig_check.h"

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "devices/hid/buttons/button_mapping.h"
#include "devices/hid/our_devices.h"
#include "devices/trackers/replay_tracker.h"
#include "protocols/input/input_error.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

constexpr const char* kConnect = "connect it and switch it on (jnd device list shows what is there)";
constexpr const char* kUdev = "install the udev rule that jnd device list prints, and connect it again";

Check good(const char* name, std::string found) {
  return {.what = name, .verdict = Verdict::ok, .found = std::move(found)};
}
Check bad(const char* name, std::string found, std::string what_to_do) {
  return {.what = name, .verdict = Verdict::bad, .found = std::move(found), .what_to_do = std::move(what_to_do)};
}

// A finding has one line.
std::string one_line(const InputError& error) {
  std::string text = error.what();
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos;) text.replace(at, 1, "; ");
  return text;
}

// Of all that fit, one that this login may use; otherwise one that it may not; null: none is connected.
const SeenHid* find(const std::vector<SeenHid>& seen, const std::function<bool(const HidInfo&)>& fits) {
  const SeenHid* found = nullptr;
  for (const SeenHid& one : seen)
    if (fits(one.info) && (found == nullptr || (one.usable && !found->usable))) found = &one;
  return found;
}

// An empty serial number fits every device.
bool has_serial(const HidInfo& info, const std::string& serial) {
  return serial.empty() || info.serial == serial;
}

bool is_at(const HidInfo& info, const std::string& path) {
  return path.empty() || info.path == path;
}

// As the program is looked for when a session starts it; empty: it is not there.
fs::path program_at(const std::string& name, const fs::path& folder) {
  const auto runs = [](const fs::path& path) {
    std::error_code error;
    return fs::is_regular_file(path, error) && access(path.c_str(), X_OK) == 0;
  };
  if (name.find('/') != std::string::npos) return runs(folder / name) ? folder / name : fs::path();
  const char* const places = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  std::istringstream rest(places != nullptr ? places : "/bin:/usr/bin");
  for (std::string place; std::getline(rest, place, ':');)
    if (fs::path path = fs::path(place.empty() ? "." : place) / name; runs(path)) return path;
  return {};
}

// For findings: its serial number, or where it is.
std::string worn_name(const WornDevice& device) {
  if (!device.serial.empty()) return device.serial;
  return device.path().empty() ? std::string("any") : device.path();
}

void add_to(std::string& list, const std::string& device, const std::string& finger) {
  list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", device, finger);
}

Check check_devices(const RigFile& file, const std::vector<SeenHid>& seen) {
  std::string there, missing, refused, startable, absent;
  for (const WornDevice& device : file.devices) {
    if (!device.command.empty()) {
      const bool runs = !program_at(device.command.front(), file.folder).empty();
      add_to(runs ? startable : absent, device.command.front(), device.finger);
      continue;
    }
    const SeenHid* const found = find(seen, [&](const HidInfo& info) {
      return is_fingertip(info) && has_serial(info, device.serial) && is_at(info, device.path());
    });
    add_to(found == nullptr ? missing : found->usable ? there : refused, worn_name(device), device.finger);
  }
  if (!absent.empty())
    return bad("devices", "there is no program " + absent,
               "install it, or correct the device's \"command\" in the rig file");
  if (!missing.empty()) return bad("devices", "not connected: " + missing, kConnect);
  if (!refused.empty()) return bad("devices", "this login may not use " + refused, kUdev);
  if (startable.empty()) return good("devices", there + " connected");
  return good("devices", (there.empty() ? "" : there + " connected; ") + "a session starts " + startable);
}

Check check_buttons(const RigFile& file, const std::vector<SeenHid>& seen) {
  try {
    const ButtonMapping mapping = load_button_mapping(file.buttons);
    const SeenHid* const found = find(seen, [&](const HidInfo& info) { return mapping.is(info); });
    if (found == nullptr) return bad("buttons", mapping.name + " is not connected", kConnect);
    if (!found->usable) return bad("buttons", "this login may not use " + mapping.name, kUdev);
    return good("buttons", mapping.name + " connected");
  } catch (const InputError& error) {
    return bad("buttons", one_line(error), "correct the rig file's \"buttons\", or learn them again");
  }
}

Check check_hid_tracker(const RigFile* file, const std::vector<SeenHid>& seen) {
  const std::string serial = file != nullptr ? file->tracker.serial : "";
  const std::string path = file != nullptr ? file->tracker.socket.string() : "";
  const SeenHid* const found = find(
      seen, [&](const HidInfo& info) { return is_tracker(info) && has_serial(info, serial) && is_at(info, path); });
  if (found == nullptr)
    return bad("tracker",
               serial.empty() ? std::string("\"hid\": the protocol asks for a tracker on HID, and none is connected")
                              : fmt::format("\"hid\": {} is not connected", serial),
               kConnect);
  if (!found->usable) return bad("tracker", "\"hid\": this login may not use " + name_of(found->info), kUdev);
  return good("tracker", fmt::format("\"hid\": {} connected", name_of(found->info)));
}

Check check_process_tracker(const TrackerSource& source) {
  if (source.command.empty())
    return bad("tracker", "\"process\": the rig file does not say which program", "give its \"tracker\" a \"command\"");
  const fs::path program = program_at(source.command.front(), source.folder);
  if (program.empty())
    return bad("tracker", fmt::format("\"process\": there is no program {}", source.command.front()),
               "install it, or correct the tracker's \"command\" in the rig file");
  return good("tracker", fmt::format("\"process\": {}", program.string()));
}

Check check_replay_tracker(const TrackerSource& source, const std::vector<std::string>& fingers) {
  if (source.replay.empty())
    return bad("tracker", "\"replay\": the rig file does not say which file", "give its \"tracker\" a \"replay\"");
  try {
    const ReplayTracker tracker(source.replay, fingers, source.to_world);
    return good("tracker", fmt::format("\"replay\": {}, {} poses", source.replay.string(), tracker.report()->poses));
  } catch (const InputError& error) {
    return bad("tracker", fmt::format("\"replay\": {}", one_line(error)), "record it anew, or name another file");
  }
}

Check check_tracker(const RigRequest& asked, const RigFile* file, const std::vector<SeenHid>& seen) {
  if (asked.tracker == "hid") return check_hid_tracker(file, seen);
  if (asked.tracker != "process" && asked.tracker != "replay")
    return good("tracker", fmt::format("\"{}\": part of the program or the device", asked.tracker));
  if (file == nullptr)
    return {.what = "tracker",
            .verdict = Verdict::warn,
            .found = fmt::format("\"{}\": a rig file says which, and none was given", asked.tracker),
            .what_to_do = "give the one of jnd run here too: --rig FILE"};
  return asked.tracker == "process" ? check_process_tracker(file->tracker)
                                    : check_replay_tracker(file->tracker, asked.fingers);
}

}  // namespace

Checks check_rig(const RigRequest* asked, const RigFile* file, const std::vector<SeenHid>& seen) {
  Checks checks;
  if (file != nullptr && !file->devices.empty()) checks.push_back(check_devices(*file, seen));
  if (asked != nullptr) checks.push_back(check_tracker(*asked, file, seen));
  if (file != nullptr && !file->buttons.empty()) checks.push_back(check_buttons(*file, seen));
  return checks;
}

}  // namespace jnd
