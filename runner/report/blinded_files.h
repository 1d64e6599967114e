// The files that `export`, `analyze --csv` and `report` write of a blinded study.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "data/export/export_folder.h"
#include "data/study/study.h"
#include "protocols/protocol.h"
#include "runner/results/blinded_results.h"

namespace jnd {

// "real data, in code": what such files hold.
std::string coded_data(SessionKind kind);

// monitoring.csv and coded.csv, with dictionary.csv and datapackage.json. Throws StorageError, as all here.
void write_blinded_results(ExportFolder& files, const BlindedResults& results, const Protocol& protocol);

// The same with participants.csv, sessions.csv and trials.csv, whose rows have no stimulus, no answer and coded
// conditions. What did not count, and what was delivered, stays sealed. Returns the files, relative.
std::vector<std::string> export_blinded(const Study& study, const Protocol& protocol, const BlindedResults& results,
                                        const std::filesystem::path& folder, bool replace);

// One page of HTML that needs nothing else.
std::string blinded_page(const BlindedResults& results, const Protocol& protocol, const std::string& study_file);

}  // namespace jnd
