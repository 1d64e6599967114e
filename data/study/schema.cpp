#include "data/study/schema.h"

#include <array>
#include <string>

#include <SQLiteCpp/SQLiteCpp.h>

#include "data/study/schema_version_3.h"
#include "data/study/schema_version_4.h"

namespace jnd {

namespace {

// Version 1. Comments inside the text stay in the file: `.schema` in the sqlite3 shell shows them.
//
// The INSERT triggers also stop INSERT OR REPLACE, which would delete a row without firing the DELETE trigger. A plain
// insert has rowid -1 in a BEFORE trigger; an explicit one that exists is such a replacement.
constexpr const char* kTables = R"sql(
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

// Plain columns for people, R and Python. Practice is in trials and voided (with a column), never in counts.
constexpr const char* kViews = R"sql(
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

void to_version_1(SQLite::Database& database) {
  database.exec(kTables);
  database.exec(kViews);
}

// Version 2: stiffnesses of a joint, and telemetry beside the events. A blob is inserted with its event or never.
constexpr const char* kTelemetry = R"sql(
ALTER TABLE event ADD COLUMN
  stimulus_1_n_per_rad REAL GENERATED ALWAYS AS (json_extract(body, '$.stimulus_1_n_per_rad')) VIRTUAL;
ALTER TABLE event ADD COLUMN
  stimulus_2_n_per_rad REAL GENERATED ALWAYS AS (json_extract(body, '$.stimulus_2_n_per_rad')) VIRTUAL;

CREATE TABLE telemetry (
  session  TEXT NOT NULL,
  seq      INTEGER NOT NULL,                           -- of the event it belongs to, whose body names sha256
  interval INTEGER NOT NULL CHECK (interval IN (0, 1)),
  sha256   TEXT NOT NULL CHECK (length(sha256) = 64),  -- of bytes
  ticks    INTEGER NOT NULL CHECK (ticks >= 0),
  dropped  INTEGER NOT NULL CHECK (dropped >= 0),      -- records lost before they could be kept
  bytes    BLOB NOT NULL,                              -- zstd; data/README.md describes what is inside
  PRIMARY KEY (session, seq, interval),
  FOREIGN KEY (session, seq) REFERENCES event (session, seq)
) STRICT;

CREATE TRIGGER telemetry_no_update BEFORE UPDATE ON telemetry
  BEGIN SELECT RAISE(ABORT, 'telemetry is never changed'); END;
CREATE TRIGGER telemetry_no_delete BEFORE DELETE ON telemetry
  BEGIN SELECT RAISE(ABORT, 'telemetry is never deleted'); END;
CREATE TRIGGER telemetry_once BEFORE INSERT ON telemetry
  WHEN NEW.seq IS NOT (SELECT max(seq) FROM event WHERE session = NEW.session)
    OR EXISTS (SELECT 1 FROM telemetry
               WHERE rowid = NEW.rowid OR (session = NEW.session AND seq = NEW.seq AND interval = NEW.interval))
  BEGIN SELECT RAISE(ABORT, 'telemetry is kept with its event, once'); END;

DROP VIEW trials;
CREATE VIEW trials AS
  SELECT e.session, s.participant, s.participant_number, s.kind, e.seq, e.utc, e.trial, e.attempt, e.block, e.practice,
         e.round, e.series, e.condition, e.stimulus_1_n_per_m, e.stimulus_2_n_per_m, e.stimulus_1_n_per_rad,
         e.stimulus_2_n_per_rad, e.same, e.answer, e.correct, e.entered_by, e.response_time_s, e.duration_s,
         e.saturated_share
  FROM sessions s JOIN event e ON e.kind = 'trial.completed' AND e.session = s.session;
)sql";

void to_version_2(SQLite::Database& database) {
  database.exec(kTelemetry);
}

// Step i makes a file of version i one of version i + 1. A step that has been released is never edited.
constexpr std::array<void (*)(SQLite::Database&), kSchemaVersion> kSteps = {to_version_1, to_version_2, to_version_3,
                                                                            to_version_4};

}  // namespace

void migrate(SQLite::Database& database, int from, int to) {
  for (int version = from; version < to; ++version) kSteps.at(static_cast<std::size_t>(version))(database);
  database.exec("PRAGMA application_id = " + std::to_string(kApplicationId));
  database.exec("PRAGMA user_version = " + std::to_string(to));
}

}  // namespace jnd
