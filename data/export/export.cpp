#include "data/export/export.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "data/export/device_places.h"
#include "data/export/export_folder.h"
#include "data/export/export_log.h"
#include "data/export/export_tables.h"
#include "data/export/export_telemetry.h"
#include "data/export/result_columns.h"
#include "data/export/result_fields.h"
#include "data/log/body_numbers.h"
#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/methods/methods_text.h"
#include "data/study/blinding.h"
#include "data/study/study_facts.h"
#include "data/study/study_impl.h"
#include "data/study/trial_rows.h"
#include "protocols/course/prescription.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

// All that the events of one session give to an export.
// not_counted: seq of the answers that were taken back.
void read_session(const Study& study, const Protocol& protocol, const SessionInfo& session,
                  const std::set<std::int64_t>& not_counted, std::vector<ExportTrial>& trials,
                  std::vector<ExportAnswer>& answers) {
  for (const Event& event : study.events(session.id)) {
    if (event.kind != event_kind::kTrialCompleted && event.kind != event_kind::kQuestionAnswered) continue;
    if (not_counted.contains(event.seq)) continue;
    try {
      const auto body = nlohmann::ordered_json::parse(event.body);
      if (event.kind == event_kind::kTrialCompleted) {
        ExportTrial row{session, event.seq, to_iso8601(event.stamp.utc_ns), trial_record_from(body), {}};
        const TrialRecord& record = row.record;
        if (!record.trial.practice)
          row.excluded_reason = exclusion_reason(
              protocol.analysis.exclude, record.answer.entered_by == EnteredBy::participant,
              record.answer.response_time_s, largest_saturated_share(record), breaks_limit(record.breach));
        trials.push_back(std::move(row));
      } else {
        const auto text_at = [&](const char* key) {
          return body.contains(key) && body.at(key).is_string() ? body.at(key).get<std::string>() : std::string();
        };
        answers.push_back({session, to_iso8601(event.stamp.utc_ns), text_at("question"), text_at("text"),
                           text_at("when"), text_at("condition"), text_at("answer"), whole_at(body, "after_trial"),
                           body.at("answer").is_string()});
      }
    } catch (const nlohmann::json::exception& error) {
      throw StorageError(fmt::format("session {}, event {} ({}): the body cannot be read: {}; run jnd verify",
                                     session.id, event.seq, event.kind, error.what()));
    }
  }
}

// Names that are taken.
struct TelemetryFiles {
  std::set<std::string> ticks, traces;
};

// Writes the ticks, or the rig's own trace, of every interval of one session that kept them. lost: keys of what a recovery could not save.
void write_telemetry(const Study& study, const SessionInfo& session, const std::set<std::string>& lost,
                     const std::string& sub, const std::vector<CsvColumn<TelemetryRow>>& columns,
                     TelemetryFiles& written, ExportFolder& files) {
  for (const Event& event : study.events(session.id)) {
    const auto body = nlohmann::ordered_json::parse(event.body, nullptr, false);
    const std::vector<TelemetryBlob> named = named_telemetry(body);
    if (named.empty()) continue;
    const std::vector<TelemetryBlob> stored = study.telemetry(session.id, event.seq);
    const auto at = [&](const char* key) {
      if (const auto found = body.find(key); found != body.end() && found->is_number_integer()) return whole(*found);
      throw StorageError(fmt::format("session {}, event {} ({}): has telemetry but no \"{}\"; run jnd verify",
                                     session.id, event.seq, event.kind, key));
    };
    const char* what = event.kind.starts_with("exploration.") ? "exploration" : "trial";
    for (const TelemetryBlob& one : named) {
      const auto found = std::find_if(stored.begin(), stored.end(),
                                      [&](const TelemetryBlob& blob) { return blob.interval == one.interval; });
      if (found == stored.end() && lost.contains(telemetry_key(session.id, event.seq, one.interval))) continue;
      if (found == stored.end() || sha256_hex(found->bytes) != one.sha256)
        throw StorageError(
            fmt::format("session {}, event {} ({}): the telemetry of interval {} is missing or was changed; run jnd "
                        "verify, or export without telemetry",
                        session.id, event.seq, event.kind, one.interval + 1));
      const bool trace = is_trace(found->bytes);
      std::string name;
      int again = 0;
      do {
        name = sub + telemetry_file(what, trace, at("index"), at("attempt"), one.interval, ++again);
      } while (!(trace ? written.traces : written.ticks).insert(name).second);
      if (trace) {
        const Trace samples = decode_trace(found->bytes);
        files.write(name, csv_table(trace_columns(), trace_rows(samples)));
        continue;
      }
      const Telemetry telemetry = decode_telemetry(found->bytes);
      files.write(name, csv_table(columns, telemetry_rows(telemetry)));
    }
  }
}

// The rows of one participant, which stand together.
template <typename Row>
std::vector<Row> rows_of(const std::vector<Row>& rows, const std::string& participant) {
  std::vector<Row> found;
  for (const Row& row : rows)
    if (row.participant == participant) found.push_back(row);
  return found;
}

}  // namespace

std::vector<std::string> export_csv(const Study& study, const Protocol& protocol, const StudyResults& results,
                                    const std::filesystem::path& folder, bool replace,
                                    const std::optional<TelemetryExport>& telemetry) {
  const SessionKind kind = attendance_of(results).kind;
  const auto* constant = std::get_if<ConstantResults>(&results.measured);
  // Trial by trial, and answer by answer with the block's condition, pilot and simulated sessions would show the plans
  // that people of a blinded study have too.
  const bool sealed = plan_sealed(study, protocol);
  ExportFolder files(folder, replace);
  std::vector<SessionInfo> listed = study.sessions();  // with those of excluded participants
  std::erase_if(listed, [&](const SessionInfo& session) { return session.kind != kind; });
  if (sealed && protocol.allotment == Allotment::balanced)  // numbers of every kind have the same groups
    for (SessionInfo& session : listed) session.group.clear();
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  auto not_counted = taken_back_of(study);

  const bool has_trials = !std::holds_alternative<ExplorationResults>(results.measured);
  const auto trials_columns = trial_columns(protocol, device_places(study, protocol, sessions));
  const auto cells_columns = csv_columns(cell_fields(protocol));
  const auto reports_columns = csv_columns(threshold_fields(protocol));
  const auto ticks_columns =
      telemetry_columns(protocol, telemetry ? telemetry->limit_names : std::vector<std::string>{});
  const std::set<std::string> lost = telemetry && !sealed ? lost_in_recovery(study) : std::set<std::string>();
  TelemetryFiles written;
  std::vector<ExportAnswer> answers;
  for (auto session = sessions.begin(); session != sessions.end();) {
    const std::string participant = session->participant;
    const std::string sub = "sub-" + participant + "/";
    std::vector<ExportTrial> trials;
    for (; session != sessions.end() && session->participant == participant; ++session) {
      read_session(study, protocol, *session, not_counted[session->id], trials, answers);
      if (telemetry && !sealed) write_telemetry(study, *session, lost, sub, ticks_columns, written, files);
    }
    if (has_trials && !sealed) files.write(sub + "trials.csv", csv_table(trials_columns, trials));
    if (constant == nullptr) continue;
    files.write(sub + "cells.csv", csv_table(cells_columns, rows_of(constant->analysis.cells, participant)));
    files.write(sub + "report.csv", csv_table(reports_columns, rows_of(constant->analysis.thresholds, participant)));
  }

  std::vector<DictionaryRow> dictionary;
  if (has_trials && !sealed) describe("sub-*/trials.csv", trials_columns, dictionary);
  if (constant != nullptr) {
    describe("sub-*/cells.csv", cells_columns, dictionary);
    describe("sub-*/report.csv", reports_columns, dictionary);
  }
  if (!written.ticks.empty()) describe("sub-*/telemetry/*.csv", ticks_columns, dictionary);
  if (!written.traces.empty()) describe("sub-*/telemetry/*-trace.csv", trace_columns(), dictionary);
  const auto write = [&](const std::string& name, const auto& columns, const auto& rows) {
    files.write(name, csv_table(columns, rows));
    describe(name, columns, dictionary);
  };
  if (constant != nullptr) write("group.csv", csv_columns(group_fields(protocol, kind)), constant->analysis.group);
  if (const std::vector<ContrastRow> contrasts = contrasts_of(results, protocol); !contrasts.empty())
    write("contrasts.csv", csv_columns(contrast_fields(protocol, kind)), contrasts);
  for (const ResultFile& file : result_files(results, protocol, nullptr)) {
    files.write(file.name, file.text);
    dictionary.insert(dictionary.end(), file.dictionary.begin(), file.dictionary.end());
  }
  if (!answers.empty() && !sealed) write("answers.csv", answer_columns(), answers);
  write("sessions.csv", session_columns(seed_text(study, protocol, ""), results.chains.study_head, protocol), listed);
  std::vector<LogRow> rows = log_rows(study, kind, listed);
  if (sealed)  // what was said in one trial of the common plan hints at its stimuli
    for (LogRow& row : rows)
      if (row.event == kTakenBackEvent) row.subject.clear();
  if (!rows.empty()) write("log.csv", log_columns(), rows);
  describe("dictionary.csv", dictionary_columns(), dictionary);
  files.write("dictionary.csv", csv_table(dictionary_columns(), dictionary));
  files.write("methods.md", methods_text(study, protocol, results));
  return files.publish();
}

}  // namespace jnd
