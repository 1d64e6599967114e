#include "runner/console/session_summary.h"

#include <fmt/format.h>

#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

// The study's name with an ending, in the same folder.
std::string copy_name(const std::string& study) {
  static const std::string kEnding = ".sqlite";
  const bool ends = study.size() > kEnding.size() && study.ends_with(kEnding);
  return (ends ? study.substr(0, study.size() - kEnding.size()) : study) + "-copy" + kEnding;
}

// As a shell takes it.
std::string quoted(const std::string& path) {
  constexpr const char* kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./,:@%+=";
  return path.find_first_not_of(kPlain) == std::string::npos ? path : shell_quoted(path);
}

}  // namespace

std::string summary_text(const SessionSummary& summary) {
  const std::string study = printable(quoted(summary.study));
  std::string text = fmt::format("  {:<9} {} of {}, {} voided\n", summary.free_interaction ? "objects" : "trials",
                                 summary.trials_done, summary.trials_total, summary.trials_voided);
  text += fmt::format("  this run  {}\n", duration_text(summary.run_s));
  text += fmt::format("  saved in  {}\n", printable(summary.study));
  if (summary.resumable) text += "  next      the same command goes on with it\n";
  text += fmt::format("  {:<9} jnd status {}\n", summary.resumable ? "" : "next", study);
  text += fmt::format("            jnd verify {}\n", study);
  text += fmt::format("            jnd backup {} --to {}", study, printable(quoted(copy_name(summary.study))));
  return text;
}

}  // namespace jnd
