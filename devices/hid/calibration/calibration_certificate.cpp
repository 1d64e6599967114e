#include "devices/hid/calibration/calibration_certificate.h"

#include <algorithm>
#include <array>
#include <ctime>

#include <fmt/format.h>

#include "devices/hid/report_words.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_text.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKind = "jnd calibration certificate";
constexpr std::size_t kIdDigits = JND_CALIBRATION_ID_SIZE;

Json table_json(const ForceTable& table) {
  return {{"sensor_n", table.sensor_n}, {"force_n", table.force_n}};
}

Json summary_json(const ReadingSummary& summary) {
  return {{"mean", summary.mean}, {"sd", summary.sd}, {"drift_per_s", summary.drift_per_s}, {"count", summary.count}};
}

Json force_json(const CalibrationRecord& record) {
  Json points = Json::array();
  for (std::size_t i = 0; i < record.force.size(); ++i) {
    const ForceRecord& one = record.force[i];
    points.push_back({{"known_n", one.point.known_n},
                      {"pushed_n", one.pushed_n},
                      {"sensor_n", summary_json(one.point.sensor)},
                      {"residual_n", record.fit.residuals_n.at(i)},
                      {"readings_n", one.sensor_n}});
  }
  return {{"full_scale_n", 1e-6 * record.limits.most_force_un},
          {"points", points},
          {"table", table_json(record.fit.table)},
          {"rms_residual_n", record.fit.rms_n},
          {"largest_residual_n", record.fit.largest_n},
          {"hysteresis_n", record.fit.hysteresis_n ? Json(*record.fit.hysteresis_n) : Json(nullptr)},
          {"former_table", table_json(record.former_table)}};
}

Json stiffness_json(const CalibrationRecord& record) {
  Json list = Json::array();
  for (const StiffnessRecord& one : record.stiffness) {
    Json points = Json::array();
    for (const StiffnessPoint& point : one.points)
      points.push_back({{"depth_m", point.depth_m}, {"force_n", summary_json(point.force)}});
    list.push_back({{"asked_n_per_m", one.fit.asked_n_per_m},
                    {"measured_n_per_m", one.fit.slope_n_per_m},
                    {"relative_error", one.fit.relative_error()},
                    {"intercept_n", one.fit.intercept_n},
                    {"rms_residual_n", one.fit.rms_n},
                    {"points", points}});
  }
  return list;
}

std::string hash_of(Json document) {
  document.erase("sha256");
  document.erase("id");
  return sha256_hex(json_text(document));
}

}  // namespace

std::vector<CalibrationFinding> findings_of(const CalibrationRecord& record) {
  std::vector<ForcePoint> points;
  for (const ForceRecord& one : record.force) points.push_back(one.point);
  std::vector<CalibrationFinding> findings = judge_force(record.fit, points, 1e-6 * record.limits.most_force_un);
  for (const StiffnessRecord& one : record.stiffness) findings.push_back(judge_stiffness(one.fit));
  return findings;
}

bool passed(const std::vector<CalibrationFinding>& findings) noexcept {
  return std::all_of(findings.begin(), findings.end(), [](const CalibrationFinding& finding) { return finding.ok; });
}

Json certificate_of(const CalibrationRecord& record) {
  const std::vector<CalibrationFinding> findings = findings_of(record);
  Json list = Json::array();
  for (const CalibrationFinding& finding : findings)
    list.push_back({{"what", finding.what},
                    {"value", finding.value},
                    {"limit", finding.limit},
                    {"unit", finding.unit},
                    {"ok", finding.ok}});
  const auto seconds = static_cast<std::time_t>(record.utc_ns / 1'000'000'000);
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  const std::string time(text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc));
  Json document = {{"format", 1},
                   {"kind", kKind},
                   {"device",
                    {{"serial", serial_of(record.identity)},
                     {"model", model_word(record.identity.model)},
                     {"finger", finger_word(record.identity.finger)},
                     {"firmware", firmware_text(record.identity)},
                     {"former_calibration_id", calibration_id_of(record.identity)}}},
                   {"date", time.substr(0, time.find('T'))},
                   {"utc", time},
                   {"program", record.program},
                   {"operator", record.operator_name},
                   {"reference", record.reference},
                   {"remarks", record.remarks},
                   {"passed", passed(findings)},
                   {"findings", list},
                   {"limits_from", calibration_limits_source()},
                   {"force", force_json(record)},
                   {"stiffness", stiffness_json(record)}};
  // As a reader of the file will have it, so that numbers and text have the very same bytes there.
  document = json_from(json_text(document));
  const std::string hash = hash_of(document);
  document["sha256"] = hash;
  document["id"] = hash.substr(0, kIdDigits);
  return document;
}

jnd_certificate stored_certificate(const Json& certificate) {
  jnd_certificate out{};
  const std::string id = certificate.at("id").get<std::string>();
  std::copy_n(id.begin(), std::min(id.size(), kIdDigits), out.calibration_id);
  std::string date = certificate.at("date").get<std::string>();
  std::erase(date, '-');
  out.date = static_cast<std::uint32_t>(std::stoul(date));
  return out;
}

Json load_certificate(const std::filesystem::path& path) {
  Json document = json_if_valid(read_input_file(path));
  const auto text = [&document](const char* key) {
    return document.is_object() && document.contains(key) && document[key].is_string()
               ? document[key].get<std::string>()
               : std::string();
  };
  if (text("kind") != kKind)
    throw InputError(
        fmt::format("{}: is no calibration certificate; give a file that jnd device calibrate wrote", path.string()));
  const std::string hash = hash_of(document);
  if (hash != text("sha256") || hash.substr(0, kIdDigits) != text("id"))
    throw InputError(fmt::format("{}: was changed after it was made: its SHA-256 is {}, it says {}; use the original",
                                 path.string(), hash, text("sha256")));
  return document;
}

std::optional<std::filesystem::path> find_certificate(const std::filesystem::path& folder, std::string_view id) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() != ".json" || entry->path().string().find(id) == std::string::npos) continue;
    try {
      if (load_certificate(entry->path()).at("id") == id) return entry->path();
    } catch (const InputError&) {  // another file that happens to have such a name
    }
  }
  return std::nullopt;
}

}  // namespace jnd
