// The sentence that a report opens with never says more than the registered tests.
#include "data/methods/verdict_text.h"

#include <cmath>
#include <regex>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/data/pair_results.h"

namespace jnd {
namespace {

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
