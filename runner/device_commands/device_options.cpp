#include "runner/device_commands/device_options.h"

#include <cmath>

namespace jnd {

const CLI::Validator& finite() {
  static const CLI::Validator validator(
      [](std::string& text) -> std::string {
        double value = 0;
        if (!CLI::detail::lexical_cast(text, value)) return {};  // the option itself says so
        return std::isfinite(value) ? "" : "\"" + text + "\" is not a finite number";
      },
      "", "finite");
  return validator;
}

void add_output(CLI::App& command, DeviceOutput& output, const std::string& what_csv) {
  command.add_flag("--json", output.json, "machine-readable");
  if (!what_csv.empty()) command.add_option("--csv", output.csv, what_csv + " into a new file; - prints it");
}

}  // namespace jnd
