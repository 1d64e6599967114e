#include "runner/device_commands/device_commands.h"

namespace jnd {

void add_device_commands(CommandTree& program) {
  CommandTree device =
      program.add_group("device", "What the devices and their models do: test, measure, ask", "jnd device test rrs3");
  add_device_list(device);
  add_device_info(device);
  add_device_model(device);
  add_device_step(device);
  add_device_bode(device);
  add_device_track(device);
  add_device_onset(device);
  add_device_stiffness(device);
  add_device_test(device);
  add_device_calibrate(device);
  add_device_learn_buttons(device);
}

}  // namespace jnd
