// CSV files: exact text, the same whatever the locale, threads or order of sessions, and never over other people's
// files.
#include "data/export/export.h"

#include <clocale>
#include <limits>
#include <locale>
#include <map>
#include <set>
#include <thread>

#include "analysis/numerics/special_values.h"
#include "data/export/export_folder.h"
#include "data/export/export_log.h"
#include "data/fields/csv_writer.h"
#include "tests/catch.h"
#include "tests/data/export/export_fixture.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

namespace fs = std::filesystem;

std::map<std::string, std::string> exported(const Study& study, const Protocol& protocol, const fs::path& folder,
                                            bool replace = false) {
  export_csv(study, protocol, results_of(study, protocol, SessionKind::simulated), folder, replace);
  return files_in(folder);
}

std::unique_ptr<Study> small_study(const fs::path& path) {
  auto study = new_study(path);
  for (int number = 1; number <= 2; ++number) {
    const NewSession session = new_session(number);
    const auto log = study->open_session(session);
    answer_all(*log, tutorial(), number);
    log->append(event_kind::kQuestionAnswered, question_body(tutorial().questions[0], "", "=1+1, \"both\"\nhands", 0),
                {9, 9});
    log->append(event_kind::kQuestionAnswered, question_body(tutorial().questions[1], "SV", std::nullopt, 0), {9, 9});
    study->close_session(session.id, {10, 10});
  }
  return study;
}

// row: 0 is the header.
std::string cell(const std::vector<std::vector<std::string>>& rows, std::size_t row, const std::string& column) {
  for (std::size_t i = 0; i < rows[0].size(); ++i)
    if (rows[0][i] == column) return rows.at(row)[i];
  throw std::out_of_range(column);
}

TEST_CASE("cells are quoted where they must be, and numbers keep every digit", "[data]") {
  CHECK(csv_line({"a", "b,c", "say \"x\"", "two\nlines", ""}) == "a,\"b,c\",\"say \"\"x\"\"\",\"two\nlines\",\n");
  CHECK(csv_number(0.1 + 0.2) == "0.30000000000000004");
  CHECK(csv_number(500.0) == "500");
  CHECK(csv_number(kInf) == "Inf");
  CHECK(csv_number(-kInf) == "-Inf");
  CHECK(csv_number(kNaN).empty());
  CHECK(csv_number(std::numeric_limits<std::int64_t>::min()) == "-9223372036854775808");
  CHECK(csv_flag(true) == "1");
  CHECK(csv_flag(false) == "0");
  for (const char* text : {"=1+1",
                           "+a",
                           "-a",
                           "-1-1",
                           "+1.",
                           "@SUM(A1)",
                           "\tx",
                           "\rx",
                           "\nx",
                           "  =1+1",
                           "\"=1",
                           "'=1",
                           "\xef\xbb\xbf=1",
                           "\xc2\xa0@x",
                           "\u3000 =1",
                           "\u2003=1",
                           "\u2060\u200d-a",
                           "\v+a",
                           "\u180e=1",
                           "\xef\xbc\x9d"
                           "1"})
    CHECK(csv_text(text) == "'" + std::string(text));
  for (const char* number : {"-1", "+1", "-0.25", "-1e-3", "7"}) CHECK(csv_text(number) == number);
  CHECK(csv_text("a=1") == "a=1");
  CHECK(csv_text("").empty());
}

TEST_CASE("an export holds every trial and result, and its dictionary every column of every file", "[data]") {
  const TemporaryFolder folder;
  const auto study = small_study(folder / "study.jnd");
  const StudyResults results = results_of(*study, tutorial(), SessionKind::simulated);
  const auto listed = export_csv(*study, tutorial(), results, folder / "out", false);
  const auto files = files_in(folder / "out");
  CHECK(listed ==
        std::vector<std::string>{"answers.csv",   "behaviour.csv",      "cells.csv",          "conditions.csv",
                                 "contrasts.csv", "cues.csv",           "datapackage.json",   "dictionary.csv",
                                 "estimates.csv", "group.csv",          "intervals.csv",      "items.csv",
                                 "methods.md",    "pairs.csv",          "participants.csv",   "ratings.csv",
                                 "recompute.R",   "recompute.py",       "schema/report.json", "sensitivity.csv",
                                 "sessions.csv",  "sub-P01/report.csv", "sub-P02/report.csv", "tests.csv",
                                 "trials.csv",    "values.csv"});
  CHECK(files.size() == listed.size() + 1);  // and SHA256SUMS

  std::map<std::string, std::set<std::string>> described;
  for (const auto& row : read_csv(files.at("dictionary.csv"))) {
    REQUIRE(row.size() == 6);
    CHECK_FALSE(row[2].empty());
    CHECK(described[row[0]].insert(row[1]).second);
  }
  for (const auto& [name, bytes] : files) {
    CAPTURE(name);
    if (!name.ends_with(".csv")) continue;
    const auto rows = read_csv(bytes);
    const std::string pattern = name.starts_with("sub-") ? "sub-*" + name.substr(name.find('/')) : name;
    const std::set<std::string> columns(rows[0].begin(), rows[0].end());
    CHECK(columns.size() == rows[0].size());
    CHECK(described.at(pattern) == columns);
    for (const auto& row : rows) CHECK(row.size() == rows[0].size());
    CHECK(bytes.find('\r') == std::string::npos);
    CHECK(bytes.substr(0, 3) != "\xEF\xBB\xBF");
  }

  const auto trials = read_csv(files.at("trials.csv"));
  CHECK(trials.size() == 1 + 2 * 24);  // practice too, marked
  const auto at = [&](std::size_t row, const std::string& column) { return cell(trials, row, column); };
  CHECK(at(1, "practice") == "1");
  CHECK(at(24, "practice") == "0");
  CHECK(at(24, "kind") == "simulated");
  CHECK(at(24, "protocol_sha256") == tutorial().sha256);
  const Trial trial = make_plan(tutorial(), 1, kSeed).trials[23];
  CHECK(at(24, "stimulus_1_n_per_m") == csv_number(trial.stimuli[0]));
  CHECK(at(25, "participant") == "P02");
  CHECK(at(24, "utc") == "2023-11-14T22:13:46.000000168Z");

  // A row for each of two fingers in each of two intervals.
  const auto intervals = read_csv(files.at("intervals.csv"));
  REQUIRE(intervals.size() == 1 + 2 * 24 * 4);
  const auto in = [&](std::size_t row, const std::string& column) { return cell(intervals, row, column); };
  for (const std::size_t row : {93U, 94U, 95U, 96U}) {
    CHECK(in(row, "seq") == at(24, "seq"));
    CHECK(in(row, "interval") == (row < 95 ? "1" : "2"));
    CHECK(in(row, "finger") == (row % 2 == 1 ? "thumb" : "index"));
    CHECK(in(row, "stimulus_n_per_m") == csv_number(trial.stimuli[row < 95 ? 0 : 1]));
  }
  CHECK(std::stod(in(93, "stiffness_n_per_m")) == trial.stimuli[0] - 0.1 / 3);
  CHECK(in(96, "peak_force_n") == "4.1");

  CHECK(read_csv(files.at("cells.csv")).size() == 1 + 4);
  CHECK(read_csv(files.at("estimates.csv")).size() == 1 + 4);
  const auto people = read_csv(files.at("participants.csv"));
  REQUIRE(people.size() == 1 + 2);
  CHECK(cell(people, 2, "participant") == "P02");
  CHECK(cell(people, 2, "sessions_closed") == "1");
  CHECK(read_csv(files.at("sub-P02/report.csv")).size() == 1 + 2);
  CHECK(read_csv(files.at("group.csv")).size() == 1 + 2 * 3);  // slope, JND and Weber fraction
  const auto answers = read_csv(files.at("answers.csv"));
  REQUIRE(answers.size() == 1 + 4);
  CHECK(answers[0][2] == "session_number");
  CHECK(answers[1][2] == "1");
  CHECK(answers[1][10] == "'=1+1, \"both\"\nhands");
  CHECK(answers[2][9] == "0");
  CHECK(answers[2][10].empty());
  CHECK(files.at("sessions.csv").find(results.attendance.heads[0].hash) != std::string::npos);
  CHECK(files.at("sessions.csv").find(std::to_string(kSeed)) != std::string::npos);
}

TEST_CASE("the same events give the same bytes, however their sessions were interleaved", "[data]") {
  const TemporaryFolder folder;
  const auto one = new_study(folder / "one.jnd", chinello());
  for (int number = 1; number <= 3; ++number) run_whole_session(*one, chinello(), number);
  const auto two = new_study(folder / "two.jnd", chinello());
  {
    std::vector<std::thread> threads;
    for (int number = 3; number >= 1; --number)
      threads.emplace_back([&two, number] { answer_all(*two->open_session(new_session(number)), chinello(), number); });
    for (std::thread& thread : threads) thread.join();
    // The order of the closings is kept in the study's own chain.
    for (int number = 1; number <= 3; ++number)
      two->close_session(new_session(number).id, {1'700'000'900'000'000'000, 900});
  }
  const auto expected = exported(*one, chinello(), folder / "a");
  CHECK(exported(*two, chinello(), folder / "b") == expected);
  // Twice the same, and into a folder given with a slash.
  CHECK(exported(*two, chinello(), (folder / "c").string() + "/") == expected);
}

TEST_CASE("no locale changes a number", "[data]") {
  const TemporaryFolder folder;
  const auto study = small_study(folder / "study.jnd");
  const auto expected = exported(*study, tutorial(), folder / "c");
  // A comma for the C++ library, whatever is installed; for the C library too where such a locale is there.
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  for (const char* name : {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8"})
    if (std::setlocale(LC_NUMERIC, name) != nullptr) break;
  const auto found = exported(*small_study(folder / "again.jnd"), tutorial(), folder / "other");
  std::setlocale(LC_NUMERIC, "C");
  std::locale::global(before);
  CHECK(found == expected);
}

TEST_CASE("an existing folder is replaced only if asked, and never one that holds anything else", "[data]") {
  const TemporaryFolder folder;
  const auto study = small_study(folder / "study.jnd");
  const auto out = folder / "out";
  const auto first = exported(*study, tutorial(), out);
  CHECK_THROWS_WITH(exported(*study, tutorial(), out), Catch::Contains("exists already"));
  CHECK(exported(*study, tutorial(), out, true) == first);

  std::ofstream(out / "sub-P01" / "thesis.txt") << "precious";
  CHECK_THROWS_WITH(exported(*study, tutorial(), out, true),
                    Catch::Contains("sub-P01/thesis.txt, which is not listed in its SHA256SUMS"));
  CHECK(bytes_of(out / "sub-P01" / "thesis.txt") == "precious");
  CHECK(bytes_of(out / "group.csv") == first.at("group.csv"));
  fs::remove(out / "sub-P01" / "thesis.txt");
  fs::create_directory(out / "figures");
  CHECK_THROWS_WITH(exported(*study, tutorial(), out, true), Catch::Contains("figures"));
  fs::remove(out / "figures");
  std::ofstream(out / "group.csv", std::ios::app) << "a row of mine\n";
  CHECK_THROWS_WITH(exported(*study, tutorial(), out, true), Catch::Contains("group.csv, which was changed"));
  std::ofstream(out / "group.csv", std::ios::trunc) << first.at("group.csv");
  std::ofstream(folder / "file") << "x";
  CHECK_THROWS_WITH(exported(*study, tutorial(), folder / "file", true), Catch::Contains("not a folder"));
  fs::create_directory_symlink(out, folder / "link");
  CHECK_THROWS_WITH(exported(*study, tutorial(), folder / "link", true), Catch::Contains("not a folder"));
  CHECK_NOTHROW(exported(*study, tutorial(), out, true));
  fs::remove(out / "SHA256SUMS");
  CHECK_THROWS_WITH(exported(*study, tutorial(), out, true), Catch::Contains("out: has no SHA256SUMS"));
  CHECK(bytes_of(out / "group.csv") == first.at("group.csv"));
  fs::create_directory(folder / "empty");
  CHECK_NOTHROW(exported(*study, tutorial(), folder / "empty", true));

  std::set<std::string> left;
  for (const auto& entry : fs::directory_iterator(folder.path())) left.insert(entry.path().filename().string());
  for (const std::string& name : left) CHECK(name.find("partial") == std::string::npos);
}

TEST_CASE("no name leads out of an export's folder", "[data]") {
  const TemporaryFolder folder;
  ExportFolder files(folder / "out", false);
  for (const std::string name : {"../x.csv", "sub-P01/../../x.csv", "sub-/../../x/trials.csv", ".."})
    CHECK_THROWS_WITH(files.write(name, "x"), Catch::Contains("would lie outside of the export"));
  CHECK_THROWS_WITH(files.write((folder / "x.csv").string(), "x"), Catch::Contains("would lie outside of the export"));
  files.write("sub-P01/a..b.csv", "x");
  CHECK(files.publish() == std::vector<std::string>{"sub-P01/a..b.csv"});
  CHECK_FALSE(std::filesystem::exists(folder / "x.csv"));
}

TEST_CASE("a file that comes piece by piece is the same as one that comes whole", "[data]") {
  const TemporaryFolder folder;
  std::string whole;
  {
    ExportFolder files(folder / "pieces", false);
    for (int i = 0; i < 60'000; ++i) {  // more than is kept waiting
      const std::string line = std::to_string(i) + ",x\n";
      whole += line;
      files.append("sub-P01/long.csv", line);
    }
    files.write("short.csv", "x\n");
    CHECK_THROWS_WITH(files.append("../x.csv", "x"), Catch::Contains("would lie outside of the export"));
    CHECK(files.names() == std::vector<std::string>{"short.csv", "sub-P01/long.csv"});
    CHECK(files.publish() == files.names());
  }
  CHECK(bytes_of(folder / "pieces" / "sub-P01" / "long.csv") == whole);
  ExportFolder files(folder / "whole", false);
  files.write("sub-P01/long.csv", whole);
  files.write("short.csv", "x\n");
  files.publish();
  CHECK(bytes_of(folder / "pieces" / "SHA256SUMS") == bytes_of(folder / "whole" / "SHA256SUMS"));
}

TEST_CASE("numbers of the log that are not whole or do not fit are refused", "[data]") {
  for (const char* number : {"1.5", "1e99", "4294967296"}) {
    CAPTURE(number);
    const TemporaryFolder folder;
    const auto study = new_study(folder / "study.jnd");
    study->open_session(new_session(1))
        ->append(event_kind::kNote, {{"text", "x"}, {"after_trial", nlohmann::ordered_json::parse(number)}}, {5, 5});
    CHECK_THROWS_WITH(log_rows(*study, SessionKind::simulated, study->sessions()),
                      Catch::Contains("P01-simulated, event 2 (note): the body cannot be read"));
  }
}

TEST_CASE("columns carry the protocol's unit, and a finger with two devices the columns of both", "[data]") {
  const TemporaryFolder folder;
  Protocol protocol = tutorial();
  protocol.stimulus.unit = Unit::n_per_rad;
  protocol.rig.fingers = {"index"};
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  for (const Trial& trial : make_plan(protocol, 1, kSeed).trials) {
    TrialRecord record = record_of(protocol, trial, usual_answer(trial));
    for (Presentation& presentation : record.presentations) {
      presentation.fingers.resize(2);
      presentation.fingers[1] = presentation.fingers[0];
      presentation.fingers[1].channel = Channel::kinaesthetic;
      presentation.fingers[1].stiffness_se = 0.125;
      presentation.fingers[1].interventions = {{"force_cap", 12, 6, 4.7}, {"soft_start", 3, 1, 0.5}};
      presentation.lateness_max_us = 60;
      presentation.lateness_histogram[3] = 7;
    }
    log->append(event_kind::kTrialCompleted, to_body(record), stamp_of(trial));
  }
  const auto files = exported(*study, protocol, folder / "out");
  for (const auto& [name, bytes] : files) {
    CAPTURE(name);
    if (name.starts_with("recompute.")) continue;  // they name a unit as an example
    CHECK(bytes.find("n_per_m") == std::string::npos);
    CHECK(bytes.find("N/m") == std::string::npos);
  }
  const auto first = [&](const std::string& file, const std::string& column) {
    return cell(read_csv(files.at(file)), 1, column);
  };
  CHECK(first("trials.csv", "stimulus_1_n_per_rad") == csv_number(make_plan(protocol, 1, kSeed).trials[0].stimuli[0]));
  const auto intervals = read_csv(files.at("intervals.csv"));
  CHECK(cell(intervals, 1, "channel") == "cutaneous");
  CHECK(cell(intervals, 2, "channel") == "kinaesthetic");
  CHECK_FALSE(cell(intervals, 1, "stiffness_n_per_rad").empty());
  CHECK(cell(intervals, 1, "stiffness_se_n_per_rad").empty());
  CHECK(cell(intervals, 2, "stiffness_se_n_per_rad") == "0.125");
  CHECK(cell(intervals, 4, "interval") == "2");
  CHECK(cell(intervals, 4, "interventions") == "force_cap:12 soft_start:3");
  CHECK(cell(intervals, 4, "deepest_penetration_rad") == "0");
  CHECK(cell(intervals, 1, "lateness_histogram") == "0 0 0 7 0 0 0 0 0 0 0 0 0");
  CHECK(first("group.csv", "unit") == "per N/rad");
  CHECK(files.at("dictionary.csv").find("N/rad") != std::string::npos);
}

TEST_CASE("exclusions are marked in the trials with their reason", "[data]") {
  const TemporaryFolder folder;
  const auto study = small_study(folder / "study.jnd");
  Protocol protocol = tutorial();
  protocol.analysis.exclude.response_time_above_s = 0.5 + 0.01 * 20 + 0.001;  // trials 21 to 24
  const auto rows = read_csv(exported(*study, protocol, folder / "out").at("trials.csv"));
  int excluded = 0;
  for (const auto& row : rows)
    for (const std::string& cell : row) excluded += cell == "response_time_above" ? 1 : 0;
  CHECK(excluded == 8);
}

}  // namespace
}  // namespace jnd
