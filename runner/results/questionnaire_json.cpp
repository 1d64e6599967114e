// The results of a study of free interaction as JSON.
#include "data/fields/answer_fields.h"
#include "runner/results/field_output.h"
#include "runner/results/result_tables_questionnaire.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

Json items_json(const QuestionnaireResults& results, const Protocol& protocol) {
  const auto scores = score_fields(protocol);
  const auto pairs = rating_fields(protocol);
  Json out = Json::array();
  auto tested = results.tests.items.begin();  // of the paired items, in the same order
  for (const QuestionnaireItem& item : results.items) {
    const std::vector<ScoreRow> rows = score_rows(item, protocol);
    Json one = json_of(scores, rows.front(), {"item", "group", "text", "scale_min", "scale_max"});
    one["scores"] = Json::array();
    for (const ScoreRow& row : rows)
      one["scores"].push_back(json_of(scores, row,
                                      {"condition", "n", "mean", "sd", "mean_ci_low", "mean_ci_high", "median",
                                       "ci_low", "ci_high", "coverage", "below", "middle", "above"}));
    if (item.paired) {
      one["pairs"] = Json::array();
      for (const ItemPair& pair : tested->pairs)
        one["pairs"].push_back(
            json_of<RatingRow>(pairs, {&*tested, &pair},
                               {"a", "b", "n", "zeros", "ties", "v", "p_r", "p_r_exact", "p", "exact", "p_holm", "p_bh",
                                "median_difference", "rank_biserial", "status"}));
      ++tested;
    }
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace

Json to_json(const QuestionnaireResults& results, const ExplorationResults& exploration, const Protocol& protocol) {
  const auto options = option_fields(protocol);
  const auto exposure = exposure_fields(protocol);
  Json out = {{"participants", results.participants},
              {"alpha", results.alpha},
              {"family", results.tests.family},
              {"below_alpha",
               {{"r", results.below_alpha.as_r},
                {"exact", results.below_alpha.exact},
                {"holm", results.below_alpha.holm},
                {"bh", results.below_alpha.bh}}},
              {"items", items_json(results, protocol)},
              {"choices", Json::array()},
              {"exposure", Json::array()}};
  for (const ChoiceResult& choice : exploration.choices) {
    const std::vector<OptionRow> rows = option_rows(choice, protocol);
    Json one = json_of(options, rows.front(), {"question", "text", "condition", "n"});
    one["options"] = Json::array();
    for (const OptionRow& row : rows)
      one["options"].push_back(json_of(options, row, {"option", "count", "share", "ci_low", "ci_high"}));
    out["choices"].push_back(std::move(one));
  }
  for (const Exposure& row : exploration.exposure) out["exposure"].push_back(json_of(exposure, row, {"*"}));
  return out;
}

}  // namespace jnd
