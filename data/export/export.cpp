#include "data/export/export.h"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "data/blocks/result_blocks.h"
#include "data/export/data_package.h"
#include "data/export/export_folder.h"
#include "data/export/export_log.h"
#include "data/export/export_tables.h"
#include "data/export/export_telemetry.h"
#include "data/export/recompute_scripts.h"
#include "data/export/result_files.h"
#include "data/log/body_numbers.h"
#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/methods/methods_text.h"
#include "data/study/blinding.h"
#include "data/study/study_facts.h"
#include "data/study/study_impl.h"
#include "data/study/trial_rows.h"
#include "protocols/course/prescription.h"
#include "protocols/input/json_text.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

// What is read back from the log, and where it goes while it is read: the files grow with the sessions, and no session
// is held longer than it takes to write its rows.
class RecordFiles {
 public:
  RecordFiles(ExportFolder& files, const Study& study, const Protocol& protocol,
              const std::vector<SessionInfo>& sessions)
      : protocol_(protocol),
        trials_(files, "trials.csv", trial_columns(protocol)),
        intervals_(files, "intervals.csv", interval_columns(protocol, device_places(study, protocol, sessions))),
        voided_(files, "voided.csv", voided_columns(protocol)),
        answers_(files, "answers.csv", answer_columns()) {
    if (!task_of(protocol.task.kind).has_trials()) return;
    trials_.begin();
    intervals_.begin();
  }

  // taken_back: seq of the answers that were.
  void add(const SessionInfo& session, const std::vector<Event>& events, const std::set<std::int64_t>& taken_back) {
    std::set<std::pair<int, int>> answered;  // trial and attempt, taken back
    for (const Event& event : events) {
      try {
        add(session, event, taken_back.contains(event.seq), answered);
      } catch (const nlohmann::json::exception& error) {
        throw StorageError(fmt::format("session {}, event {} ({}): the body cannot be read: {}; run jnd verify",
                                       session.id, event.seq, event.kind, error.what()));
      } catch (const std::out_of_range&) {
        throw StorageError(
            fmt::format("session {}, event {} ({}): it names a condition or a series that the protocol "
                        "has not; run jnd verify",
                        session.id, event.seq, event.kind));
      }
    }
  }

  void describe_in(std::vector<DictionaryRow>& dictionary) const {
    trials_.describe_in(dictionary);
    intervals_.describe_in(dictionary);
    voided_.describe_in(dictionary);
    answers_.describe_in(dictionary);
  }

 private:
  using Json = nlohmann::ordered_json;

  void add(const SessionInfo& session, const Event& event, bool taken_back, std::set<std::pair<int, int>>& answered) {
    if (event.kind == event_kind::kTrialCompleted) {
      const ExportTrial row = trial_of(session, event);
      if (taken_back)
        answered.emplace(row.record.trial.index, row.record.attempt);
      else
        add(row);
    } else if (event.kind == event_kind::kTrialVoided) {
      add_voided(session, event, answered);
    } else if (event.kind == event_kind::kQuestionAnswered) {
      add_answer(session, event);
    }
  }

  ExportTrial trial_of(const SessionInfo& session, const Event& event) const {
    ExportTrial row{session, event.seq, to_iso8601(event.stamp.utc_ns), trial_record_from(json_from(event.body)), {}};
    const TrialRecord& record = row.record;
    if (!record.trial.practice)
      row.excluded_reason =
          exclusion_reason(protocol_.analysis.exclude, record.answer.entered_by == EnteredBy::participant,
                           record.answer.response_time_s, largest_saturated_share(record), breaks_limit(record.breach));
    return row;
  }

  void add(const ExportTrial& row) {
    trials_.add(row);
    for (const ExportInterval& interval : interval_rows(row)) intervals_.add(interval);
  }

  void add_voided(const SessionInfo& session, const Event& event, const std::set<std::pair<int, int>>& answered) {
    const auto body = json_from(event.body);
    ExportVoided row{
        session, event.seq, to_iso8601(event.stamp.utc_ns), trial_from(body), whole_at(body, "attempt"), {}, {},
        {},      {}};
    row.series = protocol_.series.at(static_cast<std::size_t>(row.trial.series)).name;
    row.condition = protocol_.conditions.at(static_cast<std::size_t>(row.trial.condition)).name;
    row.reason = body.value("reason", std::string());
    row.words = body.value("words", std::string());
    row.answered = answered.contains({row.trial.index, row.attempt});
    row.uses_attempt = body.value("counts", true);
    voided_.add(row);
  }

  void add_answer(const SessionInfo& session, const Event& event) {
    const auto body = json_from(event.body);
    const auto text_at = [&](const char* key) {
      return body.contains(key) && body.at(key).is_string() ? body.at(key).get<std::string>() : std::string();
    };
    answers_.add({session, to_iso8601(event.stamp.utc_ns), text_at("question"), text_at("text"), text_at("when"),
                  text_at("condition"), text_at("answer"), whole_at(body, "after_trial"),
                  body.at("answer").is_string()});
  }

  const Protocol& protocol_;
  CsvFile<ExportTrial> trials_;
  CsvFile<ExportInterval> intervals_;
  CsvFile<ExportVoided> voided_;
  CsvFile<ExportAnswer> answers_;
};

// Names that are taken.
struct TelemetryFiles {
  std::set<std::string> ticks, traces;
};

// Writes the ticks, or the rig's own trace, of every interval of one session that kept them. lost: keys of what a recovery could not save.
void write_telemetry(const Study& study, const SessionInfo& session, const std::vector<Event>& events,
                     const std::set<std::string>& lost, const std::vector<CsvColumn<TelemetryRow>>& columns,
                     TelemetryFiles& written, ExportFolder& files) {
  const std::string sub = "sub-" + session.participant + "/";
  for (const Event& event : events) {
    const auto body = json_if_valid(event.body);
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

// The trials, answers and ticks of the participants who count.
void write_records(const Study& study, const Protocol& protocol, SessionKind kind,
                   const std::optional<TelemetryExport>& telemetry, ExportFolder& files,
                   std::vector<DictionaryRow>& dictionary) {
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  auto taken_back = taken_back_of(study);
  RecordFiles records(files, study, protocol, sessions);
  const auto ticks = telemetry_columns(protocol, telemetry ? telemetry->limit_names : std::vector<std::string>{});
  const std::set<std::string> lost = telemetry ? lost_in_recovery(study) : std::set<std::string>();
  TelemetryFiles written;
  for (const SessionInfo& session : sessions) {
    const std::vector<Event> events = study.events(session.id);
    records.add(session, events, taken_back[session.id]);
    if (telemetry) write_telemetry(study, session, events, lost, ticks, written, files);
  }
  records.describe_in(dictionary);
  if (!written.ticks.empty()) describe("sub-*/telemetry/*.csv", ticks, dictionary);
  if (!written.traces.empty()) describe("sub-*/telemetry/*-trace.csv", trace_columns(), dictionary);
}

// What each participant gets to see of the results: their own estimates.
void write_reports(const std::vector<Block>& blocks, ExportFolder& files, std::vector<DictionaryRow>& dictionary) {
  const Block* const estimates = block_named(blocks, "estimates");
  if (estimates == nullptr) return;
  std::map<std::string, std::string> of;  // by participant
  for (std::size_t row = 0; row < estimates->rows(); ++row)
    of[estimates->text(row, "participant")] += estimates->csv_row(row);
  std::vector<DictionaryRow> columns;
  estimates->describe(columns);
  for (DictionaryRow& column : columns) column.file = "sub-*/report.csv";
  dictionary.insert(dictionary.end(), columns.begin(), columns.end());
  for (const auto& [participant, rows] : of)
    files.write("sub-" + participant + "/report.csv", estimates->csv_header() + rows);
}

}  // namespace

std::vector<std::string> export_csv(const Study& study, const Protocol& protocol, const StudyResults& results,
                                    const std::filesystem::path& folder, bool replace,
                                    const std::optional<TelemetryExport>& telemetry) {
  const SessionKind kind = results.attendance.kind;
  const std::vector<Block> blocks = result_blocks(results, protocol);
  // Trial by trial, and answer by answer with the block's condition, pilot and simulated sessions would show the plans
  // that people of a blinded study have too; and so would the attempts that did not count.
  const bool sealed = plan_sealed(study, protocol);
  ExportFolder files(folder, replace);
  std::vector<SessionInfo> listed = study.sessions();  // with those of excluded participants
  std::erase_if(listed, [&](const SessionInfo& session) { return session.kind != kind; });
  if (sealed && protocol.allotment == Allotment::balanced)  // numbers of every kind have the same groups
    for (SessionInfo& session : listed) session.group.clear();

  std::vector<DictionaryRow> dictionary;
  const auto write = [&](const std::string& name, const auto& columns, const auto& rows) {
    files.write(name, csv_table(columns, rows));
    describe(name, columns, dictionary);
  };
  write("participants.csv", participant_columns(protocol), participant_rows(listed, excluded_of(study, kind)));
  write("sessions.csv", session_columns(seed_text(study, protocol, ""), results.chains.study_head, protocol), listed);
  if (!sealed) write_records(study, protocol, kind, telemetry, files, dictionary);
  write_reports(blocks, files, dictionary);
  add_results(files, blocks, dictionary);
  std::vector<LogRow> rows = log_rows(study, kind, listed);
  if (sealed)  // what was said in one trial of the common plan hints at its stimuli
    for (LogRow& row : rows)
      if (row.event == kTakenBackEvent) row.subject.clear();
  if (!rows.empty()) write("log.csv", log_columns(), rows);
  files.write("methods.md", methods_text(study, protocol, results));
  if (!results.task.outcomes.empty())  // which has nothing to compute again
    for (const RecomputeScript& script : kRecomputeScripts)
      files.write(std::string(script.name), std::string(script.text));
  write_descriptions(files, protocol, fmt::format("{} data", to_string(kind)), std::move(dictionary));
  return files.publish();
}

}  // namespace jnd
