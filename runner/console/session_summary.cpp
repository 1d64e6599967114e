#include "runner/console/session_summary.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "devices/external/external_settings.h"
#include "runner/terminal/terminal.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

// The study's name with an ending, in the same folder.
std::string copy_name(const std::string& study) {
  static const std::string kEnding = ".sqlite";
  const bool ends = study.size() > kEnding.size() && study.ends_with(kEnding);
  return (ends ? study.substr(0, study.size() - kEnding.size()) : study) + "-copy" + kEnding;
}

}  // namespace

std::string not_as_asked_text(const Deliveries& deliveries) {
  return tr(
      "by its own measure the rig did not deliver what was asked in {} of {} intervals (more than {:.0f} % off): try "
      "it with jnd device test external",
      deliveries.off, deliveries.measured, 100 * kDeliveryTolerance);
}

std::string summary_text(const SessionSummary& summary) {
  const std::string study = shell_word(summary.study);
  std::vector<std::pair<std::string, std::string>> rows = {
      {summary.free_interaction ? tr("objects") : tr("trials"),
       tr("{} of {}, {} voided", summary.trials_done, summary.trials_total, summary.trials_voided)},
      {tr("this run"), duration_text(summary.run_s)},
      {tr("saved in"), printable(summary.study)}};
  if (summary.slowest_waiting_ms > 0)
    rows.emplace_back(tr("rig"),
                      tr("slowest answer {:.0f} of {:.0f} ms while it presented, {:.0f} of {:.0f} ms while it waited",
                         summary.slowest_presenting_ms, 1000 * RigTimeOuts{}.presenting_silent_s,
                         summary.slowest_waiting_ms, 1000 * RigTimeOuts{}.silent_s));
  if (summary.deliveries.off > 0) rows.emplace_back(tr("rig"), not_as_asked_text(summary.deliveries));
  if (summary.resumable)
    rows.emplace_back(tr("next"), summary.moved ? tr("the same command with --study {} goes on with it", study)
                                                : tr("the same command goes on with it"));
  rows.emplace_back(summary.resumable ? "" : tr("next"), "jnd status " + study);
  rows.emplace_back("", "jnd verify " + study);
  rows.emplace_back("", fmt::format("jnd backup {} --to {}", study, shell_word(copy_name(summary.study))));
  std::size_t width = 0;
  for (const auto& row : rows) width = std::max(width, display_width(row.first));
  std::string text;
  for (const auto& [name, what] : rows)
    text += fmt::format("{}  {}{}  {}", text.empty() ? "" : "\n", name, std::string(width - display_width(name), ' '),
                        what);
  return text;
}

}  // namespace jnd
