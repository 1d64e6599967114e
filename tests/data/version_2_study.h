// A study of file version 2, as the program of that time left it: its step to the letter, on a file that began as one
// of version 1. Never edited: files like it are in people's hands.
#pragma once

#include "tests/data/version_1_study.h"

namespace jnd {

inline constexpr const char* kVersion2Step = R"sql(
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

// The sessions of the study of version 1, and P03-simulated: open, a voided attempt, then two answers.
inline void write_version_2_study(const std::filesystem::path& path) {
  write_version_1_study(path);
  SQLite::Database database(path.string(), SQLite::OPEN_READWRITE);
  database.exec(kVersion2Step);
  database.exec("PRAGMA user_version = 2");
  std::string before;
  std::int64_t seq = 0;
  const auto append = [&](std::string_view kind, const nlohmann::ordered_json& body) {
    Event event{"P03-simulated", ++seq, std::string(kind), {1'700'000'000'000'000'000 + seq, seq}, "0.2.0",
                body_text(body), {}};
    const std::string utc = to_iso8601(event.stamp.utc_ns);
    event.hash = before = event_hash(before, event, utc);
    SQLite::Statement insert(
        database,
        "INSERT INTO event (session, seq, kind, utc, monotonic_ns, version, body, hash) VALUES (?, ?, ?, ?, ?, ?, ?, "
        "?)");
    insert.bind(1, event.session);
    insert.bind(2, event.seq);
    insert.bind(3, event.kind);
    insert.bind(4, utc);
    insert.bind(5, event.stamp.monotonic_ns);
    insert.bind(6, event.version);
    insert.bind(7, event.body);
    insert.bind(8, event.hash);
    insert.exec();
  };
  append("session.opened", {{"participant", "P03"},
                            {"participant_number", 3},
                            {"kind", "simulated"},
                            {"responder", "profile test"},
                            {"profile_sha256", nullptr},
                            {"rig", "rrs3"},
                            {"rig_mode", "wrench"},
                            {"rig_sha256", std::string(64, 'a')},
                            {"tracker", "hand"},
                            {"trials_total", 16},
                            {"protocol_sha256", tutorial().sha256},
                            {"seed", std::to_string(kSeed)}});
  const std::vector<Trial> trials = make_plan(tutorial(), 3, kSeed).trials;
  append("trial.voided", voided_body(tutorial(), trials[0], 1, "no_answer"));
  for (std::size_t i = 0; i < 2; ++i) {
    TrialRecord record = record_of(tutorial(), trials[i], usual_answer(trials[i]));
    record.attempt = i == 0 ? 2 : 1;
    append("trial.completed", to_body(record));
  }
}

}  // namespace jnd
