#include "runner/opening/chosen_rig.h"

#include "devices/hid/hidapi_bus.h"
#include "runner/terminal/exit_code.h"

namespace jnd {

ChosenRig choose_rig(const std::string& rig, bool fast) {
  ChosenRig chosen;
  if (rig == "simulated") return chosen;
  if (rig == "specimens") {
    chosen.own = make_specimen_rigs();
    return chosen;
  }
  if (fast)
    throw UsageError(
        "--fast skips time, and devices and other programs do not: leave it out, or rehearse with --rig simulated (the default)");
  if (rig != "hid") chosen.file = load_rig_file(rig);
  chosen.own = chosen.file.external ? make_laboratory_rigs(*chosen.file.external) : make_hid_rigs(chosen.file);
  return chosen;
}

ChosenButtons choose_buttons(const std::filesystem::path& mapping, const RigFile& rig) {
  ChosenButtons chosen;
  const std::filesystem::path& file = mapping.empty() ? rig.buttons : mapping;
  if (file.empty()) return chosen;
  chosen.bus = std::make_unique<HidapiBus>();
  chosen.box = std::make_unique<ButtonBox>(*chosen.bus, load_button_mapping(file));
  chosen.box->wait_until_there();
  return chosen;
}

std::vector<std::filesystem::path> certificate_folders(const RigFile& rig, const std::filesystem::path& study) {
  std::vector<std::filesystem::path> folders = {study.has_parent_path() ? study.parent_path() : ".", "."};
  if (!rig.folder.empty()) folders.insert(folders.begin(), rig.folder);
  return folders;
}

}  // namespace jnd
