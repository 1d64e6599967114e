// The columns of the files that hold tests, other methods, behaviour and ratings: numbers for machines, unrounded.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data/export/export_folder.h"
#include "data/fields/csv_writer.h"
#include "data/results/study_models.h"
#include "data/results/study_results.h"
#include "protocols/protocol.h"

namespace jnd {

// A finished file and what its columns mean.
struct ResultFile {
  std::string name;    // "tests.csv"
  std::string header;  // its first line
  std::string rows;
  std::vector<DictionaryRow> dictionary;
};

// A column with the same cell in every row of a study.
struct LeadingColumn {
  std::string name, meaning;
  std::int64_t value = 0;
};

// cells.csv, thresholds.csv (every participant) and group.csv of same-different over given levels; contrasts.csv;
// tracks.csv where the answers set the levels; estimates.csv, counts.csv, group.csv and proportion.csv of the other
// tasks; groups.csv and between.csv where there are groups of participants; tests.csv, pairs.csv, sensitivity.csv,
// hierarchical.csv, hierarchical_ratios.csv, hierarchical_check.csv, hierarchical_variants.csv and hierarchical_people.csv (after add_hierarchical), behaviour.csv,
// sureness.csv, items.csv, ratings.csv, and models.csv where models are given; of free interaction choices.csv and
// exposure.csv. Files without rows are left out.
// leading: columns before all others, where the tables of many studies are to stand below each other.
std::vector<ResultFile> result_files(const StudyResults& results, const Protocol& protocol, const StudyModels* models,
                                     const std::vector<LeadingColumn>& leading = {});

// Writes those files and adds what their columns mean.
void add_results(ExportFolder& files, const StudyResults& results, const Protocol& protocol, const StudyModels* models,
                 std::vector<DictionaryRow>& dictionary);
// Those files alone, with dictionary.csv and datapackage.json for all of them.
void write_results(ExportFolder& files, const StudyResults& results, const Protocol& protocol,
                   const StudyModels* models);

}  // namespace jnd
