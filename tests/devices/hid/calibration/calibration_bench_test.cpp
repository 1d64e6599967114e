// A calibration from the first question to what the device then says, on the firmware with a wrong sensor.
#include "devices/hid/calibration/calibration_bench.h"

#include <deque>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "devices/device_error.h"
#include "devices/hid/report_words.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/hid/bench/bench_firmware.h"

using namespace jnd;
using jnd::testing::BenchFirmware;
namespace fs = std::filesystem;

namespace {

const std::atomic<bool> kGoesOn{false};

// Answers each question after a while, as a person does; puts on the device what it is told to.
class Typist final : public CalibrationOperator {
 public:
  Typist(BenchFirmware& device, std::deque<std::string> lines) : device_(device), lines_(std::move(lines)) {}
  void ask(const std::string& question) override {
    questions.push_back(question);
    thinks_ = 40;
  }
  std::optional<std::string> answer() override {
    if (thinks_-- > 0) return std::nullopt;
    if (lines_.empty()) throw InputError("the input has ended");
    std::string line = lines_.front();
    lines_.pop_front();
    if (follow)
      device_.load_n = line.empty() || line.find_first_not_of("0123456789.") != line.npos ? 0 : std::stod(line);
    return line;
  }
  void say(const std::string& text) override { said.push_back(text); }

  bool follow = false;
  std::vector<std::string> questions, said;

 private:
  BenchFirmware& device_;
  std::deque<std::string> lines_;
  int thinks_ = 0;
};

struct Lab {
  BenchFirmware device;
  DeviceSpec spec = spec_of(device.config.limits, device.config.geometry, 10);
  BenchLink link{device, device, spec, kGoesOn};

  CalibrationRecord record_of(std::vector<ForceRecord> forces) const {
    CalibrationRecord record;
    record.identity = device.config.identity;
    record.limits = device.config.limits;
    record.utc_ns = 1'772'366'400'000'000'000;  // 2026-03-01T12:00:00Z
    record.program = "0.1.0";
    record.operator_name = "A. Tester";
    record.reference = "scale 17";
    record.force = std::move(forces);
    std::vector<ForcePoint> points;
    for (const ForceRecord& one : record.force) points.push_back(one.point);
    record.fit = fit_force(points);
    return record;
  }
};

std::vector<CalibrationStep> pushes(const std::vector<double>& forces) {
  std::vector<CalibrationStep> steps;
  for (const double force : forces) steps.push_back({.known_n = force, .pushed_n = force});
  return steps;
}

struct Folder {
  fs::path path = fs::temp_directory_path() / ("jnd-certificates-" + std::to_string(::getpid()));
  Folder() {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path put(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name) << bytes;
    return path / name;
  }
};

}  // namespace

TEST_CASE("known forces that are typed make the device say what is true") {
  Lab lab;
  lab.device.sensor_gain = 0.8;
  lab.device.sensor_offset_n = 0.3;
  Typist typist(lab.device, {"0", "one", "1", "2.5", "4", "2.5", "0", ""});
  typist.follow = true;
  const std::vector<ForceRecord> forces = take_forces(lab.link, {}, {}, true, typist);
  REQUIRE(forces.size() == 6);
  CHECK(forces[1].sensor_n.size() > 900);
  CHECK(forces[1].point.sensor.mean == Approx(1.1).margin(1e-5));
  CHECK(std::any_of(typist.said.begin(), typist.said.end(),
                    [](const std::string& text) { return text.find("\"one\" is no number") == 0; }));
  const CalibrationRecord record = lab.record_of(forces);
  CHECK(passed(findings_of(record)));
  const nlohmann::ordered_json certificate = certificate_of(record);
  PageExchange pages(lab.device, "it");
  store_calibration(pages, record.fit.table, stored_certificate(certificate));
  CHECK(calibration_id_of(pages.identity()) == certificate["id"].get<std::string>());
  CHECK(date_text(pages.identity().calibration_date) == "2026-03-01");
  lab.device.load_n = 3;
  for (int i = 0; i < 5; ++i) lab.link.silence();
  CHECK(1e-6 * lab.link.telemetry().force_un == Approx(3).margin(1e-4));
}

TEST_CASE("a second calibration sees through the table of the first") {
  Lab lab;
  lab.device.sensor_gain = 1.3;
  Typist typist(lab.device, {});
  PageExchange pages(lab.device, "it");
  jnd_force_table wrong{};
  wrong.points = 2;
  wrong.force_un[1] = 2'000'000;
  wrong.sensor_un[1] = 1'000'000;
  pages.store(wrong);
  const ForceTable former = from_report(pages.force_table());
  const auto forces = take_forces(lab.link, former, pushes({0.5, 1.5, 3, 4, 3, 1.5, 0.5}), false, typist);
  const ForceFit fit = lab.record_of(forces).fit;
  CHECK(force_of(fit.table, 1.3 * 2) == Approx(2).margin(1e-3));
  const StiffnessRecord stiffness = take_stiffness(lab.link, former, fit.table, 700, 4.7);
  CHECK(stiffness.fit.slope_n_per_m == Approx(700).epsilon(0.001));
  CHECK(stiffness.points.size() == 5);
  CHECK(judge_stiffness(stiffness.fit).ok);
}

TEST_CASE("the reference's figure is asked for while the device presses") {
  Lab lab;
  Typist typist(lab.device, {"1.0", "2.0", "3.0"});
  const auto forces = take_forces(lab.link, {}, {{.pushed_n = 1}, {.pushed_n = 2}, {.pushed_n = 3}}, false, typist);
  REQUIRE(forces.size() == 3);
  CHECK(forces[2].point.sensor.mean == Approx(3).margin(1e-3));
  CHECK(forces[2].pushed_n == 3);
  CHECK(lab.device.fingertip.state == JND_STATE_REST);
}

TEST_CASE("nothing before the platform is no stiffness") {
  Lab lab;
  lab.device.contact = false;
  CHECK_THROWS_AS(take_stiffness(lab.link, {}, {}, 700, 4.7), DeviceError);
}

TEST_CASE("a device that falls silent before it presses is named with what was seen of it") {
  Lab lab;
  lab.device.spoil = [&](jnd::testing::HidReport& report) {
    jnd_telemetry telemetry{};
    lab.device.frozen = jnd_decode_telemetry(report.data(), report.size(), &telemetry) == JND_DECODE_OK &&
                        telemetry.state == JND_STATE_ACTIVE;
  };
  Typist typist(lab.device, {});
  CHECK_THROWS_WITH(take_forces(lab.link, {}, pushes({1}), false, typist),
                    "the device cannot press (ended by stale_reading); run jnd device test");
}

TEST_CASE("an aborted calibration leaves the device as it was, and at rest") {
  Lab lab;
  PageExchange pages(lab.device, "it");
  const PageData table = pages.read(JND_PAGE_FORCE_TABLE), certificate = pages.read(JND_PAGE_CERTIFICATE);
  {
    Typist typist(lab.device, {"1.0"});  // then the input ends, while the device presses
    BenchLink link(lab.device, lab.device, lab.spec, kGoesOn);
    CHECK_THROWS_AS(take_forces(link, {}, {{.pushed_n = 1}, {.pushed_n = 2}}, false, typist), InputError);
  }
  lab.device.sleep_until_ns(lab.device.now_ns() + 2'000'000);
  CHECK(lab.device.fingertip.state == JND_STATE_REST);
  Typist silent(lab.device, {""});
  CHECK_THROWS_AS(take_forces(lab.link, {}, {{.pushed_n = 1}}, false, silent), InputError);
  CHECK(pages.read(JND_PAGE_FORCE_TABLE) == table);
  CHECK(pages.read(JND_PAGE_CERTIFICATE) == certificate);
}

TEST_CASE("where the certificate cannot be stored the former calibration comes back") {
  Lab lab;
  const CalibrationRecord record = [&] {
    Typist typist(lab.device, {});
    return lab.record_of(take_forces(lab.link, {}, pushes({0.5, 2, 4}), false, typist));
  }();
  const jnd_certificate certificate = stored_certificate(certificate_of(record));
  PageExchange pages(lab.device, "it", {}, {.read_ms = 50, .write_ms = 50, .tries = 3});
  store_calibration(pages, record.fit.table, certificate);
  const PageData former = pages.read(JND_PAGE_FORCE_TABLE);
  // The certificate gets lost on its way: its write is answered, but another one is read back.
  int certificates = 0;
  lab.device.spoil = [&](jnd::testing::HidReport& report) {
    jnd_answer answer{};
    if (jnd_decode_answer(report.data(), report.size(), &answer) != JND_DECODE_OK) return;
    if (answer.page != JND_PAGE_CERTIFICATE || ++certificates != 3) return;  // former, written, read back
    answer.data[0] ^= 1U;
    jnd_encode_answer(&answer, report.data());
  };
  ForceTable other = record.fit.table;
  other.force_n.back() += 0.5;
  std::string message;
  try {
    store_calibration(pages, other, certificate);
  } catch (const DeviceError& error) {
    message = error.what();
  }
  CHECK(message.find("its former calibration was put back") != std::string::npos);
  CHECK(pages.read(JND_PAGE_FORCE_TABLE) == former);
}

TEST_CASE("a certificate is found by its id, and any change of it is seen") {
  Lab lab;
  Typist typist(lab.device, {});
  const CalibrationRecord record = lab.record_of(take_forces(lab.link, {}, pushes({0.5, 2, 4}), false, typist));
  const nlohmann::ordered_json certificate = certificate_of(record);
  const std::string id = certificate["id"];
  CHECK(id.size() == 16);
  CHECK(certificate["sha256"].get<std::string>().substr(0, 16) == id);
  CHECK(certificate["date"] == "2026-03-01");
  CHECK(certificate["device"]["serial"] == "FT-0001");
  const Folder folder;
  const fs::path file = folder.put("FT-0001-" + id + ".json", certificate.dump());
  CHECK(load_certificate(file) == certificate);
  CHECK(find_certificate(folder.path, id) == file);
  CHECK_FALSE(find_certificate(folder.path, "0123456789abcdef"));
  CHECK_FALSE(find_certificate(folder.path / "nowhere", id));
  // Spread over lines by another program it is the same document.
  CHECK(load_certificate(folder.put("pretty.json", certificate.dump(2))) == certificate);
  for (const char* key : {"operator", "passed", "force", "sha256", "id", "device"}) {
    nlohmann::ordered_json changed = certificate;
    changed[key] = "something else";
    const fs::path other = folder.put("changed-" + id + ".json", changed.dump());
    CHECK_THROWS_AS(load_certificate(other), InputError);
  }
  fs::remove(file);
  CHECK_FALSE(find_certificate(folder.path, id));  // the changed one does not count
  for (const char* bytes : {"", "{", "[]", "{\"kind\": 7}", "null"})
    CHECK_THROWS_AS(load_certificate(folder.put("none.json", bytes)), InputError);
  CHECK_THROWS_AS(load_certificate(folder.path / "missing.json"), InputError);
}
