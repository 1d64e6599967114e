#include "runner/device_commands/device_output.h"

#include <charconv>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "data/files/draft.h"
#include "protocols/input/resources.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"

namespace jnd {

std::vector<double> numbers_of(const std::string& text, std::size_t count, std::string_view option,
                               std::string_view wants) {
  std::vector<double> numbers;
  std::string_view rest = text;
  while (true) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::string_view word = rest.substr(0, comma);
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(number))
      throw UsageError(fmt::format("{}: \"{}\" is not a finite number: give {}", option, printable(word), wants));
    numbers.push_back(number);
    if (comma == rest.size()) break;
    rest.remove_prefix(comma + 1);
  }
  if (numbers.size() != count)
    throw UsageError(fmt::format("{}: {} number{} instead of {}: give {}", option, numbers.size(),
                                 numbers.size() == 1 ? "" : "s", count, wants));
  return numbers;
}

bool write_csv(const DeviceOutput& output, const std::string& csv) {
  if (output.csv.empty()) return false;
  if (output.csv == "-") {
    if (output.json) throw UsageError("--json and --csv - both want standard output: give --csv a file");
    fmt::print("{}", csv);
    return true;
  }
  const HoldInterrupts hold;
  Draft draft(output.csv, Draft::What::file, Draft::Access::everyone);
  draft.write(csv);
  if (!draft.publish()) throw UsageError(fmt::format("{} exists already; choose another name", output.csv));
  return false;
}

nlohmann::ordered_json json_rows(const Eigen::MatrixXd& matrix) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) rows.push_back(json_vector(matrix.row(row).transpose()));
  return rows;
}

nlohmann::ordered_json json_vector(const Eigen::VectorXd& vector) {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) array.push_back(json_number(vector[i]));
  return array;
}

std::string angle_text(double angle_rad) {
  return fmt::format("{:.6f} rad ({:.3f} deg)", angle_rad, angle_rad * kDegreesPerRadian);
}

RigSpec rig_named(const std::string& name_or_path) {
  return load_rig_spec(find_resource(Resource::device_spec, name_or_path));
}

DeviceSpec device_named(const std::string& name_or_path, DeviceModel model) {
  const RigSpec rig = rig_named(name_or_path);
  const DeviceSpec* device = rig.of(model);
  if (device == nullptr)
    throw UsageError(fmt::format("{} is no {}: give a description of one", name_or_path, facts_of(model).title));
  return *device;
}

void print_field(int width, const char* what, const std::string& value) {
  fmt::print("  {:<{}}{}\n", what, width, printable(value));
}

std::string not_finite(const std::string& text) {
  return std::isfinite(std::strtod(text.c_str(), nullptr)) ? "" : "\"" + text + "\" is not a finite number";
}

void add_output(const Command& command, DeviceOutput& output, const std::string& what_csv) {
  command.add_flag("--json", output.json, "machine-readable");
  if (!what_csv.empty()) command.add_option("--csv", output.csv, what_csv + " into a new file; - prints it");
}

}  // namespace jnd
