// Tables of how the answers were given: order of the intervals, bias, drift, cues; and of the questionnaires.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runner/result_format.h"
#include "runner/result_table_parts.h"

namespace jnd {

namespace {

const Question* question_of(const std::string& id, const Protocol& protocol) {
  for (const Question& question : protocol.questions)
    if (question.id == id) return &question;
  return nullptr;
}

std::string question_note(const std::string& id, const Protocol& protocol) {
  const Question* question = question_of(id, protocol);
  return question == nullptr ? id
                             : fmt::format("{}: \"{}\" ({:g} {} .. {:g} {})", id, question->text, question->min,
                                           question->low_label, question->max, question->high_label);
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
          remarks};
}

}  // namespace

ResultTable behaviour_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{
      "behaviour",
      "How the answers were given",
      "order: rate of \"different\" with the stiffer stimulus first minus second; bias: criterion c over all "
      "trials (c > 0 leans to \"same\") and share of \"different\" answers; drift: d' in the second half minus "
      "the first; no correction for many tests",
      {},
      {},
      {}};
  table.columns = {{"participant"}, {"condition"},         {"order", true},   {"95 % CI", true},
                   {"p", true},     {"c", true},           {"95 % CI", true}, {"said different", true},
                   {"p", true},     {"drift of d'", true}, {"95 % CI", true}, {"p", true},
                   {"remarks"}};
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

ResultTable ratings_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{
      "ratings",
      "Ratings of the conditions",
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
    table.remarks.push_back(question_note(item.id, protocol));
  }
  return table;
}

ResultTable comparative_table(const StudyResults& results, const Protocol& protocol) {
  ResultTable table{"comparative",
                    "Ratings given once",
                    "median with a distribution-free interval; no test, as there is no pair",
                    {},
                    {},
                    {}};
  table.columns = {{"item"}, {"n", true}, {"median", true}, {"95 % CI", true}, {"coverage", true}, {"remarks"}};
  for (const ComparativeItemResult& item : results.comparative) {
    const MedianInterval& rating = item.rating;
    table.rows.push_back({item.id, std::to_string(rating.n), number_text(rating.median, 1),
                          range_text(rating.ci_low, rating.ci_high, 1), percent_text(rating.coverage),
                          rating.status == TestStatus::ok ? "" : to_text(rating.status)});
    table.remarks.push_back(question_note(item.id, protocol));
  }
  return table;
}

}  // namespace jnd
