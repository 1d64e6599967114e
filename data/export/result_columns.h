// The columns of the files that hold tests, other methods, behaviour and ratings: numbers for machines, unrounded.
#pragma once

#include <string>
#include <vector>

#include "data/export/csv_writer.h"
#include "data/export/export_folder.h"
#include "data/results/study_models.h"
#include "data/results/study_results.h"
#include "protocols/protocol.h"

namespace jnd {

// A finished file and what its columns mean.
struct ResultFile {
  std::string name;  // "tests.csv"
  std::string text;
  std::vector<DictionaryRow> dictionary;
};

// groups.csv and between.csv where there are groups of participants; tests.csv, pairs.csv, sensitivity.csv, behaviour.csv, ratings.csv, and models.csv where models are given; of free
// interaction items.csv, choices.csv and exposure.csv. Files without rows are left out.
std::vector<ResultFile> result_files(const StudyResults& results, const Protocol& protocol, const StudyModels* models);

// Those files, with group.csv, contrasts.csv, thresholds.csv (every participant) and cells.csv beside them, and
// dictionary.csv for all of them.
void write_results(ExportFolder& files, const StudyResults& results, const Protocol& protocol,
                   const StudyModels* models);

}  // namespace jnd
