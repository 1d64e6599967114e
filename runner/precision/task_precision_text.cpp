#include "runner/precision/task_precision_text.h"

#include <cmath>

#include <fmt/format.h>

#include "data/fields/number_text.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/task.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"

namespace jnd {
namespace {

std::string four_digits(double value) {
  constexpr double kRounding = 1e-12;  // what is left of a 0
  if (!std::isfinite(value)) return "-";
  return fmt::format("{:.4g}", std::abs(value) < kRounding ? 0 : value);
}

const Series& series_of(const TaskPrecisionRow& row, const Protocol& protocol) {
  return protocol.series[static_cast<std::size_t>(row.series)];
}

std::string assumed_of(const Protocol& protocol) {
  return task_of(protocol.task.kind).unbiased_words(protocol) +
         ", without lapses, each answer independently of the others; everyone has the same noise";
}

}  // namespace

std::string task_precision_text(const std::vector<TaskPrecisionRow>& rows, const TaskPrecisionQuestion& question,
                                const Protocol& protocol, TableStyle style) {
  const std::vector<TaskOutcome> outcomes = measured_outcomes(protocol);
  const std::string_view unit = to_string(protocol.stimulus.unit);
  PrecisionTable table({"standard", "noise " + std::string(unit), "trials", "outcome", "median", "95 % of participants",
                        "CV", "undefined"});
  for (const TaskPrecisionRow& row : rows) {
    const TaskOutcome& outcome = outcomes[row.outcome];
    const bool first = row.outcome == 0;
    std::string title(outcome.title);
    if (!outcome.unit.empty()) title += fmt::format(" {}", outcome.unit);
    if (outcome.key == protocol.analysis.outcome) title += " *";
    table.add({first ? series_of(row, protocol).name : "", first ? four_digits(row.noise) : "",
               first ? fmt::format("{:.4g}", row.trials) : "", title, four_digits(row.median),
               range_text(four_digits(row.low), four_digits(row.high)), outcome.positive ? percent_text(row.cv) : "",
               percent_text(row.undefined)});
  }
  return table.text(style) + fmt::format("assumed: {}\n", assumed_of(protocol)) +
         fmt::format(
             "{} participants who feel alike were simulated in one condition; to them two equal intervals differ "
             "with a standard deviation of the noise{}. CV: standard deviation over mean of what is measured of "
             "them. * the registered outcome.\n",
             question.participants,
             question.noise
                 ? ""
                 : fmt::format(
                       ", {:g} % of the standard or, where that is 0, of the middle of the levels (--jnd N or --noise N says otherwise)",
                       100 * kAssumedWeber));
}

nlohmann::ordered_json task_precision_json(const std::vector<TaskPrecisionRow>& rows,
                                           const TaskPrecisionQuestion& question, const Protocol& protocol) {
  const std::vector<TaskOutcome> outcomes = measured_outcomes(protocol);
  nlohmann::ordered_json out = {
      {"protocol_sha256", protocol.sha256}, {"registered", protocol.analysis.outcome},
      {"simulated", question.participants}, {"noise_from", question.noise ? "asked" : "assumed"},
      {"assumed", assumed_of(protocol)},    {"precision", nlohmann::ordered_json::array()}};
  for (const TaskPrecisionRow& row : rows)
    out["precision"].push_back({{"standard", series_of(row, protocol).name},
                                {"noise", row.noise},
                                {"trials", row.trials},
                                {"outcome", outcomes[row.outcome].key},
                                {"unit", outcomes[row.outcome].unit},
                                {"median", json_number(row.median)},
                                {"low", json_number(row.low)},
                                {"high", json_number(row.high)},
                                {"cv", json_number(row.cv)},
                                {"undefined", row.undefined}});
  return out;
}

}  // namespace jnd
