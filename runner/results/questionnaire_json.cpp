// The results of a study of free interaction as JSON.
#include "runner/results/result_tables_questionnaire.h"
#include "runner/terminal/json_output.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

Json side_json(const ItemScore& score, int ItemScore::Sides::*side) {
  return score.sides ? Json(*score.sides.*side) : Json(nullptr);
}

Json score_json(const ItemScore& score, const Names& names) {
  return {{"condition", score.condition < 0 ? Json(nullptr) : Json(names[static_cast<std::size_t>(score.condition)])},
          {"n", score.mean.n},
          {"mean", json_number(score.mean.mean)},
          {"sd", json_number(score.mean.sd)},
          {"mean_ci_low", json_number(score.mean.ci_low)},
          {"mean_ci_high", json_number(score.mean.ci_high)},
          {"median", json_number(score.median.median)},
          {"ci_low", json_number(score.median.ci_low)},
          {"ci_high", json_number(score.median.ci_high)},
          {"coverage", json_number(score.median.coverage)},
          {"below", side_json(score, &ItemScore::Sides::below)},
          {"middle", side_json(score, &ItemScore::Sides::at)},
          {"above", side_json(score, &ItemScore::Sides::above)}};
}

Json pair_json(const ItemPair& pair, const Names& names) {
  return {{"a", names[pair.a]},
          {"b", names[pair.b]},
          {"n", pair.test.n},
          {"zeros", pair.test.zeros},
          {"ties", pair.test.ties},
          {"v", json_number(pair.test.v)},
          {"p_r", json_number(pair.test.p)},
          {"p_r_exact", pair.test.exact},
          {"p", json_number(pair.p)},
          {"exact", pair.exact},
          {"p_holm", json_number(pair.p_holm)},
          {"p_bh", json_number(pair.p_bh)},
          {"median_difference", json_number(pair.median_difference)},
          {"rank_biserial", json_number(pair.test.rank_biserial)},
          {"status", to_text(pair.test.status)}};
}

Json items_json(const QuestionnaireResults& results, const Protocol& protocol, const Names& names) {
  Json out = Json::array();
  std::size_t tested = 0;
  for (const QuestionnaireItem& item : results.items) {
    const Question& question = question_of(item.question, protocol);
    Json one = {{"item", question.id},       {"group", question.group},   {"text", question.text},
                {"scale_min", question.min}, {"scale_max", question.max}, {"scores", Json::array()}};
    for (const ItemScore& score : item.scores) one["scores"].push_back(score_json(score, names));
    if (item.paired) {
      one["pairs"] = Json::array();
      for (const ItemPair& pair : results.tests.items[tested].pairs) one["pairs"].push_back(pair_json(pair, names));
      ++tested;
    }
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace

Json to_json(const QuestionnaireResults& results, const Protocol& protocol) {
  const Names names = condition_names(protocol);
  Json out = {{"participants", results.participants},
              {"alpha", results.alpha},
              {"family", results.tests.family},
              {"below_alpha",
               {{"r", results.below_alpha.as_r},
                {"exact", results.below_alpha.exact},
                {"holm", results.below_alpha.holm},
                {"bh", results.below_alpha.bh}}},
              {"items", items_json(results, protocol, names)},
              {"choices", Json::array()},
              {"exposure", Json::array()}};
  for (const ChoiceResult& choice : results.choices) {
    const Question& question = question_of(choice.question, protocol);
    const bool once = choice.condition < 0;
    Json one = {{"question", question.id},
                {"text", question.text},
                {"condition", once ? Json(nullptr) : Json(names[static_cast<std::size_t>(choice.condition)])},
                {"n", choice.n},
                {"options", Json::array()}};
    for (std::size_t i = 0; i < choice.options.size(); ++i)
      one["options"].push_back({{"option", question.options[i]},
                                {"count", choice.options[i].k},
                                {"share", json_number(choice.options[i].share)},
                                {"ci_low", json_number(choice.options[i].ci_low)},
                                {"ci_high", json_number(choice.options[i].ci_high)}});
    out["choices"].push_back(std::move(one));
  }
  for (const Exposure& row : results.exposure)
    out["exposure"].push_back({{"condition", names[static_cast<std::size_t>(row.condition)]},
                               {"object", protocol.explore->objects[static_cast<std::size_t>(row.object)]},
                               {"n", row.n},
                               {"planned_s", json_number(row.planned_s)},
                               {"mean_s", json_number(row.mean_s)},
                               {"shortest_s", json_number(row.shortest_s)},
                               {"ended_early", row.ended_early},
                               {"given_up", row.given_up}});
  return out;
}

}  // namespace jnd
