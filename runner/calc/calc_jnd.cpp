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
#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "runner/calc/calc.h"
#include "runner/calc/csv_counts.h"
#include "runner/calc/trials_input.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"
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

struct GroupResult {
  std::vector<std::optional<JndEstimate>> estimates;  // in the order of kJndMethods; none: not of such data
  std::vector<std::optional<FitQuality>> qualities;   // of the maximum-likelihood methods
  std::optional<JndBootstrap> bootstrap;              // of least_squares
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
    if (count.level == 0) {
      same.n_same = count.n;
      same.false_alarms = count.k;
    } else {
      group.series.push_back({count.level, {count.n, count.k, 0, 0}});
    }
  }
  if (group.series.empty())
    throw InputError(fmt::format("{}: {}: no trial with different stimuli (every difference is 0)", file, unit.name()));
  for (SeriesCounts& series : group.series) {
    series.counts.n_same = same.n_same;
    series.counts.false_alarms = same.false_alarms;
  }
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

// Of series that share their same trials. Fit quality is left out: their cells are not two of each series.
GroupResult result_of_shared(const Group& group, const JndOptions& options) {
  GroupResult result;
  for (const JndMethod method : kJndMethods) {
    result.qualities.emplace_back();
    result.estimates.emplace_back();
    if (!of_own_criteria(method))
      result.estimates.back() =
          estimate_jnd(group.series, group.reference, method, *correction_from(options.correction), SameTrials::shared);
  }
  return result;
}

GroupResult result_of(const Group& group, const JndOptions& options) {
  if (options.trials.trials && group.series.size() > 1) return result_of_shared(group, options);
  const Correction correction = *correction_from(options.correction);
  GroupResult result;
  for (const JndMethod method : kJndMethods) {
    JndEstimate estimate = estimate_jnd(group.series, group.reference, method, correction);
    if (method == JndMethod::least_squares && options.bootstrap > 0) {
      result.bootstrap = least_squares_bootstrap(group.series, correction, options.bootstrap, options.seed);
      estimate.slope_ci_low = result.bootstrap->slope_ci_low;
      estimate.slope_ci_high = result.bootstrap->slope_ci_high;
      estimate.ci_low = result.bootstrap->ci_low;
      estimate.ci_high = result.bootstrap->ci_high;
    }
    std::optional<FitQuality> quality;
    if (is_maximum_likelihood(method)) quality = fit_quality(group.series, method, options.bootstrap, options.seed);
    result.estimates.push_back(std::move(estimate));  // NOLINT(modernize-use-emplace): it is one already
    result.qualities.push_back(quality);
  }
  return result;
}

Json json_of(const JndBootstrap& bootstrap) {
  return {{"replicates", bootstrap.replicates},
          {"ok", bootstrap.ok},
          {"no_sensitivity", bootstrap.no_sensitivity},
          {"ceiling", bootstrap.ceiling},
          {"no_information", bootstrap.no_information}};
}

Json json_of(const FitQuality& quality) {
  return {{"status", to_string(quality.status)},
          {"df", quality.degrees_of_freedom},
          {"deviance", json_number(quality.deviance)},
          {"deviance_p", json_number(quality.deviance_p)},
          {"pearson", json_number(quality.pearson)},
          {"pearson_p", json_number(quality.pearson_p)},
          {"deviance_p_bootstrap", json_number(quality.deviance_p_bootstrap)},
          {"pearson_p_bootstrap", json_number(quality.pearson_p_bootstrap)},
          {"replicates", quality.replicates}};
}

Json json_of(const JndEstimate& estimate) {
  Json json = {{"slope", json_number(estimate.slope)},
               {"jnd", json_number(estimate.jnd)},
               {"weber", json_number(estimate.weber)},
               {"ci_low", json_number(estimate.ci_low)},
               {"ci_high", json_number(estimate.ci_high)},
               {"log_likelihood", json_number(estimate.log_likelihood)},
               {"status", to_string(estimate.status)},
               {"cautions", Json::array()},
               {"slope_ci_low", json_number(estimate.slope_ci_low)},
               {"slope_ci_high", json_number(estimate.slope_ci_high)},
               {"series_used", estimate.series_used}};
  for (const Caution caution : estimate.cautions) json["cautions"].push_back(to_string(caution));
  return json;
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

void print_json(const Group& group, const GroupResult& result, bool falling) {
  Json line = {{"participant", group.participant},
               {"condition", group.condition},
               {"reference", group.reference},
               {"series", group.series.size()},
               {"falling", falling}};
  for (std::size_t i = 0; i < kJndMethods.size(); ++i) {
    if (!result.estimates[i]) {
      line[std::string(to_string(kJndMethods[i]))] = {
          {"slope", nullptr}, {"jnd", nullptr}, {"status", "shared_same_trials"}};
      continue;
    }
    Json method = json_of(*result.estimates[i]);
    if (kJndMethods[i] == JndMethod::least_squares && result.bootstrap)
      method["bootstrap"] = json_of(*result.bootstrap);
    if (result.qualities[i]) method["fit"] = json_of(*result.qualities[i]);
    line[std::string(to_string(kJndMethods[i]))] = std::move(method);
  }
  fmt::print("{}\n", json_line(line));
}

std::string jnd_number(double value) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return fmt::format("{:.4g}", value);
}

std::string percent(double fraction) {
  return std::isnan(fraction) ? "-" : fmt::format("{:.1f} %", 100 * fraction);
}

std::string interval(const JndEstimate& estimate) {
  return range_text(jnd_number(estimate.ci_low), jnd_number(estimate.ci_high));
}

// The p value to look at: of the replicates where there are any.
std::string fit_p(const std::optional<FitQuality>& quality) {
  if (!quality) return "-";
  if (!std::isnan(quality->deviance_p_bootstrap)) return jnd_number(quality->deviance_p_bootstrap);
  return quality->status == FitStatus::few_trials ? "few_trials" : jnd_number(quality->deviance_p);
}

std::string cautions_of(const JndEstimate& estimate) {
  std::string text;
  if (estimate.status != JndStatus::ok) text = to_string(estimate.status);
  for (const Caution caution : estimate.cautions) text += (text.empty() ? "" : ", ") + std::string(to_string(caution));
  return text;
}

void add_rows(TextTable& table, const Group& group, const GroupResult& result) {
  for (std::size_t i = 0; i < kJndMethods.size(); ++i) {
    if (!result.estimates[i]) {
      table.add({"", "", std::string(to_string(kJndMethods[i])), "-", "-", "-", "-", "-", "shared_same_trials"});
      continue;
    }
    const JndEstimate& estimate = *result.estimates[i];
    table.add({i == 0 ? printable(group.participant) : "", i == 0 ? printable(group.condition) : "",
               std::string(to_string(kJndMethods[i])), jnd_number(estimate.jnd), interval(estimate),
               percent(estimate.weber), jnd_number(estimate.slope), fit_p(result.qualities[i]), cautions_of(estimate)});
  }
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
  using Align = TextTable::Align;
  TextTable table({"participant", "condition", "method", "JND", "95 % CI", "Weber", "slope", "fit p", "cautions"},
                  {Align::left, Align::left, Align::left, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::left});
  for (const Group& group : groups) {
    const GroupResult result = [&] {
      const WorkLine working(fmt::format("{} {}", group.participant, group.condition));
      return result_of(group, options);
    }();
    const bool falling = falls(group, options.trials.trials);
    if (options.input.json) {
      print_json(group, result, falling);
      continue;
    }
    if (&group != &groups.front()) table.rule();
    add_rows(table, group, result);
  }
  if (options.input.json) return exit_code::kDone;
  fmt::print(
      "{}\n{}\n{}\n", bold("Thresholds"),
      dim(fmt::format("JND: difference at d' = 1, in the unit of delta; Weber fraction = JND / {}; slope: d' per "
                      "unit; closed forms on {} rates, maximum likelihood (ml_*) on raw counts",
                      options.reference > 0 ? fmt::format("{:g}", options.reference) : std::string("the standard"),
                      options.correction)),
      table.text());
  fmt::print("{}\n", dim(options.bootstrap > 0
                             ? fmt::format("Intervals: profile likelihood (ml_*), {} bootstrap replicates "
                                           "(least_squares); fit p: deviance, by the same number of replicates.",
                                           options.bootstrap)
                             : std::string("Intervals: profile likelihood (ml_*); --bootstrap gives least_squares one. "
                                           "fit p: deviance against chi-square; few_trials: too few for it, "
                                           "--bootstrap draws one.")));
  if (options.trials.trials)
    fmt::print("{}\n", dim("The same trials go with every difference of their participant and condition: closed forms "
                           "take them for\neach, ml_*_common once; shared_same_trials: needs same trials of each "
                           "series of its own."));
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
