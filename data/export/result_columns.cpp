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

template <typename Row>
void add_file(std::vector<ResultFile>& files, const std::string& name, const Fields<Row>& fields,
              const std::vector<Row>& rows) {
  if (rows.empty()) return;
  const std::vector<CsvColumn<Row>> columns = csv_columns(fields);
  ResultFile file{name, csv_table(columns, rows), {}};
  describe(name, columns, file.dictionary);
  files.push_back(std::move(file));
}

template <typename Row>
void append(std::vector<Row>& rows, const std::vector<Row>& more) {
  rows.insert(rows.end(), more.begin(), more.end());
}

// Where the model was not fitted, the rows of conditions say why.
void add_hierarchical_files(std::vector<ResultFile>& files, const StudyHierarchical& model, const Protocol& protocol,
                            SessionKind kind) {
  if (model.people.empty()) return;
  add_file(files, "hierarchical.csv", hierarchical_fields(protocol, kind), hierarchical_rows(model));
  add_file(files, "hierarchical_ratios.csv", hierarchical_ratio_fields(protocol, kind), model.ratios);
  if (model.check)
    add_file(files, "hierarchical_check.csv", hierarchical_check_fields(protocol, kind),
             hierarchical_check_rows(model));
  if (!model.variants.empty())
    add_file(files, "hierarchical_variants.csv", hierarchical_variant_fields(protocol, kind),
             hierarchical_variant_rows(model));
  if (model.status == HierarchicalStatus::ok)
    add_file(files, "hierarchical_people.csv", hierarchical_person_fields(protocol, kind), model.people);
}

}  // namespace

std::vector<ResultFile> result_files(const StudyResults& results, const Protocol& protocol, const StudyModels* models) {
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

  std::vector<ResultFile> files;
  const SessionKind kind = attendance_of(results).kind;
  if (const auto* constant = std::get_if<ConstantResults>(&results.measured)) {
    add_file(files, "cells.csv", cell_fields(protocol), constant->analysis.cells);
    add_file(files, "thresholds.csv", threshold_fields(protocol), constant->analysis.thresholds);
    add_file(files, "group.csv", group_fields(protocol, kind), constant->analysis.group);
  }
  add_file(files, "contrasts.csv", contrast_fields(protocol, kind), contrasts_of(results, protocol));
  if (const auto* adaptive = std::get_if<AdaptiveResults>(&results.measured)) {
    add_file(files, "tracks.csv", track_fields(protocol), adaptive->rows);
    add_file(files, "group.csv", adaptive_group_fields(protocol), adaptive->group);
  }
  if (const auto* measured = std::get_if<MeasuredTask>(&results.measured)) {
    add_file(files, "estimates.csv", task_estimate_fields(protocol), measured->task.estimates);
    add_file(files, "counts.csv", task_count_fields(protocol), measured->task.counts);
    add_file(files, "group.csv", task_group_fields(protocol, kind), measured->task.group);
    add_file(files, "proportion.csv", proportion_fields(protocol), measured->task.proportion);
  }
  if (results.groups) {
    add_file(files, "groups.csv", group_mean_fields(protocol, kind), group_mean_rows(*results.groups));
    add_file(files, "between.csv", between_fields(protocol, kind), between_rows(*results.groups));
  }
  add_file(files, "tests.csv", test_fields(), tests);
  add_file(files, "pairs.csv", pair_fields(protocol), pairs);
  add_file(files, "sensitivity.csv", sensitivity_fields(protocol), sensitivity);
  add_file(files, "behaviour.csv", behaviour_fields(protocol), behaviour);
  if (results.hierarchical) add_hierarchical_files(files, *results.hierarchical, protocol, kind);
  add_file(files, "sureness.csv", sureness_fields(protocol), sureness);
  add_file(files, "items.csv", score_fields(protocol), scores);
  add_file(files, "ratings.csv", rating_fields(protocol), rating_rows(results.questionnaire.tests));
  if (models != nullptr) add_file(files, "models.csv", model_fields(protocol), models->thresholds);
  add_file(files, "choices.csv", option_fields(protocol), options);
  if (exploration != nullptr) add_file(files, "exposure.csv", exposure_fields(protocol), exploration->exposure);
  return files;
}

void add_results(ExportFolder& files, const StudyResults& results, const Protocol& protocol, const StudyModels* models,
                 std::vector<DictionaryRow>& dictionary) {
  for (const ResultFile& file : result_files(results, protocol, models)) {
    files.write(file.name, file.text);
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
