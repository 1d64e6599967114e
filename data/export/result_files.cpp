#include "data/export/result_files.h"

#include "data/export/data_package.h"

namespace jnd {

std::vector<ResultFile> result_files(const std::vector<Block>& blocks, const std::vector<LeadingColumn>& leading) {
  std::string names, values;
  for (const LeadingColumn& one : leading) {
    names += one.name + ",";
    values += csv_number(one.value) + ",";
  }
  std::vector<ResultFile> files;
  for (const Block& block : blocks) {
    if (block.rows() == 0) continue;
    ResultFile& file = files.emplace_back();
    file.name = block.file();
    file.header = block.csv_header(names);
    file.rows = block.csv_rows(values);
    for (const LeadingColumn& one : leading)
      file.dictionary.push_back({file.name, one.name, one.meaning, "", "", CellType::integer});
    block.describe(file.dictionary);
  }
  return files;
}

void add_results(ExportFolder& files, const std::vector<Block>& blocks, std::vector<DictionaryRow>& dictionary) {
  for (const ResultFile& file : result_files(blocks)) {
    files.write(file.name, file.header + file.rows);
    dictionary.insert(dictionary.end(), file.dictionary.begin(), file.dictionary.end());
  }
}

void write_results(ExportFolder& files, const std::vector<Block>& blocks, const Protocol& protocol,
                   const std::string& holds) {
  std::vector<DictionaryRow> dictionary;
  add_results(files, blocks, dictionary);
  write_descriptions(files, protocol, holds, std::move(dictionary));
}

}  // namespace jnd
