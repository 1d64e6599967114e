#include "runner/report/blinded_files.h"

#include <map>
#include <set>

#include <fmt/format.h>

#include "data/export/export_tables.h"
#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/study/trial_rows.h"
#include "protocols/planning/condition_codes.h"
#include "protocols/version.h"
#include "runner/figures/svg.h"
#include "runner/report/report_html.h"
#include "runner/report/report_style.h"

namespace jnd {

namespace {

// What may be seen of one answered trial. Its place and time say nothing about its stimuli; forces, saturation and
// answers would, and so would the number of its attempts, where trials at a device's limit are repeated.
struct CodedTrial {
  std::string session, utc, code;
  int index = 0, block = 0;
  bool practice = false, by_participant = false;
  double response_time_s = 0, duration_s = 0;
};

std::vector<CsvColumn<CodedTrial>> coded_trial_columns() {
  using R = CodedTrial;
  return {
      {"session", "identifier of the session", "", "", [](const R& r) { return csv_text(r.session); }},
      {"utc", "when the answer was saved, ISO 8601", "", "", [](const R& r) { return r.utc; }},
      {"trial", "place in the plan, from 1", "", "", [](const R& r) { return csv_number(r.index); }},
      {"block", "block of the main part, from 1; 0 in practice", "", "",
       [](const R& r) { return csv_number(r.block); }},
      {"practice", "whether it is practice", "", "0 1", [](const R& r) { return csv_flag(r.practice); }},
      {"condition_code",
       "letter of the condition on the operator's console; empty in practice, whose order would name the letters", "",
       "", [](const R& r) { return r.code; }},
      {"entered_by", "who pressed the key", "", "participant operator",
       [](const R& r) {
         return std::string(to_string(r.by_participant ? EnteredBy::participant : EnteredBy::operator_));
       }},
      {"response_time_s", "from the question to the key", "s", "",
       [](const R& r) { return csv_number(r.response_time_s); }},
      {"duration_s", "from the first cue to the answer", "s", "", [](const R& r) { return csv_number(r.duration_s); }}};
}

std::vector<CsvColumn<SessionInfo>> coded_session_columns(const BlindedResults& results, const Protocol& protocol) {
  std::vector<CsvColumn<SessionInfo>> columns = session_columns("", results.chains.study_head, protocol);
  std::erase_if(columns, [](const auto& column) { return column.name == "seed"; });
  return columns;
}

// not_counted: seq of the answers that were taken back.
void add_trials(const Study& study, const SessionInfo& session, const std::vector<std::string>& codes,
                const std::set<std::int64_t>& not_counted, std::vector<CodedTrial>& rows) {
  for (const Event& event : study.events(session.id)) {
    if (event.kind != event_kind::kTrialCompleted || not_counted.contains(event.seq)) continue;
    const auto body = nlohmann::ordered_json::parse(event.body, nullptr, false);
    if (body.is_discarded())
      throw StorageError(fmt::format("session {}, event {} ({}): the body cannot be read; run jnd verify", session.id,
                                     event.seq, event.kind));
    const TrialRecord record = trial_record_from(body);
    const Trial& trial = record.trial;
    rows.push_back({session.id, to_iso8601(event.stamp.utc_ns),
                    trial.practice ? std::string() : codes.at(static_cast<std::size_t>(trial.condition)), trial.index,
                    trial.block, trial.practice, record.answer.entered_by == EnteredBy::participant,
                    record.answer.response_time_s, record.duration_s});
  }
}

// Writes the results, and adds what their columns mean.
void write_results(ExportFolder& files, const BlindedResults& results, const Protocol& protocol,
                   std::vector<DictionaryRow>& dictionary) {
  const auto write = [&](const std::string& name, const auto& fields, const auto& rows) {
    const auto columns = csv_columns(fields);
    files.write(name, csv_table(columns, rows));
    describe(name, columns, dictionary);
  };
  write("monitoring.csv", blinded_participant_fields(), results.participants);
  if (!results.groups.empty()) write("coded.csv", blinded_group_fields(protocol), results.groups);
}

void write_dictionary(ExportFolder& files, std::vector<DictionaryRow>& dictionary) {
  describe("dictionary.csv", dictionary_columns(), dictionary);
  files.write("dictionary.csv", csv_table(dictionary_columns(), dictionary));
}

}  // namespace

void write_blinded_results(ExportFolder& files, const BlindedResults& results, const Protocol& protocol) {
  std::vector<DictionaryRow> dictionary;
  write_results(files, results, protocol, dictionary);
  write_dictionary(files, dictionary);
}

std::vector<std::string> export_blinded(const Study& study, const Protocol& protocol, const BlindedResults& results,
                                        const std::filesystem::path& folder, bool replace) {
  ExportFolder files(folder, replace);
  std::vector<SessionInfo> sessions = study.sessions();
  std::erase_if(sessions, [](const SessionInfo& session) { return session.kind != SessionKind::real; });
  const std::vector<std::string> codes = condition_codes(protocol, study.info().seed);
  const auto trial_columns = coded_trial_columns();
  const auto sessions_columns = coded_session_columns(results, protocol);
  std::map<std::string, std::vector<CodedTrial>> trials;  // by participant
  std::map<std::string, std::set<std::int64_t>> not_counted = taken_back_of(study);
  for (const SessionInfo& session : sessions)
    if (!session.excluded) add_trials(study, session, codes, not_counted[session.id], trials[session.participant]);
  std::erase_if(trials, [](const auto& entry) { return entry.second.empty(); });
  for (const auto& [participant, rows] : trials)
    files.write("sub-" + participant + "/trials.csv", csv_table(trial_columns, rows));

  std::vector<DictionaryRow> dictionary;
  if (!trials.empty()) describe("sub-*/trials.csv", trial_columns, dictionary);
  write_results(files, results, protocol, dictionary);
  files.write("sessions.csv", csv_table(sessions_columns, sessions));
  describe("sessions.csv", sessions_columns, dictionary);
  write_dictionary(files, dictionary);
  return files.publish();
}

std::string blinded_page(const BlindedResults& results, const Protocol& protocol, const std::string& study_file) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
      "<meta name=\"generator\" content=\"jnd {0}\">\n<title>{1} - {2} (blinded)</title>\n<style>{3}</style>\n</head>\n"
      "<body>\n<a class=\"skip\" href=\"#summary\">Skip to the results</a>\n<header>\n<p class=\"eyebrow\">Report of "
      "{4} <span class=\"kind\">real, blinded</span></p>\n<h1>{5}</h1>\n</header>\n",
      kVersion, escape_markup(protocol.title), escape_markup(study_file), report_style(), user_text(study_file),
      user_text(protocol.title));
  html += fmt::format(
      "<main>\n<h2 id=\"summary\">Summary</h2>\n<section class=\"alert\" aria-labelledby=\"blinded\">\n"
      "<h2 id=\"blinded\">This study is blinded</h2>\n{}</section>\n",
      list_html({results.line}));
  if (results.participants.empty()) html += "<p class=\"lead\">No session has begun yet.</p>\n";
  for (const ResultTable& table : blinded_tables(results, protocol)) html += table_html(table);
  html += fmt::format(
      "<h2 id=\"provenance\">Provenance</h2>\n<dl>\n<dt>Program</dt><dd>jnd {}</dd>\n<dt>Study</dt><dd>{}</dd>\n"
      "<dt>Protocol</dt><dd>{}</dd>\n<dt>SHA-256 of the protocol</dt><dd class=\"hash\">{}</dd>\n"
      "<dt>Chains of events</dt><dd class=\"hash\">{}</dd>\n</dl>\n",
      kVersion, user_text(study_file), user_text(protocol.name), escape_markup(protocol.sha256),
      escape_markup(chain_line(results.chains)));
  return html + fmt::format("</main>\n<footer>Made by jnd {} from {}.</footer>\n</body>\n</html>\n", kVersion,
                            user_text(study_file));
}

}  // namespace jnd
