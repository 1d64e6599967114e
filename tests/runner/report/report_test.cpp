// The report's page and its files: well formed, self-contained, escaped, complete; and never half written.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <rapidcheck.h>
#include <unistd.h>

#include "data/blocks/result_blocks.h"
#include "data/files/seal.h"
#include "data/log/storage_error.h"
#include "runner/report/report_files.h"
#include "runner/report/report_html.h"
#include "runner/report/report_markdown.h"
#include "runner/report/report_page.h"
#include "runner/report/report_style.h"
#include "tests/catch.h"
#include "tests/runner/markup_check.h"
#include "tests/runner/report_fixture.h"

using namespace jnd;

namespace {

namespace fs = std::filesystem;

ReportFacts facts() {
  ReportFacts facts;
  facts.program_version = "9.9.9";
  facts.study_file = "s.sqlite";
  facts.study_seed = 17;
  return facts;
}

std::vector<ResultTable> two_tables() {
  ResultTable table{"group", "Group", "a note", {{"condition"}, {"mean JND", true}}, {{"S", "283.5"}, {"", "1"}},
                    {"r"}};
  ResultTable wide{"cells", "Cells", "", {}, {}, {}};
  for (int i = 0; i < 17; ++i) wide.columns.push_back({"c" + std::to_string(i), i > 0});
  wide.rows.emplace_back(17, "0");
  return {table, wide};
}

std::string page_of(const StudyResults& results, const Protocol& protocol) {
  return report_page(results, protocol, result_blocks(results, protocol), study_figures(results, protocol),
                     "A method, `jnd`.\n", facts());
}

// What could run or be fetched: the only addresses are links that a person may follow.
void check_self_contained(const std::string& page) {
  CHECK(markup_problem(page).empty());
  for (const char* part : {"<script", "<link", "<img", "<iframe", "<object", "<embed", "@import", "url(",
                           "src=", "onload=\"", "onclick=", "javascript:", "xlink", "<foreignObject", "<base"})
    CHECK(page.find(part) == std::string::npos);
  CHECK(count_of(page, "http://") == 0);
  CHECK(count_of(page, "https://") == count_of(page, "<a href=\"https://doi.org/10."));
}

struct Folder {
  Folder() : path(fs::temp_directory_path() / ("jnd-report-test-" + std::to_string(::getpid()))) {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path path;
};

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

ReportFiles two_files(const fs::path& folder, const std::string& bytes) {
  return {folder / "r.html", folder / "r-figures", bytes, {{"a.svg", bytes}, {"b.svg", bytes}}};
}

}  // namespace

TEST_CASE("a page has its parts in order, and needs nothing else") {
  const Protocol protocol = published_protocol();
  const StudyResults results = invented_study(protocol, 18);
  const std::string page = page_of(results, protocol);
  check_self_contained(page);
  CHECK(page.starts_with("<!DOCTYPE html>\n<html lang=\"en\">"));
  std::size_t at = 0;
  for (const char* part : {"<meta charset=\"utf-8\">",
                           "viewport",
                           "Content-Security-Policy",
                           "<title>",
                           "class=\"skip\"",
                           "<h1>",
                           "<main>",
                           "id=\"summary\"",
                           "<nav",
                           "id=\"figures\"",
                           "<figure id=\"fig-jnd\">",
                           "<figcaption>",
                           "id=\"tables\"",
                           "<caption>",
                           "scope=\"col\"",
                           "scope=\"row\"",
                           "id=\"methods\"",
                           "<code>jnd</code>",
                           "id=\"provenance\"",
                           "</main>",
                           "<footer>"}) {
    INFO(part);
    at = page.find(part, at);
    REQUIRE(at != std::string::npos);
  }
  CHECK(page.find(protocol.sha256) != std::string::npos);
  CHECK(page.find("seed 17") != std::string::npos);
  CHECK(page.find("jnd 9.9.9") != std::string::npos);
  CHECK(page.find("18 simulated participants (18 planned)") != std::string::npos);
  CHECK(page.find("yes-no d&#39; of loglinear rates, least_squares") != std::string::npos);
  CHECK(count_of(page, "<figure ") == study_figures(results, protocol).size());
  CHECK(count_of(page, std::string(64, 'a')) == 18);  // the sessions' heads
  // Every link within the page has its place, and no place stands twice.
  for (at = page.find("href=\"#"); at != std::string::npos; at = page.find("href=\"#", at + 1)) {
    const std::string anchor = page.substr(at + 7, page.find('"', at + 7) - at - 7);
    INFO(anchor);
    CHECK(count_of(page, " id=\"" + anchor + "\"") == 1);
  }
  CHECK(page == page_of(results, protocol));
}

TEST_CASE("what must be said stands before the figures") {
  const Protocol protocol = published_protocol();
  StudyResults results = invented_study(protocol, 4);
  CHECK(page_of(results, protocol).find("class=\"alert\"") == std::string::npos);
  results.cautions = {"too few <trials>"};
  results.deviations = {"another analysis"};
  results.attendance.heads[0].closed = false;
  ReportFacts others = facts();
  others.other_kinds = {"pilot"};
  const std::string page = report_page(results, protocol, {}, study_figures(results, protocol), "", others);
  for (const char* part :
       {"too few &lt;trials&gt;", "another analysis", "1 of 4 sessions are not finished", "also has pilot sessions"}) {
    INFO(part);
    REQUIRE(page.find(part) != std::string::npos);
    CHECK(page.find(part) < page.find("id=\"figures\""));
  }
  CHECK(page.find("id=\"methods\"") == std::string::npos);
}

TEST_CASE("the summary counts who has no JND") {
  const Protocol protocol = published_protocol();
  std::vector<CellCounts> cells = invented_counts(protocol, 5, 5);
  for (CellCounts& cell : cells) cell.counts = {6, 1, 6, 5};
  const StudyResults results = invented_results(protocol, cells);
  const std::string page = page_of(results, protocol), summary = page.substr(0, page.find("id=\"figures\""));
  CHECK(count_of(summary, "<td class=\"number\">0 of 5</td><td class=\"number\">-</td>") == 3);
  CHECK(summary.find("the mean leaves out 5 of 5 (5 no_sensitivity") != std::string::npos);
  check_self_contained(page);
}

TEST_CASE("a study without sessions, and a large one, have pages too") {
  const Protocol protocol = published_protocol();
  StudyResults empty;
  empty.attendance.kind = SessionKind::real;
  const std::string page = report_page(empty, protocol, {}, study_figures(empty, protocol), "", facts());
  check_self_contained(page);
  CHECK(page.find("no real session yet") != std::string::npos);
  CHECK(page.find("id=\"figures\"") == std::string::npos);
  const StudyResults many =
      results_of(results_of_counts(invented_counts(protocol, 201, 2), protocol, SessionKind::simulated), 201, protocol);
  check_self_contained(page_of(many, protocol));
}

TEST_CASE("text of users is never markup") {
  const std::string attack = "\"><script>alert('x')</script><img src=x onerror=y> & \xe2\x80\xae \xff";
  Protocol protocol = published_protocol();
  protocol.title = protocol.name = protocol.source.citation = protocol.source.doi = attack;
  for (Condition& condition : protocol.conditions) condition.label = attack;
  for (Question& question : protocol.questions) question.text = question.low_label = question.high_label = attack;
  std::vector<CellCounts> cells = invented_counts(protocol, 3, 5);
  for (CellCounts& cell : cells) cell.participant = attack + cell.participant;
  StudyResults results = invented_results(protocol, cells);
  results.cautions = results.deviations = {attack};
  ReportFacts hostile = facts();
  hostile.study_file = attack;
  Block block;
  block.id = block.title = block.note = attack;
  block.footnotes = {attack};
  block.columns = {{attack}};
  block.with(Fields<std::string>{{attack, attack, [](const std::string& text) { return text; }, {.unit = attack}}},
             std::vector<std::string>{attack});
  const std::string page = report_page(results, protocol, {block}, study_figures(results, protocol),
                                       "# " + attack + "\n\n- " + attack + "\n\n`" + attack + "`\n", hostile);
  CHECK(markup_problem(page).empty());
  CHECK(page.find("<script") == std::string::npos);
  CHECK(page.find("<img") == std::string::npos);
  CHECK(page.find("\xe2\x80\xae") == std::string::npos);
  CHECK(page.find('\xff') == std::string::npos);
  CHECK(page.find("doi.org") == std::string::npos);  // what is no DOI is no link
  CHECK(page.find("&lt;script&gt;") != std::string::npos);
}

TEST_CASE("the few words of Markdown") {
  CHECK(markdown_to_html("# A\ntext\nmore\n\n- one\n  still one\n- two\n\nend `c<` **b**", 3) ==
        "<h3>A</h3>\n<p>text more</p>\n<ul>\n<li>one still one</li>\n<li>two</li>\n</ul>\n"
        "<p>end <code>c&lt;</code> <strong>b</strong></p>\n");
  CHECK(markdown_to_html("1. a\n2. b\n## h", 2) == "<ol>\n<li>a</li>\n<li>b</li>\n</ol>\n<h3>h</h3>\n");
  CHECK(markdown_to_html("<b>x</b> *y*", 3) == "<p>&lt;b&gt;x&lt;/b&gt; <em>y</em></p>\n");
  CHECK(markdown_to_html("[l](javascript:f) <javascript:f> ![i](http://x \"t\") http://x [r] \\[e\\](x)\n\n[r]: data:y",
                         3) == "<p>l javascript:f i http://x r [e](x)</p>\n");
  CHECK(markdown_to_html("&lt;script&#62;", 3) == "<p>&amp;lt;script&amp;#62;</p>\n");
  CHECK(markdown_to_html("<script>\nf()\n</script>\n\n    indented\n\n> quoted", 3) ==
        "<p>&lt;script&gt; f() &lt;/script&gt;</p>\n<p>indented</p>\n<p>quoted</p>\n");
  CHECK(markdown_to_html("2.5 is no list, nor is # this", 3) == "<p>2.5 is no list, nor is # this</p>\n");
  CHECK(markdown_to_html("a \\`b\\` \\*\\*c\\*\\* \\\\ **d\\*** \\<b>", 3) ==
        "<p>a `b` **c** \\ <strong>d*</strong> &lt;b&gt;</p>\n");
  CHECK(markdown_to_html("an open ` stays", 3) == "<p>an open ` stays</p>\n");
  CHECK(markdown_to_html("###### deep", 6) == "<h6>deep</h6>\n");
  CHECK(markdown_to_html("", 3).empty());
  CHECK(markdown_to_html("> ![a](*)*", 3) == "<p>a</p>\n");
  REQUIRE(rc::check("balanced, whatever the text", [](const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts)
      text += part + *rc::gen::element<std::string>("\n", "\n- ", "\n# ", "`", "**", "\n1. ", "\n\n", "[a](b \"c\")",
                                                    "![a](", "<", ">", "&#0;", "\n> ", "\n```\n", "*", "_");
    const std::string html = markdown_to_html(text, 3);
    RC_LOG() << text << " -> " << html;
    RC_ASSERT(markup_problem(html).empty());
  }));
}

TEST_CASE("a table keeps its heads and its numbers to the right") {
  const std::string html = table_html(two_tables()[0]);
  CHECK(html.find("<th scope=\"col\" class=\"number\">mean JND</th>") != std::string::npos);
  CHECK(html.find("<th scope=\"row\">S</th><td class=\"number\">283.5</td>") != std::string::npos);
  CHECK(html.find("<tr><td></td><td class=\"number\">1</td></tr>") != std::string::npos);
  CHECK(html.find("<span class=\"note\">a note</span>") != std::string::npos);
  CHECK(table_html(two_tables()[1]).find("\"table wide widest short\"") != std::string::npos);
}

TEST_CASE("the style sheet knows every class of the figures, dark paper and print", "[long]") {
  const std::string style(report_style());
  CHECK(style.find("url(") == std::string::npos);
  CHECK(style.find("@import") == std::string::npos);
  CHECK(style.find("prefers-color-scheme: dark") != std::string::npos);
  CHECK(style.find("@media print") != std::string::npos);
  const Protocol protocol = published_protocol();
  StudyResults results = invented_study(protocol, 30);
  results.hierarchical = study_hierarchical(results.task, protocol);
  for (const Figure& figure : study_figures(results, protocol)) {
    const std::string svg = figure.svg.file();
    for (std::size_t at = svg.find("class=\""); at != std::string::npos; at = svg.find("class=\"", at + 1)) {
      const std::string name = svg.substr(at + 7, svg.find('"', at + 7) - at - 7);
      // Groups carry no look of their own.
      if (name == "panel" || name == "point" || name == "edge" || name == "mean" || name == "published-value") continue;
      INFO(name);
      CHECK(style.find("svg ." + name + " {") != std::string::npos);
    }
  }
}

TEST_CASE("a report appears whole, and replaces only a report") {
  const Folder folder;
  write_report(two_files(folder.path, "one"), false);
  CHECK(bytes_of(folder.path / "r.html") == sealed("one", "report"));
  CHECK(bytes_of(folder.path / "r-figures" / "b.svg") == sealed("one", "report"));
  CHECK_THROWS_AS(write_report(two_files(folder.path, "two"), false), StorageError);
  CHECK(bytes_of(folder.path / "r.html") == sealed("one", "report"));
  ReportFiles fewer = two_files(folder.path, "two");
  fewer.figures.pop_back();
  write_report(fewer, true);
  CHECK(bytes_of(folder.path / "r.html") == sealed("two", "report"));
  CHECK(bytes_of(folder.path / "r-figures" / "a.svg") == sealed("two", "report"));
  CHECK_FALSE(fs::exists(folder.path / "r-figures" / "b.svg"));
  SECTION("nothing is left beside it") {
    std::size_t entries = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path)) ++entries;
    CHECK(entries == 2);
  }
  SECTION("a folder that holds something else is not touched") {
    std::ofstream(folder.path / "r-figures" / "notes.txt") << "mine";
    CHECK_THROWS_AS(write_report(two_files(folder.path, "three"), true), StorageError);
    CHECK(bytes_of(folder.path / "r.html") == sealed("two", "report"));
    CHECK(bytes_of(folder.path / "r-figures" / "notes.txt") == "mine");
  }
  SECTION("a link or folder in the page's place is refused") {
    fs::remove(folder.path / "r.html");
    fs::create_directory(folder.path / "r.html");
    CHECK_THROWS_AS(write_report(two_files(folder.path, "three"), true), StorageError);
    fs::remove(folder.path / "r.html");
    fs::create_symlink("elsewhere", folder.path / "r.html");
    CHECK_THROWS_AS(write_report(two_files(folder.path, "three"), true), StorageError);
    CHECK_FALSE(fs::exists(folder.path / "elsewhere"));
  }
  SECTION("without figures the old ones go") {
    fewer.figures.clear();
    write_report(fewer, true);
    CHECK_FALSE(fs::exists(folder.path / "r-figures"));
  }
  SECTION("the page and the folder need two names") {
    fewer.folder = fewer.page;
    CHECK_THROWS_AS(write_report(fewer, true), StorageError);
  }
  SECTION("a place that cannot be written says so and leaves nothing") {
    std::ofstream(folder.path / "file") << "x";
    ReportFiles nowhere = two_files(folder.path / "file" / "inside", "x");
    CHECK_THROWS_AS(write_report(nowhere, true), StorageError);
  }
}
