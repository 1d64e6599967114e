// The report of a study: one HTML page that needs nothing else. No script, nothing fetched, readable on screen, in dark
// mode and in print. The same study gives the same bytes: no date, no random number.
//
// All text of a study (titles, codes, questions, reasons) is escaped; a content security policy in the page forbids
// scripts and every load besides.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "data/fields/block.h"
#include "data/results/study_results.h"
#include "protocols/protocol.h"
#include "runner/figures/figure.h"

namespace jnd {

// Where the numbers come from.
struct ReportFacts {
  std::string program_version;              // "0.3.0"
  std::string study_file;                   // its name, without folders
  std::optional<std::uint64_t> study_seed;  // none while it is sealed
  std::vector<std::string> other_kinds;     // sessions in the study that are not in the report: "pilot", ...
};

// figures: study_figures(results, protocol). methods_markdown: see report_markdown.h; the section is left out where it
// is empty.
std::string report_page(const StudyResults& results, const Protocol& protocol, const std::vector<Block>& blocks,
                        const std::vector<Figure>& figures, const std::string& methods_markdown,
                        const ReportFacts& facts);

}  // namespace jnd
