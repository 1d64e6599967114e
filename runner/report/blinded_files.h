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

// monitoring.csv, coded.csv and dictionary.csv. Throws StorageError, as all here.
void write_blinded_results(ExportFolder& files, const BlindedResults& results, const Protocol& protocol);

// The same with sessions.csv and sub-PARTICIPANT/trials.csv, whose rows have no stimulus, no answer and coded
// conditions. Returns the files, relative.
std::vector<std::string> export_blinded(const Study& study, const Protocol& protocol, const BlindedResults& results,
                                        const std::filesystem::path& folder, bool replace);

// One page of HTML that needs nothing else.
std::string blinded_page(const BlindedResults& results, const Protocol& protocol, const std::string& study_file);

}  // namespace jnd
