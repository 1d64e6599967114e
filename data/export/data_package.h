// What describes a folder of CSV files: dictionary.csv for people, and datapackage.json for programs, as a Data Package
// of version 2 (https://datapackage.org). Both are written from the same rows.
#pragma once

#include <string>
#include <vector>

#include "data/export/export_folder.h"
#include "data/fields/csv_writer.h"
#include "protocols/protocol.h"

namespace jnd {

// Writes both, last of all CSV files. dictionary: of every other file; "sub-*/report.csv" is of every participant's.
// Such files share one schema, which gets a file of its own: schema/report.json. holds: "simulated data",
// "real data, in code". Throws StorageError.
void write_descriptions(ExportFolder& files, const Protocol& protocol, const std::string& holds,
                        std::vector<DictionaryRow> dictionary);

}  // namespace jnd
