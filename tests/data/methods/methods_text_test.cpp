// The methods' text and its verdicts.
#include "data/methods/methods_text.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "data/methods/markdown_text.h"
#include "data/methods/references.h"
#include "data/methods/verdict_text.h"
#include "data/task_results/threshold_method.h"
#include "protocols/random_stream.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/data/pair_results.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

// The methods in words: nothing that is not so, and every reference cited.

Protocol shipped(const std::string& name) {
  return load_protocol(std::string(JND_SOURCE_DIR) + "/protocols/" + name + ".json");
}

std::string methods_of(const Protocol& protocol) {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.sqlite", protocol);
  const bool has_answers = protocol.task.kind == TaskKind::same_different && !protocol.design.procedure;
  for (int number = 1; number <= 2 && has_answers; ++number) run_whole_session(*study, protocol, number);
  return methods_text(*study, protocol, results_of(*study, protocol, SessionKind::simulated));
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_CASE("the methods name the generator that drew the plans", "[data]") {
  CHECK(kGeneratorName == "Philox4x64-10");
  for (const char* name : {"tutorial", "adaptive-quest", "adaptive-posterior"}) {
    const std::string text = methods_of(shipped(name));
    CHECK(has(text, "(Philox4x64-10, Salmon et al. 2011)"));
    CHECK_FALSE(has(text, "4x32"));
  }
}

// "Hautus 1995", "Games and Howell 1976", "King-Smith et al. 1994".
std::set<std::string> citations_in(const std::string& text) {
  static const std::regex citation(R"([A-Z][A-Za-z-]+( and [A-Z][A-Za-z-]+| et al\.)? (19|20)\d\d)");
  std::set<std::string> cited;
  for (std::sregex_iterator found(text.begin(), text.end(), citation), end; found != end; ++found)
    cited.insert(found->str());
  return cited;
}

std::string list_of_references(const std::set<std::string>& cited) {
  std::string list;
  for (const Reference& reference : all_references())
    if (cited.contains(std::string(reference.cited))) list += "- " + std::string(reference.full) + "\n";
  return list.empty() ? "" : "\n## References\n\n" + list;
}

// What the program itself says: behind the title and the study's own source, which are the protocol's words.
void require_references(const std::string& text) {
  const std::size_t list = std::min(text.find("\n## References\n"), text.size());
  const std::size_t begin = text.find("## Design\n");
  REQUIRE(begin < list);
  const std::set<std::string> cited = citations_in(text.substr(begin, list - begin));
  std::set<std::string> known;
  for (const Reference& reference : all_references()) known.emplace(reference.cited);
  for (const std::string& one : cited) {
    INFO(one << " is cited and in no list");
    CHECK(known.contains(one));
  }
  CHECK(text.substr(list) == list_of_references(cited));
}

// The literals of a C++ source, neighbours joined as the compiler joins them, one a line. Comments are left out.
std::string literals_of(const std::filesystem::path& source) {
  std::string all, line;
  std::istringstream code(bytes_of(source));
  bool joins = false;  // nothing but blanks since the last literal
  while (std::getline(code, line)) {
    bool within = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const char c = line[i];
      if (!within && c == '/' && line.compare(i, 2, "//") == 0) break;
      if (!within && c == '\'' && line.compare(i, 3, "'\"'") == 0) i += 2;
      if (c == '"') {
        within = !within;
        if (within && !joins) all += '\n';
        joins = !within;
      } else if (within) {
        if (c == '\\' && i + 1 < line.size()) ++i;
        all += line[i];
      } else if (c != ' ') {
        joins = false;
      }
    }
  }
  return all;
}

// All of the program's words that a methods text can be made of.
std::string words_of_the_methods() {
  std::string all;
  for (const char* folder : {"data/methods", "data/results", "data/task_results", "protocols/tasks",
                             "protocols/planning", "protocols/course"})
    for (const auto& entry : std::filesystem::directory_iterator(std::string(JND_SOURCE_DIR) + "/" + folder))
      if (entry.path().extension() == ".cpp" && entry.path().filename() != "references.cpp")
        all += literals_of(entry.path());
  return all;
}

TEST_CASE("every work that the program's words can cite is in the list, and no other", "[data]") {
  const std::set<std::string> cited = citations_in(words_of_the_methods());
  std::set<std::string> known;
  for (const Reference& reference : all_references()) known.emplace(reference.cited);
  CHECK(cited == known);
}

TEST_CASE("a reference has its authors, year and title, and stands in the order of the alphabet", "[data]") {
  const std::regex form(R"([A-Z][A-Za-z-]+ [A-Z]\..* \((19|20)\d\d\)\. [A-Z][^.]{10,}.*\. .+)");
  std::string before;
  for (const Reference& reference : all_references()) {
    const std::string cited(reference.cited), full(reference.full);
    CAPTURE(full);
    CHECK(std::regex_match(full, form));
    CHECK(full.starts_with(cited.substr(0, cited.find(' ')) + " "));
    CHECK(has(full, " (" + cited.substr(cited.size() - 4) + "). "));
    CHECK(before < cited);
    before = cited;
  }
}

std::vector<std::string> shipped_names() {
  std::vector<std::string> names;
  const std::filesystem::path folder = std::string(JND_SOURCE_DIR) + "/protocols";
  for (const std::filesystem::path& one : {folder, folder / "studies"})
    for (const auto& entry : std::filesystem::directory_iterator(one))
      if (entry.path().extension() == ".json" && entry.path().filename() != "protocol.schema.json")
        names.push_back(entry.path().lexically_relative(folder).replace_extension().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST_CASE("what the methods cite is listed in full, and nothing else", "[data]") {
  std::set<TaskKind> tasks;
  for (const std::string& name : shipped_names()) {
    CAPTURE(name);
    const Protocol protocol = shipped(name);
    tasks.insert(protocol.task.kind);
    require_references(methods_of(protocol));
  }
  CHECK(tasks.size() == kTaskWords.size());  // each task is shipped at least once
  const std::string constant = methods_of(shipped("chinello2017"));
  CHECK_FALSE(has(constant, "Levitt"));
  CHECK_FALSE(has(constant, "Watson"));
  CHECK(has(constant, "Corrections for extreme proportions and their biasing effects on estimated values of d'."));
  CHECK(references_of("no work at all").empty());
}

TEST_CASE("what the methods of every registered analysis cite is listed in full, and nothing else", "[data]") {
  std::set<std::string> texts;
  const auto check = [&](const std::string& what, const std::function<void(Protocol&)>& change) {
    CAPTURE(what);
    Protocol protocol = tutorial();
    change(protocol);
    const std::string text = methods_of(protocol);
    require_references(text);
    texts.insert(text);
  };
  std::size_t changes = 0;
  struct Registered {
    const char *model, *method;
    bool common_criterion;
  };
  std::set<JndMethod> methods;
  for (const Registered& one : {Registered{"yes-no", "least_squares", false},
                                {"yes-no", "weighted", false},
                                {"yes-no", "inverse_mean_slope", false},
                                {"yes-no", "mean_of_ratios", false},
                                {"yes-no", "ml", false},
                                {"yes-no", "ml", true},
                                {"differencing", "ml", false},
                                {"differencing", "ml", true},
                                {"independent-observation", "least_squares", false}}) {
    check(std::string(one.model) + ", " + one.method, [&](Protocol& protocol) {
      protocol.analysis.model = one.model;
      protocol.analysis.jnd_method = one.method;
      protocol.analysis.common_criterion = one.common_criterion;
      methods.insert(registered_method(protocol).method);
    });
    ++changes;
  }
  for (const ThresholdMethod& one : all_methods(registered_method(tutorial()))) CHECK(methods.contains(one.method));
  for (const char* correction : {"none", "half"}) {
    check(correction, [&](Protocol& protocol) { protocol.analysis.correction = correction; });
    ++changes;
  }
  for (const Omnibus omnibus : {Omnibus::none, Omnibus::anova, Omnibus::friedman})
    for (const PostHoc post_hoc : {PostHoc::holm_t, PostHoc::games_howell, PostHoc::tukey, PostHoc::wilcoxon}) {
      check("tests", [&](Protocol& protocol) {
        protocol.analysis.tests.omnibus = omnibus;
        protocol.analysis.tests.post_hoc = post_hoc;
      });
      ++changes;
    }
  CHECK(texts.size() + 1 >= changes);  // the tutorial's own analysis is among the first and the last of these
}

TEST_CASE("the methods say which model tests the contrasts", "[data]") {
  Protocol protocol = chinello();
  const std::size_t contrasts = protocol.analysis.contrasts.size();
  REQUIRE(contrasts == 3);
  const std::string separate = methods_of(protocol);
  CHECK(has(separate, "the 3 registered contrasts by paired t tests"));
  CHECK_FALSE(has(separate, "hierarchical"));
  protocol.analysis.hierarchical = true;
  const std::string text = methods_of(protocol);
  require_references(text);
  CHECK(has(text, "The 3 registered contrasts are ratios of JNDs by one model of the answers of all 2 participants"));
  CHECK(has(text, "(Venzon and Moolgavkar 1988; alpha = 0.05)"));
  CHECK(has(text, hierarchical_assumptions(false)));
  CHECK_FALSE(has(text, "paired t test"));
  protocol.analysis.model = "differencing";
  protocol.analysis.jnd_method = "ml";
  CHECK(has(methods_of(protocol), "with the criterion t, where x is"));
}

TEST_CASE("the methods of a fit to counts speak of no corrected rates", "[data]") {
  Protocol protocol = tutorial();
  protocol.analysis.jnd_method = "ml";
  const std::string text = methods_of(protocol);
  CHECK_FALSE(has(text, "log-linearly"));
  CHECK(has(text, "to the counts, without any correction"));
}

TEST_CASE("the methods say how orders came about", "[data]") {
  Protocol protocol = chinello();
  protocol.design.series_order = Order::fixed;
  protocol.design.condition_order = Order::williams;
  protocol.design.sessions = 2;
  const std::string text = methods_of(protocol);
  CHECK(
      has(text, "Series came in the protocol's order. Conditions came in blocks, in the orders of a Williams square"));
  CHECK(has(text, "12 trials in each of 2 sessions"));
  CHECK(has(text, "500/900, 600/900 and 700/900 N/m"));
}

TEST_CASE("people's texts stay as they were typed in the methods", "[data]") {
  CHECK(markdown_text("a `b` **c** [d](e)") == "a \\`b\\` \\*\\*c\\*\\* \\[d\\](e)");
  CHECK(markdown_text("no_sensitivity, _x_, p < 0.05, <b>, R&D, a & b, &amp;") ==
        "no_sensitivity, \\_x\\_, p < 0.05, \\<b>, R\\&D, a & b, \\&amp;");
  CHECK(markdown_text("one\n# two") == "one # two");
  Protocol protocol = tutorial();
  protocol.title = "The `title`, **bold**";
  protocol.conditions[0].label = "**label**";
  const std::string text = methods_of(protocol);
  CHECK(has(text, "# Methods: The \\`title\\`, \\*\\*bold\\*\\*\n"));
  CHECK(has(text, "(\\*\\*label\\*\\*)"));
}

TEST_CASE("the methods say of tests and orders what was so", "[data]") {
  Protocol protocol = tutorial();
  protocol.analysis.tests.post_hoc = PostHoc::holm_t;
  CHECK(has(methods_of(protocol), "the registered contrast by a paired t test ("));
  protocol.analysis.tests.omnibus = Omnibus::none;
  protocol.analysis.contrasts.clear();
  const std::string text = methods_of(protocol);
  CHECK(has(text, "No test was registered."));
  CHECK(has(text, "pairwise tests were computed for: slope of d'"));
  CHECK_FALSE(has(text, "registered ones"));
  Protocol fixed = chinello();
  fixed.design.per_series = true;
  fixed.design.condition_order = Order::permuted;
  CHECK(has(methods_of(fixed), "another one in each series"));
  fixed.design.condition_order = Order::fixed;
  CHECK_FALSE(has(methods_of(fixed), "another one in each series"));
  CHECK(has(methods_of(shipped("adaptive-quest")), "Each condition had "));
  const std::string posterior = methods_of(shipped("adaptive-posterior"));
  CHECK(
      has(posterior, "of 24 levels each trial had the one whose answer was expected to leave the smallest posterior"));
  CHECK(has(posterior, "The threshold is the JND s, the difference at d' = 1"));
  CHECK_FALSE(has(posterior, "moves with the criterion"));
  CHECK(has(methods_of(shipped("adaptive-staircase-90")),
            "given all answers of a condition at once, by the response model"));
}

// The sentence that a report opens with never says more than the registered tests.

Protocol published() {
  return load_protocol(JND_SOURCE_DIR "/protocols/chinello2017.json");
}

// Counts of participants, "different" said so often of different pairs in each condition; shares: 0..1, by condition.
StudyResults results_of_shares(const Protocol& protocol, const std::vector<double>& shares, int participants) {
  std::vector<CellCounts> cells;
  for (int person = 0; person < participants; ++person)
    for (int condition = 0; condition < static_cast<int>(shares.size()); ++condition)
      for (int series = 0; series < 3; ++series) {
        const double share = shares[static_cast<std::size_t>(condition)];
        // People differ a little, in no condition's favour.
        const int hits = std::min(12, static_cast<int>(std::lround(12 * share)) + (person + condition + series) % 3);
        cells.push_back({fmt::format("P{:02}", person + 1), condition, series, {12, hits, 12, 2 + person % 3}});
      }
  return results_of(cells, protocol);
}

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_CASE("nothing significant is not called equal") {
  const Protocol protocol = published();
  const std::string text = verdict_text(results_of_shares(protocol, {0.6, 0.6, 0.6}, 12), protocol);
  INFO(text);
  CHECK(text.starts_with("No registered contrast is significant at 0.05 ("));
  CHECK(says(text, "which does not show that the conditions are equal."));
  CHECK(says(
      text,
      "The registered test of all conditions together (analysis of variance, Greenhouse-Geisser) is not significant (p = "));
  CHECK(says(text, "other methods that give a test"));
}

TEST_CASE("a difference is named with its direction and p") {
  const Protocol protocol = published();
  const std::string text = verdict_text(results_of_shares(protocol, {0.6, 0.3, 0.75}, 12), protocol);
  INFO(text);
  CHECK(says(text, "discrimination is finer in S than in V (slope of d' on the stiffness difference, p < .001)"));
  CHECK(says(text, "discrimination is finer in SV than in V ("));
  CHECK_FALSE(says(text, "finer in V than"));
}

TEST_CASE("where the hierarchical model is registered the verdict is of its ratios", "[long]") {
  Protocol protocol = published();
  protocol.analysis.hierarchical = true;
  const StudyResults results = results_of_shares(protocol, {0.6, 0.3, 0.75}, 12);
  const std::string text = verdict_text(results, protocol);
  INFO(text);
  CHECK(says(text, "discrimination is finer in S than in V (JNDs of the hierarchical model, ratio 0."));
  CHECK(says(text, "discrimination is finer in SV than in V (JNDs of the hierarchical model, ratio "));
  CHECK_FALSE(says(text, "finer in V than"));
  CHECK_FALSE(says(text, "other methods"));  // they test something else
}

// Where nothing tells the JNDs the ends of their ratios are long to find.
TEST_CASE("by the hierarchical model answers of chance have no ratio, whatever its p", "[long]") {
  Protocol protocol = published();
  protocol.analysis.hierarchical = true;
  const std::string chance = verdict_text(results_of_shares(protocol, {0.25, 0.25, 0.25}, 12), protocol);
  INFO(chance);
  CHECK_FALSE(says(chance, "nan"));
}

TEST_CASE("ranks have no direction, groups of one cannot be tested, one condition has nothing to compare") {
  Protocol protocol = published();
  protocol.analysis.tests.post_hoc = PostHoc::wilcoxon;
  const std::string ranks = verdict_text(results_of_shares(protocol, {0.6, 0.3, 0.75}, 12), protocol);
  INFO(ranks);
  CHECK(says(ranks, "S and V differ ("));
  CHECK_FALSE(says(ranks, "finer"));
  protocol.analysis.tests.post_hoc = PostHoc::holm_t;
  const std::string alone = verdict_text(results_of_shares(protocol, {0.6, 0.3, 0.75}, 1), protocol);
  INFO(alone);
  CHECK(says(alone, "No registered contrast could be tested."));
  CHECK_FALSE(says(alone, "significant"));
  protocol.analysis.contrasts.clear();
  protocol.analysis.tests.omnibus = Omnibus::none;
  CHECK(verdict_text(results_of_shares(protocol, {0.6, 0.3, 0.75}, 12), protocol)
            .starts_with("The protocol registers no test of the conditions."));
}

TEST_CASE("of two conditions the test of all is told where it is another than the contrast's") {
  Protocol protocol = published();
  protocol.conditions.resize(2);
  std::erase_if(protocol.analysis.contrasts, [](const auto& contrast) { return contrast.a > 1 || contrast.b > 1; });
  REQUIRE(protocol.analysis.contrasts.size() == 1);
  const auto tells_of_all = [&protocol](Omnibus omnibus, PostHoc post_hoc) {
    protocol.analysis.tests.omnibus = omnibus;
    protocol.analysis.tests.post_hoc = post_hoc;
    return says(verdict_text(results_of_shares(protocol, {0.6, 0.3}, 8), protocol), "test of all conditions together");
  };
  CHECK_FALSE(tells_of_all(Omnibus::anova, PostHoc::holm_t));
  CHECK(tells_of_all(Omnibus::friedman, PostHoc::holm_t));
  CHECK(tells_of_all(Omnibus::friedman, PostHoc::wilcoxon));
  CHECK(tells_of_all(Omnibus::anova, PostHoc::wilcoxon));
}

TEST_CASE("a p is never rounded to the other side of alpha") {
  CHECK(p_in_words(0.1427, 0.05) == ".143");
  CHECK(p_in_words(0.0499999, 0.05) == ".0499999");
  CHECK(p_in_words(0.0501, 0.05) == ".050");  // which is not below it
  CHECK(p_in_words(0.05, 0.05) == ".050");
  CHECK(p_in_words(2e-7, 0.05) == "< .001");
  CHECK(p_in_words(1, 0.05) == "1.000");
  CHECK(p_in_words(1e-5, 2e-5) == ".00001");
  REQUIRE(rc::check("whatever the p", [] {
    const double p = *rc::gen::inRange(1, 1000000) / 1e6, alpha = *rc::gen::inRange(1, 200) / 1000.0;
    const std::string text = p_in_words(p, alpha);
    if (text.front() == '.') RC_ASSERT((std::stod(text) < alpha) == (p < alpha));
  }));
}

// What the sentence says of each contrast is what its registered p says, whatever the data.
TEST_CASE("the verdict says what the tests say", "[long]") {
  const Protocol protocol = published();
  int significant = 0, not_significant = 0;
  REQUIRE(rc::check("of random studies", [&] {
    std::vector<double> shares;
    for (int i = 0; i < 3; ++i) shares.push_back(*rc::gen::inRange(1, 10) / 10.0);
    const StudyResults results = results_of_shares(protocol, shares, *rc::gen::inRange(2, 8));
    const std::string text = verdict_text(results, protocol);
    int found = 0, others = 0, untested = 0;
    for (const ContrastRow& row : results.contrasts) {
      if (!row.registered) continue;
      const std::string& a = condition_name(protocol, row.a);
      const std::string& b = condition_name(protocol, row.b);
      const bool named = says(text, fmt::format("finer in {} than in {} ", a, b));
      const bool turned = says(text, fmt::format("finer in {} than in {} ", b, a));
      RC_ASSERT(named == (row.p_registered < 0.05 && row.difference.mean > 0));
      RC_ASSERT(turned == (row.p_registered < 0.05 && row.difference.mean < 0));
      found += row.p_registered < 0.05 ? 1 : 0;
      others += row.p_registered >= 0.05 ? 1 : 0;
      untested += std::isnan(row.p_registered) ? 1 : 0;
    }
    RC_ASSERT(says(text, "No registered contrast") == (found == 0));
    RC_ASSERT(says(text, "could not be tested") == (untested > 0 && untested < 3));
    RC_ASSERT(says(text, "The other two contrasts are not significant") == (found == 1 && others == 2));
    const bool all = omnibus_p(results.comparisons.front().comparison, protocol.analysis) < 0.05;
    RC_ASSERT(says(text, "Greenhouse-Geisser) is significant") == all);
    significant += found;
    not_significant += others;
  }));
  CHECK(significant > 20);
  CHECK(not_significant > 20);
}

}  // namespace
}  // namespace jnd
