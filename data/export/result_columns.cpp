#include "data/export/result_columns.h"

#include <utility>

#include <fmt/format.h>

#include "data/export/data_package.h"
#include "data/fields/answer_fields.h"
#include "data/fields/between_fields.h"
#include "data/fields/hierarchical_fields.h"
#include "data/fields/result_fields.h"
#include "data/fields/task_fields.h"

namespace jnd {

namespace {

// The files so far, and the columns that each begins with.
struct ResultFiles {
  const std::vector<LeadingColumn>& leading;
  std::vector<ResultFile> all{};

  template <typename Row>
  void add(const std::string& name, const Fields<Row>& fields, const std::vector<Row>& rows) {
    if (rows.empty()) return;
    std::vector<CsvColumn<Row>> columns;
    for (const LeadingColumn& one : leading) {
      CsvColumn<Row>& column = columns.emplace_back();
      column.name = one.name;
      column.meaning = one.meaning;
      column.type = CellType::integer;
      column.cell = [value = one.value](const Row&) { return csv_number(value); };
    }
    for (CsvColumn<Row>& column : csv_columns(fields)) columns.push_back(std::move(column));
    ResultFile file{name, csv_header(columns), {}, {}};
    for (const Row& row : rows) file.rows += csv_row(columns, row);
    describe(name, columns, file.dictionary);
    all.push_back(std::move(file));
  }
};

template <typename Row>
void append(std::vector<Row>& rows, const std::vector<Row>& more) {
  rows.insert(rows.end(), more.begin(), more.end());
}

// Where the model was not fitted, the rows of conditions say why.
void add_hierarchical_files(ResultFiles& files, const StudyHierarchical& model, const Protocol& protocol,
                            SessionKind kind) {
  if (model.people.empty()) return;
  files.add("hierarchical.csv", hierarchical_fields(protocol, kind), hierarchical_rows(model));
  files.add("hierarchical_ratios.csv", hierarchical_ratio_fields(protocol, kind), model.ratios);
  if (model.check)
    files.add("hierarchical_check.csv", hierarchical_check_fields(protocol, kind), hierarchical_check_rows(model));
  if (!model.variants.empty())
    files.add("hierarchical_variants.csv", hierarchical_variant_fields(protocol, kind),
              hierarchical_variant_rows(model));
  if (model.fitted()) files.add("hierarchical_people.csv", hierarchical_person_fields(protocol, kind), model.people);
}

}  // namespace

std::vector<ResultFile> result_files(const StudyResults& results, const Protocol& protocol, const StudyModels* models,
                                     const std::vector<LeadingColumn>& leading) {
  std::vector<TestRow> tests;
  std::vector<PairRow> pairs;
  for (const OutcomeComparison& outcome : results.comparisons) {
    if (!outcome.refused.empty()) continue;
    tests.push_back({&outcome});
    for (const PairComparison& pair : outcome.comparison.pairs) pairs.push_back({&outcome, &pair});
  }
  std::vector<MethodRow> sensitivity;
  std::vector<BehaviourRow> behaviour;
  std::vector<SurenessRow> sureness;
  if (const auto* constant = std::get_if<ConstantResults>(&results.measured)) {
    for (const SensitivityRow& row : constant->sensitivity)
      for (std::size_t condition = 0; condition < protocol.conditions.size(); ++condition)
        sensitivity.push_back({&row, condition});
    append(behaviour, constant->behaviour.conditions);
    append(behaviour, constant->behaviour.participants);
    sureness = constant->sureness;
  }
  std::vector<ScoreRow> scores;
  for (const QuestionnaireItem& item : results.questionnaire.items) append(scores, score_rows(item, protocol));
  const auto* exploration = std::get_if<ExplorationResults>(&results.measured);
  std::vector<OptionRow> options;
  if (exploration != nullptr)
    for (const ChoiceResult& choice : exploration->choices) append(options, option_rows(choice, protocol));

  ResultFiles files{leading};
  const SessionKind kind = attendance_of(results).kind;
  if (const auto* constant = std::get_if<ConstantResults>(&results.measured)) {
    files.add("cells.csv", cell_fields(protocol), constant->analysis.cells);
    files.add("thresholds.csv", threshold_fields(protocol), constant->analysis.thresholds);
    files.add("group.csv", group_fields(protocol, kind), constant->analysis.group);
  }
  files.add("contrasts.csv", contrast_fields(protocol, kind), contrasts_of(results, protocol));
  if (const auto* adaptive = std::get_if<AdaptiveResults>(&results.measured)) {
    files.add("tracks.csv", track_fields(protocol), adaptive->rows);
    files.add("group.csv", adaptive_group_fields(protocol), adaptive->group);
  }
  if (const auto* measured = std::get_if<MeasuredTask>(&results.measured)) {
    files.add("estimates.csv", task_estimate_fields(protocol), measured->task.estimates);
    files.add("counts.csv", task_count_fields(protocol), measured->task.counts);
    files.add("group.csv", task_group_fields(protocol, kind), measured->task.group);
    files.add("proportion.csv", proportion_fields(protocol), measured->task.proportion);
  }
  if (results.groups) {
    files.add("groups.csv", group_mean_fields(protocol, kind), group_mean_rows(*results.groups));
    files.add("between.csv", between_fields(protocol, kind), between_rows(*results.groups));
  }
  files.add("tests.csv", test_fields(), tests);
  files.add("pairs.csv", pair_fields(protocol), pairs);
  files.add("sensitivity.csv", sensitivity_fields(protocol), sensitivity);
  files.add("behaviour.csv", behaviour_fields(protocol), behaviour);
  if (results.hierarchical) add_hierarchical_files(files, *results.hierarchical, protocol, kind);
  files.add("sureness.csv", sureness_fields(protocol), sureness);
  files.add("items.csv", score_fields(protocol), scores);
  files.add("ratings.csv", rating_fields(protocol), rating_rows(results.questionnaire.tests));
  if (models != nullptr) files.add("models.csv", model_fields(protocol), models->thresholds);
  files.add("choices.csv", option_fields(protocol), options);
  if (exploration != nullptr) files.add("exposure.csv", exposure_fields(protocol), exploration->exposure);
  return std::move(files.all);
}

void add_results(ExportFolder& files, const StudyResults& results, const Protocol& protocol, const StudyModels* models,
                 std::vector<DictionaryRow>& dictionary) {
  for (const ResultFile& file : result_files(results, protocol, models)) {
    files.write(file.name, file.header + file.rows);
    dictionary.insert(dictionary.end(), file.dictionary.begin(), file.dictionary.end());
  }
}

void write_results(ExportFolder& files, const StudyResults& results, const Protocol& protocol,
                   const StudyModels* models) {
  std::vector<DictionaryRow> dictionary;
  add_results(files, results, protocol, models, dictionary);
  write_descriptions(files, protocol, fmt::format("results of {} data", to_string(attendance_of(results).kind)),
                     std::move(dictionary));
}

}  // namespace jnd
