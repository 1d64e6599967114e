// What an operator reads after a damaged disk: what is whole, what is gone, and what to do next; and the same as JSON.
#include "runner/study_commands/recovery_words.h"

#include <sstream>

#include "tests/catch.h"

namespace jnd {
namespace {

const RecoveryFiles kFiles{"broken.sqlite", "saved study.sqlite"};

RecoveredChain session(const char* id, const char* participant, std::int64_t events) {
  RecoveredChain chain;
  chain.session = id;
  chain.participant = participant;
  chain.kind = "real";
  chain.events = chain.last_found = events;
  chain.trials = events - 4;
  chain.last_kind = "trial.completed";
  chain.last_utc = "2026-11-26T09:08:07.123456789Z";
  return chain;
}

RecoveryReport whole_report() {
  RecoveryReport report;
  report.sessions = {session("P01-real", "P01", 26)};
  report.sessions[0].closed = true;
  report.sessions[0].last_kind = "session.closed";
  report.pages = 40;
  report.events_added = report.events_found = 29;
  return report;
}

// One whole, one whose end is lost behind a gap, one of which nothing is left.
RecoveryReport damaged_report() {
  RecoveryReport report = whole_report();
  report.sessions.push_back(session("P02-real", "P02", 11));
  report.sessions[1].unchained = 15;
  report.sessions[1].last_found = 26;
  report.sessions[1].cut = true;
  RecoveredChain lost;
  lost.session = "P03-real";
  lost.participant = "P03";
  lost.kind = "real";
  lost.cut = true;
  report.sessions.push_back(lost);
  report.pages_missing = 9;
  report.events_added = 80;
  report.events_found = 40;
  report.doubts = {"the file ends early: 9 of its 40 pages are missing, and what was on them"};
  return report;
}

std::string text_of(const RecoveryReport& report, std::size_t columns = 0) {
  return recovery_text(kFiles, report, {}, columns);
}

TEST_CASE("a whole recovery says so, and speaks neither of losses nor of backups to look into") {
  const std::string text = text_of(whole_report());
  CHECK_THAT(text,
             Catch::Contains("everything that is known of was recovered") &&
                 Catch::Contains("29 events with 22 trials; 1 of 1 session is whole; 40 of 40 pages of the file"));
  CHECK_THAT(text, Catch::Contains("Go on with saved study.sqlite") && Catch::Contains("keep broken.sqlite"));
  CHECK_THAT(text, !Catch::Contains("Lost") && !Catch::Contains("jnd status BACKUP"));
}

TEST_CASE("a recovery with losses says what is whole, up to which event, what is gone, and what to do") {
  const std::string text = text_of(damaged_report());
  CHECK_THAT(text, Catch::Contains("what could be read was recovered"));
  CHECK_THAT(text,
             Catch::Contains("40 events of 80 with 29 trials; 1 of 3 sessions is whole; 31 of 40 pages of the file"));
  CHECK_THAT(text, Catch::Contains("the file ends early: 9 of its 40 pages"));
  CHECK_THAT(text,
             Catch::Contains("of P02 (session P02-real) everything after event 11: event 12 is missing or changed"));
  CHECK_THAT(text, Catch::Contains("up to event 26") && Catch::Contains("trial.completed, 2026-11-26T09:08:07 UTC"));
  CHECK_THAT(text, Catch::Contains("all of P03 (session P03-real)"));
  CHECK_THAT(text, Catch::Contains("copy it to another disk"));
  CHECK_THAT(text, Catch::Contains("it may have more of P02 (session P02-real), P03 (session P03-real)"));
  CHECK_THAT(text, Catch::Contains("Open in the new study, after their last event above: P02 (session P02-real)."));
  CHECK_THAT(text, Catch::Contains("jnd verify 'saved study.sqlite' --deep"));
}

TEST_CASE("an open session is not called whole where the file lacks something, nor is the table called complete") {
  RecoveryReport report = whole_report();
  report.sessions.push_back(session("P02-real", "P02", 18));  // up to the end of what was found
  CHECK_THAT(text_of(report), Catch::Contains("2 of 2 sessions are whole") && !Catch::Contains("perhaps"));
  CHECK(recovery_json(kFiles, report, {}).at("sessions")[1].at("fate") == "open");
  report.doubts = {"91 events were added to the study, and 47 of them were found"};
  const std::string text = text_of(report);
  CHECK_THAT(text, Catch::Contains("1 of 2 sessions is whole"));
  CHECK_THAT(text, Catch::Contains("open, and its end may be lost"));
  CHECK_THAT(text, Catch::Contains("perhaps what came in P02 (session P02-real) after event 18"));
  CHECK_THAT(text, Catch::Contains("perhaps sessions of which nothing was found: they are not in the table"));
  CHECK_THAT(text, Catch::Contains("it may have more of P02 (session P02-real)"));
  CHECK(recovery_json(kFiles, report, {}).at("sessions")[1].at("fate") == "open, and its end may be lost");
  report.doubts.clear();
  report.unreadable = 4096;
  CHECK_THAT(text_of(report), Catch::Contains("1 of 2 sessions is whole"));
}

TEST_CASE("what is not known after a loss is not said to be known") {
  RecoveryReport report = damaged_report();
  report.pages.reset();
  report.events_added.reset();
  report.sessions[1].unchained = 0;
  report.sessions[1].last_found = 11;
  report.sessions[2].trials.reset();
  const std::string text = text_of(report);
  CHECK_THAT(text, !Catch::Contains("pages of the file") && !Catch::Contains(" of 80"));
  CHECK_THAT(text, Catch::Contains("everything after event 11; how much that was is not known"));
  const auto json = recovery_json(kFiles, report, {});
  CHECK(json.at("pages").is_null());
  CHECK(json.at("pages_missing").is_null());
  CHECK(json.at("events_added").is_null());
  CHECK(json.at("sessions")[2].at("trials").is_null());
  CHECK(json.at("sessions")[2].at("last_event").is_null());
}

TEST_CASE("a lost end of the study's own events asks to say exclusions and an unblinding again") {
  RecoveryReport report = whole_report();
  CHECK_THAT(text_of(report), !Catch::Contains("jnd unblind"));
  report.own.cut = true;
  CHECK_THAT(text_of(report), Catch::Contains("jnd note, jnd exclude and jnd unblind"));
}

TEST_CASE("the words of a recovery fit the terminal") {
  std::istringstream text(text_of(damaged_report(), 60));
  bool within_table = false;
  for (std::string line; std::getline(text, line);) {
    if (line.find("session") != std::string::npos && line.find("participant") != std::string::npos) within_table = true;
    if (line.find("Lost, or in doubt") != std::string::npos) within_table = false;
    CAPTURE(line);
    if (!within_table && line.find("saved study.sqlite: ") == std::string::npos) CHECK(line.size() <= 60);
  }
}

TEST_CASE("as JSON a recovery says each session's last event and what became of it") {
  const auto json = recovery_json(kFiles, damaged_report(), {"a problem"});
  CHECK(json.at("whole") == false);
  CHECK(json.at("pages") == 40);
  CHECK(json.at("pages_missing") == 9);
  CHECK(json.at("events_added") == 80);
  CHECK(json.at("events_found") == 40);
  CHECK(json.at("problems") == nlohmann::ordered_json::array({"a problem"}));
  CHECK(json.at("sessions")[0].at("fate") == "whole");
  CHECK(json.at("sessions")[1].at("fate") == "its end is lost");
  CHECK(json.at("sessions")[1].at("last_event").at("seq") == 11);
  CHECK(json.at("sessions")[1].at("last_found") == 26);
  CHECK(json.at("sessions")[2].at("fate") == "lost");
}

}  // namespace
}  // namespace jnd
