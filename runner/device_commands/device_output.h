// What the device commands share: their numbers as arguments and as text, and where their answers go.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "protocols/rigs/rig_description.h"
#include "runner/terminal/command_tree.h"
#include "runner/terminal/json_output.h"

namespace jnd {

// Where an answer goes beside the text for a person. csv: a file to write, "-" for standard output (then nothing else
// is printed there), empty for none.
struct DeviceOutput {
  bool json = false;
  std::string csv;
};

// "0.1,0.2,0.3" as exactly `count` finite numbers. Throws UsageError that names the option and what it wants: `wants`
// is "PZ,ROLL,PITCH (m, rad, rad), such as -0.02,0.1,-0.05".
std::vector<double> numbers_of(const std::string& text, std::size_t count, std::string_view option,
                               std::string_view wants);

// Writes what --csv asks. Returns whether standard output belongs to the CSV, so that nothing else is to be printed.
// Throws UsageError beside --json and where the file exists, and StorageError where it cannot be written.
bool write_csv(const DeviceOutput& output, const std::string& csv);

template <typename Numbers>
nlohmann::ordered_json json_array(const Numbers& numbers) {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (const double number : numbers) array.push_back(json_number(number));
  return array;
}
// A row an array.
nlohmann::ordered_json json_rows(const Eigen::MatrixXd& matrix);
nlohmann::ordered_json json_vector(const Eigen::VectorXd& vector);

// "0.351181 rad (20.121 deg)".
std::string angle_text(double angle_rad);
inline constexpr double kDegreesPerRadian = 57.295779513082320877;

// The rig's description from a shipped name or a file; the device of one model. Throws InputError, and UsageError where
// the rig has no device of that model.
RigSpec rig_named(const std::string& name_or_path);
DeviceSpec device_named(const std::string& name_or_path, DeviceModel model);

// A line "  WHAT     VALUE" for a person; the value begins `width` characters behind the indent. Text of a device is made
// printable.
void print_field(int width, const char* what, const std::string& value);

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
