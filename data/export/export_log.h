// What happened in a study beside its trials: log.csv.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "data/fields/csv_writer.h"
#include "data/study/study.h"

namespace jnd {

// The event of a row about an answer that was taken back.
inline constexpr std::string_view kTakenBackEvent = "answer_taken_back";

// A note, a pause, an interruption, a participant left out, an answer taken back, ...
struct LogRow {
  std::string participant, session;   // empty where it is about the whole study
  std::optional<int> session_number;  // of the participant
  std::string kind;                   // of the session; empty where it is about the whole study
  std::int64_t seq = 0;
  std::string utc;
  std::string event;  // "note", "paused", ...
  std::optional<int> trial, attempt;
  std::string subject;  // of the checklist and of consent: which question, which language
  std::string cause;
  std::string text;  // the note, the reason, the answer
  std::string by;
  std::optional<double> duration_s;
};

// Of the sessions, which are of one kind, and of the study itself. In the order of sessions, and of their events.
std::vector<LogRow> log_rows(const Study& study, SessionKind kind, const std::vector<SessionInfo>& sessions);
std::vector<CsvColumn<LogRow>> log_columns();

}  // namespace jnd
