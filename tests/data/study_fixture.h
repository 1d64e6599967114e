// A folder that goes when the test does, and sessions whose every answer is a pure function of the plan.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <SQLiteCpp/SQLiteCpp.h>
#include <stdlib.h>

#include "analysis/numerics/stop_request.h"
#include "data/log/event_body.h"
#include "data/study/study.h"
#include "data/verify/verify.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/tasks/task.h"
#include "tests/temporary_folder.h"

namespace jnd {

// The program is asked to end, while it lives.
struct StopAsked {
  StopAsked() { stop_requested() = true; }
  ~StopAsked() { stop_requested() = false; }
  StopAsked(const StopAsked&) = delete;
  StopAsked& operator=(const StopAsked&) = delete;
};

inline const Protocol& tutorial() {
  static const Protocol protocol = load_protocol(std::string(JND_SOURCE_DIR) + "/protocols/tutorial.json");
  return protocol;
}

inline const Protocol& chinello() {
  static const Protocol protocol = load_protocol(std::string(JND_SOURCE_DIR) + "/protocols/chinello2017.json");
  return protocol;
}

inline constexpr std::uint64_t kSeed = 18446744073709551557ULL;  // does not fit into a signed integer

inline std::unique_ptr<Study> new_study(const std::filesystem::path& path, const Protocol& protocol = tutorial()) {
  return Study::create(path, protocol.name, protocol.bytes, kSeed, {1'700'000'000'000'000'001, 5});
}

inline NewSession new_session(int number, SessionKind kind = SessionKind::simulated) {
  NewSession session;
  session.participant = (number < 10 ? "P0" : "P") + std::to_string(number);
  session.id = session.participant + "-" + std::string(to_string(kind));
  session.participant_number = number;
  session.kind = kind;
  session.responder = kind == SessionKind::simulated ? "profile test" : "keyboard";
  session.rig = "rrs3";
  session.trials_total = 16;
  session.stamp = {1'700'000'001'000'000'000 + number, 10};
  return session;
}

// An answered trial with everything delivered differing from trial to trial.
inline TrialRecord record_of(const Protocol& protocol, const Trial& trial, int answer) {
  TrialRecord record;
  record.trial = trial;
  record.condition_name = protocol.conditions.at(static_cast<std::size_t>(trial.condition)).name;
  record.series_name = protocol.series.at(static_cast<std::size_t>(trial.series)).name;
  record.answer = {.said = answer, .entered_by = EnteredBy::participant, .response_time_s = 0.5 + 0.01 * trial.index};
  record.answer_word = said_word(protocol.task, answer);
  record.duration_s = 7 + 0.1 * trial.index;
  for (std::size_t i = 0; i < 2; ++i) {
    Presentation& presentation = record.presentations[i];
    presentation.first_contact_s = 0.25;
    presentation.duration_s = 3.0 / trial.index;
    presentation.ticks = 3000;
    presentation.fingers.resize(protocol.rig.fingers.size());
    for (std::size_t place = 0; place < presentation.fingers.size(); ++place) {
      FingerPresentation& finger = presentation.fingers[place];
      finger.finger = static_cast<int>(place);
      finger.stiffness = trial.stimuli[i] - 0.1 / 3;
      finger.fit_samples = 1000;
      finger.peak_force_n = 4.1;
      finger.contacts = 1;
    }
  }
  return record;
}

// Right except every seventh trial.
inline int usual_answer(const Trial& trial) {
  const bool same = trial.index % 7 == 0 ? (trial.target != kClassSame) : (trial.target == kClassSame);
  return same ? kClassSame : kClassDifferent;
}

inline Stamp stamp_of(const Trial& trial) {
  return {1'700'000'002'000'000'000 + trial.index * 1'000'000'007LL, trial.index * 1'000'000'007LL};
}

inline void answer_all(SessionLog& log, const Protocol& protocol, int number, int at_most = 1'000'000) {
  for (const Trial& trial : make_plan(protocol, number, kSeed).trials) {
    if (at_most-- <= 0) return;
    log.append(event_kind::kTrialCompleted, to_body(record_of(protocol, trial, usual_answer(trial))), stamp_of(trial));
  }
}

inline void run_whole_session(Study& study, const Protocol& protocol, int number,
                              SessionKind kind = SessionKind::simulated) {
  const NewSession session = new_session(number, kind);
  answer_all(*study.open_session(session), protocol, number);
  study.close_session(session.id, {1'700'000'900'000'000'000, 900});
}

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline std::vector<std::string> texts(const std::vector<Problem>& problems) {
  std::vector<std::string> all;
  for (const Problem& problem : problems) all.push_back(problem.text);
  return all;
}

// SQL as someone with the sqlite3 shell would run it.
inline void raw_sql(const std::filesystem::path& path, const std::string& sql) {
  SQLite::Database database(path.string(), SQLite::OPEN_READWRITE);
  database.exec(sql);
}

// The same, hidden: triggers are out of the way meanwhile, and stand there again afterwards.
inline void hidden_sql(const std::filesystem::path& path, const std::string& sql) {
  std::string drop, restore;
  {
    SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
    SQLite::Statement query(database, "SELECT name, sql FROM sqlite_schema WHERE type = 'trigger'");
    while (query.executeStep()) {
      drop += "DROP TRIGGER " + query.getColumn(0).getString() + ";";
      restore += query.getColumn(1).getString() + ";";
    }
  }
  raw_sql(path, drop + sql + ";" + restore);
}

inline constexpr Stamp kNow = {1'700'001'000'000'000'000, 7};

// What verify() finds, a line each.
inline std::string problems_of(const std::filesystem::path& path) {
  std::string all;
  for (const Problem& problem : verify(*Study::open(path, Study::Access::read_only)).problems)
    all += problem.text + "\n";
  return all;
}

// Of the file's format.
inline int version_of(const std::filesystem::path& path) {
  SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
  return database.execAndGet("PRAGMA user_version").getInt();
}

}  // namespace jnd
