// The tables and the JSON of groups of participants.
#include <cmath>

#include <fmt/format.h>

#include "data/fields/between_fields.h"
#include "runner/calc/calc_group.h"
#include "runner/results/analysis_text.h"
#include "runner/results/field_output.h"
#include "runner/results/result_format.h"
#include "runner/results/result_table_parts.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

const char* test_title(BetweenTest test) {
  switch (test) {
    case BetweenTest::welch:
      return "Welch's t of each pair, of participants' means over their conditions; p(Holm): over the pairs";
    case BetweenTest::mann_whitney:
      return "Mann-Whitney test of each pair, of participants' means over their conditions; p(Holm): over the pairs";
    case BetweenTest::mixed_anova:
      return "analysis of variance with groups between and conditions within participants; p(GG), p(HF): corrected "
             "for sphericity";
    case BetweenTest::none:
      break;
  }
  return "";
}

// For `jnd calc compare`'s form of the whole comparison.
GroupedLongTable named_table(const GroupsCompared& groups, const Protocol& protocol) {
  GroupedLongTable table{group_names(protocol), {}, groups.table};
  if (groups.test == BetweenTest::mixed_anova)
    for (const int condition : conditions_of(protocol, 0))
      table.conditions.push_back(condition_name(protocol, condition));
  return table;
}

}  // namespace

ResultTable groups_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"groups", "Groups of participants", "", {}, {}, {}};
  if (!results.groups) return table;
  const GroupsCompared& groups = *results.groups;
  const TableMaker of(group_mean_fields(protocol, attendance_of(results).kind));
  table.note = fmt::format("{}{}{}; means with Student's 95 % interval", groups.title, groups.unit.empty() ? "" : ", ",
                           groups.unit);
  using Row = GroupMeanRow;
  const auto condition = [&](const Row& row) {
    return row.mean->condition < 0 ? std::string("mean of them") : condition_text(protocol, row.mean->condition);
  };
  table = of(std::move(table),
             {of("group"), of.words("condition", condition), of.share("n_used", "participants", "n used"), of("mean"),
              of.range("ci95_low", "ci95_high"), of("sd"), of("median")},
             group_mean_rows(groups));
  for (std::size_t i = table.rows.size(); i-- > 1;)  // a group is named once
    if (table.rows[i].front() == table.rows[i - 1].front()) table.rows[i].front().clear();
  if (groups.test != BetweenTest::none && !groups.refused.empty())
    table.footnotes.push_back("no test of the groups: " + groups.refused);
  return table;
}

ResultTable between_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"between", "Groups compared", "", {}, {}, {}};
  if (!results.groups || !results.groups->tested()) return table;
  const GroupsCompared& groups = *results.groups;
  const TableMaker of(between_fields(protocol, attendance_of(results).kind));
  table.note = fmt::format("{}; outcome: {}; {} participants", test_title(groups.test), groups.title,
                           groups.participants.size());
  for (const LeftOut& one : groups.left_out)
    table.footnotes.push_back(fmt::format("left out: {} ({})", one.participant, one.reason));
  using Row = BetweenRow;
  const auto status = [&](const Row& row) {
    const std::string text = of.text("status", row);
    return text == "ok" ? "" : text;
  };
  std::vector<TableColumn<Row>> columns;
  if (groups.test == BetweenTest::mixed_anova) {
    columns = {
        of("effect"),
        of("f"),
        of.words(
            "df", [](const Row& row) { return fmt::format("{:g}, {:g}", row.tested->df1, row.tested->df2); }, true),
        of("p"),
        of("p_gg"),
        of("p_hf"),
        of("eta2_generalised"),
        of("eta2_partial")};
    if (groups.comparison.anova.unequal)
      table.footnotes.emplace_back(
          "the groups differ in size: sums of squares are of type I (group, condition, group x condition)");
  } else {
    columns = {
        of.words("pair", [&](const Row& row) { return of.text("group_a", row) + " - " + of.text("group_b", row); }),
        of.share("n_a", "n_b", "n", " and "), of("mean_difference")};
    if (groups.test == BetweenTest::welch)
      columns.insert(columns.end(),
                     {of.range("ci95_low", "ci95_high"), of("t"), of("df"), of("p"), of("p_holm"), of("d")});
    else
      columns.insert(columns.end(), {of("w"), of("p"), of("p_holm"), of("rank_biserial")});
  }
  columns.push_back(of.words("cautions", status));
  return of(std::move(table), columns, between_rows(groups));
}

nlohmann::ordered_json groups_json(const StudyResults& results, const Protocol& protocol) {
  const GroupsCompared& groups = *results.groups;
  Json out = {{"test", to_string(groups.test)},
              {"outcome", groups.outcome},
              {"title", groups.title},
              {"unit", groups.unit},
              {"n_used", groups.participants.size()},
              {"left_out", Json::array()},
              {"refused", groups.refused.empty() ? Json(nullptr) : Json(groups.refused)},
              {"means", Json::array()},
              {"comparison", nullptr}};
  for (const LeftOut& one : groups.left_out)
    out["left_out"].push_back({{"participant", one.participant}, {"reason", one.reason}});
  const auto fields = group_mean_fields(protocol, attendance_of(results).kind);
  for (const GroupMeanRow& row : group_mean_rows(groups))
    out["means"].push_back(
        json_of(fields, row,
                {"group", "condition", "participants", "n_used", "mean", "sd", "ci95_low", "ci95_high", "median"}));
  if (groups.tested()) out["comparison"] = groups_json(named_table(groups, protocol), groups.comparison);
  return out;
}

}  // namespace jnd
