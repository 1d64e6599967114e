// The methods in words: nothing that is not so, and every reference cited.
#include "data/methods/methods_text.h"

#include <algorithm>
#include <regex>
#include <set>

#include "data/methods/markdown_text.h"
#include "data/methods/references.h"
#include "protocols/random_stream.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

Protocol shipped(const std::string& name) {
  return load_protocol(std::string(JND_SOURCE_DIR) + "/protocols/" + name + ".json");
}

std::string methods_of(const Protocol& protocol) {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.sqlite", protocol);
  for (int number = 1; number <= 2 && !protocol.design.procedure; ++number) run_whole_session(*study, protocol, number);
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

TEST_CASE("what the methods cite is listed in full, and nothing else", "[data]") {
  for (const char* name :
       {"chinello2017", "adaptive-staircase", "adaptive-quest", "adaptive-posterior", "adaptive-staircase-90"}) {
    CAPTURE(name);
    const std::string text = methods_of(shipped(name));
    const std::size_t list = text.find("\n## References\n");
    REQUIRE(list != std::string::npos);
    const std::size_t begin = text.find("\n## Design\n");
    const std::string body = text.substr(begin, list - begin);
    std::set<std::string> cited;
    const std::regex citation(R"([A-Z][A-Za-z-]+( and [A-Z][a-z]+| et al\.)? (19|20)\d\d)");
    for (std::sregex_iterator found(body.begin(), body.end(), citation), end; found != end; ++found)
      cited.insert(found->str());
    for (const std::string& one : cited) {
      CAPTURE(one);
      CHECK_FALSE(references_of(one).empty());
    }
    CHECK(text.substr(list) == references_of(body));
    const auto lines = std::count(text.begin() + static_cast<std::ptrdiff_t>(list), text.end(), '\n');
    CHECK(lines == static_cast<std::ptrdiff_t>(cited.size()) + 3);
  }
  const std::string constant = methods_of(shipped("chinello2017"));
  CHECK_FALSE(has(constant, "Levitt"));
  CHECK_FALSE(has(constant, "Watson"));
  CHECK(has(constant, "Corrections for extreme proportions and their biasing effects on estimated values of d'."));
  CHECK(references_of("no work at all").empty());
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

}  // namespace
}  // namespace jnd
