// jnd calc jnd: thresholds of every participant and condition in a CSV of counts, by every method side by side.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "analysis/thresholds/fit_quality.h"
#include "analysis/thresholds/jnd.h"
#include "analysis/thresholds/jnd_bootstrap.h"
#include "data/blocks/common_fields.h"
#include "data/blocks/part_fields.h"
#include "data/fields/number_text.h"
#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "runner/calc/calc.h"
#include "runner/calc/calc_output.h"
#include "runner/calc/trials_input.h"
#include "runner/results/block_output.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/work_line.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

struct JndOptions {
  CalcInput input;
  TrialOptions trials;
  double reference = 0;  // 0: not given
  std::string correction = "loglinear";
  int bootstrap = 0;
  std::uint64_t seed = 1;
};

// The series of one participant and condition, in the order of the file.
struct Group {
  std::string participant, condition;
  double reference = 0;
  std::vector<SeriesCounts> series;
};

// What a method says of a group.
struct JndRow {
  std::string participant, condition;
  JndMethod method;
  bool shared = false;  // no estimate: the method needs same trials of each series
  JndEstimate estimate{};
  std::optional<FitQuality> quality{};      // of the maximum-likelihood methods
  std::optional<JndBootstrap> bootstrap{};  // of least_squares
};

SeriesCounts series_of(const CsvTable& table, std::size_t row) {
  SeriesCounts series;
  series.difference = table.number(row, "delta", {-1e300, 1e12});
  if (!(series.difference > 0))
    table.fail(row, "delta", fmt::format("{} is not a difference between two stimuli", series.difference),
               "delta is above 0, in the unit of the reference; equal pairs are counted in n_same");
  series.counts = counts_of(table, row);
  return series;
}

// In order of first appearance. A difference may occur twice in a group: two series, each with its own criterion.
std::vector<Group> groups_of(const CsvTable& table, double reference) {
  std::vector<Group> groups;
  std::map<std::pair<std::string, std::string>, std::size_t> places;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const SeriesCounts series = series_of(table, row);
    const std::pair<std::string, std::string> key(table.text(row, "participant"), table.text(row, "condition"));
    const auto [place, added] = places.try_emplace(key, groups.size());
    if (added) groups.push_back({key.first, key.second, reference, {}});
    groups[place->second].series.push_back(series);
  }
  return groups;
}

Group group_of_trials(const JndOptions& options, const std::string& file, const TrialUnit& unit,
                      const std::vector<TrialCount>& counts) {
  Group group;
  group.participant = unit.participant.value_or("");
  group.condition = unit.condition.value_or("");
  group.reference = options.reference > 0 ? options.reference : unit.standard.value_or(0);
  if (!(group.reference > 0))
    throw UsageError(
        "--reference is required: the base of the Weber fraction (or --standard, where levels are absolute)");
  Counts same;
  for (const TrialCount& count : counts) {
    if (count.level < 0)
      throw InputError(fmt::format(
          "{}: {}: {:g} is not a difference between two stimuli (differences are above 0, and 0 on same trials; "
          "where the level is absolute, give --standard)",
          file, unit.name(), count.level));
    if (count.level == 0)
      same = {0, 0, count.n, count.k};
    else
      group.series.push_back({count.level, {count.n, count.k, 0, 0}});
  }
  if (group.series.empty())
    throw InputError(fmt::format("{}: {}: no trial with different stimuli (every difference is 0)", file, unit.name()));
  for (SeriesCounts& series : group.series) series.counts += same;
  return group;
}

std::vector<Group> groups_of_trials(const JndOptions& options) {
  const TrialTable table = read_trials(options.input.file, options.trials, kSameDifferentUse);
  const std::vector<std::vector<TrialCount>> counts = count_trials(table);
  std::vector<Group> groups;
  for (std::size_t unit = 0; unit < counts.size(); ++unit) {
    groups.push_back(group_of_trials(options, table.file, table.units[unit], counts[unit]));
    if (groups.back().series.size() > 1 && options.bootstrap > 0)
      throw UsageError("--bootstrap draws every series by itself, but these share their same trials: leave it out");
  }
  return groups;
}

bool of_own_criteria(JndMethod method) noexcept {
  return method == JndMethod::ml_yes_no_series || method == JndMethod::ml_differencing_series;
}

// Of each method. Fit quality of shared same trials is left out: their cells are not two of each series.
std::vector<JndRow> rows_of(const Group& group, const JndOptions& options) {
  const Correction correction = *correction_from(options.correction);
  const bool shared = options.trials.trials && group.series.size() > 1;
  std::vector<JndRow> rows;
  for (const JndMethod method : kJndMethods) {
    JndRow& row = rows.emplace_back(JndRow{group.participant, group.condition, method});
    row.shared = shared && of_own_criteria(method);
    if (row.shared) row.estimate.slope = row.estimate.jnd = row.estimate.weber = kNaN;
    if (row.shared) continue;
    row.estimate =
        estimate_jnd(group.series, group.reference, method, correction, shared ? SameTrials::shared : SameTrials::own);
    if (shared) continue;
    if (method == JndMethod::least_squares && options.bootstrap > 0) {
      row.bootstrap = least_squares_bootstrap(group.series, correction, options.bootstrap, options.seed);
      row.estimate.slope_ci_low = row.bootstrap->slope_ci_low;
      row.estimate.slope_ci_high = row.bootstrap->slope_ci_high;
      row.estimate.ci_low = row.bootstrap->ci_low;
      row.estimate.ci_high = row.bootstrap->ci_high;
    }
    if (is_maximum_likelihood(method)) row.quality = fit_quality(group.series, method, options.bootstrap, options.seed);
  }
  return rows;
}

bool falls(const Group& group, bool shared_same_trials) {
  std::vector<AnsweredLevel> levels;
  for (const SeriesCounts& one : group.series) {
    levels.push_back({one.difference, one.counts.n_diff, one.counts.hits});
    if (!shared_same_trials || &one == &group.series.front())
      levels.push_back({0, one.counts.n_same, one.counts.false_alarms});
  }
  return say_falling(levels, fmt::format("{} {}", group.participant, group.condition));
}

// The p value to look at: of the replicates where there are any.
std::string fit_p(const FitQuality& quality) {
  if (!std::isnan(quality.deviance_p_bootstrap)) return p_value_text(quality.deviance_p_bootstrap);
  return quality.status == FitStatus::few_trials ? "few_trials" : p_value_text(quality.deviance_p);
}

std::string cautions_of(const JndRow& row) {
  if (row.shared) return "shared_same_trials";
  std::string text;
  if (row.estimate.status != JndStatus::ok) text = to_string(row.estimate.status);
  for (const Caution caution : row.estimate.cautions) text = joined(text, std::string(to_string(caution)));
  return text;
}

Block jnd_block(const std::vector<JndRow>& rows, const JndOptions& options) {
  using R = JndRow;
  using E = JndEstimate;
  using Q = FitQuality;
  using B = JndBootstrap;
  const FieldTraits table = {.place = Place::table};
  Fields<R> fields;
  add_parts(
      fields, "", "of whom, and how", table, [](const R& r) { return r; }, "participant", &R::participant, "condition",
      &R::condition, "method", &R::method, "fit_p", [](const R& r) { return r.quality ? fit_p(*r.quality) : ""; });
  add_parts(fields, "", "estimate", {}, &R::estimate, "slope", &E::slope, "jnd", &E::jnd);
  add_parts(fields, "", "JND / reference", {.shown = Shown::percent}, &R::estimate, "weber", &E::weber);
  add_parts(fields, "", "its 95 % intervals, and how it came about", {}, &R::estimate, "ci_low", &E::ci_low, "ci_high",
            &E::ci_high, "log_likelihood", &E::log_likelihood, "status", &E::status);
  fields.push_back({"cautions", "status and cautions", cautions_of});
  add_parts(fields, "", "95 % interval of the slope, and how many series it rests on", {}, &R::estimate, "slope_ci_low",
            &E::slope_ci_low, "slope_ci_high", &E::slope_ci_high, "series_used", &E::series_used);
  add_parts(
      fields, "bootstrap.", "replicates of that status", {}, [](const R& r) { return r.bootstrap.value_or(B{}); },
      "replicates", &B::replicates, "ok", &B::ok, "no_sensitivity", &B::no_sensitivity, "ceiling", &B::ceiling,
      "no_information", &B::no_information);
  add_parts(
      fields, "fit.", "how well the model fits", {}, [](const R& r) { return r.quality.value_or(Q{}); }, "status",
      &Q::status, "df", &Q::degrees_of_freedom, "deviance", &Q::deviance, "deviance_p", &Q::deviance_p, "pearson",
      &Q::pearson, "pearson_p", &Q::pearson_p, "deviance_p_bootstrap", &Q::deviance_p_bootstrap, "pearson_p_bootstrap",
      &Q::pearson_p_bootstrap, "replicates", &Q::replicates);
  Block block;
  block.title = "Thresholds";
  block.note = fmt::format(
      "JND: difference at d' = 1, in the unit of delta; Weber fraction = JND / {}; slope: d' per unit; closed forms on {} rates, maximum likelihood (ml_*) on raw counts",
      options.reference > 0 ? fmt::format("{:g}", options.reference) : "the standard", options.correction);
  block.columns = columns("participant", "condition", "method", titled("jnd", "JND"), range("ci_low", "ci_high"),
                          titled("weber", "Weber"), "slope", titled("fit_p", "fit p"), "cautions");
  block.footnotes.push_back(
      options.bootstrap > 0
          ? fmt::format(
                "Intervals: profile likelihood (ml_*), {} bootstrap replicates (least_squares); fit p: deviance, by the same number of replicates.",
                options.bootstrap)
          : "Intervals: profile likelihood (ml_*); --bootstrap gives least_squares one. fit p: deviance against chi-square; few_trials: too few for it, --bootstrap draws one.");
  if (options.trials.trials)
    block.footnotes.emplace_back(
        "The same trials go with every difference of their participant and condition: closed forms take them for each, ml_*_common once; shared_same_trials: needs same trials of each series of its own.");
  return std::move(block.with(fields, rows));
}

Json method_json(const Block& block, std::size_t at, const JndRow& row) {
  if (row.shared) return {{"slope", nullptr}, {"jnd", nullptr}, {"status", "shared_same_trials"}};
  Json json = json_row(block, at);
  json["cautions"] = Json::array();
  for (const Caution caution : row.estimate.cautions) json["cautions"].push_back(to_string(caution));
  if (!row.bootstrap) json.erase("bootstrap");
  if (!row.quality) json.erase("fit");
  return json;
}

std::vector<Group> counted_groups(const JndOptions& options) {
  refuse_trial_options(options.trials, kSameDifferentUse);
  if (!(options.reference > 0)) throw UsageError("--reference is required: the base of the Weber fraction");
  const CsvTable csv = CsvTable::read(
      options.input.file, {"participant", "condition", "delta", "n_diff", "hits", "n_same", "false_alarms"});
  say_look_alikes(csv, "participant", options.input.file);
  return groups_of(csv, options.reference);
}

int run_jnd(const JndOptions& options) {
  // The whole file is read before anything is printed: a mistake in the last row leaves no half an answer.
  const std::vector<Group> groups = options.trials.trials ? groups_of_trials(options) : counted_groups(options);
  std::vector<JndRow> rows;
  std::vector<Json> lines;
  for (const Group& group : groups) {
    const std::vector<JndRow> methods = [&] {
      const WorkLine working(fmt::format("{} {}", group.participant, group.condition));
      return rows_of(group, options);
    }();
    rows.insert(rows.end(), methods.begin(), methods.end());
    lines.push_back({{"participant", group.participant},
                     {"condition", group.condition},
                     {"reference", group.reference},
                     {"series", group.series.size()},
                     {"falling", falls(group, options.trials.trials)}});
  }
  const Block block = jnd_block(rows, options);
  if (!options.input.json) print_rows({block}, false);
  for (std::size_t i = 0; options.input.json && i < rows.size(); ++i) {
    Json& line = lines[i / kJndMethods.size()];
    line[std::string(to_string(rows[i].method))] = method_json(block, i, rows[i]);
    if (i % kJndMethods.size() == kJndMethods.size() - 1) print_json(line);
  }
  return exit_code::kDone;
}

}  // namespace

void add_calc_jnd(CommandTree& calc) {
  const auto [command, options] =
      calc.add("jnd", "JND and Weber fraction from the counts of several series, method by method",
               "jnd calc jnd counts.csv --reference 900", run_jnd);
  add_input(command, options.input,
            "participant, condition, delta, n_diff, hits, n_same, false_alarms: a line a series (the same delta "
            "twice in a condition is two series)");
  command.add_option("--reference", options.reference, "base of the Weber fraction, in the unit of delta, above 0")
      .check(not_above_0);
  command.add_option("--correction", options.correction, "how rates of 0 and 1 are corrected in the closed forms")
      .one_of({"none", "loglinear", "half"})
      .show_default();
  command
      .add_option("--bootstrap", options.bootstrap,
                  "replicates for an interval of least_squares and for the p values of the fits; 0: none")
      .range(0, 1'000'000)
      .show_default();
  command.add_option("--seed", options.seed, "seed of the replicates").show_default();
  add_trial_options(command, options.trials, kSameDifferentUse);
}

}  // namespace jnd
