// The files of the blocks of results: numbers for machines, unrounded.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data/export/export_folder.h"
#include "data/fields/block.h"
#include "data/fields/csv_writer.h"
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

// A file for each block that has rows. leading: columns before all others, where the tables of many studies are to stand
// below each other.
std::vector<ResultFile> result_files(const std::vector<Block>& blocks, const std::vector<LeadingColumn>& leading = {});

// Writes those files and adds what their columns mean.
void add_results(ExportFolder& files, const std::vector<Block>& blocks, std::vector<DictionaryRow>& dictionary);
// Those files alone, with dictionary.csv and datapackage.json for all of them. holds: as write_descriptions().
void write_results(ExportFolder& files, const std::vector<Block>& blocks, const Protocol& protocol,
                   const std::string& holds);

}  // namespace jnd
