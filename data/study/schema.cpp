#include "data/study/schema.h"

#include <array>
#include <string>

#include <SQLiteCpp/SQLiteCpp.h>

namespace jnd {

namespace {

// Version 1. Comments inside a definition stay in the file: `.schema` in the sqlite3 shell shows them.
//
// The INSERT triggers also stop INSERT OR REPLACE, which would delete a row without firing the DELETE trigger. A plain
// insert has rowid -1 in a BEFORE trigger; an explicit one that exists is such a replacement.
//
// The views are plain columns for people, R and Python. Answers that were taken back are in taken_back and nowhere else.
// Practice is in trials and voided (with a column), never in counts. The rows of excluded participants stay, with a
// flag, except in counts. Row numbers are in no hash: what has an order has it by seq.
constexpr const char* kVersion1 = R"sql(
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
  task         TEXT GENERATED ALWAYS AS (json_extract(body, '$.task')) VIRTUAL,
  standard     REAL GENERATED ALWAYS AS (json_extract(body, '$.standard')) VIRTUAL,
  stimulus_1_n_per_m REAL GENERATED ALWAYS AS (json_extract(body, '$.stimulus_1_n_per_m')) VIRTUAL,
  stimulus_2_n_per_m REAL GENERATED ALWAYS AS (json_extract(body, '$.stimulus_2_n_per_m')) VIRTUAL,
  stimulus_1_n_per_rad REAL GENERATED ALWAYS AS (json_extract(body, '$.stimulus_1_n_per_rad')) VIRTUAL,
  stimulus_2_n_per_rad REAL GENERATED ALWAYS AS (json_extract(body, '$.stimulus_2_n_per_rad')) VIRTUAL,
  -- The same whatever the unit.
  stimulus_1   REAL GENERATED ALWAYS AS (coalesce(json_extract(body, '$.stimulus_1'),
                 json_extract(body, '$.stimulus_1_n_per_m'), json_extract(body, '$.stimulus_1_n_per_rad'))) VIRTUAL,
  stimulus_2   REAL GENERATED ALWAYS AS (coalesce(json_extract(body, '$.stimulus_2'),
                 json_extract(body, '$.stimulus_2_n_per_m'), json_extract(body, '$.stimulus_2_n_per_rad'))) VIRTUAL,
  stimulus_3   REAL GENERATED ALWAYS AS (coalesce(json_extract(body, '$.stimulus_3'),
                 json_extract(body, '$.stimulus_3_n_per_m'), json_extract(body, '$.stimulus_3_n_per_rad'))) VIRTUAL,
  same         INTEGER GENERATED ALWAYS AS (json_extract(body, '$.same')) VIRTUAL,
  unit         TEXT GENERATED ALWAYS AS (json_extract(body, '$.unit')) VIRTUAL,
  -- The class of the task that is correct to say, and that was said, from 0; of same-different 0 is "same".
  target       INTEGER GENERATED ALWAYS AS (json_extract(body, '$.target')) VIRTUAL,
  said         INTEGER GENERATED ALWAYS AS (json_extract(body, '$.said')) VIRTUAL,
  sureness     INTEGER GENERATED ALWAYS AS (json_extract(body, '$.sureness')) VIRTUAL,
  answer       TEXT GENERATED ALWAYS AS (json_extract(body, '$.answer')) VIRTUAL,
  correct      INTEGER GENERATED ALWAYS AS (json_extract(body, '$.correct')) VIRTUAL,
  entered_by   TEXT GENERATED ALWAYS AS (json_extract(body, '$.entered_by')) VIRTUAL,
  response_time_s REAL GENERATED ALWAYS AS (json_extract(body, '$.response_time_s')) VIRTUAL,
  duration_s   REAL GENERATED ALWAYS AS (json_extract(body, '$.duration_s')) VIRTUAL,
  saturated_share REAL GENERATED ALWAYS AS (json_extract(body, '$.saturated_share')) VIRTUAL,
  PRIMARY KEY (session, seq)
) STRICT;

-- What was recorded during an event, inserted with it or never.
CREATE TABLE telemetry (
  session  TEXT NOT NULL,
  seq      INTEGER NOT NULL,                           -- of the event it belongs to, whose body names sha256
  interval INTEGER NOT NULL CHECK (interval IN (0, 1, 2)),
  sha256   TEXT NOT NULL CHECK (length(sha256) = 64),  -- of bytes
  ticks    INTEGER NOT NULL CHECK (ticks >= 0),
  dropped  INTEGER NOT NULL CHECK (dropped >= 0),      -- records lost before they could be kept
  bytes    BLOB NOT NULL,                              -- zstd; data/README.md describes what is inside
  PRIMARY KEY (session, seq, interval),
  FOREIGN KEY (session, seq) REFERENCES event (session, seq)
) STRICT;

-- A chain shows what is missing before its last event, not behind it. How many events were ever added does.
CREATE TABLE tally (
  id     INTEGER PRIMARY KEY CHECK (id = 1),
  events INTEGER NOT NULL CHECK (events >= 0)  -- ever added to this file
) STRICT;
INSERT INTO tally (id, events) VALUES (1, 0);

CREATE INDEX event_completed ON event (session, trial, practice) WHERE kind = 'trial.completed';
CREATE INDEX event_voided ON event (session, trial, attempt, seq) WHERE kind = 'trial.voided';
CREATE INDEX event_opened ON event (session) WHERE kind = 'session.opened';
CREATE INDEX event_closed ON event (session) WHERE kind = 'session.closed';
CREATE INDEX event_answered ON event (session) WHERE kind = 'questionnaire.answered';
CREATE INDEX event_excluded ON event (session) WHERE kind = 'participant.excluded';
CREATE INDEX event_note ON event (session) WHERE kind = 'note';
CREATE INDEX event_paused ON event (session) WHERE kind = 'session.paused';
CREATE INDEX event_continued ON event (session, seq) WHERE kind = 'session.continued';
CREATE INDEX event_resumed ON event (session) WHERE kind = 'session.resumed';

CREATE TRIGGER event_no_update BEFORE UPDATE ON event
  BEGIN SELECT RAISE(ABORT, 'events are never changed: append a new one'); END;
CREATE TRIGGER event_no_delete BEFORE DELETE ON event
  BEGIN SELECT RAISE(ABORT, 'events are never deleted: append a new one'); END;
CREATE TRIGGER event_in_order BEFORE INSERT ON event
  WHEN NEW.seq <> COALESCE((SELECT max(seq) FROM event WHERE session = NEW.session), 0) + 1
    OR EXISTS (SELECT 1 FROM event WHERE rowid = NEW.rowid)
  BEGIN SELECT RAISE(ABORT, 'an event must follow the last one of its session'); END;
-- A voided attempt that had been answered takes the answer back: the trial may then be answered again.
CREATE TRIGGER event_trial_once BEFORE INSERT ON event
  WHEN NEW.kind = 'trial.completed' AND EXISTS (
    SELECT 1 FROM event c WHERE c.kind = 'trial.completed' AND c.session = NEW.session
       AND c.trial = json_extract(NEW.body, '$.index')
       AND NOT EXISTS (SELECT 1 FROM event v WHERE v.kind = 'trial.voided' AND v.session = c.session
                          AND v.trial = c.trial AND v.attempt = c.attempt AND +v.seq > c.seq))
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

CREATE TRIGGER telemetry_no_update BEFORE UPDATE ON telemetry
  BEGIN SELECT RAISE(ABORT, 'telemetry is never changed'); END;
CREATE TRIGGER telemetry_no_delete BEFORE DELETE ON telemetry
  BEGIN SELECT RAISE(ABORT, 'telemetry is never deleted'); END;
CREATE TRIGGER telemetry_once BEFORE INSERT ON telemetry
  WHEN NEW.seq IS NOT (SELECT max(seq) FROM event WHERE session = NEW.session)
    OR EXISTS (SELECT 1 FROM telemetry
               WHERE rowid = NEW.rowid OR (session = NEW.session AND seq = NEW.seq AND interval = NEW.interval))
  BEGIN SELECT RAISE(ABORT, 'telemetry is kept with its event, once'); END;

CREATE TRIGGER event_counted AFTER INSERT ON event
  BEGIN UPDATE tally SET events = events + 1; END;
CREATE TRIGGER tally_only_rises BEFORE UPDATE ON tally WHEN NEW.events <> OLD.events + 1 OR NEW.id <> OLD.id
  BEGIN SELECT RAISE(ABORT, 'events are counted one by one'); END;
CREATE TRIGGER tally_no_delete BEFORE DELETE ON tally
  BEGIN SELECT RAISE(ABORT, 'events are counted one by one'); END;
CREATE TRIGGER tally_once BEFORE INSERT ON tally WHEN EXISTS (SELECT 1 FROM tally)
  BEGIN SELECT RAISE(ABORT, 'events are counted one by one'); END;

CREATE VIEW exclusions AS
  SELECT json_extract(body, '$.participant') AS participant, json_extract(body, '$.kind') AS kind, seq, utc,
         json_extract(body, '$.reason') AS reason, json_extract(body, '$.replace') AS replaced
  FROM event WHERE kind = 'participant.excluded' AND session = 'study';

-- Voids are few: they are looked up first. The plus keeps SQLite to the index of trials.
CREATE VIEW sessions AS
  SELECT opened.session,
         json_extract(opened.body, '$.participant') AS participant,
         json_extract(opened.body, '$.participant_number') AS participant_number,
         COALESCE(json_extract(opened.body, '$.session_number'), 1) AS session_number,
         json_extract(opened.body, '$.kind') AS kind,
         CASE WHEN closed.session IS NULL THEN 'open' ELSE 'closed' END AS state,
         EXISTS (SELECT 1 FROM exclusions x WHERE x.participant = json_extract(opened.body, '$.participant')
                    AND x.kind = json_extract(opened.body, '$.kind')) AS excluded,
         json_extract(opened.body, '$.responder') AS responder,
         json_extract(opened.body, '$.rig') AS rig,
         json_extract(opened.body, '$.language') AS language,
         json_extract(opened.body, '$.boot_id') AS boot,
         (SELECT count(*) FROM event e WHERE e.kind = 'trial.completed' AND e.session = opened.session
            AND e.practice = 0)
           - (SELECT count(DISTINCT c.seq) FROM event v CROSS JOIN event c
                WHERE v.kind = 'trial.voided' AND v.session = opened.session AND c.kind = 'trial.completed'
                  AND c.session = v.session AND c.trial = v.trial AND +c.seq < v.seq AND c.practice = 0
                  AND c.attempt = v.attempt) AS trials_done,
         (SELECT count(*) FROM event e WHERE e.kind = 'trial.voided' AND e.session = opened.session) AS trials_voided,
         json_extract(opened.body, '$.trials_total') AS trials_total,
         opened.utc AS started,
         closed.utc AS ended,
         (SELECT e.hash FROM event e WHERE e.session = opened.session ORDER BY e.seq DESC LIMIT 1) AS head
  FROM event opened
  LEFT JOIN event closed ON closed.kind = 'session.closed' AND closed.session = opened.session
  WHERE opened.kind = 'session.opened';

CREATE VIEW trials AS
  SELECT e.session, s.participant, s.participant_number, s.session_number, s.kind, s.excluded, e.seq, e.utc, e.trial,
         e.attempt, e.block, e.practice, e.round, e.series, e.condition, e.task, e.standard, e.stimulus_1_n_per_m,
         e.stimulus_2_n_per_m, e.stimulus_1_n_per_rad, e.stimulus_2_n_per_rad, e.stimulus_1,
         e.stimulus_2, e.stimulus_3, e.unit, e.target,
         e.same, e.said, e.sureness, e.answer, e.correct, e.entered_by, e.response_time_s,
         e.duration_s, e.saturated_share
  FROM sessions s JOIN event e ON e.kind = 'trial.completed' AND e.session = s.session
  WHERE NOT EXISTS (SELECT 1 FROM event v WHERE v.kind = 'trial.voided' AND v.session = e.session
                      AND v.trial = e.trial AND +v.seq > e.seq AND +v.attempt = e.attempt);

CREATE VIEW taken_back AS
  SELECT c.session, s.participant, s.participant_number, s.session_number, s.kind, s.excluded, c.seq, c.utc,
         v.seq AS voided_seq, v.utc AS voided_utc, json_extract(v.body, '$.reason') AS reason, c.trial, c.attempt,
         c.block, c.practice, c.round, c.series, c.condition, c.task, c.standard, c.stimulus_1_n_per_m,
         c.stimulus_2_n_per_m, c.stimulus_1_n_per_rad, c.stimulus_2_n_per_rad, c.stimulus_1,
         c.stimulus_2, c.stimulus_3, c.unit, c.target,
         c.same, c.said, c.sureness, c.answer, c.correct, c.entered_by, c.response_time_s,
         c.duration_s, c.saturated_share
  FROM sessions s CROSS JOIN event v CROSS JOIN event c
  WHERE v.kind = 'trial.voided' AND v.session = s.session AND c.kind = 'trial.completed' AND c.session = v.session
    AND c.trial = v.trial AND +c.seq < v.seq AND c.attempt = v.attempt;

CREATE VIEW voided AS
  SELECT e.session, s.participant, s.participant_number, s.session_number, s.kind, s.excluded, e.seq, e.utc, e.trial,
         e.attempt, e.block, e.practice, e.series, e.condition, json_extract(e.body, '$.reason') AS reason,
         COALESCE(json_extract(e.body, '$.counts'), 1) AS counts
  FROM sessions s JOIN event e ON e.kind = 'trial.voided' AND e.session = s.session;

CREATE VIEW participants AS
  SELECT participant, participant_number, kind, count(*) AS sessions, sum(state = 'closed') AS sessions_closed,
         sum(trials_done) AS trials_done, sum(trials_voided) AS trials_voided, max(excluded) AS excluded,
         (SELECT x.reason FROM exclusions x WHERE x.participant = s.participant AND x.kind = s.kind) AS excluded_reason
  FROM sessions s GROUP BY kind, participant_number, participant;

-- Every answered main trial, before the exclusions of single trials that the protocol registers; over all sessions of a
-- participant. Of the task same-different; of the others answer_counts has what was answered to what.
CREATE VIEW counts AS
  SELECT participant, participant_number, kind, condition, series,
         sum(target = 1) AS n_diff, sum(target = 1 AND said = 1) AS hits,
         sum(target = 0) AS n_same, sum(target = 0 AND said = 1) AS false_alarms
  FROM trials WHERE practice = 0 AND excluded = 0 AND task = 'same-different'
  GROUP BY kind, participant_number, participant, condition, series;

CREATE VIEW answer_counts AS
  SELECT participant, participant_number, kind, condition, series, standard, stimulus_1, stimulus_2, stimulus_3, answer,
         count(*) AS n
  FROM trials WHERE practice = 0 AND excluded = 0
  GROUP BY kind, participant_number, participant, condition, series, standard, stimulus_1, stimulus_2, stimulus_3, answer;

CREATE VIEW answers AS
  SELECT e.session, s.participant, s.participant_number, s.session_number, s.kind, s.excluded, e.seq, e.utc,
         json_extract(e.body, '$.question') AS question, json_extract(e.body, '$.text') AS text,
         json_extract(e.body, '$.when') AS asked, json_extract(e.body, '$.condition') AS condition,
         json_extract(e.body, '$.after_trial') AS after_trial, json_extract(e.body, '$.answer') AS answer
  FROM sessions s JOIN event e ON e.kind = 'questionnaire.answered' AND e.session = s.session;

-- Notes on the whole study too: their session is NULL.
CREATE VIEW notes AS
  SELECT s.session, COALESCE(s.participant, json_extract(e.body, '$.participant')) AS participant, s.session_number,
         s.kind, e.seq, e.utc, json_extract(e.body, '$.text') AS text, json_extract(e.body, '$.by') AS by,
         json_extract(e.body, '$.after_trial') AS after_trial
  FROM event e LEFT JOIN sessions s ON s.session = e.session WHERE e.kind = 'note';

-- paused_s is NULL where the pause had no end: the session was left, or the program ended.
CREATE VIEW pauses AS
  SELECT e.session, s.participant, s.session_number, s.kind, e.seq, e.utc, json_extract(e.body, '$.cause') AS cause,
         json_extract(e.body, '$.reason') AS reason,
         (SELECT json_extract(c.body, '$.paused_s') FROM event c WHERE c.kind = 'session.continued'
             AND c.session = e.session AND c.seq > e.seq
             AND NOT EXISTS (SELECT 1 FROM event p WHERE p.kind = 'session.paused' AND p.session = e.session
                               AND p.seq > e.seq AND p.seq < c.seq)
           ORDER BY c.seq LIMIT 1) AS paused_s
  FROM sessions s JOIN event e ON e.kind = 'session.paused' AND e.session = s.session;

CREATE VIEW resumes AS
  SELECT e.session, s.participant, s.session_number, s.kind, e.seq, e.utc, json_extract(e.body, '$.cause') AS cause,
         json_extract(e.body, '$.gap_s') AS gap_s, json_extract(e.body, '$.reason') AS reason
  FROM sessions s JOIN event e ON e.kind = 'session.resumed' AND e.session = s.session;
)sql";

constexpr std::array kSteps = {kVersion1};
static_assert(kSteps.size() == kSchemaVersion);

}  // namespace

SchemaSteps schema_steps() noexcept {
  return kSteps;
}

void migrate(SQLite::Database& database, int from, SchemaSteps steps) {
  for (const char* step : steps.subspan(static_cast<std::size_t>(from))) database.exec(step);
  database.exec("PRAGMA application_id = " + std::to_string(kApplicationId));
  database.exec("PRAGMA user_version = " + std::to_string(steps.size()));
}

}  // namespace jnd
