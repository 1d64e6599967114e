#include "runner/results/result_tables_questionnaire.h"

#include <algorithm>

#include <fmt/format.h>

#include "runner/terminal/number_text.h"

namespace jnd {

namespace {

using Names = std::vector<std::string>;

std::string mean_text(const MeanEstimate& mean) {
  if (mean.n == 0) return "-";
  if (mean.n < 2) return number_text(mean.mean, 1);
  return number_text(mean.mean, 1) + " ± " + number_text(mean.sd, 1);
}

std::string side_text(const ItemScore& score, int ItemScore::Sides::*side) {
  return score.sides ? std::to_string(*score.sides.*side) : "";
}

std::string median_text(const MedianInterval& median) {
  return fmt::format("{} ({})", number_text(median.median, 1), range_text(median.ci_low, median.ci_high, 1));
}

// The scale, where all items share one.
std::string scale_text(const std::vector<QuestionnaireItem>& items, bool paired, const Protocol& protocol) {
  const Question* first = nullptr;
  for (const QuestionnaireItem& item : items) {
    if (item.paired != paired) continue;
    const Question& question = question_of(item.question, protocol);
    if (first == nullptr) first = &question;
    if (question.min != first->min || question.max != first->max || question.low_label != first->low_label ||
        question.high_label != first->high_label)
      return {};
  }
  if (first == nullptr) return {};
  return fmt::format("; scale {:g} ({}) .. {:g} ({})", first->min, first->low_label, first->max, first->high_label);
}

std::string question_line(const Question& question) {
  return fmt::format("{}: {}", question.id, question.text);
}

// What the source of the protocol printed for an item in a condition; empty where it printed nothing.
std::string published_text(const std::string& item, const std::string& condition, const Protocol& protocol) {
  for (const PublishedValue& value : protocol.published)
    if (value.question == item && value.condition == condition && value.quantity == "rating")
      return fmt::format("{:g}", value.value) + (value.sd ? fmt::format(" ± {:g}", *value.sd) : "");
  return {};
}

std::string published_once(const std::string& item, const Protocol& protocol) {
  for (const Condition& condition : protocol.conditions)
    if (std::string text = published_text(item, condition.name, protocol); !text.empty()) return text;
  return {};
}

// Takes out columns without any text.
void drop_empty_columns(ResultTable& table) {
  for (std::size_t column = table.columns.size(); column-- > 0;) {
    const auto empty = [column](const std::vector<std::string>& row) { return row[column].empty(); };
    if (!std::all_of(table.rows.begin(), table.rows.end(), empty)) continue;
    table.columns.erase(table.columns.begin() + static_cast<std::ptrdiff_t>(column));
    for (std::vector<std::string>& row : table.rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(column));
  }
}

ResultTable scores_table(const QuestionnaireResults& results, const Protocol& protocol, const Names& names) {
  ResultTable table{
      "items",
      "Ratings by condition",
      "mean ± SD, and the median with a distribution-free 95 % interval" + scale_text(results.items, true, protocol),
      {{"item"}, {"n", true}},
      {},
      {}};
  for (const std::string& name : names) {
    table.columns.push_back({name + " mean", true});
    table.columns.push_back({name + " median", true});
    table.columns.push_back({"published", true});
  }
  for (const QuestionnaireItem& item : results.items) {
    if (!item.paired) continue;
    const Question& question = question_of(item.question, protocol);
    int n = 0;
    for (const ItemScore& score : item.scores) n = std::max(n, score.mean.n);
    std::vector<std::string> row = {question.id, std::to_string(n)};
    for (const ItemScore& score : item.scores) {
      row.push_back(mean_text(score.mean));
      row.push_back(median_text(score.median));
      row.push_back(
          published_text(question.id, protocol.conditions[static_cast<std::size_t>(score.condition)].name, protocol));
    }
    table.rows.push_back(std::move(row));
    table.remarks.push_back(question_line(question));
  }
  drop_empty_columns(table);
  return table;
}

// Which of the p fall below the level.
std::string decided(const ItemPair& pair, double alpha) {
  std::string text;
  const auto add = [&](bool below, const char* name) {
    if (below) text += (text.empty() ? "" : ", ") + std::string(name);
  };
  add(pair.p < alpha, "alone");
  add(pair.p_holm < alpha, "Holm");
  add(pair.p_bh < alpha, "BH");
  return text;
}

ResultTable tests_table(const QuestionnaireResults& results, const Names& names) {
  ResultTable table{
      "ratings",
      "Wilcoxon signed-rank tests of the ratings",
      fmt::format("p: as R's wilcox.test; exact: permutation p with midranks; Holm and Benjamini-Hochberg correct the "
                  "exact p over {} test{}; r: rank-biserial; zeros: equal ratings, dropped",
                  results.tests.family, results.tests.family == 1 ? "" : "s"),
      {{"item"},
       {"pair"},
       {"n", true},
       {"zeros", true},
       {"V", true},
       {"p", true},
       {"exact", true},
       {"Holm", true},
       {"BH", true},
       {"r", true},
       {fmt::format("below {:g}", results.alpha)}},
      {},
      {}};
  for (const PairedItemResult& item : results.tests.items)
    for (const ItemPair& pair : item.pairs)
      table.rows.push_back({item.id, names[pair.a] + " - " + names[pair.b], std::to_string(pair.test.n),
                            std::to_string(pair.test.zeros), number_text(pair.test.v, 1), p_value_text(pair.test.p),
                            p_value_text(pair.p), p_value_text(pair.p_holm), p_value_text(pair.p_bh),
                            number_text(pair.test.rank_biserial, 2), decided(pair, results.alpha)});
  const TestCount& below = results.below_alpha;
  table.remarks.push_back(
      fmt::format("Of {} tests, below {:g}: {} as R, {} by the exact p, {} with Holm's correction, {} with "
                  "Benjamini-Hochberg's.",
                  results.tests.family, results.alpha, below.as_r, below.exact, below.holm, below.bh));
  return table;
}

ResultTable once_table(const QuestionnaireResults& results, const Protocol& protocol) {
  ResultTable table{"comparative",
                    "Ratings given once",
                    "no test, as there is no pair; counts of ratings below, on and above the middle of the scale" +
                        scale_text(results.items, false, protocol),
                    {{"item"},
                     {"n", true},
                     {"mean", true},
                     {"median", true},
                     {"coverage", true},
                     {"published", true},
                     {"below", true},
                     {"middle", true},
                     {"above", true}},
                    {},
                    {}};
  for (const QuestionnaireItem& item : results.items) {
    if (item.paired) continue;
    const Question& question = question_of(item.question, protocol);
    const ItemScore& score = item.scores.front();
    table.rows.push_back({question.id, std::to_string(score.mean.n), mean_text(score.mean), median_text(score.median),
                          percent_text(score.median.coverage), published_once(question.id, protocol),
                          side_text(score, &ItemScore::Sides::below), side_text(score, &ItemScore::Sides::at),
                          side_text(score, &ItemScore::Sides::above)});
    table.remarks.push_back(question_line(question));
  }
  drop_empty_columns(table);
  return table;
}

ResultTable choices_table(const QuestionnaireResults& results, const Protocol& protocol, const Names& names) {
  ResultTable table{"choices",
                    "Choices",
                    "share with its exact binomial interval (Clopper and Pearson)",
                    {{"question"}, {"answer"}, {"count", true}, {"share", true}, {"95 % CI", true}},
                    {},
                    {}};
  for (const ChoiceResult& choice : results.choices) {
    const Question& question = question_of(choice.question, protocol);
    const std::string of = choice.condition < 0 ? "" : ", " + names[static_cast<std::size_t>(choice.condition)];
    for (std::size_t i = 0; i < choice.options.size(); ++i) {
      const ExactProportion& option = choice.options[i];
      table.rows.push_back({question.id + of, question.options[i], fmt::format("{} of {}", option.k, option.n),
                            percent_text(option.share),
                            percent_text(option.ci_low) + " .. " + percent_text(option.ci_high)});
    }
    if (choice.condition <= 0) table.remarks.push_back(question_line(question));
  }
  return table;
}

ResultTable exposure_table(const QuestionnaireResults& results, const Protocol& protocol, const Names& names) {
  ResultTable table{"exposure",
                    "Free interaction",
                    "time with each object, without pauses",
                    {{"condition"},
                     {"object"},
                     {"n", true},
                     {"planned s", true},
                     {"mean s", true},
                     {"shortest s", true},
                     {"ended early", true},
                     {"given up", true}},
                    {},
                    {}};
  for (const Exposure& row : results.exposure)
    table.rows.push_back({names[static_cast<std::size_t>(row.condition)],
                          protocol.explore->objects[static_cast<std::size_t>(row.object)], std::to_string(row.n),
                          number_text(row.planned_s, 1), number_text(row.mean_s, 1), number_text(row.shortest_s, 1),
                          std::to_string(row.ended_early), std::to_string(row.given_up)});
  return table;
}

}  // namespace

Names condition_names(const Protocol& protocol) {
  Names names;
  for (const Condition& condition : protocol.conditions) names.push_back(condition.name);
  return names;
}

std::vector<ResultTable> questionnaire_tables(const QuestionnaireResults& results, const Protocol& protocol) {
  const Names names = condition_names(protocol);
  std::vector<ResultTable> tables = {exposure_table(results, protocol, names), once_table(results, protocol),
                                     scores_table(results, protocol, names), tests_table(results, names),
                                     choices_table(results, protocol, names)};
  std::erase_if(tables, [](const ResultTable& table) { return table.rows.empty(); });
  return tables;
}

std::string questionnaire_summary(const QuestionnaireResults& results) {
  const TestCount& below = results.below_alpha;
  return fmt::format(
      "{} of {} Wilcoxon tests fall below {:g} by the exact p, {} with Holm's correction and {} with "
      "Benjamini-Hochberg's",
      below.exact, results.tests.family, results.alpha, below.holm, below.bh);
}

}  // namespace jnd
