// `jnd device`: what the devices and their models do, before a study relies on them. Each command adds itself in its own
// command_device_*.cpp; runner/device_commands/device_commands.cpp collects them. Angles are rad, everything else SI.
#pragma once

#include "runner/terminal/command_tree.h"

namespace jnd {

// Adds the whole tree `jnd device ...`.
void add_device_commands(CommandTree& program);
// jnd doctor: is this machine fit to run a session.
void add_doctor(CommandTree& program);

void add_device_list(CommandTree& device);
void add_device_info(CommandTree& device);
void add_device_model(CommandTree& device);
void add_device_step(CommandTree& device);
void add_device_bode(CommandTree& device);
void add_device_track(CommandTree& device);
void add_device_onset(CommandTree& device);
void add_device_stiffness(CommandTree& device);
void add_device_test(CommandTree& device);
void add_device_calibrate(CommandTree& device);
void add_device_learn_buttons(CommandTree& device);

}  // namespace jnd
