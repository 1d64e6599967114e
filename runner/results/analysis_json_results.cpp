// The rest of a study's results as JSON: comparisons, sensitivity, behaviour, ratings, models.
#include <fmt/format.h>

#include "runner/calc/calc_detection.h"
#include "runner/calc/calc_group.h"
#include "runner/results/adaptive_text.h"
#include "runner/results/analysis_text.h"
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
  Json out = {{"outcome", outcome.outcome},
              {"title", outcome.title},
              {"unit", outcome.unit},
              {"registered", outcome.registered},
              {"n_used", outcome.table.n},
              {"n", outcome.table.n + outcome.left_out.size()},
              {"left_out", left_out_json(outcome.left_out)},
              {"refused", outcome.refused.empty() ? Json(nullptr) : Json(outcome.refused)}};
  if (!outcome.refused.empty()) return out;
  if (outcome.registered) {
    out["omnibus_p"] = json_number(omnibus_p(outcome.comparison, protocol.analysis));
    out["contrasts"] = Json::array();
    const std::vector<double> p = contrast_p(outcome.comparison, protocol.analysis);
    for (std::size_t i = 0; i < p.size(); ++i) {
      Json one = contrast_json(protocol.analysis.contrasts[i], protocol);
      one["p"] = json_number(p[i]);
      out["contrasts"].push_back(one);
    }
  }
  std::vector<std::string> names;
  for (const Condition& condition : protocol.conditions) names.push_back(condition.name);
  out["comparison"] = comparison_json({names, outcome.comparison});
  return out;
}

Json effect_json(const TwoWayEffect& effect) {
  const WithinEffect& e = effect.effect;
  return {{"f", json_number(e.f)},
          {"df1", json_number(e.df1)},
          {"df2", json_number(e.df2)},
          {"p", json_number(e.p)},
          {"p_gg", json_number(e.p_gg)},
          {"p_hf", json_number(e.p_hf)},
          {"epsilon_gg", json_number(e.epsilon_gg)},
          {"eta2_generalised", json_number(effect.eta2_generalised)},
          {"eta2_partial", json_number(e.eta2_partial)},
          {"status", to_text(e.status)}};
}

Json sensitivity_json(const SensitivityRow& row, const Protocol& protocol) {
  Json out = {{"model", row.method.model},
              {"correction", to_string(row.method.correction)},
              {"method", to_string(row.method.method)},
              {"registered", row.registered},
              {"n", row.n},
              {"participants", row.participants},
              {"omnibus_p", json_number(row.omnibus_p)},
              {"same_conclusion", row.same_conclusion},
              {"refused", row.refused.empty() ? Json(nullptr) : Json(row.refused)},
              {"conditions", Json::array()},
              {"contrasts", Json::array()}};
  for (std::size_t i = 0; i < row.median_jnd.size(); ++i)
    out["conditions"].push_back({{"condition", protocol.conditions[i].name},
                                 {"median_jnd", json_number(row.median_jnd[i])},
                                 {"median_status", to_string(row.median_status[i])},
                                 {"mean_jnd", json_number(row.mean_jnd[i])},
                                 {"n_ok", row.n_ok[i]}});
  for (std::size_t i = 0; i < row.contrast_p.size(); ++i) {
    Json one = contrast_json(protocol.analysis.contrasts[i], protocol);
    one["mean_slope_difference"] = json_number(row.contrast_slope[i]);
    one["p"] = json_number(row.contrast_p[i]);
    out["contrasts"].push_back(one);
  }
  return out;
}

Json half_json(const HalfDifference& half) {
  return {{"first", json_number(half.first)},           {"second", json_number(half.second)},
          {"difference", json_number(half.difference)}, {"ci_low", json_number(half.ci_low)},
          {"ci_high", json_number(half.ci_high)},       {"p", json_number(half.p)}};
}

Json share_json(const Share& share) {
  return {{"k", share.k}, {"n", share.n}, {"value", json_number(share.value)}};
}

Json behaviour_json(const BehaviourRow& row, const Protocol& protocol) {
  return {{"participant", row.participant.empty() ? Json(nullptr) : Json(row.participant)},
          {"condition", row.condition < 0 ? Json(nullptr) : Json(condition_name(protocol, row.condition))},
          {"order_effect",
           {{"status", to_string(row.order.status)},
            {"stiffer_first", share_json(row.order.stiffer_first)},
            {"stiffer_second", share_json(row.order.stiffer_second)},
            {"difference", json_number(row.order.difference)},
            {"ci_low", json_number(row.order.ci_low)},
            {"ci_high", json_number(row.order.ci_high)},
            {"p", json_number(row.order.p)}}},
          {"response_bias",
           {{"status", to_string(row.bias.status)},
            {"criterion", json_number(row.bias.criterion)},
            {"ci_low", json_number(row.bias.ci_low)},
            {"ci_high", json_number(row.bias.ci_high)},
            {"said_different", share_json(row.bias.said_different)},
            {"planned_share", json_number(row.bias.planned_share)},
            {"p", json_number(row.bias.p)}}},
          {"drift",
           {{"status", to_string(row.drift.status)},
            {"dprime", half_json(row.drift.dprime)},
            {"criterion", half_json(row.drift.criterion)}}},
          {"session_drift", row.session_drift ? Json{{"strata", row.session_drift->strata},
                                                     {"difference", json_number(row.session_drift->difference)},
                                                     {"ci_low", json_number(row.session_drift->ci_low)},
                                                     {"ci_high", json_number(row.session_drift->ci_high)},
                                                     {"p", json_number(row.session_drift->p)}}
                                              : Json(nullptr)}};
}

Json cue_strategy_json(const StudyBehaviour& behaviour, const Protocol& protocol) {
  Json out = Json::array();
  for (const CueRow& row : behaviour.cues) {
    const CueStrategy& strategy = row.strategy;
    Json one = {{"condition", condition_name(protocol, row.condition)},
                {"status", to_string(strategy.status)},
                {"best", strategy.best ? Json(to_string(*strategy.best)) : Json(nullptr)},
                {"common_trials", strategy.common_trials},
                {"undecided_participants", row.undecided},
                {"cues", Json::array()}};
    for (std::size_t i = 0; i < strategy.cues.size(); ++i) {
      const CueFit& fit = strategy.cues[i];
      one["cues"].push_back({{"cue", to_string(fit.cue)},
                             {"status", to_string(fit.status)},
                             {"n", fit.n},
                             {"missing", fit.missing},
                             {"slope", json_number(fit.slope)},
                             {"slope_se", json_number(fit.slope_se)},
                             {"log_likelihood", json_number(fit.log_likelihood)},
                             {"deviance_explained", json_number(fit.deviance_explained)},
                             {"aic", json_number(fit.aic)},
                             {"beside_stiffness",
                              {{"status", to_string(fit.beside_stiffness.status)},
                               {"chi2", json_number(fit.beside_stiffness.chi_square)},
                               {"p", json_number(fit.beside_stiffness.p)}}},
                             {"participants_best", row.best_of.empty() ? Json(nullptr) : Json(row.best_of[i])}});
    }
    out.push_back(one);
  }
  return out;
}

Json score_json(const ItemScore& score) {
  return {{"n", score.mean.n},
          {"mean", json_number(score.mean.mean)},
          {"mean_ci_low", json_number(score.mean.ci_low)},
          {"mean_ci_high", json_number(score.mean.ci_high)},
          {"median", json_number(score.median.median)},
          {"ci_low", json_number(score.median.ci_low)},
          {"ci_high", json_number(score.median.ci_high)},
          {"coverage", json_number(score.median.coverage)},
          {"status", to_text(score.median.status)}};
}

Json item_pair_json(const ItemPair& pair, const Protocol& protocol) {
  return {{"a", protocol.conditions[pair.a].name},
          {"b", protocol.conditions[pair.b].name},
          {"n", pair.test.n},
          {"v", json_number(pair.test.v)},
          {"p", json_number(pair.p)},
          {"exact", pair.exact},
          {"p_holm", json_number(pair.p_holm)},
          {"p_bh", json_number(pair.p_bh)},
          {"median_difference", json_number(pair.median_difference)},
          {"rank_biserial", json_number(pair.test.rank_biserial)},
          {"status", to_text(pair.test.status)}};
}

Json ratings_json(const StudyResults& results, const Protocol& protocol) {
  Json out = {{"family", results.ratings.family}, {"items", Json::array()}, {"once", Json::array()}};
  auto tested = results.ratings.items.begin();  // of the paired items, in the same order
  for (const QuestionnaireItem& item : results.items) {
    Json one = {{"item", protocol.questions[static_cast<std::size_t>(item.question)].id}};
    if (!item.paired) {
      one.update(score_json(item.scores.front()));
      out["once"].push_back(one);
      continue;
    }
    one["conditions"] = one["pairs"] = Json::array();
    for (const ItemScore& score : item.scores) {
      Json condition = {{"condition", condition_name(protocol, score.condition)}};
      condition.update(score_json(score));
      one["conditions"].push_back(condition);
    }
    for (const ItemPair& pair : tested->pairs) one["pairs"].push_back(item_pair_json(pair, protocol));
    ++tested;
    out["items"].push_back(one);
  }
  return out;
}

Json contrast_row_json(const ContrastRow& row, const Protocol& protocol) {
  Json out = contrast_json({row.a, row.b}, protocol);
  out.update({{"outcome", row.outcome},
              {"unit", row.unit},
              {"registered", row.registered},
              {"participants", row.participants},
              {"difference", to_json(row.difference)},
              {"p", json_number(row.p)},
              {"refused", row.refused.empty() ? Json(nullptr) : Json(row.refused)},
              {"difference_source", to_string(row.difference_source)}});
  return out;
}

void add_chains(Json& out, const ChainReport& chains) {
  out["events_verified"] = chains.events;
  out["study_head"] = chains.study_head;
}

// Of the paradigm explore.
Json explore_json(const StudyResults& results, const Protocol& protocol) {
  Json out = {{"kind", to_string(results.analysis.kind)}, {"protocol_sha256", protocol.sha256}};
  out["questionnaire"] = to_json(*results.questionnaire, protocol);
  out["deviations"] = results.deviations;
  out["cautions"] = results.cautions;
  add_chains(out, results.chains);
  out["heads"] = Json::array();
  for (const SessionHead& head : results.analysis.heads)
    out["heads"].push_back(
        {{"participant", head.participant}, {"session", head.session}, {"closed", head.closed}, {"hash", head.hash}});
  return out;
}

}  // namespace

nlohmann::ordered_json to_json(const StudyResults& results, const Protocol& protocol) {
  if (results.questionnaire) return explore_json(results, protocol);
  Json out = results.adaptive ? to_json(*results.adaptive, protocol) : to_json(results.analysis, protocol);
  add_chains(out, results.chains);
  out["contrasts"] = Json::array();
  for (const ContrastRow& row : contrasts_of(results, protocol))
    out["contrasts"].push_back(contrast_row_json(row, protocol));
  out["comparisons"] = Json::array();
  for (const OutcomeComparison& outcome : results.comparisons)
    out["comparisons"].push_back(outcome_json(outcome, protocol));
  const SeriesComparison& series = results.by_series;
  out["condition_by_series"] = {{"n_used", series.n},
                                {"left_out", left_out_json(series.left_out)},
                                {"refused", series.refused.empty() ? Json(nullptr) : Json(series.refused)}};
  if (series.refused.empty()) {
    out["condition_by_series"]["condition"] = effect_json(series.test.a);
    out["condition_by_series"]["series"] = effect_json(series.test.b);
    out["condition_by_series"]["interaction"] = effect_json(series.test.ab);
  }
  out["sensitivity"] = Json::array();
  for (const SensitivityRow& row : results.sensitivity) out["sensitivity"].push_back(sensitivity_json(row, protocol));
  out["behaviour"] = Json::array();
  for (const auto* rows : {&results.behaviour.conditions, &results.behaviour.participants})
    for (const BehaviourRow& row : *rows) out["behaviour"].push_back(behaviour_json(row, protocol));
  out["cue_strategy"] = cue_strategy_json(results.behaviour, protocol);
  out["ratings"] = ratings_json(results, protocol);
  out["deviations"] = results.deviations;
  out["cautions"] = results.cautions;
  return out;
}

nlohmann::ordered_json to_json(const StudyModels& models, const Protocol& protocol) {
  Json out = {{"thresholds", Json::array()}, {"cells", Json::array()}};
  for (const ThresholdModel& row : models.thresholds) {
    Json one = {{"participant", row.participant},
                {"condition", condition_name(protocol, row.condition)},
                {"model", row.method.model},
                {"correction", to_string(row.method.correction)},
                {"method", to_string(row.method.method)},
                {"slope", json_number(row.jnd.slope)},
                {"jnd", json_number(row.jnd.jnd)},
                {"weber", json_number(row.jnd.weber)},
                {"ci_low", json_number(row.jnd.ci_low)},
                {"ci_high", json_number(row.jnd.ci_high)},
                {"log_likelihood", json_number(row.jnd.log_likelihood)},
                {"status", to_string(row.jnd.status)}};
    if (row.quality)
      one["fit"] = {{"status", to_string(row.quality->status)},
                    {"deviance", json_number(row.quality->deviance)},
                    {"df", row.quality->degrees_of_freedom},
                    {"p", json_number(row.quality->deviance_p)}};
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
