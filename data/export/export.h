// Tidy CSV files of a study: sub-P01/{trials,cells,report}.csv, group.csv and the other results, dictionary.csv,
// methods.md, and on request the ticks of every interval, sub-P01/telemetry/trial-007-attempt-1-interval-1.csv.
// RFC 4180 with LF, UTF-8 without BOM, decimal points in any locale, full precision, rows in a fixed order.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "data/results/study_results.h"
#include "data/study/study.h"
#include "protocols/protocol.h"

namespace jnd {

struct TelemetryExport {
  std::vector<std::string> limit_names;  // of the bits of TickRecord::limits, lowest first
};

// telemetry: given where the ticks are to be written too, voided attempts' among them.
// Writes into a fresh folder beside `folder` and renames it into place, so that a failed export leaves nothing half
// written. Returns the files, relative. Throws StorageError; also where folder exists and replace is false.
std::vector<std::string> export_csv(const Study& study, const Protocol& protocol, const StudyResults& results,
                                    const std::filesystem::path& folder, bool replace,
                                    const std::optional<TelemetryExport>& telemetry = {});

}  // namespace jnd
