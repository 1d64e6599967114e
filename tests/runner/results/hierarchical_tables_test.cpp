// The tables and the JSON of the hierarchical model: what is ok is not said, what is missing has its reason.
#include <algorithm>

#include <nlohmann/json.hpp>

#include "data/results/hierarchical_words.h"
#include "runner/results/result_table_parts.h"
#include "runner/results/result_tables.h"
#include "tests/catch.h"
#include "tests/runner/report_fixture.h"

using namespace jnd;

namespace {

const ResultTable& table_named(const std::vector<ResultTable>& tables, std::string_view id) {
  const auto found =
      std::find_if(tables.begin(), tables.end(), [&](const ResultTable& table) { return table.id == id; });
  if (found == tables.end()) throw std::runtime_error("no table " + std::string(id));
  return *found;
}

bool says(const ResultTable& table, std::string_view words) {
  return std::any_of(table.footnotes.begin(), table.footnotes.end(),
                     [words](const std::string& note) { return note.find(words) != std::string::npos; });
}

TEST_CASE("the hierarchical model has its tables where it was added") {
  const Protocol protocol = published_protocol();
  StudyResults results = invented_study(protocol, 9);
  for (const ResultTable& table : result_tables(results, protocol)) CHECK_FALSE(table.id.starts_with("hierarchical"));
  add_hierarchical(results, protocol);
  const std::vector<ResultTable> tables = result_tables(results, protocol);
  const ResultTable& group = table_named(tables, "hierarchical");
  CHECK(group.rows.size() == 3);
  CHECK(section_of(group) == Section::tests);
  CHECK(says(group, "one JND for all conditions"));
  CHECK(says(group, "standard deviation between people"));
  CHECK(group.footnotes.back() == hierarchical_assumptions(false));
  const ResultTable& ratios = table_named(tables, "hierarchical-ratios");
  CHECK(ratios.rows.size() == 3);
  CHECK(ratios.rows.front().front() == "S : V");
  CHECK(section_of(ratios) == Section::tests);
  const ResultTable& check = table_named(tables, "hierarchical-check");
  REQUIRE(check.rows.size() == 3 * 4);
  CHECK(check.rows.front().front() == "S");
  CHECK(section_of(check) == Section::tests);
  CHECK(says(check, "The model d"));
  CHECK(check.footnotes.back() == kPredictiveMeaning);
  const nlohmann::ordered_json json =
      hierarchical_json(*results.hierarchical, protocol, SessionKind::simulated).at("check");
  CHECK(json.at("draws") == kPredictiveDraws);
  CHECK(json.at("rows").size() == 12);
  CHECK(json.at("rows").at(1).at("share_status") == "inside");
  CHECK(json.at("p") > 0);
  const ResultTable& left_out = table_named(tables, "hierarchical-variants");
  REQUIRE(left_out.rows.size() == 4);  // drift has two parameters
  CHECK(left_out.rows[1].front() == "ln JND, second half less first");
  CHECK(left_out.rows[1].back() == "not_identified");  // of counts alone
  CHECK(section_of(left_out) == Section::tests);
  const ResultTable& with_that = table_named(tables, "hierarchical-variant-jnds");
  REQUIRE(with_that.rows.size() == 2 * 3);
  CHECK(with_that.rows[3].front() == "lapse");
  CHECK(section_of(with_that) == Section::tests);
  const nlohmann::ordered_json variants =
      hierarchical_json(*results.hierarchical, protocol, SessionKind::simulated).at("variants");
  REQUIRE(variants.size() == 4 * 3);
  CHECK(variants.at(3).at("status") == "not_identified");
  CHECK(variants.at(3).at("jnd").is_null());
  CHECK(variants.at(0).at("width_ratio") >= 0.999);
  const ResultTable& people = table_named(tables, "hierarchical-people");
  CHECK(people.rows.size() == 27);
  CHECK(section_of(people) == Section::participants);
  CHECK(people.rows[1].front().empty());  // named once
  CHECK(people.columns.back().name == "criterion");

  StudyHierarchical& model = *results.hierarchical;
  model.check->rows[2].share.status = BandStatus::below;
  model.check->rows[2].between.status = BandStatus::above;
  const ResultTable outside = hierarchical_check_table(results, protocol);
  CHECK(outside.columns.back().name == "outside");
  CHECK(outside.rows[2].back() == "share below, sd above");
  model.check.reset();
  CHECK(hierarchical_check_table(results, protocol).rows.empty());
  model.people[3].status = ShrunkenStatus::missing;
  model.people[4].separate_status = JndStatus::no_sensitivity;
  const ResultTable odd = hierarchical_people_table(results, protocol);
  CHECK(odd.columns.back().name == "status");
  CHECK(odd.rows[3].back() == "missing");
  CHECK(odd.rows[0].back().empty());
  CHECK(odd.rows[4][3] == "no_sensitivity");
}

TEST_CASE("what limits the numbers of the hierarchical model is said beside them") {
  const Protocol protocol = published_protocol();
  StudyResults results = invented_study(protocol, 4);
  add_hierarchical(results, protocol);
  StudyHierarchical& model = *results.hierarchical;
  REQUIRE(says(hierarchical_table(results, protocol), "4 participants are few: "));
  results.cautions = model.cautions;
  CHECK_FALSE(says(hierarchical_table(results, protocol), "are few"));  // it is said of the study
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
  const ResultTable group = hierarchical_table(results, protocol);
  CHECK(group.rows[0].back() == "interval out_of_work");
  CHECK(group.rows[1].back() == "one_answer");
  CHECK(group.rows[2].back() == "ok");
  CHECK(says(group, "at_limit 2.00 of ln JND"));
  CHECK(hierarchical_ratios_table(results, protocol).rows[0].back() == "interval not_converged");
  const nlohmann::ordered_json json = hierarchical_json(model, protocol, SessionKind::simulated);
  CHECK(json.at("conditions").at(0).at("ci_status") == "out_of_work");
  CHECK(json.at("conditions").at(0).at("ci_low").is_null());
  CHECK(json.at("cautions").size() == model.cautions.size());

  model.status = HierarchicalStatus::not_converged;
  const ResultTable unsettled = hierarchical_table(results, protocol);
  CHECK(unsettled.rows[0].back() == "not_converged, interval out_of_work");
  CHECK(unsettled.rows[1].back() == "one_answer");
  CHECK_FALSE(hierarchical_people_table(results, protocol).rows.empty());
  CHECK_FALSE(hierarchical_json(model, protocol, SessionKind::simulated).at("people").empty());
}

TEST_CASE("where there is no hierarchical model, its table and JSON say why") {
  const Protocol protocol = published_protocol();
  StudyResults results =
      results_of(analyze_counts(invented_counts(protocol, 201, 5), protocol, SessionKind::simulated), protocol);
  add_hierarchical(results, protocol);
  const std::vector<ResultTable> tables = result_tables(results, protocol);
  const ResultTable& group = table_named(tables, "hierarchical");
  CHECK(group.rows.front().back() == "too_many_people");
  CHECK(says(group, "no model: it is left out above 200 participants"));
  CHECK_THROWS(table_named(tables, "hierarchical-people"));
  const nlohmann::ordered_json json = hierarchical_json(*results.hierarchical, protocol, SessionKind::simulated);
  CHECK(json.at("status") == "too_many_people");
  CHECK(json.at("observer") == "yes_no");
  CHECK(json.at("sd").is_null());
  CHECK(json.at("equal").is_null());
  CHECK(json.at("check").is_null());
  CHECK(json.at("people").empty());
  CHECK(json.at("variants").empty());
  CHECK(json.at("conditions").at(0).at("jnd").is_null());
  CHECK(json.at("conditions").at(0).at("status") == "too_many_people");
}

}  // namespace
