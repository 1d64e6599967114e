// The rest of a study's results as JSON: comparisons, sensitivity, behaviour, ratings, models.
#include <fmt/format.h>

#include "data/fields/answer_fields.h"
#include "data/fields/result_fields.h"
#include "runner/calc/calc_detection.h"
#include "runner/calc/calc_group.h"
#include "runner/results/adaptive_text.h"
#include "runner/results/analysis_text.h"
#include "runner/results/field_output.h"
#include "runner/results/result_table_parts.h"
#include "runner/results/result_tables_questionnaire.h"
#include "runner/terminal/json_output.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

Json contrast_json(const Contrast& contrast, const Protocol& protocol) {
  return Json{{"a", condition_name(protocol, contrast.a)}, {"b", condition_name(protocol, contrast.b)}};
}

Json left_out_json(const std::vector<LeftOut>& left_out) {
  Json out = Json::array();
  for (const LeftOut& one : left_out) out.push_back({{"participant", one.participant}, {"reason", one.reason}});
  return out;
}

Json outcome_json(const OutcomeComparison& outcome, const Protocol& protocol) {
  Json out = json_of<TestRow>(test_fields(), {&outcome}, {"outcome", "title", "unit", "registered", "n_used", "n"});
  out["left_out"] = left_out_json(outcome.left_out);
  out["refused"] = outcome.refused.empty() ? Json(nullptr) : Json(outcome.refused);
  if (!outcome.refused.empty()) return out;
  if (outcome.registered && outcome.crossed) {
    out["omnibus_p"] = json_number(omnibus_p(outcome.comparison, protocol.analysis));
    if (protocol.analysis.hierarchical) {  // whose contrasts are not this outcome's
      out["contrasts"] = nullptr;
    } else {
      out["contrasts"] = Json::array();
      const std::vector<double> p = contrast_p(outcome.comparison, protocol.analysis);
      for (std::size_t i = 0; i < p.size(); ++i) {
        Json one = contrast_json(protocol.analysis.contrasts[i], protocol);
        one["p"] = json_number(p[i]);
        out["contrasts"].push_back(one);
      }
    }
  }
  std::vector<std::string> names;
  for (const Condition& condition : protocol.conditions) names.push_back(condition.name);
  out["comparison"] = comparison_json({names, outcome.comparison});
  return out;
}

Json series_json(const SeriesComparison& series) {
  Json out = {{"n_used", series.n},
              {"left_out", left_out_json(series.left_out)},
              {"refused", series.refused.empty() ? Json(nullptr) : Json(series.refused)}};
  if (!series.refused.empty()) return out;
  const auto fields = effect_fields();
  const auto add = [&](const char* name, const TwoWayEffect& effect) {
    out[name] = json_of<EffectRow>(
        fields, {name, &effect, &series},
        {"f", "df1", "df2", "p", "p_gg", "p_hf", "epsilon_gg", "eta2_generalised", "eta2_partial", "status"});
  };
  add("condition", series.test.a);
  add("series", series.test.b);
  add("interaction", series.test.ab);
  return out;
}

Json sensitivity_json(const SensitivityRow& row, const Protocol& protocol) {
  const auto fields = sensitivity_fields(protocol);
  Json out = json_of<MethodRow>(
      fields, {&row, 0},
      {"model", "correction", "method", "registered", "n", "participants", "omnibus_p", "same_conclusion", "refused"});
  out["conditions"] = Json::array();
  out["contrasts"] = Json::array();
  for (std::size_t i = 0; i < row.median_jnd.size(); ++i)
    out["conditions"].push_back(
        json_of<MethodRow>(fields, {&row, i}, {"condition", "median_jnd", "median_status", "mean_jnd", "n_ok"}));
  for (std::size_t i = 0; i < row.contrast_p.size(); ++i) {
    Json one = contrast_json(protocol.analysis.contrasts[i], protocol);
    one["mean_slope_difference"] = json_number(row.contrast_slope[i]);
    one["p"] = json_number(row.contrast_p[i]);
    out["contrasts"].push_back(one);
  }
  return out;
}

Json behaviour_json(const StudyBehaviour& behaviour, const Protocol& protocol) {
  const auto fields = behaviour_fields(protocol);
  Json out = Json::array();
  for (const auto* rows : {&behaviour.conditions, &behaviour.participants}) {
    for (const BehaviourRow& row : *rows) {
      out.push_back(json_of(fields, row, {"*"}));
      if (!row.session_drift) out.back()["session_drift"] = nullptr;
    }
  }
  return out;
}

Json cue_strategy_json(const StudyBehaviour& behaviour, const Protocol& protocol) {
  const auto fields = cue_fields(protocol);
  Json out = Json::array();
  for (const CueRow& row : behaviour.cues) {
    const CueStrategy& strategy = row.strategy;
    Json one = {{"condition", condition_name(protocol, row.condition)},
                {"status", to_string(strategy.status)},
                {"best", strategy.best ? Json(to_string(*strategy.best)) : Json(nullptr)},
                {"common_trials", strategy.common_trials},
                {"undecided_participants", row.undecided},
                {"cues", Json::array()}};
    for (std::size_t i = 0; i < strategy.cues.size(); ++i)
      one["cues"].push_back(
          json_of<CueFitRow>(fields, {&row, i},
                             {"cue", "status", "n", "missing", "slope", "slope_se", "log_likelihood",
                              "deviance_explained", "aic", "beside_stiffness.*", "participants_best"}));
    out.push_back(one);
  }
  return out;
}

Json ratings_json(const StudyResults& results, const Protocol& protocol) {
  const auto scores = score_fields(protocol);
  const auto pairs = rating_fields(protocol);
  const std::vector<std::string> answers = {"n",      "mean",    "mean_ci_low", "mean_ci_high", "median",
                                            "ci_low", "ci_high", "coverage",    "status"};
  Json out = {{"family", results.questionnaire.tests.family}, {"items", Json::array()}, {"once", Json::array()}};
  auto tested = results.questionnaire.tests.items.begin();  // of the paired items, in the same order
  for (const QuestionnaireItem& item : results.questionnaire.items) {
    const std::vector<ScoreRow> rows = score_rows(item, protocol);
    Json one = json_of(scores, rows.front(), {"item"});
    if (!item.paired) {
      add_json(one, scores, rows.front(), answers);
      out["once"].push_back(one);
      continue;
    }
    one["pairs"] = Json::array();
    one["conditions"] = Json::array();
    for (const ScoreRow& row : rows) {
      one["conditions"].push_back(json_of(scores, row, {"condition"}));
      add_json(one["conditions"].back(), scores, row, answers);
    }
    for (const ItemPair& pair : tested->pairs)
      one["pairs"].push_back(json_of<RatingRow>(
          pairs, {&*tested, &pair},
          {"a", "b", "n", "v", "p", "exact", "p_holm", "p_bh", "median_difference", "rank_biserial", "status"}));
    ++tested;
    out["items"].push_back(one);
  }
  return out;
}

void add_chains(Json& out, const ChainReport& chains) {
  out["events_verified"] = chains.events;
  out["study_head"] = chains.study_head;
}

void add_cautions(Json& out, const StudyResults& results) {
  out["deviations"] = results.deviations;
  out["cautions"] = results.cautions;
}

struct ResultsJson {
  const StudyResults& results;
  const Protocol& protocol;

  Json operator()(const ConstantResults& measured) const {
    return with_tests(to_json(measured.analysis, protocol), measured);
  }
  Json operator()(const AdaptiveResults& measured) const {
    // What needs given levels is there all the same, and empty.
    ConstantResults none;
    none.by_series.refused = "the answers set the levels: there are no series";
    return with_tests(to_json(measured, protocol), none);
  }
  Json operator()(const MeasuredTask& measured) const {
    ConstantResults none;
    none.by_series.refused = "belongs to the task same-different";
    return with_tests(task_json(results, measured.task, protocol), none);
  }
  Json operator()(const ExplorationResults& measured) const {
    Json out = {{"kind", to_string(measured.attendance.kind)}, {"protocol_sha256", protocol.sha256}};
    out["questionnaire"] = to_json(results.questionnaire, measured, protocol);
    add_cautions(out, results);
    add_chains(out, results.chains);
    out["heads"] = heads_json(measured.attendance);
    return out;
  }

 private:
  Json with_tests(Json out, const ConstantResults& measured) const {
    add_chains(out, results.chains);
    out["contrasts"] = Json::array();
    const auto contrasts = contrast_fields(protocol, attendance_of(results).kind);
    for (const ContrastRow& row : contrasts_of(results, protocol))
      out["contrasts"].push_back(json_of(contrasts, row,
                                         {"a", "b", "outcome", "unit", "registered", "participants", "difference.*",
                                          "p", "refused", "difference_source"}));
    if (results.groups) out["between"] = groups_json(results, protocol);
    out["comparisons"] = Json::array();
    for (const OutcomeComparison& outcome : results.comparisons)
      out["comparisons"].push_back(outcome_json(outcome, protocol));
    out["condition_by_series"] = series_json(measured.by_series);
    out["hierarchical"] = results.hierarchical
                              ? hierarchical_json(*results.hierarchical, protocol, attendance_of(results).kind)
                              : Json(nullptr);
    out["sensitivity"] = Json::array();
    for (const SensitivityRow& row : measured.sensitivity)
      out["sensitivity"].push_back(sensitivity_json(row, protocol));
    out["behaviour"] = behaviour_json(measured.behaviour, protocol);
    if (protocol.task.sureness_levels > 0) {
      const auto fields = sureness_fields(protocol);
      out["sureness"] = Json::array();
      for (const SurenessRow& row : measured.sureness) out["sureness"].push_back(json_of(fields, row, {"*"}));
    }
    out["cue_strategy"] = cue_strategy_json(measured.behaviour, protocol);
    out["ratings"] = ratings_json(results, protocol);
    add_cautions(out, results);
    return out;
  }
};

}  // namespace

nlohmann::ordered_json to_json(const StudyResults& results, const Protocol& protocol) {
  return std::visit(ResultsJson{results, protocol}, results.measured);
}

nlohmann::ordered_json to_json(const StudyModels& models, const Protocol& protocol) {
  const auto fields = model_fields(protocol);
  Json out = {{"thresholds", Json::array()}, {"cells", Json::array()}};
  for (const ThresholdModel& row : models.thresholds) {
    Json one = json_of(fields, row,
                       {"participant", "condition", "model", "correction", "method", "slope", "jnd", "weber", "ci_low",
                        "ci_high", "log_likelihood", "status"});
    if (row.quality) add_json(one, fields, row, {"fit.*"});
    out["thresholds"].push_back(one);
  }
  for (const CellModel& cell : models.cells) {
    Json one = {{"participant", cell.participant},
                {"condition", condition_name(protocol, cell.condition)},
                {"series", protocol.series[static_cast<std::size_t>(cell.series)].name}};
    one.update(detection_json({"", cell.row}));
    one.erase("id");
    out["cells"].push_back(one);
  }
  return out;
}

}  // namespace jnd
