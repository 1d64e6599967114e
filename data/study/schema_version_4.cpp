#include "data/study/schema_version_4.h"

#include <SQLiteCpp/SQLiteCpp.h>

namespace jnd {

namespace {

// Row numbers are in no hash: whatever has an order has it by seq.
constexpr const char* kViewsOfVersion4 = R"sql(
DROP VIEW taken_back;
DROP VIEW sessions;

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

CREATE VIEW taken_back AS
  SELECT c.session, s.participant, s.participant_number, s.session_number, s.kind, s.excluded, c.seq, c.utc,
         v.seq AS voided_seq, v.utc AS voided_utc, json_extract(v.body, '$.reason') AS reason, c.trial, c.attempt,
         c.block, c.practice, c.round, c.series, c.condition, c.stimulus_1_n_per_m, c.stimulus_2_n_per_m,
         c.stimulus_1_n_per_rad, c.stimulus_2_n_per_rad, c.same, c.answer, c.correct, c.entered_by, c.response_time_s,
         c.duration_s, c.saturated_share
  FROM sessions s CROSS JOIN event v CROSS JOIN event c
  WHERE v.kind = 'trial.voided' AND v.session = s.session AND c.kind = 'trial.completed' AND c.session = v.session
    AND c.trial = v.trial AND +c.seq < v.seq AND c.attempt = v.attempt;
)sql";

// A chain shows what is missing before its last event, not behind it. How many events were ever added does.
constexpr const char* kTally = R"sql(
CREATE TABLE tally (
  id     INTEGER PRIMARY KEY CHECK (id = 1),
  events INTEGER NOT NULL CHECK (events >= 0)  -- ever added to this file
) STRICT;
INSERT INTO tally (id, events) SELECT 1, count(*) FROM event;

CREATE TRIGGER event_counted AFTER INSERT ON event
  BEGIN UPDATE tally SET events = events + 1; END;
CREATE TRIGGER tally_only_rises BEFORE UPDATE ON tally WHEN NEW.events <> OLD.events + 1 OR NEW.id <> OLD.id
  BEGIN SELECT RAISE(ABORT, 'events are counted one by one'); END;
CREATE TRIGGER tally_no_delete BEFORE DELETE ON tally
  BEGIN SELECT RAISE(ABORT, 'events are counted one by one'); END;
CREATE TRIGGER tally_once BEFORE INSERT ON tally WHEN EXISTS (SELECT 1 FROM tally)
  BEGIN SELECT RAISE(ABORT, 'events are counted one by one'); END;
)sql";

}  // namespace

void to_version_4(SQLite::Database& database) {
  database.exec(kViewsOfVersion4);
  database.exec(kTally);
}

}  // namespace jnd
