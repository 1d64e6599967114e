#include "runner/report/blinded_files.h"

#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "data/export/data_package.h"
#include "data/export/export_tables.h"
#include "data/export/result_files.h"
#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/study/trial_rows.h"
#include "protocols/condition_words.h"
#include "protocols/input/json_text.h"
#include "protocols/version.h"
#include "runner/drawing/svg.h"
#include "runner/report/report_html.h"
#include "runner/report/report_style.h"

namespace jnd {

namespace {

// What may be seen of answered trials: place and time say nothing about the stimuli; forces, saturation and answers
// would, and so would the number of attempts, where trials at a device's limit are repeated. And the condition's code.
// codes: by condition.
std::vector<CsvColumn<ExportTrial>> coded_trial_columns(const Protocol& protocol,
                                                        const std::vector<std::string>& codes) {
  std::vector<CsvColumn<ExportTrial>> columns = blinded(trial_columns(protocol));
  columns.push_back(
      {"condition_code",
       "letter of the condition on the operator's console; empty in practice, whose order would name the letters", "",
       "", [codes](const ExportTrial& row) {
         const Trial& trial = row.record.trial;
         return trial.practice ? std::string() : codes.at(static_cast<std::size_t>(trial.condition));
       }});
  return columns;
}

// not_counted: seq of the answers that were taken back.
void add_trials(const Study& study, const SessionInfo& session, const std::set<std::int64_t>& not_counted,
                CsvFile<ExportTrial>& trials) {
  for (const Event& event : study.events(session.id)) {
    if (event.kind != event_kind::kTrialCompleted || not_counted.contains(event.seq)) continue;
    const auto body = json_if_valid(event.body);
    if (body.is_discarded())
      throw StorageError(fmt::format("session {}, event {} ({}): the body cannot be read; run jnd verify", session.id,
                                     event.seq, event.kind));
    trials.add({session, event.seq, to_iso8601(event.stamp.utc_ns), trial_record_from(body), {}});
  }
}

}  // namespace

std::string coded_data(SessionKind kind) {
  return fmt::format("{} data, in code", to_string(kind));
}

void write_blinded_results(ExportFolder& files, const BlindedResults& results, const Protocol& protocol) {
  write_results(files, blinded_blocks(results, protocol), protocol, coded_data(results.kind));
}

std::vector<std::string> export_blinded(const Study& study, const Protocol& protocol, const BlindedResults& results,
                                        const std::filesystem::path& folder, bool replace) {
  ExportFolder files(folder, replace);
  std::vector<SessionInfo> sessions = study.sessions();
  std::erase_if(sessions, [&](const SessionInfo& session) { return session.kind != results.kind; });
  for (SessionInfo& session : sessions) session.head = shown_head(session, true);
  std::vector<DictionaryRow> dictionary;
  const auto write = [&](const std::string& name, const auto& columns, const auto& rows) {
    files.write(name, csv_table(columns, rows));
    describe(name, columns, dictionary);
  };
  write("participants.csv", blinded(participant_columns(protocol)), participant_rows(sessions, {}));
  write("sessions.csv", blinded(session_columns("", results.chains.study_head, protocol)), sessions);
  CsvFile<ExportTrial> trials(files, "trials.csv",
                              coded_trial_columns(protocol, condition_codes(protocol, study.info().seed)));
  std::map<std::string, std::set<std::int64_t>> not_counted = taken_back_of(study);
  for (const SessionInfo& session : sessions)
    if (!session.excluded) add_trials(study, session, not_counted[session.id], trials);
  trials.describe_in(dictionary);
  add_results(files, blinded_blocks(results, protocol), dictionary);
  write_descriptions(files, protocol, coded_data(results.kind), std::move(dictionary));
  return files.publish();
}

std::string blinded_page(const BlindedResults& results, const Protocol& protocol, const std::string& study_file) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
      "<meta name=\"generator\" content=\"jnd {0}\">\n<title>{1} - {2} (blinded)</title>\n<style>{3}</style>\n</head>\n"
      "<body>\n<a class=\"skip\" href=\"#summary\">Skip to the results</a>\n<header>\n<p class=\"eyebrow\">Report of "
      "{4} <span class=\"kind\">{6}, blinded</span></p>\n<h1>{5}</h1>\n</header>\n",
      kVersion, escape_markup(protocol.title), escape_markup(study_file), report_style(), user_text(study_file),
      user_text(protocol.title), to_string(results.kind));
  html += fmt::format(
      "<main>\n<h2 id=\"summary\">Summary</h2>\n<section class=\"alert\" aria-labelledby=\"blinded\">\n"
      "<h2 id=\"blinded\">This study is blinded</h2>\n{}</section>\n",
      list_html({results.line}));
  if (results.participants.empty()) html += "<p class=\"lead\">No session has begun yet.</p>\n";
  for (const Block& block : blinded_blocks(results, protocol))
    if (block.rows() > 0) html += table_html(table_of(block));
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
