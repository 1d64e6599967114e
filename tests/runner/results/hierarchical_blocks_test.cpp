// The hierarchical model as tables and JSON: what is ok is not said, what is missing has its reason.
#include <algorithm>

#include <nlohmann/json.hpp>

#include "data/blocks/result_blocks.h"
#include "data/results/hierarchical_words.h"
#include "runner/results/block_output.h"
#include "tests/catch.h"
#include "tests/runner/report_fixture.h"

using namespace jnd;

namespace {

StudyResults with_model(const Protocol& protocol, int participants) {
  StudyResults results = invented_study(protocol, participants);
  results.hierarchical = study_hierarchical(results.task, protocol);
  return results;
}

Block block_of(const StudyResults& results, const Protocol& protocol, const std::string& id) {
  const Blocks blocks = hierarchical_blocks(results, protocol);
  const Block* const found = block_named(blocks, id);
  if (found == nullptr) throw std::runtime_error("no block " + id);
  return *found;
}

ResultTable table_named(const StudyResults& results, const Protocol& protocol, const std::string& id) {
  return table_of(block_of(results, protocol, id));
}

nlohmann::ordered_json json_named(const StudyResults& results, const Protocol& protocol, const std::string& id) {
  return json_rows(block_of(results, protocol, id));
}

bool says(const ResultTable& table, std::string_view words) {
  return std::any_of(table.footnotes.begin(), table.footnotes.end(),
                     [words](const std::string& note) { return note.find(words) != std::string::npos; });
}

TEST_CASE("the hierarchical model has its blocks where it was added") {
  const Protocol protocol = published_protocol();
  StudyResults results = invented_study(protocol, 9);
  CHECK(hierarchical_blocks(results, protocol).empty());
  results = with_model(protocol, 9);
  for (const Block& block : hierarchical_blocks(results, protocol))
    CHECK(block.section == (block.id == "hierarchical_people" ? Section::participants : Section::tests));
  const ResultTable group = table_named(results, protocol, "hierarchical");
  CHECK(group.rows.size() == 3);
  CHECK(says(group, "one JND for all conditions"));
  CHECK(says(group, "standard deviation between people"));
  CHECK(group.footnotes.back() == hierarchical_assumptions(*results.hierarchical));
  const ResultTable ratios = table_named(results, protocol, "hierarchical_ratios");
  CHECK(ratios.rows.size() == 3);
  CHECK(ratios.rows.front().front() == "S : V");
  const ResultTable check = table_named(results, protocol, "hierarchical_check");
  REQUIRE(check.rows.size() == 3 * 4);
  CHECK(check.rows.front().front() == "S");
  CHECK(says(check, "The model d"));
  CHECK(check.footnotes.back() == kPredictiveMeaning);
  const nlohmann::ordered_json checked = json_named(results, protocol, "hierarchical_check");
  CHECK(checked.at(1).at("draws") == kPredictiveDraws);
  CHECK(checked.at(1).at("drawn_status") == "inside");
  CHECK(checked.at(1).at("discrepancy_p") > 0);
  const ResultTable left_out = table_named(results, protocol, "hierarchical_variants");
  REQUIRE(left_out.rows.size() == 4);  // drift has two parameters
  CHECK(left_out.rows[1].front() == "ln JND, second half less first");
  CHECK(left_out.rows[1].back() == "not_identified");  // of counts alone
  CHECK(json_named(results, protocol, "hierarchical_variants").at(1).at("status") == "not_identified");
  const ResultTable with_that = table_named(results, protocol, "hierarchical_variant_jnds");
  REQUIRE(with_that.rows.size() == 2 * 3);
  CHECK(with_that.rows[3].front() == "lapse");
  CHECK(json_named(results, protocol, "hierarchical_variant_jnds").at(0).at("width_ratio") >= 0.999);
  const ResultTable people = table_named(results, protocol, "hierarchical_people");
  CHECK(people.rows.size() == 27);
  CHECK(people.rows[1].front().empty());  // named once
  CHECK(people.columns.back().name == "criterion");

  StudyHierarchical& model = *results.hierarchical;
  model.check->rows[2].share.status = BandStatus::below;
  model.check->rows[2].between.status = BandStatus::above;
  const ResultTable outside = table_named(results, protocol, "hierarchical_check");
  CHECK(outside.columns.back().name == "outside");
  CHECK(outside.rows[2].back() == "share below, sd above");
  model.check.reset();
  CHECK_THROWS(block_of(results, protocol, "hierarchical_check"));
  model.people[3].status = ShrunkenStatus::missing;
  model.people[4].separate_status = JndStatus::no_sensitivity;
  const ResultTable odd = table_named(results, protocol, "hierarchical_people");
  CHECK(odd.columns.back().name == "status");
  CHECK(odd.rows[3].back() == "missing");
  CHECK(odd.rows[0].back().empty());
  CHECK(odd.rows[4][3] == "no_sensitivity");
}

TEST_CASE("what limits the numbers of the hierarchical model is said beside them") {
  const Protocol protocol = published_protocol();
  StudyResults results = with_model(protocol, 4);
  StudyHierarchical& model = *results.hierarchical;
  const auto table = [&](const std::string& id) { return table_named(results, protocol, id); };
  REQUIRE(says(table("hierarchical"), "4 participants are few: "));
  results.cautions = model.cautions;
  CHECK_FALSE(says(table("hierarchical"), "are few"));  // it is said of the study
  results.cautions.clear();

  model.conditions[0].ci_low = model.conditions[0].ci_high = kNaN;
  model.conditions[0].ci_status = EndsStatus::out_of_work;
  model.conditions[1].status = SlopeStatus::one_answer;
  model.ratios[0].ci_low = model.ratios[0].ci_high = kNaN;
  model.ratios[0].ci_status = EndsStatus::not_converged;
  model.persons = {SpreadStatus::at_limit, 2};
  CHECK_FALSE(model.alike());
  CHECK_FALSE(are_alike(SpreadStatus::zero, SpreadStatus::by_condition));
  CHECK(are_alike(SpreadStatus::zero, SpreadStatus::not_asked));
  HierarchicalFit fit;
  fit.conditions.resize(2);
  fit.conditions[1].tv_status = SpreadStatus::at_limit;
  const std::vector<std::string> said = hierarchical_cautions(fit, {"PV", "S"}, {});
  CHECK(std::any_of(said.begin(), said.end(),
                    [](const std::string& one) { return one.starts_with("at_limit (between persons in S (tv))"); }));
  const ResultTable group = table("hierarchical");
  CHECK(group.rows[0].back() == "interval out_of_work");
  CHECK(group.rows[1].back() == "one_answer");
  CHECK(group.rows[2].back() == "ok");
  CHECK(says(group, "at_limit 2.00 of ln JND"));
  CHECK(table("hierarchical_ratios").rows[0].back() == "interval not_converged");
  const nlohmann::ordered_json json = json_named(results, protocol, "hierarchical");
  CHECK(json.at(0).at("ci_status") == "out_of_work");
  CHECK(json.at(0).at("ci_low").is_null());

  model.status = HierarchicalStatus::not_converged;
  const ResultTable unsettled = table("hierarchical");
  CHECK(unsettled.rows[0].back() == "not_converged, interval out_of_work");
  CHECK(unsettled.rows[1].back() == "one_answer");
  CHECK_FALSE(table("hierarchical_people").rows.empty());
}

TEST_CASE("where there is no hierarchical model, its table and JSON say why") {
  const Protocol protocol = published_protocol();
  const StudyResults results = results_of(
      results_of_counts(invented_counts(protocol, 201, 5), protocol, SessionKind::simulated), 201, protocol, true);
  const ResultTable group = table_named(results, protocol, "hierarchical");
  CHECK(group.rows.front().back() == "too_many_people");
  CHECK(says(group, "no model: it is left out above 200 participants"));
  CHECK_THROWS(block_of(results, protocol, "hierarchical_people"));
  for (const char* const id : {"hierarchical_ratios", "hierarchical_variants", "hierarchical_variant_jnds"})
    CHECK(table_named(results, protocol, id).rows.empty());
  const nlohmann::ordered_json json = json_named(results, protocol, "hierarchical").at(0);
  CHECK(json.at("status") == "too_many_people");
  CHECK(json.at("observer") == "yes_no");
  for (const char* const key : {"jnd", "sd_persons", "sd_persons_status", "equal_p"}) CHECK(json.at(key).is_null());
}

}  // namespace
