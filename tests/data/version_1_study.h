// A study of file version 1, as the program of that time made it: its schema to the letter, and bodies without the keys
// that came later. Never edited: files like it are in people's hands.
#pragma once

#include "data/log/chain.h"
#include "data/log/utc_time.h"
#include "protocols/input/sha256.h"
#include "tests/data/study_fixture.h"

namespace jnd {

inline constexpr const char* kVersion1Tables = R"sql(
CREATE TABLE protocol (
  sha256 TEXT PRIMARY KEY NOT NULL CHECK (length(sha256) = 64),  -- of bytes
  name   TEXT NOT NULL,
  bytes  BLOB NOT NULL                                           -- the file, verbatim
) STRICT;

CREATE TABLE study (
  id       INTEGER PRIMARY KEY CHECK (id = 1),
  seed     TEXT NOT NULL CHECK (seed <> '' AND seed NOT GLOB '*[^0-9]*'),  -- 0..2^64-1 in decimal: INTEGER is signed
  protocol TEXT NOT NULL REFERENCES protocol (sha256)
) STRICT;

CREATE TABLE event (
  session      TEXT NOT NULL CHECK (session <> ''),
  seq          INTEGER NOT NULL CHECK (seq >= 1),   -- 1, 2, 3, ... in each session
  kind         TEXT NOT NULL CHECK (kind <> ''),
  utc          TEXT NOT NULL CHECK (utc LIKE '____-__-__T__:__:__._________Z'),
  monotonic_ns INTEGER NOT NULL,
  version      TEXT NOT NULL,                       -- of the program
  body         TEXT NOT NULL CHECK (json_valid(body)),
  hash         TEXT NOT NULL CHECK (length(hash) = 64),
  -- What analyses read, computed from body when read.
  trial        INTEGER GENERATED ALWAYS AS (json_extract(body, '$.index')) VIRTUAL,
  attempt      INTEGER GENERATED ALWAYS AS (json_extract(body, '$.attempt')) VIRTUAL,
  block        INTEGER GENERATED ALWAYS AS (json_extract(body, '$.block')) VIRTUAL,
  practice     INTEGER GENERATED ALWAYS AS (json_extract(body, '$.practice')) VIRTUAL,
  round        INTEGER GENERATED ALWAYS AS (json_extract(body, '$.round')) VIRTUAL,
  series       TEXT GENERATED ALWAYS AS (json_extract(body, '$.series')) VIRTUAL,
  condition    TEXT GENERATED ALWAYS AS (json_extract(body, '$.condition')) VIRTUAL,
  stimulus_1_n_per_m REAL GENERATED ALWAYS AS (json_extract(body, '$.stimulus_1_n_per_m')) VIRTUAL,
  stimulus_2_n_per_m REAL GENERATED ALWAYS AS (json_extract(body, '$.stimulus_2_n_per_m')) VIRTUAL,
  same         INTEGER GENERATED ALWAYS AS (json_extract(body, '$.same')) VIRTUAL,
  answer       TEXT GENERATED ALWAYS AS (json_extract(body, '$.answer')) VIRTUAL,
  correct      INTEGER GENERATED ALWAYS AS (json_extract(body, '$.correct')) VIRTUAL,
  entered_by   TEXT GENERATED ALWAYS AS (json_extract(body, '$.entered_by')) VIRTUAL,
  response_time_s REAL GENERATED ALWAYS AS (json_extract(body, '$.response_time_s')) VIRTUAL,
  duration_s   REAL GENERATED ALWAYS AS (json_extract(body, '$.duration_s')) VIRTUAL,
  saturated_share REAL GENERATED ALWAYS AS (json_extract(body, '$.saturated_share')) VIRTUAL,
  PRIMARY KEY (session, seq)
) STRICT;

CREATE INDEX event_completed ON event (session, trial, practice) WHERE kind = 'trial.completed';
CREATE INDEX event_voided ON event (session) WHERE kind = 'trial.voided';
CREATE INDEX event_opened ON event (session) WHERE kind = 'session.opened';
CREATE INDEX event_closed ON event (session) WHERE kind = 'session.closed';
CREATE INDEX event_answered ON event (session) WHERE kind = 'questionnaire.answered';

CREATE TRIGGER event_no_update BEFORE UPDATE ON event
  BEGIN SELECT RAISE(ABORT, 'events are never changed: append a new one'); END;
CREATE TRIGGER event_no_delete BEFORE DELETE ON event
  BEGIN SELECT RAISE(ABORT, 'events are never deleted: append a new one'); END;
CREATE TRIGGER event_in_order BEFORE INSERT ON event
  WHEN NEW.seq <> COALESCE((SELECT max(seq) FROM event WHERE session = NEW.session), 0) + 1
    OR EXISTS (SELECT 1 FROM event WHERE rowid = NEW.rowid)
  BEGIN SELECT RAISE(ABORT, 'an event must follow the last one of its session'); END;
CREATE TRIGGER event_trial_once BEFORE INSERT ON event
  WHEN NEW.kind = 'trial.completed' AND EXISTS (SELECT 1 FROM event WHERE kind = 'trial.completed'
    AND session = NEW.session AND trial = json_extract(NEW.body, '$.index'))
  BEGIN SELECT RAISE(ABORT, 'this trial of the plan is completed already'); END;

CREATE TRIGGER study_no_update BEFORE UPDATE ON study
  BEGIN SELECT RAISE(ABORT, 'a study keeps its seed and protocol'); END;
CREATE TRIGGER study_no_delete BEFORE DELETE ON study
  BEGIN SELECT RAISE(ABORT, 'a study keeps its seed and protocol'); END;
CREATE TRIGGER study_once BEFORE INSERT ON study WHEN EXISTS (SELECT 1 FROM study)
  BEGIN SELECT RAISE(ABORT, 'a study keeps its seed and protocol'); END;
CREATE TRIGGER protocol_no_update BEFORE UPDATE ON protocol
  BEGIN SELECT RAISE(ABORT, 'a protocol is never changed'); END;
CREATE TRIGGER protocol_no_delete BEFORE DELETE ON protocol
  BEGIN SELECT RAISE(ABORT, 'a protocol is never deleted'); END;
CREATE TRIGGER protocol_once BEFORE INSERT ON protocol
  WHEN EXISTS (SELECT 1 FROM protocol WHERE sha256 = NEW.sha256 OR rowid = NEW.rowid)
  BEGIN SELECT RAISE(ABORT, 'a protocol is never changed'); END;
)sql";

inline constexpr const char* kVersion1Views = R"sql(
CREATE VIEW sessions AS
  SELECT opened.session,
         json_extract(opened.body, '$.participant') AS participant,
         json_extract(opened.body, '$.participant_number') AS participant_number,
         json_extract(opened.body, '$.kind') AS kind,
         CASE WHEN closed.session IS NULL THEN 'open' ELSE 'closed' END AS state,
         json_extract(opened.body, '$.responder') AS responder,
         json_extract(opened.body, '$.rig') AS rig,
         (SELECT count(*) FROM event e WHERE e.kind = 'trial.completed' AND e.session = opened.session
            AND e.practice = 0) AS trials_done,
         (SELECT count(*) FROM event e WHERE e.kind = 'trial.voided' AND e.session = opened.session) AS trials_voided,
         json_extract(opened.body, '$.trials_total') AS trials_total,
         opened.utc AS started,
         closed.utc AS ended,
         (SELECT e.hash FROM event e WHERE e.session = opened.session ORDER BY e.seq DESC LIMIT 1) AS head
  FROM event opened
  LEFT JOIN event closed ON closed.kind = 'session.closed' AND closed.session = opened.session
  WHERE opened.kind = 'session.opened';

CREATE VIEW trials AS
  SELECT e.session, s.participant, s.participant_number, s.kind, e.seq, e.utc, e.trial, e.attempt, e.block, e.practice,
         e.round, e.series, e.condition, e.stimulus_1_n_per_m, e.stimulus_2_n_per_m, e.same, e.answer, e.correct,
         e.entered_by, e.response_time_s, e.duration_s, e.saturated_share
  FROM sessions s JOIN event e ON e.kind = 'trial.completed' AND e.session = s.session;

CREATE VIEW voided AS
  SELECT e.session, s.participant, s.participant_number, s.kind, e.seq, e.utc, e.trial, e.attempt, e.block, e.practice,
         e.series, e.condition, json_extract(e.body, '$.reason') AS reason
  FROM sessions s JOIN event e ON e.kind = 'trial.voided' AND e.session = s.session;

CREATE VIEW participants AS
  SELECT participant, participant_number, kind, count(*) AS sessions, sum(state = 'closed') AS sessions_closed,
         sum(trials_done) AS trials_done, sum(trials_voided) AS trials_voided
  FROM sessions GROUP BY kind, participant_number, participant;

-- Every answered main trial, before the exclusions that the protocol registers.
CREATE VIEW counts AS
  SELECT participant, participant_number, kind, condition, series,
         sum(same = 0) AS n_diff, sum(same = 0 AND answer = 'different') AS hits,
         sum(same = 1) AS n_same, sum(same = 1 AND answer = 'different') AS false_alarms
  FROM trials WHERE practice = 0 GROUP BY kind, participant_number, participant, condition, series;

CREATE VIEW answers AS
  SELECT e.session, s.participant, s.participant_number, s.kind, e.seq, e.utc,
         json_extract(e.body, '$.question') AS question, json_extract(e.body, '$.text') AS text,
         json_extract(e.body, '$.when') AS asked, json_extract(e.body, '$.condition') AS condition,
         json_extract(e.body, '$.after_trial') AS after_trial, json_extract(e.body, '$.answer') AS answer
  FROM sessions s JOIN event e ON e.kind = 'questionnaire.answered' AND e.session = s.session;
)sql";

// The body of a completed trial without what version 1 did not know.
inline nlohmann::ordered_json version_1_body(const TrialRecord& record) {
  nlohmann::ordered_json body = to_body(record);
  for (auto& presentation : body["presentations"]) {
    presentation.erase("lateness_histogram");
    presentation.erase("stopped_by");
    for (auto& finger : presentation["fingers"])
      for (const char* key :
           {"finger", "channel", "stiffness_se_n_per_m", "joint_stiffness_n_m_per_rad", "interventions"})
        finger.erase(key);
  }
  return body;
}

// P01-simulated, closed, with every trial of the tutorial, and P02-simulated, open after ten.
inline void write_version_1_study(const std::filesystem::path& path) {
  SQLite::Database database(path.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  database.exec(kVersion1Tables);
  database.exec(kVersion1Views);
  database.exec("PRAGMA application_id = 1785619571");  // "jnds"
  database.exec("PRAGMA user_version = 1");
  SQLite::Statement protocol(database, "INSERT INTO protocol (sha256, name, bytes) VALUES (?, ?, ?)");
  protocol.bind(1, tutorial().sha256);
  protocol.bind(2, tutorial().name);
  protocol.bind(3, tutorial().bytes.data(), static_cast<int>(tutorial().bytes.size()));
  protocol.exec();
  database.exec("INSERT INTO study (id, seed, protocol) VALUES (1, '" + std::to_string(kSeed) + "', '" +
                tutorial().sha256 + "')");

  std::map<std::string, Event> last;
  const auto append = [&](const std::string& session, std::string_view kind, const nlohmann::ordered_json& body) {
    Event& before = last[session];
    Event event{session,
                before.seq + 1,
                std::string(kind),
                {1'700'000'000'000'000'000 + before.seq, before.seq},
                "0.1.0",
                body_text(body),
                {}};
    const std::string utc = to_iso8601(event.stamp.utc_ns);
    event.hash = event_hash(before.hash, event, utc);
    SQLite::Statement insert(
        database,
        "INSERT INTO event (session, seq, kind, utc, monotonic_ns, version, body, hash) VALUES (?, "
        "?, ?, ?, ?, ?, ?, ?)");
    insert.bind(1, event.session);
    insert.bind(2, event.seq);
    insert.bind(3, event.kind);
    insert.bind(4, utc);
    insert.bind(5, event.stamp.monotonic_ns);
    insert.bind(6, event.version);
    insert.bind(7, event.body);
    insert.bind(8, event.hash);
    insert.exec();
    before = event;
  };
  append("study", "study.created",
         {{"seed", std::to_string(kSeed)}, {"protocol_sha256", tutorial().sha256}, {"protocol_name", tutorial().name}});
  for (int number = 1; number <= 2; ++number) {
    const std::string participant = "P0" + std::to_string(number), session = participant + "-simulated";
    append(session, "session.opened",
           {{"participant", participant},
            {"participant_number", number},
            {"kind", "simulated"},
            {"responder", "profile test"},
            {"profile_sha256", nullptr},
            {"rig", "rrs3"},
            {"rig_mode", "wrench"},
            {"tracker", "hand"},
            {"trials_total", 16},
            {"protocol_sha256", tutorial().sha256},
            {"seed", std::to_string(kSeed)}});
    int left = number == 1 ? 1'000 : 10;
    for (const Trial& trial : make_plan(tutorial(), number, kSeed).trials)
      if (left-- > 0)
        append(session, "trial.completed", version_1_body(record_of(tutorial(), trial, usual_answer(trial))));
  }
  append("P01-simulated", "session.closed", {{"trials_completed", 16}, {"trials_voided", 0}});
  append("study", "session.closed",
         {{"session", "P01-simulated"},
          {"participant", "P01"},
          {"kind", "simulated"},
          {"head", last["P01-simulated"].hash}});
}

}  // namespace jnd
