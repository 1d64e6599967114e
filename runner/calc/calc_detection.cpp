// jnd calc sdt: d' of counts, model by model. jnd calc coverage: how often its intervals and tests are right.
#include "runner/calc/calc_detection.h"

#include <array>
#include <cstdint>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/detection/coverage.h"
#include "protocols/input/csv_table.h"
#include "runner/calc/calc.h"
#include "runner/calc/csv_counts.h"
#include "runner/calc/trials_input.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/progress_bar.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

struct SdtOptions {
  CalcInput input;
  TrialOptions trials;
};

// The rows of many cells: few of them have counts that no other has, and those cost a millisecond each.
class DetectionRows {
 public:
  const DetectionRow& of(const Counts& counts) {
    if (known_.size() == kMostKnown) known_.clear();
    const auto [place, added] =
        known_.try_emplace({counts.n_diff, counts.hits, counts.n_same, counts.false_alarms}, DetectionRow{});
    if (added) place->second = detection_row(counts);
    return place->second;
  }

 private:
  static constexpr std::size_t kMostKnown = 100'000;
  std::map<std::array<int, 4>, DetectionRow> known_;
};

// A cell whose row is to come.
struct CountedCell {
  NamedDetectionRow named;  // without its numbers
  Counts counts;
};

std::vector<CountedCell> counted_cells(const SdtOptions& options) {
  refuse_trial_options(options.trials, kSameDifferentUse);
  const CsvTable table = CsvTable::read(options.input.file, {"id", "n_diff", "hits", "n_same", "false_alarms"});
  std::vector<CountedCell> cells;
  for (std::size_t row = 0; row < table.rows(); ++row)
    cells.push_back({{std::string(table.text(row, "id")), {}}, counts_of(table, row)});
  return cells;
}

// A cell for each difference; the same trials of a unit go with all of its differences.
std::vector<CountedCell> cells_of_trials(const SdtOptions& options) {
  const TrialTable table = read_trials(options.input.file, options.trials, kSameDifferentUse);
  const std::vector<std::vector<TrialCount>> counts = count_trials(table);
  std::vector<CountedCell> cells;
  for (std::size_t unit = 0; unit < counts.size(); ++unit) {
    const TrialUnit& of = table.units[unit];
    Counts same;
    for (const TrialCount& count : counts[unit])
      if (count.level == 0) {
        same.n_same = count.n;
        same.false_alarms = count.k;
      }
    for (const TrialCount& count : counts[unit]) {
      if (count.level == 0 && counts[unit].size() > 1) continue;
      Counts cell = same;
      if (count.level != 0) {
        cell.n_diff = count.n;
        cell.hits = count.k;
      }
      cells.push_back(
          {{fmt::format("{} / {:g}", of.name(), count.level), {}, of.participant, of.condition, count.level}, cell});
    }
  }
  return cells;
}

int sdt(const SdtOptions& options) {
  // The whole file is read before anything is printed: a mistake in the last row leaves no half an answer.
  const std::vector<CountedCell> cells = options.trials.trials ? cells_of_trials(options) : counted_cells(options);
  std::vector<NamedDetectionRow> rows;
  DetectionRows known;
  ProgressBar progress("rows", static_cast<std::int64_t>(cells.size()));
  for (std::size_t row = 0; row < cells.size(); ++row) {
    constexpr std::size_t kRowsOfASecond = 1000;
    if (row > 0 && row % kRowsOfASecond == 0) progress.update(static_cast<std::int64_t>(row));
    NamedDetectionRow named = cells[row].named;
    named.row = known.of(cells[row].counts);
    if (options.input.json)
      fmt::print("{}\n", json_line(detection_json(named)));
    else
      rows.push_back(named);
  }
  if (!options.input.json) fmt::print("{}", detection_text(rows));
  return exit_code::kDone;
}

struct CoverageOptions {
  std::vector<int> trials = {6, 12, 24, 48, 100, 200};
  bool json = false;
};

constexpr double kDprimes[] = {0, 0.5, 1, 1.5, 2};
constexpr double kCriteria[] = {-0.5, 0, 0.5};

void print_coverage_json(const CoverageOptions& options) {
  for (const int trials : options.trials) {
    const ProfileCoverage coverage(trials);
    for (const double criterion : kCriteria) {
      const TestSizes sizes = test_sizes(trials, criterion);
      nlohmann::ordered_json line = {{"trials_a_class", trials}, {"criterion", criterion}};
      line["coverage"] = nlohmann::ordered_json::array();
      for (const double dprime : kDprimes)
        line["coverage"].push_back({{"dprime", dprime}, {"profile", coverage.at(dprime, criterion)}});
      line["test_sizes"] = {{"yes_no_05", sizes.yes_no_05},
                            {"yes_no_01", sizes.yes_no_01},
                            {"differencing_05", sizes.differencing_05},
                            {"differencing_01", sizes.differencing_01}};
      fmt::print("{}\n", json_line(line));
    }
  }
}

int coverage(const CoverageOptions& options) {
  if (options.json) {
    print_coverage_json(options);
    return exit_code::kDone;
  }
  fmt::print("Coverage of the 95 % profile-likelihood interval of the yes-no d', in percent:\n\n");
  fmt::print("| trials per class | c | d' = 0 | 0.5 | 1 | 1.5 | 2 |\n|---:|---:|---:|---:|---:|---:|---:|\n");
  for (const int trials : options.trials) {
    const ProfileCoverage coverage(trials);
    for (const double criterion : kCriteria) {
      fmt::print("| {} | {} |", trials, criterion);
      for (const double dprime : kDprimes) fmt::print(" {:.1f} |", 100 * coverage.at(dprime, criterion));
      fmt::print("\n");
    }
  }
  fmt::print("\nSize of the tests of d' = 0, in percent of experiments that have p <= 5 % and p <= 1 %:\n\n");
  fmt::print("| trials per class | c | yes-no 5 % | yes-no 1 % | differencing 5 % | differencing 1 % |\n");
  fmt::print("|---:|---:|---:|---:|---:|---:|\n");
  for (const int trials : options.trials)
    for (const double criterion : kCriteria) {
      const TestSizes sizes = test_sizes(trials, criterion);
      fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", trials, criterion, 100 * sizes.yes_no_05,
                 100 * sizes.yes_no_01, 100 * sizes.differencing_05, 100 * sizes.differencing_01);
    }
  return exit_code::kDone;
}

}  // namespace

void add_calc_detection(CommandTree& calc) {
  const auto [detection, counts] = calc.add("sdt", "d' of same-different counts, under every model and correction",
                                            "jnd calc sdt counts.csv --json", sdt);
  add_input(detection, counts.input, "id, n_diff, hits, n_same, false_alarms");
  add_trial_options(detection, counts.trials, kSameDifferentUse);

  const auto [command, options] =
      calc.add("coverage", "How often the intervals and tests of sdt are right, by exact enumeration",
               "jnd calc coverage --trials 12,48", coverage);
  command.add_option("--trials", options.trials, "trials per class, each 1 to 500")
      .delimiter(',')
      .range(1, 500)
      .show_default();
  command.add_flag("--json", options.json, "machine-readable, a line per number of trials and criterion");
}

// The JSON line of a row of `jnd calc sdt`.

namespace {

using nlohmann::ordered_json;

ordered_json yes_no_json(const YesNo& result) {
  return {{"hit_rate", json_number(result.hit_rate)}, {"false_alarm_rate", json_number(result.false_alarm_rate)},
          {"z_hit", json_number(result.z_hit)},       {"z_false_alarm", json_number(result.z_false_alarm)},
          {"dprime", json_number(result.dprime)},     {"criterion", json_number(result.criterion)},
          {"ln_beta", json_number(result.ln_beta)},   {"se", json_number(result.se)},
          {"ci_low", json_number(result.ci_low)},     {"ci_high", json_number(result.ci_high)}};
}

ordered_json profile_json(const DprimeProfile& profile) {
  return {{"dprime", json_number(profile.dprime)},   {"ci_low", json_number(profile.ci_low)},
          {"ci_high", json_number(profile.ci_high)}, {"log_likelihood", json_number(profile.log_likelihood)},
          {"p_value", json_number(profile.p_value)}, {"status", to_string(profile.status)}};
}

ordered_json differencing_json(const Differencing& result) {
  return {{"status", to_string(result.fit.status)},    {"dprime", json_number(result.fit.dprime)},
          {"tau", json_number(result.fit.tau)},        {"se_dprime", json_number(result.fit.se_dprime)},
          {"se_tau", json_number(result.fit.se_tau)},  {"log_likelihood", json_number(result.fit.log_likelihood)},
          {"ci_low", json_number(result.ci_low)},      {"ci_high", json_number(result.ci_high)},
          {"tau_ci_low", json_number(result.tau_low)}, {"tau_ci_high", json_number(result.tau_high)},
          {"p_value", json_number(result.p_value)}};
}

// Under no_sensitivity the likelihood-ratio observer has no d'; the unit slope is sign-reflected.
ordered_json independent_json(const IndependentObservation& result, const YesNo& scores) {
  const bool reflected = scores.status == RateStatus::ok && !(scores.dprime > 0);
  return {{"unit_slope", json_number(result.unit_slope)},
          {"exact", json_number(result.exact)},
          {"status", reflected ? "no_sensitivity" : to_string(scores.status)}};
}

}  // namespace

ordered_json detection_json(const NamedDetectionRow& named) {
  const DetectionRow& row = named.row;
  ordered_json out = {{"id", named.id}};
  if (named.participant) out["participant"] = *named.participant;
  if (named.condition) out["condition"] = *named.condition;
  if (named.difference) out["delta"] = *named.difference;
  out["n_diff"] = row.counts.n_diff;
  out["hits"] = row.counts.hits;
  out["n_same"] = row.counts.n_same;
  out["false_alarms"] = row.counts.false_alarms;
  out["status"] = to_string(row.status);
  out["raw"] = {{"hit_rate", json_number(row.none.raw_hit_rate)},
                {"false_alarm_rate", json_number(row.none.raw_false_alarm_rate)}};
  out["yes_no"] = {{"none", yes_no_json(row.none)},
                   {"loglinear", yes_no_json(row.loglinear)},
                   {"half", yes_no_json(row.half)},
                   {"profile", profile_json(row.profile)}};
  out["differencing"] = differencing_json(row.differencing);
  out["differencing_loglinear"] = {{"status", to_string(row.differencing_loglinear.status)},
                                   {"dprime", json_number(row.differencing_loglinear.dprime)},
                                   {"tau", json_number(row.differencing_loglinear.tau)}};
  out["independent"] = {{"loglinear", independent_json(row.independent_loglinear, row.loglinear)},
                        {"half", independent_json(row.independent_half, row.half)}};
  out["bootstrap"] = {{"mean", json_number(row.bootstrap.mean)},
                      {"sd", json_number(row.bootstrap.sd)},
                      {"q025", json_number(row.bootstrap.q025)},
                      {"q975", json_number(row.bootstrap.q975)}};
  return out;
}

// `jnd calc sdt` for a person.

namespace {

using Align = TextTable::Align;

std::string number(double value) {
  return number_text(value, 3);
}

std::string yes_no_table(const std::vector<NamedDetectionRow>& rows) {
  TextTable table({"id", "hits", "false alarms", "d'", "95 % profile", "p", "c", "ln beta", "se", "status"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right, Align::left});
  for (const auto& [id, row, participant, condition, difference] : rows)
    table.add({printable(id), fmt::format("{}/{}", row.counts.hits, row.counts.n_diff),
               fmt::format("{}/{}", row.counts.false_alarms, row.counts.n_same), number(row.loglinear.dprime),
               range_text(row.profile.ci_low, row.profile.ci_high, 3), p_value_text(row.profile.p_value),
               number(row.loglinear.criterion), number(row.loglinear.ln_beta), number(row.loglinear.se),
               std::string(to_string(row.status))});
  return table.text();
}

std::string model_table(const std::vector<NamedDetectionRow>& rows) {
  TextTable table({"id", "yes-no raw", "half", "bootstrap 95 %", "differencing raw", "95 % profile", "p one-sided",
                   "log-linear", "independent", "exact"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right, Align::right});
  for (const auto& [id, row, participant, condition, difference] : rows)
    table.add({printable(id), number(row.none.dprime), number(row.half.dprime),
               range_text(row.bootstrap.q025, row.bootstrap.q975, 3), number(row.differencing.fit.dprime),
               range_text(row.differencing.ci_low, row.differencing.ci_high, 3), p_value_text(row.differencing.p_value),
               number(row.differencing_loglinear.dprime), number(row.independent_loglinear.unit_slope),
               number(row.independent_loglinear.exact)});
  return table.text();
}

}  // namespace

std::string detection_text(const std::vector<NamedDetectionRow>& rows) {
  int missing = 0, no_information = 0;
  for (const auto& [id, row, participant, condition, difference] : rows) {
    missing += row.status == RateStatus::missing;
    no_information += row.status == RateStatus::no_information;
  }
  std::string text = bold("yes-no model, log-linear correction") + "\n" + yes_no_table(rows);
  text +=
      dim("Profile-likelihood interval and two-sided test of d' = 0 on the raw counts; se: Gourevitch and Galanter.");
  text += "\n\n" + bold("d' of the same counts under other corrections and models") + "\n" + model_table(rows);
  text += dim(
      "Differencing: maximum likelihood on raw counts, then of log-linear rates. Independent observation, log-linear\n"
      "rates: unit slope, and the exact likelihood-ratio observer. d' of different models are different quantities.");
  text += "\n";
  if (missing > 0) text += warn(fmt::format("{} of {} rows lack a class: no d'.", missing, rows.size())) + "\n";
  if (no_information > 0)
    text += warn(fmt::format("{} of {} rows hold one and the same answer throughout: their d' is the arithmetic of the "
                             "correction, not an observation.",
                             no_information, rows.size())) +
            "\n";
  return text;
}

}  // namespace jnd
