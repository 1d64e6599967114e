// A study of version 1 as a later program meets it, one whose schema has a second version. There is no such program
// yet: its step is an example.
#pragma once

#include <array>

#include "data/study/database.h"
#include "data/study/schema.h"
#include "tests/data/study_fixture.h"

namespace jnd {

inline constexpr const char* kExampleStep = R"sql(
ALTER TABLE event ADD COLUMN reason TEXT GENERATED ALWAYS AS (json_extract(body, '$.reason')) VIRTUAL;
CREATE TABLE length (
  session TEXT NOT NULL,
  seq     INTEGER NOT NULL,
  bytes   INTEGER NOT NULL,  -- of the body
  PRIMARY KEY (session, seq)
) STRICT;
INSERT INTO length (session, seq, bytes) SELECT session, seq, length(body) FROM event;
DROP VIEW exclusions;
CREATE VIEW exclusions AS SELECT reason FROM event WHERE kind = 'participant.excluded' AND session = 'study';
)sql";

inline SchemaSteps example_steps() {
  static const std::array steps = {schema_steps()[0], kExampleStep};
  return steps;
}

// P01-simulated, closed, with every trial of the tutorial, and P02-simulated, open after ten.
inline void write_older_study(const std::filesystem::path& path) {
  const auto study = new_study(path);
  run_whole_session(*study, tutorial(), 1);
  const auto log = study->open_session(new_session(2));
  const std::vector<Trial> trials = make_plan(tutorial(), 2, kSeed).trials;
  for (std::size_t i = 0; i < 10; ++i)
    log->append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), trials[i], usual_answer(trials[i]))),
                stamp_of(trials[i]));
}

// What must be the same before and after.
inline std::string hashes_in(SQLite::Database& database) {
  return database.execAndGet("SELECT group_concat(hash) FROM (SELECT hash FROM event ORDER BY session, seq)");
}

// What the example step adds, and that SQLite finds the file whole: empty where all is as it should be.
inline std::string faults_of_second_version(SQLite::Database& database) {
  if (database.execAndGet("PRAGMA user_version").getInt() != 2) return "is not of version 2";
  if (database.execAndGet("SELECT count(*) FROM event LEFT JOIN length USING (session, seq) WHERE bytes IS NULL")
          .getInt() != 0)
    return "lacks rows of the step";
  const std::string check = database.execAndGet("PRAGMA integrity_check");
  return check == "ok" ? "" : check;
}

}  // namespace jnd
