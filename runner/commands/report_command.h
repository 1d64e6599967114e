// jnd report: a study as a page for people.
#pragma once

#include <optional>
#include <string>

namespace jnd {

struct ReportOptions {
  std::string study;
  std::string file;                 // the page; empty: the study's name without extension + "-report.html", beside it
  std::string figures_folder;       // empty: the page's name without extension + "-figures", beside it
  std::optional<std::string> kind;  // real, pilot or simulated
  std::optional<std::string> by;    // nominal or delivered; without it, what the protocol registers
  bool replace = false;             // an earlier report
};

// Writes the page, and every figure as an SVG file of its own. Returns the exit code; throws StorageError, InputError
// and UsageError. A study without sessions of that kind has a page too, which says so.
int command_report(const ReportOptions& options);

}  // namespace jnd
