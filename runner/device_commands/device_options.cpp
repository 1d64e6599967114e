#include "runner/device_commands/device_options.h"

#include <cmath>
#include <cstdlib>

namespace jnd {

std::string not_finite(const std::string& text) {
  return std::isfinite(std::strtod(text.c_str(), nullptr)) ? "" : "\"" + text + "\" is not a finite number";
}

void add_output(const Command& command, DeviceOutput& output, const std::string& what_csv) {
  command.add_flag("--json", output.json, "machine-readable");
  if (!what_csv.empty()) command.add_option("--csv", output.csv, what_csv + " into a new file; - prints it");
}

}  // namespace jnd
