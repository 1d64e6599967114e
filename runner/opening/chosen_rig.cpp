#include "runner/opening/chosen_rig.h"

#include "devices/hid/hidapi_bus.h"

namespace jnd {

ChosenRig choose_rig(const RunOptions& options) {
  ChosenRig chosen;
  if (options.rig == "simulated") return chosen;
  if (options.fast)
    throw UsageError(
        "--fast skips time, and real devices do not: leave it out, or rehearse with --rig simulated (the default)");
  if (options.rig != "hid") chosen.file = load_rig_file(options.rig);
  chosen.own = make_hid_rigs(chosen.file);
  return chosen;
}

ChosenButtons choose_buttons(const RunOptions& options, const RigFile& rig) {
  ChosenButtons chosen;
  const std::filesystem::path mapped = options.buttons.empty() ? rig.buttons : std::filesystem::path(options.buttons);
  if (mapped.empty()) return chosen;
  const ButtonMapping mapping = load_button_mapping(mapped);
  chosen.bus = std::make_unique<HidapiBus>();
  chosen.box = std::make_unique<ButtonBox>(*chosen.bus, mapping);
  chosen.box->wait_until_there();
  return chosen;
}

std::vector<std::filesystem::path> certificate_folders(const RigFile& rig, const std::filesystem::path& study) {
  std::vector<std::filesystem::path> folders = {study.has_parent_path() ? study.parent_path() : ".", "."};
  if (!rig.tracker.folder.empty()) folders.insert(folders.begin(), rig.tracker.folder);
  return folders;
}

}  // namespace jnd
