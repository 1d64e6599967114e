// Tables of how the answers were given: order of the intervals, bias, drift, cues; and of the questionnaires.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/fields/answer_fields.h"
#include "runner/results/field_output.h"
#include "runner/results/result_format.h"
#include "runner/results/result_table_parts.h"

namespace jnd {

namespace {

// "(1 not at all to 9 completely)", or "(0 to 40)" of a number, whose ends have no names.
std::string question_note(const Question& question) {
  const auto end = [](double value, const std::string& label) {
    return fmt::format("{:g}{}{}", value, label.empty() ? "" : " ", label);
  };
  return fmt::format("{}: \"{}\" ({} to {})", question.id, question.text, end(question.min, question.low_label),
                     end(question.max, question.high_label));
}

std::string behaviour_cautions(const BehaviourRow& row) {
  const bool ordered = row.order.status == OrderStatus::ok;
  std::string cautions = ordered ? "" : std::string(to_string(row.order.status));
  if (row.bias.status != RateStatus::ok)
    cautions = joined(cautions, "bias: " + std::string(to_string(row.bias.status)));
  if (row.drift.status != RateStatus::ok)
    cautions = joined(cautions, "drift: " + std::string(to_string(row.drift.status)));
  return cautions;
}

// Whether a condition has any trial that a cue could be fitted to.
bool anything_measured(const CueRow& row) {
  return row.strategy.status != CueStatus::too_few_trials || row.strategy.common_trials != 0 ||
         std::any_of(row.strategy.cues.begin(), row.strategy.cues.end(), [](const CueFit& fit) { return fit.n != 0; });
}

}  // namespace

ResultTable behaviour_table(const ConstantResults& results, const Protocol& protocol) {
  const TableMaker of(behaviour_fields(protocol));
  const auto or_all = [&of](const char* key) {
    return of.words(key, [&of, key](const BehaviourRow& row) {
      const std::string text = of.text(key, row);
      return text.empty() ? "all" : text;
    });
  };
  std::vector<BehaviourRow> rows = results.behaviour.conditions;
  rows.insert(rows.end(), results.behaviour.participants.begin(), results.behaviour.participants.end());
  return of(
      {"behaviour",
       "How the answers were given",
       "order: rate of \"different\" with the stiffer stimulus first minus second; c: criterion over all trials (c > 0 "
       "leans to \"same\"), with the share of \"different\" answers; drift: d' in the second half of each cell minus "
       "the first; session: second half of the session minus the first, each series held against itself; p(Holm): "
       "over the conditions, or over the participants",
       {},
       {},
       {}},
      {or_all("participant"), or_all("condition"), of("order_effect.difference"),
       of.range("order_effect.ci_low", "order_effect.ci_high"), of("order_effect.holm.p"),
       of("response_bias.criterion"), of.range("response_bias.ci_low", "response_bias.ci_high"),
       of("response_bias.said_different.value"), of("response_bias.holm.p"), of("drift.dprime.difference"),
       of.range("drift.dprime.ci_low", "drift.dprime.ci_high"), of("drift.dprime.holm.p"),
       of("session_drift.difference"), of("session_drift.holm.p"), of.words("cautions", behaviour_cautions)},
      rows);
}

ResultTable sureness_table(const ConstantResults& results, const Protocol& protocol) {
  const TableMaker of(sureness_fields(protocol));
  return of(
      {"sureness",
       "JND from how sure the answers were",
       "P(answer <= j) = Phi(c_j - dK / JND), the criteria c_j common to all differences; maximum likelihood with "
       "its profile interval; p: of no sensitivity",
       {},
       {},
       {}},
      {of("participant"), of("condition"), of("trials"), of("jnd"), of.range("ci_low", "ci_high"), of("deviance"),
       of("p"), of("status")},
      results.sureness);
}

ResultTable cues_table(const ConstantResults& results, const Protocol& protocol) {
  using Row = CueFitRow;
  const TableMaker of(cue_fields(protocol));
  const auto fit = [](const Row& row) -> const CueFit& { return row.row->strategy.cues[row.cue]; };
  const auto condition = [&](const Row& row) { return row.cue == 0 ? of.text("condition", row) : ""; };
  const auto best_of = [&](const Row& row) {
    return row.row->best_of.empty() ? "-" : of.text("participants_best", row);
  };
  const auto cautions = [&](const Row& row) {
    std::string text = fit(row).status == CueStatus::ok ? "" : of.text("status", row);
    if (fit(row).missing > 0) text = joined(text, fmt::format("{} trials without it", fit(row).missing));
    return row.row->strategy.best == fit(row).cue ? joined("explains most", text) : text;
  };
  std::vector<Row> rows;
  for (const CueRow& row : results.behaviour.cues)
    if (anything_measured(row))
      for (std::size_t i = 0; i < row.strategy.cues.size(); ++i) rows.push_back({&row, i});
  return of({"cues",
             "Which trace of the stimulus explains the answers?",
             "P(\"different\") = Phi(l + b z), z the standardised difference between the intervals as delivered; p: "
             "what the cue adds to stiffness; best of: participants whose own answers it explains best",
             {},
             {},
             {}},
            {of.words("condition", condition), of("cue"), of("n"), of("slope"), of("deviance_explained"), of("aic"),
             of("beside_stiffness.p"), of.words("best of", best_of, true), of.words("cautions", cautions)},
            rows);
}

ResultTable items_table(const StudyResults& results, const Protocol& protocol) {
  const TableMaker of(score_fields(protocol));
  ResultTable table{"items",
                    "Answers to the questions",
                    "mean with Student's interval; median with a distribution-free one, which covers as often as said",
                    {},
                    {},
                    {}};
  std::vector<ScoreRow> rows;
  for (const QuestionnaireItem& item : results.questionnaire.items) {
    for (const ScoreRow& row : score_rows(item, protocol)) rows.push_back(row);
    table.footnotes.push_back(question_note(protocol.questions[static_cast<std::size_t>(item.question)]));
  }
  const auto question = [&](const ScoreRow& row) { return row.score->condition <= 0 ? of.text("item", row) : ""; };
  const auto condition = [&](const ScoreRow& row) {
    return row.score->condition < 0 ? "asked once" : of.text("condition", row);
  };
  return of(std::move(table),
            {of.words("question", question), of.words("condition", condition), of("n"), of("mean"),
             of.range("mean_ci_low", "mean_ci_high"), of("median"), of.range("ci_low", "ci_high", "interval"),
             of("coverage", "covers")},
            rows);
}

ResultTable ratings_table(const StudyResults& results, const Protocol& protocol) {
  const TableMaker of(rating_fields(protocol));
  const auto medians = [](const RatingRow& row) {
    return fmt::format("{:g} / {:g}", row.item->conditions[row.pair->a].median,
                       row.item->conditions[row.pair->b].median);
  };
  return of({"ratings",
             "Answers compared between conditions",
             fmt::format("Wilcoxon signed ranks with the exact permutation p; Holm and Benjamini-Hochberg over {} "
                         "test{}",
                         results.questionnaire.tests.family, results.questionnaire.tests.family == 1 ? "" : "s"),
             {},
             {},
             {}},
            {of("item"),
             of.words("pair", [&](const RatingRow& row) { return of.text("a", row) + " - " + of.text("b", row); }),
             of.words("medians", medians, true), of("n"), of("zeros"), of("v"), of("p"), of("p_holm"), of("p_bh"),
             of("rank_biserial")},
            rating_rows(results.questionnaire.tests));
}

}  // namespace jnd
