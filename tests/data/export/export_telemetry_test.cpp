// The ticks of an interval as CSV: value for value, with limits by their names, and safely replaced.
#include "data/export/export_telemetry.h"

#include <set>

#include "data/export/export.h"
#include "tests/catch.h"
#include "tests/data/damage_fixture.h"
#include "tests/data/export/export_fixture.h"
#include "tests/data/telemetry_fixture.h"

namespace jnd {
namespace {

namespace fs = std::filesystem;

TEST_CASE("the ticks of every interval are a file each, on request", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
  const std::vector<TelemetryBlob> blobs = {encode_telemetry(1, press(2))};
  for (int again = 0; again < 2; ++again) {  // a fault and the attempt that it voided
    auto body = voided_body(tutorial(), trials[0], 1, "stale_pose");
    body["telemetry"] = telemetry_body(blobs);
    log->append(event_kind::kTrialVoided, body, {1, 1}, blobs);
  }
  append_with_telemetry(*log, trials[0], {press(40), press(30)});
  const StudyResults results = results_of(*study, tutorial(), SessionKind::simulated);
  export_csv(*study, tutorial(), results, folder / "plain", false);
  for (const auto& [name, bytes] : files_in(folder / "plain")) CHECK(name.find("telemetry") == std::string::npos);

  const TelemetryExport names{{"force_cap", "force_rise"}};
  export_csv(*study, tutorial(), results, folder / "out", false, names);
  const auto files = files_in(folder / "out");
  const std::string ticks = "sub-P01/telemetry/trial-001-attempt-1-interval-";
  REQUIRE(files.contains(ticks + "1.csv"));
  CHECK(files.contains(ticks + "2.csv"));
  CHECK(files.contains(ticks + "2-2.csv"));
  CHECK(files.contains(ticks + "2-3.csv"));
  const auto rows = read_csv(files.at(ticks + "1.csv"));
  CHECK(rows[0] == std::vector<std::string>{"time_s", "time_ns", "lateness_ns", "finger", "channel", "limits",
                                            "penetration_m", "asked_n", "given_n", "measured_n", "vibration_g",
                                            "travel_m", "travel_rad", "finger_x_m", "finger_y_m", "finger_z_m"});
  REQUIRE(rows.size() == 1 + 80);
  const Telemetry expected = press(40);
  for (std::size_t i = 0; i < 80; ++i) {
    const TickRecord& tick = expected.ticks[i];
    const auto& row = rows[i + 1];
    CHECK(row[0] == csv_number(static_cast<double>(i / 2) * 1e6 / 1e9));
    CHECK(row[1] == csv_number(tick.time_ns));
    CHECK(row[3] == "thumb");
    CHECK(row[4] == (i % 2 == 0 ? "cutaneous" : "kinaesthetic"));
    CHECK(row[5] == (tick.limits == 1 ? "force_cap" : ""));
    CHECK(std::stod(row[6]) == tick.penetration);
    CHECK(std::stod(row[8]) == tick.given_n);
    CHECK(row[11] == (i % 2 == 0 ? "0.0375" : ""));
    CHECK(row[12] == (i % 2 == 0 ? "" : "0.6125"));
    CHECK(row[15] == "0.25");
  }
  std::set<std::string> described;
  for (const auto& row : read_csv(files.at("dictionary.csv")))
    if (row[0] == "sub-*/telemetry/*.csv") described.insert(row[1]);
  CHECK(described == std::set<std::string>(rows[0].begin(), rows[0].end()));

  // It may be replaced, with or without ticks, but not where anything else lies among them.
  std::ofstream(folder / "out" / "sub-P01" / "telemetry" / "trial-001-notes.csv") << "precious";
  CHECK_THROWS_WITH(export_csv(*study, tutorial(), results, folder / "out", true),
                    Catch::Contains("trial-001-notes.csv"));
  fs::remove(folder / "out" / "sub-P01" / "telemetry" / "trial-001-notes.csv");
  export_csv(*study, tutorial(), results, folder / "out", true);
  CHECK(files_in(folder / "out") == files_in(folder / "plain"));

  // What was changed is not exported as if it were not.
  study->close();
  raw_sql(folder / "study.jnd", "DROP TRIGGER telemetry_no_update; UPDATE telemetry SET bytes = x'00'");
  const auto changed = Study::open(folder / "study.jnd", Study::Access::read_only);
  CHECK_THROWS_WITH(export_csv(*changed, tutorial(), results, folder / "changed", false, names),
                    Catch::Contains("was changed"));
  CHECK_FALSE(fs::exists(folder / "changed"));
}

TEST_CASE("ticks that a recovery could not save are left out, and the others are exported", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  {
    const auto original = new_study(path);
    const auto log = original->open_session(new_session(1));
    const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
    for (int i = 0; i < 3; ++i)
      append_with_telemetry(*log, trials[static_cast<std::size_t>(i)], {press(150 + i), press(60 + i)});
  }
  std::string bytes = bytes_of(path);
  const std::string blob = content_of(path).telemetry.at({"P01-simulated", 3})[1].bytes;
  const std::size_t at = bytes.find(blob.substr(100, 200));
  REQUIRE(at != std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  write_bytes(folder / "damaged.jnd", bytes);
  recover(folder / "damaged.jnd", folder / "new.jnd", std::nullopt, kLater);
  const auto study = Study::open(folder / "new.jnd", Study::Access::read_only);
  const StudyResults results = results_of(*study, tutorial(), SessionKind::simulated);
  export_csv(*study, tutorial(), results, folder / "out", false, TelemetryExport{{"force_cap"}});
  std::size_t ticks = 0;
  for (const auto& [name, content] : files_in(folder / "out"))
    if (name.find("telemetry/") != std::string::npos) ++ticks;
  CHECK(ticks == 5);
}

TEST_CASE("limits that nobody named keep their bit", "[data]") {
  Telemetry telemetry = press(1);
  telemetry.ticks[0].limits = 0x80000003;
  const auto columns = telemetry_columns(tutorial(), {"force_cap"});
  CHECK(read_csv(csv_table(columns, telemetry_rows(telemetry)))[1][5] == "force_cap bit_1 bit_31");
}

}  // namespace
}  // namespace jnd
