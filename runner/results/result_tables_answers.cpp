// Tables of how the answers were given: order of the intervals, bias, drift, cues; and of the questionnaires.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runner/results/result_format.h"
#include "runner/results/result_table_parts.h"

namespace jnd {

namespace {

// "(1 not at all .. 9 completely)", or "(0 .. 40)" of a number, whose ends have no names.
std::string question_note(const Question& question) {
  const auto end = [](double value, const std::string& label) {
    return fmt::format("{:g}{}{}", value, label.empty() ? "" : " ", label);
  };
  return fmt::format("{}: \"{}\" ({} .. {})", question.id, question.text, end(question.min, question.low_label),
                     end(question.max, question.high_label));
}

std::vector<std::string> behaviour_row(const BehaviourRow& row, const Protocol& protocol) {
  const bool ordered = row.order.status == OrderStatus::ok;
  std::string remarks = ordered ? "" : std::string(to_string(row.order.status));
  if (row.bias.status != RateStatus::ok) remarks = joined(remarks, "bias: " + std::string(to_string(row.bias.status)));
  if (row.drift.status != RateStatus::ok)
    remarks = joined(remarks, "drift: " + std::string(to_string(row.drift.status)));
  return {row.participant.empty() ? "all" : row.participant,
          row.condition < 0 ? "all" : condition_text(protocol, row.condition),
          number_text(row.order.difference, 3),
          range_text(row.order.ci_low, row.order.ci_high, 2),
          p_value_text(row.order.p),
          number_text(row.bias.criterion, 2),
          range_text(row.bias.ci_low, row.bias.ci_high, 2),
          percent_text(row.bias.said_different.value),
          p_value_text(row.bias.p),
          number_text(row.drift.dprime.difference, 2),
          range_text(row.drift.dprime.ci_low, row.drift.dprime.ci_high, 2),
          p_value_text(row.drift.dprime.p),
          row.session_drift ? number_text(row.session_drift->difference, 2) : "",
          row.session_drift ? p_value_text(row.session_drift->p) : "",
          remarks};
}

}  // namespace

ResultTable behaviour_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{
      "behaviour",
      "How the answers were given",
      "order: rate of \"different\" with the stiffer stimulus first minus second; c: criterion over all trials (c > 0 "
      "leans "
      "to \"same\"), with the share of \"different\" answers; drift: d' in the second half of each cell minus the "
      "first; session: second half of the session minus the first, each series held against itself; no "
      "correction for many tests",
      {},
      {},
      {}};
  table.columns = {{"participant"},   {"condition"},         {"order", true},   {"95 % CI", true},
                   {"p", true},       {"c", true},           {"95 % CI", true}, {"said different", true},
                   {"p", true},       {"drift of d'", true}, {"95 % CI", true}, {"p", true},
                   {"session", true}, {"p", true},           {"remarks"}};
  for (const BehaviourRow& row : results.behaviour.conditions) table.rows.push_back(behaviour_row(row, protocol));
  for (const BehaviourRow& row : results.behaviour.participants) table.rows.push_back(behaviour_row(row, protocol));
  return table;
}

ResultTable cues_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{
      "cues",
      "Which trace of the stimulus explains the answers?",
      "P(\"different\") = Phi(l + b z), z the standardised difference between the intervals as delivered; p: "
      "what the cue adds to stiffness; best of: participants whose own answers it explains best",
      {},
      {},
      {}};
  table.columns = {{"condition"},
                   {"cue"},
                   {"trials", true},
                   {"b", true},
                   {"deviance explained", true},
                   {"AIC", true},
                   {"p beside stiffness", true},
                   {"best of", true},
                   {"remarks"}};
  for (const CueRow& row : results.behaviour.cues) {
    if (row.strategy.status == CueStatus::too_few_trials && row.strategy.common_trials == 0 &&
        std::all_of(row.strategy.cues.begin(), row.strategy.cues.end(), [](const CueFit& fit) { return fit.n == 0; }))
      continue;  // nothing was measured
    for (std::size_t i = 0; i < row.strategy.cues.size(); ++i) {
      const CueFit& fit = row.strategy.cues[i];
      std::string remarks = fit.status == CueStatus::ok ? "" : std::string(to_string(fit.status));
      if (fit.missing > 0) remarks = joined(remarks, fmt::format("{} trials without it", fit.missing));
      if (row.strategy.best && *row.strategy.best == fit.cue) remarks = joined("explains most", remarks);
      table.rows.push_back({i == 0 ? condition_text(protocol, row.condition) : "", std::string(to_string(fit.cue)),
                            std::to_string(fit.n), number_text(fit.slope, 3), percent_text(fit.deviance_explained),
                            number_text(fit.aic, 1), p_value_text(fit.beside_stiffness.p),
                            row.best_of.empty() ? "-" : std::to_string(row.best_of[i]), remarks});
    }
  }
  return table;
}

ResultTable items_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"items",
                    "Answers to the questions",
                    "mean with Student's interval; median with a distribution-free one, which covers as often as said",
                    {{"question"},
                     {"condition"},
                     {"n", true},
                     {"mean", true},
                     {"95 % CI", true},
                     {"median", true},
                     {"interval", true},
                     {"covers", true}},
                    {},
                    {}};
  for (const QuestionnaireItem& item : results.items) {
    const Question& question = protocol.questions[static_cast<std::size_t>(item.question)];
    for (const ItemScore& score : item.scores)
      table.rows.push_back({score.condition <= 0 ? question.id : "",
                            score.condition < 0 ? "asked once" : condition_text(protocol, score.condition),
                            std::to_string(score.mean.n), number_text(score.mean.mean, 2),
                            range_text(score.mean.ci_low, score.mean.ci_high, 2), number_text(score.median.median, 1),
                            range_text(score.median.ci_low, score.median.ci_high, 1),
                            percent_text(score.median.coverage)});
    table.remarks.push_back(question_note(question));
  }
  return table;
}

ResultTable ratings_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{
      "ratings",
      "Answers compared between conditions",
      fmt::format("Wilcoxon signed ranks with the exact permutation p; Holm and Benjamini-Hochberg over {} "
                  "test{}",
                  results.ratings.family, results.ratings.family == 1 ? "" : "s"),
      {},
      {},
      {}};
  table.columns = {{"item"},    {"pair"},    {"medians", true}, {"n", true},     {"zeros", true},
                   {"V", true}, {"p", true}, {"p(Holm)", true}, {"p(BH)", true}, {"rank-biserial", true}};
  for (const PairedItemResult& item : results.ratings.items) {
    for (const ItemPair& pair : item.pairs)
      table.rows.push_back({item.id, protocol.conditions[pair.a].name + " - " + protocol.conditions[pair.b].name,
                            fmt::format("{:g} / {:g}", item.conditions[pair.a].median, item.conditions[pair.b].median),
                            std::to_string(pair.test.n), std::to_string(pair.test.zeros), number_text(pair.test.v, 1),
                            p_value_text(pair.p), p_value_text(pair.p_holm), p_value_text(pair.p_bh),
                            number_text(pair.test.rank_biserial, 2)});
  }
  return table;
}

}  // namespace jnd
