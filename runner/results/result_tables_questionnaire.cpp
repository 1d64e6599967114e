#include "runner/results/result_tables_questionnaire.h"

#include <algorithm>

#include <fmt/format.h>

#include "data/fields/answer_fields.h"
#include "runner/results/field_output.h"
#include "runner/terminal/number_text.h"

namespace jnd {

namespace {

using Names = std::vector<std::string>;

std::string mean_text(const MeanEstimate& mean) {
  if (mean.n == 0) return "-";
  if (mean.n < 2) return number_text(mean.mean, 1);
  return number_text(mean.mean, 1) + " ± " + number_text(mean.sd, 1);
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
    table.footnotes.push_back(question_line(question));
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

ResultTable tests_table(const QuestionnaireResults& results, const Protocol& protocol) {
  const TableMaker of(rating_fields(protocol));
  const TestCount& below = results.below_alpha;
  return of(
      {"ratings",
       "Wilcoxon signed-rank tests of the ratings",
       fmt::format("p: as R's wilcox.test; exact: permutation p with midranks; Holm and Benjamini-Hochberg correct the "
                   "exact p over {} test{}; r: rank-biserial; zeros: equal ratings, dropped",
                   results.tests.family, results.tests.family == 1 ? "" : "s"),
       {},
       {},
       {fmt::format("Of {} tests, below {:g}: {} as R, {} by the exact p, {} with Holm's correction, {} with "
                    "Benjamini-Hochberg's.",
                    results.tests.family, results.alpha, below.as_r, below.exact, below.holm, below.bh)}},
      {of("item"),
       of.words("pair", [&](const RatingRow& row) { return of.text("a", row) + " - " + of.text("b", row); }), of("n"),
       of("zeros"), of("v"), of("p_r"), of("p", "exact"), of("p_holm", "Holm"), of("p_bh", "BH"),
       of("rank_biserial", "r"),
       of.words(fmt::format("below {:g}", results.alpha),
                [&](const RatingRow& row) { return decided(*row.pair, results.alpha); })},
      rating_rows(results.tests));
}

ResultTable once_table(const QuestionnaireResults& results, const Protocol& protocol) {
  ResultTable table{"comparative",
                    "Ratings given once",
                    "no test, as there is no pair; counts of ratings below, on and above the middle of the scale" +
                        scale_text(results.items, false, protocol),
                    {},
                    {},
                    {}};
  std::vector<ScoreRow> rows;
  for (const QuestionnaireItem& item : results.items) {
    if (item.paired) continue;
    rows.push_back(score_rows(item, protocol).front());
    table.footnotes.push_back(question_line(*rows.back().question));
  }
  const TableMaker of(score_fields(protocol));
  table = of(std::move(table),
             {of("item"), of("n"),
              of.words(
                  "mean", [](const ScoreRow& row) { return mean_text(row.score->mean); }, true),
              of.words(
                  "median", [](const ScoreRow& row) { return median_text(row.score->median); }, true),
              of("coverage"),
              of.words(
                  "published", [&](const ScoreRow& row) { return published_once(row.question->id, protocol); }, true),
              of("below"), of("middle"), of("above")},
             rows);
  drop_empty_columns(table);
  return table;
}

ResultTable choices_table(const ExplorationResults& results, const Protocol& protocol) {
  ResultTable table{"choices", "Choices", "share with its exact binomial interval (Clopper and Pearson)", {}, {}, {}};
  std::vector<OptionRow> rows;
  for (const ChoiceResult& choice : results.choices) {
    for (const OptionRow& row : option_rows(choice, protocol)) rows.push_back(row);
    if (choice.condition <= 0) table.footnotes.push_back(question_line(question_of(choice.question, protocol)));
  }
  const TableMaker of(option_fields(protocol));
  const auto question = [&](const OptionRow& row) {
    const std::string condition = of.text("condition", row);
    return row.question->id + (condition.empty() ? "" : ", " + condition);
  };
  return of(std::move(table),
            {of.words("question", question), of("option"), of.share("count", "n", "count"), of("share"),
             of.range("ci_low", "ci_high")},
            rows);
}

ResultTable exposure_table(const ExplorationResults& results, const Protocol& protocol) {
  const TableMaker of(exposure_fields(protocol));
  return of({"exposure", "Free interaction", "time with each object, without pauses", {}, {}, {}},
            {of("condition"), of("object"), of("n"), of("planned_s"), of("mean_s"), of("shortest_s"), of("ended_early"),
             of("given_up")},
            results.exposure);
}

}  // namespace

Names condition_names(const Protocol& protocol) {
  Names names;
  for (const Condition& condition : protocol.conditions) names.push_back(condition.name);
  return names;
}

std::vector<ResultTable> questionnaire_tables(const QuestionnaireResults& results,
                                              const ExplorationResults& exploration, const Protocol& protocol) {
  const Names names = condition_names(protocol);
  std::vector<ResultTable> tables = {exposure_table(exploration, protocol), once_table(results, protocol),
                                     scores_table(results, protocol, names), tests_table(results, protocol),
                                     choices_table(exploration, protocol)};
  std::erase_if(tables, [](const ResultTable& table) { return table.rows.empty(); });
  return tables;
}

}  // namespace jnd
