#include "data/study/schema_version_3.h"

#include <SQLiteCpp/SQLiteCpp.h>

namespace jnd {

namespace {

// A voided attempt that had been answered takes the answer back: the trial may then be answered again.
constexpr const char* kTakenBack = R"sql(
DROP INDEX event_voided;
CREATE INDEX event_voided ON event (session, trial, attempt, seq) WHERE kind = 'trial.voided';
CREATE INDEX event_excluded ON event (session) WHERE kind = 'participant.excluded';
CREATE INDEX event_note ON event (session) WHERE kind = 'note';
CREATE INDEX event_paused ON event (session) WHERE kind = 'session.paused';
CREATE INDEX event_continued ON event (session, seq) WHERE kind = 'session.continued';
CREATE INDEX event_resumed ON event (session) WHERE kind = 'session.resumed';

DROP TRIGGER event_trial_once;
CREATE TRIGGER event_trial_once BEFORE INSERT ON event
  WHEN NEW.kind = 'trial.completed' AND EXISTS (
    SELECT 1 FROM event c WHERE c.kind = 'trial.completed' AND c.session = NEW.session
       AND c.trial = json_extract(NEW.body, '$.index')
       AND NOT EXISTS (SELECT 1 FROM event v WHERE v.kind = 'trial.voided' AND v.session = c.session
                          AND v.trial = c.trial AND v.attempt = c.attempt AND +v.seq > c.seq))
  BEGIN SELECT RAISE(ABORT, 'this trial of the plan is completed already'); END;
)sql";

// Taken-back answers are in taken_back and nowhere else. The rows of participants that were left out stay, with a flag,
// except in counts, which analyses read.
constexpr const char* kViewsOfVersion3 = R"sql(
DROP VIEW answers;
DROP VIEW counts;
DROP VIEW participants;
DROP VIEW voided;
DROP VIEW trials;
DROP VIEW sessions;

CREATE VIEW exclusions AS
  SELECT json_extract(body, '$.participant') AS participant, json_extract(body, '$.kind') AS kind, seq, utc,
         json_extract(body, '$.reason') AS reason, json_extract(body, '$.replace') AS replaced
  FROM event WHERE kind = 'participant.excluded' AND session = 'study';

-- Voids are few: they are looked up first. Within a session the order of rowid is that of seq.
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
                  AND c.session = v.session AND c.trial = v.trial AND c.rowid < v.rowid AND c.practice = 0
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
         e.attempt, e.block, e.practice, e.round, e.series, e.condition, e.stimulus_1_n_per_m, e.stimulus_2_n_per_m,
         e.stimulus_1_n_per_rad, e.stimulus_2_n_per_rad, e.same, e.answer, e.correct, e.entered_by, e.response_time_s,
         e.duration_s, e.saturated_share
  FROM sessions s JOIN event e ON e.kind = 'trial.completed' AND e.session = s.session
  WHERE NOT EXISTS (SELECT 1 FROM event v WHERE v.kind = 'trial.voided' AND v.session = e.session
                      AND v.trial = e.trial AND +v.seq > e.seq AND +v.attempt = e.attempt);

CREATE VIEW taken_back AS
  SELECT c.session, s.participant, s.participant_number, s.session_number, s.kind, s.excluded, c.seq, c.utc,
         v.seq AS voided_seq, v.utc AS voided_utc, json_extract(v.body, '$.reason') AS reason, c.trial, c.attempt,
         c.block, c.practice, c.round, c.series, c.condition, c.stimulus_1_n_per_m, c.stimulus_2_n_per_m,
         c.stimulus_1_n_per_rad, c.stimulus_2_n_per_rad, c.same, c.answer, c.correct, c.entered_by, c.response_time_s,
         c.duration_s, c.saturated_share
  FROM sessions s CROSS JOIN event v CROSS JOIN event c
  WHERE v.kind = 'trial.voided' AND v.session = s.session AND c.kind = 'trial.completed' AND c.session = v.session
    AND c.trial = v.trial AND c.rowid < v.rowid AND c.attempt = v.attempt;

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
-- participant.
CREATE VIEW counts AS
  SELECT participant, participant_number, kind, condition, series,
         sum(same = 0) AS n_diff, sum(same = 0 AND answer = 'different') AS hits,
         sum(same = 1) AS n_same, sum(same = 1 AND answer = 'different') AS false_alarms
  FROM trials WHERE practice = 0 AND excluded = 0 GROUP BY kind, participant_number, participant, condition, series;

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

-- paused_s is NULL where nobody continued: the session was left, or the program ended.
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

}  // namespace

void to_version_3(SQLite::Database& database) {
  database.exec(kTakenBack);
  database.exec(kViewsOfVersion3);
}

}  // namespace jnd
