// The tables of an export that hold what was recorded: which columns each file has, what they mean, and where their
// cells come from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "data/export/csv_writer.h"
#include "data/export/device_places.h"
#include "data/study/study.h"
#include "data/study/trial_rows.h"
#include "protocols/protocol.h"

namespace jnd {

// One answered trial, practice or main.
struct ExportTrial {
  SessionInfo session;
  std::int64_t seq = 0;
  std::string utc;
  TrialRecord record;
  std::string excluded_reason;  // empty where it counts
};

struct ExportAnswer {
  SessionInfo session;
  std::string utc, question, text, asked, condition, answer;
  int after_trial = 0;
  bool answered = true;
};

std::vector<CsvColumn<ExportTrial>> trial_columns(const Protocol& protocol, const std::vector<DevicePlace>& places);
std::vector<CsvColumn<ExportAnswer>> answer_columns();
// seed: empty where it is sealed.
std::vector<CsvColumn<SessionInfo>> session_columns(const std::string& seed, const std::string& study_head,
                                                    const Protocol& protocol);
std::vector<CsvColumn<DictionaryRow>> dictionary_columns();

}  // namespace jnd
