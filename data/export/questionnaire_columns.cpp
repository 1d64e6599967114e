#include "data/export/questionnaire_columns.h"

#include <cmath>
#include <string>
#include <utility>

#include "data/export/column_makers.h"

namespace jnd {

namespace {

struct ScoreRow {
  const Question* question;
  const ItemScore* score;
};

// NaN of numbers.
double side_of(const ItemScore& score, int ItemScore::Sides::*side) {
  return score.sides ? *score.sides.*side : std::nan("");
}

Columns<ScoreRow> score_columns(const Protocol& protocol) {
  using R = ScoreRow;
  return {text<R>("item", "identifier of the question", [](const R& r) { return r.question->id; }),
          text<R>("group", "part of the questionnaire", [](const R& r) { return r.question->group; }),
          text<R>("text", "the question", [](const R& r) { return r.question->text; }),
          text<R>("condition", "condition rated; empty where asked once",
                  [&protocol](const R& r) { return condition_of(protocol, r.score->condition); }),
          number<R>("n", "participants who answered", [](const R& r) { return r.score->mean.n; }),
          number<R>("mean", "mean answer", [](const R& r) { return r.score->mean.mean; }),
          number<R>("sd", "standard deviation, n - 1", [](const R& r) { return r.score->mean.sd; }),
          number<R>("mean_ci95_low", "lower end of the mean's 95 % interval (Student t)",
                    [](const R& r) { return r.score->mean.ci_low; }),
          number<R>("mean_ci95_high", "upper end", [](const R& r) { return r.score->mean.ci_high; }),
          number<R>("median", "median answer", [](const R& r) { return r.score->median.median; }),
          number<R>("ci_low", "lower end of the median's distribution-free interval",
                    [](const R& r) { return r.score->median.ci_low; }),
          number<R>("ci_high", "upper end", [](const R& r) { return r.score->median.ci_high; }),
          number<R>("coverage", "how often the interval covers; below 0.95 where there are too few participants",
                    [](const R& r) { return r.score->median.coverage; }),
          number<R>("scale_min", "lowest answer that may be given", [](const R& r) { return r.question->min; }),
          number<R>("scale_max", "highest", [](const R& r) { return r.question->max; }),
          number<R>("n_below", "ratings below the middle of the scale; empty for numbers, as the next two",
                    [](const R& r) { return side_of(*r.score, &ItemScore::Sides::below); }),
          number<R>("n_middle", "ratings on the middle of the scale",
                    [](const R& r) { return side_of(*r.score, &ItemScore::Sides::at); }),
          number<R>("n_above", "ratings above the middle of the scale",
                    [](const R& r) { return side_of(*r.score, &ItemScore::Sides::above); })};
}

struct OptionRow {
  const Question* question;
  const ChoiceResult* choice;
  std::size_t option;
};

Columns<OptionRow> option_columns(const Protocol& protocol) {
  using R = OptionRow;
  const auto share = [](const R& r) { return r.choice->options[r.option]; };
  return {text<R>("question", "identifier of the question", [](const R& r) { return r.question->id; }),
          text<R>("condition", "condition asked about; empty where asked once",
                  [&protocol](const R& r) { return condition_of(protocol, r.choice->condition); }),
          text<R>("option", "the answer", [](const R& r) { return r.question->options[r.option]; }),
          number<R>("count", "participants who chose it", [share](const R& r) { return share(r).k; }),
          number<R>("n", "participants who chose any", [](const R& r) { return r.choice->n; }),
          number<R>("share", "count / n", [share](const R& r) { return share(r).share; }),
          number<R>("ci95_low", "lower end of its exact binomial interval (Clopper and Pearson)",
                    [share](const R& r) { return share(r).ci_low; }),
          number<R>("ci95_high", "upper end", [share](const R& r) { return share(r).ci_high; })};
}

Columns<Exposure> exposure_columns(const Protocol& protocol) {
  using R = Exposure;
  return {text<R>("condition", "condition", [&protocol](const R& r) { return condition_of(protocol, r.condition); }),
          text<R>("object", "virtual object explored",
                  [&protocol](const R& r) { return protocol.explore->objects[static_cast<std::size_t>(r.object)]; }),
          number<R>("n", "completed explorations", [](const R& r) { return r.n; }),
          number<R>(
              "planned_s", "time planned for each", [](const R& r) { return r.planned_s; }, "s"),
          number<R>(
              "mean_s", "mean time, without pauses", [](const R& r) { return r.mean_s; }, "s"),
          number<R>(
              "shortest_s", "shortest time", [](const R& r) { return r.shortest_s; }, "s"),
          number<R>("ended_early", "of them ended by the operator", [](const R& r) { return r.ended_early; }),
          number<R>("given_up", "explorations that were given up", [](const R& r) { return r.given_up; })};
}

}  // namespace

void add_items_file(std::vector<ResultFile>& files, const std::vector<QuestionnaireItem>& items,
                    const Protocol& protocol) {
  std::vector<ScoreRow> scores;
  for (const QuestionnaireItem& item : items)
    for (const ItemScore& score : item.scores)
      scores.push_back({&protocol.questions[static_cast<std::size_t>(item.question)], &score});
  add_file(files, "items.csv", score_columns(protocol), scores);
}

std::vector<ResultFile> questionnaire_files(const QuestionnaireResults& results, const Protocol& protocol) {
  std::vector<OptionRow> options;
  for (const ChoiceResult& choice : results.choices)
    for (std::size_t i = 0; i < choice.options.size(); ++i)
      options.push_back({&protocol.questions[static_cast<std::size_t>(choice.question)], &choice, i});
  std::vector<ResultFile> files;
  add_file(files, "choices.csv", option_columns(protocol), options);
  add_file(files, "exposure.csv", exposure_columns(protocol), results.exposure);
  return files;
}

}  // namespace jnd
