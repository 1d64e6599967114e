#include "runner/report/report_page.h"

#include <algorithm>

#include <fmt/format.h>

#include "data/methods/verdict_text.h"
#include "runner/drawing/figure_style.h"
#include "runner/report/report_html.h"
#include "runner/report/report_markdown.h"
#include "runner/report/report_style.h"
#include "runner/results/analysis_text.h"

namespace jnd {

namespace {

std::string head_html(const Protocol& protocol, const ReportFacts& facts) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
      "<meta name=\"generator\" content=\"jnd {}\">\n<title>{} - {}</title>\n<style>{}</style>\n</head>\n",
      escape_markup(facts.program_version), escape_markup(protocol.title), escape_markup(facts.study_file),
      report_style());
}

// What was found: the same verdict and tables that `jnd analyze` begins with.
std::string summary_html(const StudyResults& results, const std::vector<Block>& blocks, const Protocol& protocol) {
  const Attendance& attendance = results.attendance;
  if (attendance.participants == 0)
    return fmt::format("<p class=\"lead\">This study holds no {} session yet: there is nothing to report.</p>\n",
                       to_string(attendance.kind));
  std::string html = fmt::format("<p>{}.</p>\n", escape_markup(who_took_part(results, protocol)));
  if (const std::string verdict = verdict_text(results, protocol); !verdict.empty())
    html += fmt::format("<p class=\"lead\">{}</p>\n", escape_markup(verdict));
  if (results.task.outcomes.empty()) return html;  // its tables follow all the same
  for (const Block& block : blocks) {
    ResultTable table = answer_of(block);
    if (table.rows.empty()) continue;
    table.id = fmt::format("answer-{}", table.id);
    html += table_html(table);
  }
  return html;
}

std::string alert_html(std::string_view id, std::string_view title, const std::vector<std::string>& items) {
  if (items.empty()) return {};
  return fmt::format("<section class=\"alert\" aria-labelledby=\"{0}\">\n<h2 id=\"{0}\">{1}</h2>\n{2}</section>\n", id,
                     title, list_html(items));
}

std::vector<std::string> state_of(const Attendance& attendance, const ReportFacts& facts) {
  std::vector<std::string> items;
  const auto open = std::count_if(attendance.heads.begin(), attendance.heads.end(),
                                  [](const SessionHead& head) { return !head.closed; });
  if (open > 0)
    items.push_back(
        fmt::format("{} of {} sessions are not finished: these numbers are not final.", open, attendance.heads.size()));
  for (const std::string& kind : facts.other_kinds)
    items.push_back(fmt::format("This study also has {} sessions; they are not in these numbers.", kind));
  return items;
}

std::string contents_html(const std::vector<Figure>& figures, const std::vector<ResultTable>& tables, bool methods) {
  std::string html = "<nav aria-labelledby=\"contents\">\n<h2 id=\"contents\">Contents</h2>\n<ol>\n";
  const auto add = [&](const std::string& anchor, const std::string& text) {
    html += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", anchor, escape_markup(text));
  };
  add("summary", "Summary");
  for (const Figure& figure : figures) add(figure_anchor(figure), "Figure: " + figure.title);
  for (const ResultTable& table : tables) add(table_anchor(table), "Table: " + table.title);
  if (methods) add("methods", "Methods");
  add("provenance", "Provenance");
  return html + "</ol>\n</nav>\n";
}

std::string source_html(const Source& source) {
  if (source.citation.empty() && source.doi.empty()) return {};
  std::string html = fmt::format("<dt>Source</dt><dd>{}", user_text(source.citation));
  if (source.doi.starts_with("10."))
    html += fmt::format(" <a href=\"https://doi.org/{0}\" rel=\"noreferrer\">doi:{0}</a>", escape_markup(source.doi));
  else if (!source.doi.empty())
    html += fmt::format(" {}", user_text(source.doi));
  return html + "</dd>\n";
}

std::string provenance_html(const StudyResults& results, const Protocol& protocol, const ReportFacts& facts) {
  std::string html = fmt::format(
      "<h2 id=\"provenance\">Provenance</h2>\n<p>Whoever has the study file can recompute every number of this page "
      "with <code>jnd analyze</code>; <code>jnd verify</code> recomputes the hashes.</p>\n<dl>\n"
      "<dt>Program</dt><dd>jnd {}</dd>\n<dt>Study</dt><dd>{}, seed {}</dd>\n<dt>Protocol</dt><dd>{}</dd>\n"
      "<dt>SHA-256 of the protocol</dt><dd class=\"hash\">{}</dd>\n<dt>Sessions</dt><dd>{}</dd>\n"
      "<dt>Chains of events</dt><dd class=\"hash\">{}</dd>\n{}</dl>\n",
      escape_markup(facts.program_version), user_text(facts.study_file),
      facts.study_seed ? std::to_string(*facts.study_seed) : "sealed while the study is blinded",
      user_text(protocol.name), escape_markup(protocol.sha256), to_string(results.attendance.kind),
      escape_markup(chain_line(results.chains)), source_html(protocol.source));
  ResultTable heads{"heads", "Session heads", "the last hash of each session's chain of events"};
  heads.columns = {{"participant"}, {"session"}, {"state"}, {"head"}};
  for (const SessionHead& head : results.attendance.heads)
    heads.rows.push_back({head.participant, head.session, head.closed ? "finished" : "not finished", head.hash});
  if (!heads.rows.empty()) html += table_html(heads);
  return html;
}

}  // namespace

std::string report_page(const StudyResults& results, const Protocol& protocol, const std::vector<Block>& blocks,
                        const std::vector<Figure>& figures, const std::string& methods_markdown,
                        const ReportFacts& facts) {
  std::vector<ResultTable> tables;
  for (const Block& block : blocks)
    if (ResultTable table = table_of(block); !table.rows.empty()) tables.push_back(std::move(table));
  std::string html = head_html(protocol, facts);
  html += fmt::format(
      "<body>\n<a class=\"skip\" href=\"#summary\">Skip to the results</a>\n<header>\n<p class=\"eyebrow\">Report of "
      "{} "
      "<span class=\"kind\">{}</span></p>\n<h1>{}</h1>\n</header>\n",
      user_text(facts.study_file), to_string(results.attendance.kind), user_text(protocol.title));
  html += "<main>\n<h2 id=\"summary\">Summary</h2>\n" + summary_html(results, blocks, protocol);
  html += alert_html("state", "State of the study", state_of(results.attendance, facts));
  html += alert_html("deviations", "Deviations from what was registered", results.deviations);
  html += alert_html("cautions", "Cautions", results.cautions);
  html += contents_html(figures, tables, !methods_markdown.empty());
  if (!figures.empty()) html += "<h2 id=\"figures\">Figures</h2>\n";
  for (std::size_t i = 0; i < figures.size(); ++i) html += figure_html(figures[i], static_cast<int>(i) + 1);
  if (!tables.empty()) html += "<h2 id=\"tables\">Tables</h2>\n";
  for (const ResultTable& table : tables) html += table_html(table);
  if (!methods_markdown.empty()) html += "<h2 id=\"methods\">Methods</h2>\n" + markdown_to_html(methods_markdown, 3);
  html += provenance_html(results, protocol, facts);
  return html + fmt::format("</main>\n<footer>Made by jnd {} from {}.</footer>\n</body>\n</html>\n",
                            escape_markup(facts.program_version), user_text(facts.study_file));
}

}  // namespace jnd
