// What a calibration leaves behind: every reading, the fit and the verdict, as one JSON document that names its own
// SHA-256. Its first 16 digits are the calibration id that the device then carries.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "devices/hid/calibration/calibration.h"
#include "devices/hid/firmware/jnd_report.h"

namespace jnd {

// One point of a force calibration with all its readings.
struct ForceRecord {
  ForcePoint point;
  double pushed_n = 0;           // what the device was asked to press with; 0: it was pressed on
  std::vector<double> sensor_n;  // the sensor's own figures, in order
};

struct StiffnessRecord {
  StiffnessFit fit;
  std::vector<StiffnessPoint> points;
};

struct CalibrationRecord {
  jnd_identity identity{};
  jnd_limits limits{};
  std::int64_t utc_ns = 0;  // when it ended
  std::string program;      // version of this program
  std::string operator_name, reference, remarks;
  ForceTable former_table;  // that was in the device
  std::vector<ForceRecord> force;
  ForceFit fit;
  std::vector<StiffnessRecord> stiffness;  // empty: not measured
};

std::vector<CalibrationFinding> findings_of(const CalibrationRecord& record);
bool passed(const std::vector<CalibrationFinding>& findings) noexcept;

// The whole document, sealed: "sha256" is that of the compact document without "sha256" and "id".
nlohmann::ordered_json certificate_of(const CalibrationRecord& record);
// What goes into the device.
jnd_certificate stored_certificate(const nlohmann::ordered_json& certificate);

// A certificate's file, looked through. Throws InputError where it cannot be read, is none, or was changed since.
nlohmann::ordered_json load_certificate(const std::filesystem::path& path);
// The file in a folder whose certificate has this id; none where there is none that is whole.
std::optional<std::filesystem::path> find_certificate(const std::filesystem::path& folder, std::string_view id);

}  // namespace jnd
