// The tables and the JSON of the hierarchical model.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/fields/hierarchical_fields.h"
#include "protocols/tasks/task.h"
#include "runner/calc_hierarchical/calc_hierarchical_check.h"
#include "runner/results/field_output.h"
#include "runner/results/result_format.h"
#include "runner/results/result_table_parts.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

// "0.24 between persons (ln JND)", or why there is no number.
std::string spread_text(const HierarchicalSpread& spread, const std::string& of) {
  if (std::isnan(spread.sd)) return fmt::format("not identified {}", of);
  return fmt::format("{}{} {}", spread.status == SpreadStatus::at_limit ? "at_limit " : "", number_text(spread.sd, 2),
                     of);
}

std::string spreads_by_condition_text(const StudyHierarchical& model, const Protocol& protocol) {
  if (model.by_condition.status != SpreadStatus::by_condition)
    return spread_text(model.by_condition, "of ln JND by condition");
  std::vector<std::string> each;
  for (const HierarchicalCondition& one : model.conditions)
    each.push_back(
        spread_text(one.spread, "of ln JND in " + protocol.conditions[static_cast<std::size_t>(one.condition)].name));
  return fmt::format("{}", fmt::join(each, ", "));
}

bool is_choice(const StudyHierarchical& model) {
  return model.response == ResponseModel::choice;
}

// Whether a row needs to say of which standard it is.
bool shows_standards(const Protocol& protocol) {
  return !task_of(protocol.task.kind).has_own_results() && protocol.series.size() > 1;
}

// What an answer is taken to go by.
std::string observer_words(const StudyHierarchical& model, const Protocol& protocol) {
  if (!model.response) return "";
  switch (*model.response) {
    case ResponseModel::yes_no:
      return task_of(protocol.task.kind).has_own_results() ? ", decided on the difference"
                                                           : ", decided on the distance of the signal from the noise";
    case ResponseModel::differencing:
      return ", decided on the size of the difference";
    case ResponseModel::independent:
      return ", decided on each interval by itself";
    case ResponseModel::choice:
      break;
  }
  return fmt::format(", without an effect of the order{}",
                     model.lapse > 0 ? fmt::format(", with a lapse rate of {:g}", model.lapse) : "");
}

std::string criteria_text(const StudyHierarchical& model, const Protocol& protocol) {
  if (model.pse_at_standard) return "; the PSE is taken as the standard, as all comparisons lie on one side of it";
  if (!is_choice(model)) return "; " + spread_text(model.criteria, "of the criterion");
  const std::string of =
      fmt::format("of the PSE, {}", model.several_standards ? "as a share of the standard"
                                                            : "in " + std::string(to_string(protocol.stimulus.unit)));
  return "; " + spread_text(model.criteria, of);
}

std::string equality_text(const StudyHierarchical& model) {
  return fmt::format("one JND for all conditions: chi-square {} with {} df, p {}", number_text(model.equal_lr, 2),
                     model.equal_df, p_value_text(model.equal_p));
}

Json spread_json(const HierarchicalSpread& spread) {
  return {{"sd", json_value(spread.sd)}, {"status", word_of(kSpreadStatusWords, spread.status)}};
}

template <typename Row>
Json rows_json(const Fields<Row>& fields, const std::vector<Row>& rows, const std::vector<std::string>& keys) {
  Json all = Json::array();
  for (const Row& row : rows) all.push_back(json_of(fields, row, keys));
  return all;
}

}  // namespace

ResultTable hierarchical_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"hierarchical", "The group by the hierarchical model", "", {}, {}, {}};
  if (!results.hierarchical || results.hierarchical->people.empty()) return table;
  const StudyHierarchical& model = *results.hierarchical;
  table.note =
      fmt::format("one model of everybody's answers{}; {}: of the median person, with 95 % profile likelihood; {}",
                  observer_words(model, protocol), jnd_title(protocol),
                  protocol.analysis.hierarchical ? "registered for the contrasts" : "not registered");
  const TableMaker of(hierarchical_fields(protocol, attendance_of(results).kind));
  using Row = HierarchicalConditionRow;
  std::vector<TableColumn<Row>> columns = {of("condition")};
  if (shows_standards(protocol)) columns.push_back(of("standard"));
  columns.insert(columns.end(), {of("n"), of("jnd"), of.range("ci_low", "ci_high"), of("weber")});
  if (!is_choice(model))
    columns.push_back(of("criterion", model.response == ResponseModel::differencing ? "ln tau" : "criterion"));
  else if (!model.pse_at_standard)
    columns.insert(columns.end(), {of("pse"), of.range("pse_low", "pse_high")});
  columns.push_back(of.words("status", [&of](const Row& row) {
    const EndsStatus interval = row.one->ci_status == EndsStatus::ok ? row.one->pse_status : row.one->ci_status;
    return status_with_interval(of.text("status", row), interval);
  }));
  table = of(std::move(table), columns, hierarchical_rows(model));
  if (!model.fitted()) {
    table.footnotes.push_back("no model: " + model.reason);
    return table;
  }
  if (model.equal_df > 0) table.footnotes.push_back(equality_text(model));
  table.footnotes.push_back(fmt::format("standard deviation between people: {}; {}{}",
                                        spread_text(model.persons, "of ln JND"),
                                        spreads_by_condition_text(model, protocol), criteria_text(model, protocol)));
  for (const std::string& one : model.cautions)  // those of a registered model are said of the study
    if (std::find(results.cautions.begin(), results.cautions.end(), one) == results.cautions.end())
      table.footnotes.push_back(one);
  table.footnotes.push_back(hierarchical_assumptions(model));
  return table;
}

ResultTable hierarchical_ratios_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"hierarchical-ratios", "Ratios of conditions by the hierarchical model", "", {}, {}, {}};
  if (!results.hierarchical) return table;
  table.note =
      fmt::format("{0} of the first / {0} of the second; p: likelihood ratio, each alone", jnd_title(protocol));
  const TableMaker of(hierarchical_ratio_fields(protocol, attendance_of(results).kind));
  using Row = HierarchicalRatio;
  std::vector<TableColumn<Row>> columns = {
      of.words("conditions", [&](const Row& row) { return of.text("a", row) + " : " + of.text("b", row); })};
  if (shows_standards(protocol)) columns.push_back(of("standard"));
  columns.insert(columns.end(), {of("participants"), of("ratio"), of.range("ci_low", "ci_high"), of("lr"), of("p"),
                                 of.words("status", [&of](const Row& row) {
                                   return status_with_interval(of.text("status", row), row.ci_status);
                                 })});
  return of(std::move(table), columns, results.hierarchical->ratios);
}

ResultTable hierarchical_check_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"hierarchical-check", "Posterior predictive check of the hierarchical model", "", {}, {}, {}};
  if (!results.hierarchical || !results.hierarchical->check) return table;
  const PredictiveCheck& check = *results.hierarchical->check;
  table.note =
      fmt::format("answers beside those that the model draws for the same people; sd of people: of their shares{}",
                  results.hierarchical->response == ResponseModel::independent
                      ? "; below 0: equal stimuli, of the series with that difference"
                      : "");
  const TableMaker of(hierarchical_check_fields(protocol, attendance_of(results).kind));
  using Row = HierarchicalCheckRow;
  const auto outside = [](const Row& row) {
    std::string text;
    for (const auto& [name, band] : {std::pair{"share", &row.one->share}, {"sd", &row.one->between}})
      if (band->status == BandStatus::below || band->status == BandStatus::above)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, word_of(kBandStatusWords, band->status));
    return text;
  };
  std::vector<TableColumn<Row>> columns = {of("condition"), of("difference"), of("trials"), of("share"),
                                           of.range("share_low", "share_high", "95 % of drawn")};
  if (results.hierarchical->participants > 1)
    columns.insert(columns.end(), {of("sd"), of.range("sd_low", "sd_high", "95 % of drawn")});
  if (check.outside() > 0) columns.push_back(of.words("outside", outside));
  table = of(std::move(table), columns, hierarchical_check_rows(*results.hierarchical));
  table.footnotes.push_back(predictive_verdict(check));
  table.footnotes.emplace_back(kPredictiveMeaning);
  return table;
}

ResultTable hierarchical_variants_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"hierarchical-variants", "What the hierarchical model leaves out", "", {}, {}, {}};
  if (!results.hierarchical) return table;
  table.note = "each estimated in a model of its own, the same for everybody; p: likelihood ratio of none";
  const TableMaker of(hierarchical_variant_fields(protocol, attendance_of(results).kind));
  using Row = HierarchicalVariantRow;
  std::vector<Row> rows = hierarchical_variant_rows(*results.hierarchical);
  std::erase_if(rows, [](const Row& row) { return row.with != row.of->conditions.data(); });
  const auto title = [&](const Row& row) {
    return std::string(title_of(row.shared->parameter, is_choice(*results.hierarchical)));
  };
  return of(std::move(table),
            {of.words("left out", title), of("estimate"), of.range("estimate_low", "estimate_high"), of("lr"), of("p"),
             of.words("status",
                      [&of](const Row& row) {
                        return status_with_interval(of.text("status", row), row.shared->ends.status);
                      })},
            rows);
}

ResultTable hierarchical_variant_jnds_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"hierarchical-variant-jnds", "The group with that in the model", "", {}, {}, {}};
  if (!results.hierarchical) return table;
  table.note =
      "times as wide: the interval of ln JND, compared with the one above; beside lapses only jnd calc hierarchical has one";
  const TableMaker of(hierarchical_variant_fields(protocol, attendance_of(results).kind));
  using Row = HierarchicalVariantRow;
  std::vector<Row> rows = hierarchical_variant_rows(*results.hierarchical);
  std::erase_if(rows, [](const Row& row) {
    return row.shared != row.of->shared.data() || row.with->status == SlopeStatus::missing;
  });
  std::vector<TableColumn<Row>> columns = {of("variant"), of("condition")};
  if (shows_standards(protocol)) columns.push_back(of("standard"));
  columns.insert(columns.end(), {of("jnd"), of.range("ci_low", "ci_high"), of("width_ratio"),
                                 of.words("status", [&of](const Row& row) {
                                   return status_with_interval(of.text("jnd_status", row), row.with->ci_status);
                                 })});
  return of(std::move(table), columns, rows);
}

ResultTable hierarchical_people_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"hierarchical-people", "Participants by the hierarchical model", "", {}, {}, {}};
  if (!results.hierarchical || !results.hierarchical->fitted()) return table;
  const StudyHierarchical& model = *results.hierarchical;
  const std::string jnd = jnd_title(protocol);
  table.note = fmt::format(
      "separate: {}, of these answers alone; shrunken: given everybody's answers, drawn towards the group's {} as far "
      "as a participant's answers are few",
      model.separate, jnd);
  const TableMaker of(hierarchical_person_fields(protocol, attendance_of(results).kind));
  using Row = HierarchicalPerson;
  const std::vector<Row>& people = model.people;
  // What is ok is said of nobody, and there is no column where all are.
  const auto said = [&of](const char* key) {
    return [&of, key](const Row& row) {
      std::string text = of.text(key, row);
      return text == "ok" ? "" : text;
    };
  };
  std::vector<TableColumn<Row>> columns = {of("participant")};
  if (!protocol.groups.empty()) columns.push_back(of("group"));
  columns.push_back(of("condition"));
  if (shows_standards(protocol)) columns.push_back(of("standard"));
  columns.push_back(of("separate"));
  if (std::any_of(people.begin(), people.end(), [](const Row& row) { return row.separate_status != JndStatus::ok; }))
    columns.push_back(of.words("without", said("separate_status")));
  columns.insert(columns.end(), {of("jnd"), of("ln_sd")});
  if (!model.pse_at_standard) columns.push_back(of(is_choice(model) ? "bias" : "criterion"));
  if (std::any_of(people.begin(), people.end(), [](const Row& row) { return row.status != ShrunkenStatus::ok; }))
    columns.push_back(of.words("status", said("status")));
  table = of(std::move(table), columns, people);
  for (std::size_t i = table.rows.size(); i-- > 1;)  // a participant is named once
    if (table.rows[i].front() == table.rows[i - 1].front()) table.rows[i].front().clear();
  if (model.participants > 1 &&
      std::any_of(people.begin(), people.end(), [](const Row& row) { return row.status == ShrunkenStatus::ok; }))
    table.footnotes.emplace_back(model.alike() ? kPeopleAlike : kPersonRange);
  table.footnotes.push_back(hierarchical_assumptions(model));
  return table;
}

Json hierarchical_json(const StudyHierarchical& model, const Protocol& protocol, SessionKind kind) {
  Json out = {
      {"status", word_of(kHierarchicalStatusWords, model.status)},
      {"reason", model.reason.empty() ? Json(nullptr) : Json(model.reason)},
      {"observer", model.response ? Json(word_of(kResponseModelWords, *model.response)) : Json(nullptr)},
      {"participants", model.participants},
      {"trials", model.trials},
      {"cautions", model.cautions},
      {"exact", model.fitted() ? Json(model.exact) : Json(nullptr)},
      {"pooled_levels", model.gathered ? Json::array({model.gathered.from, model.gathered.to}) : Json(nullptr)}};
  const bool standards = !task_of(protocol.task.kind).has_own_results(), choice = is_choice(model);
  const auto with = [standards](std::vector<std::string> keys, std::size_t after, std::vector<std::string> more) {
    keys.insert(keys.end() - 1, more.begin(), more.end());
    if (standards) keys.insert(keys.begin() + static_cast<std::ptrdiff_t>(after), "standard");
    return keys;
  };
  using Keys = std::vector<std::string>;
  out["conditions"] =
      rows_json(hierarchical_fields(protocol, kind), hierarchical_rows(model),
                with({"condition", "n", "jnd", "ci_low", "ci_high", "ci_status", "weber", "status"}, 1,
                     choice ? Keys{"pse", "pse_low", "pse_high", "pse_status", "bias"} : Keys{"criterion"}));
  out["ratios"] = rows_json(
      hierarchical_ratio_fields(protocol, kind), model.ratios,
      with({"a", "b", "participants", "ratio", "ci_low", "ci_high", "ci_status", "lr", "p", "status"}, 2, {}));
  out["people"] = model.fitted() ? rows_json(hierarchical_person_fields(protocol, kind), model.people,
                                             with({"participant", "condition", "separate", "separate_status", "alone",
                                                   "alone_status", "jnd", "ln_sd", "status"},
                                                  2, choice ? Keys{"bias"} : Keys{"criterion"}))
                                 : Json::array();
  out["people_note"] = kPersonRange;
  out["check"] = nullptr;
  if (model.check) {
    out["check"] = predictive_summary_json(*model.check);
    out["check"]["rows"] = rows_json(hierarchical_check_fields(protocol, kind), hierarchical_check_rows(model),
                                     {"condition", "difference", "participants", "trials", "share", "share_low",
                                      "share_high", "share_status", "sd", "sd_low", "sd_high", "sd_status"});
  }
  out["variants"] = rows_json(
      hierarchical_variant_fields(protocol, kind), hierarchical_variant_rows(model),
      with({"variant", "parameter", "condition", "estimate", "estimate_low", "estimate_high", "estimate_ci_status",
            "lr", "p", "status", "jnd", "ci_low", "ci_high", "ci_status", "width_ratio", "jnd_status"},
           3, {}));
  out["sd"] = nullptr;
  if (model.fitted())
    out["sd"] = {{"persons", spread_json(model.persons)},
                 {"persons_by_condition", spread_json(model.by_condition)},
                 {choice ? "pse" : "criterion", spread_json(model.criteria)}};
  out["equal"] =
      model.equal_df > 0
          ? Json{{"lr", json_value(model.equal_lr)}, {"df", model.equal_df}, {"p", json_value(model.equal_p)}}
          : Json(nullptr);
  return out;
}

}  // namespace jnd
