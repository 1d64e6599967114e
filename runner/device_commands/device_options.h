// What the device commands share: the options that several of them have.
#pragma once

#include <string>

#include "runner/device_commands/device_output.h"
#include "runner/terminal/command_tree.h"

namespace jnd {

// --json, and --csv where the answer can be a table: what_csv says what it writes, empty where there is none.
void add_output(const Command& command, DeviceOutput& output, const std::string& what_csv);

// What is wrong with a text that is no finite number; empty where it is one, or no number at all: that the option says.
std::string not_finite(const std::string& text);

// An option that is a finite number, or several of them. value: a number, std::optional or std::vector of it.
template <typename T>
CommandOption add_number(const Command& command, const std::string& name, T& value, const std::string& what) {
  return command.add_option(name, value, what).check(not_finite);
}

}  // namespace jnd
