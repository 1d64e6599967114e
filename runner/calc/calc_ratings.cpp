// jnd calc ratings, sureness, identify: answers in ordered categories.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/ratings/identification.h"
#include "analysis/ratings/rating_roc.h"
#include "analysis/ratings/sureness.h"
#include "protocols/input/csv_table.h"
#include "runner/calc/calc.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

// Rows of one group, in the order of the file; without the column one group without a name.
struct RowGroup {
  std::optional<std::string> name;
  std::vector<std::size_t> rows;
};

// Groups in the order of their first row.
std::vector<RowGroup> row_groups(const CsvTable& table) {
  std::vector<RowGroup> groups;
  std::map<std::optional<std::string>, std::size_t> places;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    std::optional<std::string> name;
    if (table.has("group")) name = table.text(row, "group");
    const auto [place, added] = places.try_emplace(name, groups.size());
    if (added) groups.push_back({name, {}});
    groups[place->second].rows.push_back(row);
  }
  return groups;
}

// Null without a name.
nlohmann::ordered_json name_json(const RowGroup& group) {
  return group.name ? nlohmann::ordered_json(*group.name) : nlohmann::ordered_json(nullptr);
}

// "all" without a name; printable.
std::string name_text(const RowGroup& group) {
  return printable(group.name.value_or("all"));
}

// Adds the count in column n of a row to sum. Throws InputError, located, where it is not a whole number of 0 or more,
// or the sum would pass a thousand million.
void add_count(const CsvTable& table, std::size_t row, int& sum) {
  constexpr int kMost = 1'000'000'000;
  const int n = table.integer(row, "n", 0, kMost);
  if (n > kMost - sum)
    table.fail(row, "n", "more than a thousand million answers of one kind", "leave out rows that were counted twice");
  sum += n;
}

using nlohmann::ordered_json;
using Align = TextTable::Align;

constexpr int kMostCategories = 100;  // and classes: the work grows with the third power

std::string rating_number(double value) {
  return number_text(value, 3);
}

std::string significant(double value) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return fmt::format("{:.5g}", value);
}

std::string with_rating_error(const RatingEstimate& estimate) {
  return std::isnan(estimate.se) ? rating_number(estimate.value)
                                 : fmt::format("{:.3f} ± {:.3f}", estimate.value, estimate.se);
}

template <typename Member>
ordered_json estimates_json(const std::vector<RatingEstimate>& estimates, Member member) {
  ordered_json out = ordered_json::array();
  for (const RatingEstimate& estimate : estimates) out.push_back(json_number(estimate.*member));
  return out;
}

// The meaning of each status that some row has, once.
template <typename Status, std::size_t N>
std::string meanings_of(const std::pair<Status, const char*> (&meanings)[N], const std::vector<Status>& found) {
  std::string text;
  for (const auto& [status, meaning] : meanings)
    if (std::find(found.begin(), found.end(), status) != found.end())
      text += warn(fmt::format("{}: {}.", to_string(status), meaning)) + "\n";
  return text;
}

// ---- ratings

struct RatingsOptions {
  CalcInput input;
};

struct RatingCounts {
  std::vector<int> noise, signal;
};

RatingCounts rating_counts(const CsvTable& table, const RowGroup& group) {
  RatingCounts out;
  for (const std::size_t row : group.rows) {
    const auto name = table.text(row, "class");
    if (name != "noise" && name != "signal")
      table.fail(row, "class", fmt::format("\"{}\" is no class", printable(name)), "classes are noise and signal");
    const auto category = static_cast<std::size_t>(table.integer(row, "category", 1, kMostCategories));
    if (category > out.noise.size()) {
      out.noise.resize(category, 0);
      out.signal.resize(category, 0);
    }
    add_count(table, row, (name == "noise" ? out.noise : out.signal)[category - 1]);
  }
  return out;
}

struct NamedRatings {
  RowGroup group;
  RatingCounts counts;
  RatingRoc found;
};

ordered_json equal_json(const EqualVarianceRoc& roc) {
  return {{"loglik", json_number(roc.log_likelihood)},
          {"criteria", estimates_json(roc.criteria, &RatingEstimate::value)},
          {"criteria_se", estimates_json(roc.criteria, &RatingEstimate::se)},
          {"dprime", json_number(roc.dprime.value)},
          {"dprime_se", json_number(roc.dprime.se)},
          {"A_z", json_number(roc.area.value)},
          {"A_z_se", json_number(roc.area.se)},
          {"deviance", json_number(roc.deviance)},
          {"status", to_string(roc.status)}};
}

ordered_json unequal_json(const UnequalVarianceRoc& roc) {
  return {{"loglik", json_number(roc.log_likelihood)},
          {"criteria", estimates_json(roc.criteria, &RatingEstimate::value)},
          {"criteria_se", estimates_json(roc.criteria, &RatingEstimate::se)},
          {"mu", json_number(roc.mu.value)},
          {"mu_se", json_number(roc.mu.se)},
          {"ln_sigma", json_number(roc.ln_sigma.value)},
          {"ln_sigma_se", json_number(roc.ln_sigma.se)},
          {"sigma", json_number(roc.sigma.value)},
          {"zroc_slope", json_number(roc.zroc_slope.value)},
          {"zroc_slope_se", json_number(roc.zroc_slope.se)},
          {"d_a", json_number(roc.d_a.value)},
          {"d_a_se", json_number(roc.d_a.se)},
          {"A_z", json_number(roc.area.value)},
          {"A_z_se", json_number(roc.area.se)},
          {"deviance", json_number(roc.deviance)},
          {"lr_equal_variance", json_number(roc.lr_equal_variance)},
          {"p_equal_variance", json_number(roc.p_equal_variance)},
          {"status", to_string(roc.status)}};
}

ordered_json ratings_json(const NamedRatings& named) {
  const RatingRoc& found = named.found;
  ordered_json out;
  out["group"] = name_json(named.group);
  out["noise"] = named.counts.noise;
  out["signal"] = named.counts.signal;
  out["categories_used"] = found.categories_used;
  out["equal_variance"] = equal_json(found.equal);
  // What there is no model for is null; its status says why.
  const bool no_model = found.unequal.status == RatingStatus::not_applicable;
  out["unequal_variance"] = no_model ? ordered_json(nullptr) : unequal_json(found.unequal);
  out["unequal_variance_status"] = to_string(found.unequal.status);
  out["auc_trapezoid"] = json_number(found.area_trapezoid.value);
  out["auc_delong_se"] = json_number(found.area_trapezoid.se);
  out["status"] = to_string(found.equal.status);
  return out;
}

constexpr std::pair<RatingStatus, const char*> kRatingMeanings[] = {
    {RatingStatus::separated, "noise and signal share one category at most: d' is infinite"},
    {RatingStatus::unbounded,
     "some of the ratings say nothing about sigma: equal variances, or the trapezoids, remain"},
    {RatingStatus::not_applicable, "unequal variances need three categories in use, and classes that overlap"},
    {RatingStatus::no_information, "one and the same rating throughout"},
    {RatingStatus::missing, "no trial of one class"}};

std::string ratings_text(const std::vector<NamedRatings>& rows) {
  const std::vector<Align> align = {Align::left, Align::right, Align::right, Align::right, Align::right, Align::left};
  TextTable equal({"group", "d'", "A_z", "deviance", "trapezoids", "status"}, align);
  TextTable unequal({"group", "d_a", "A_z", "slope of z-ROC", "p of equal variances", "status"}, align);
  std::vector<RatingStatus> statuses;
  for (const auto& [group, counts, found] : rows) {
    equal.add({name_text(group), with_rating_error(found.equal.dprime), with_rating_error(found.equal.area),
               rating_number(found.equal.deviance), with_rating_error(found.area_trapezoid),
               std::string(to_string(found.equal.status))});
    unequal.add({name_text(group), with_rating_error(found.unequal.d_a), with_rating_error(found.unequal.area),
                 with_rating_error(found.unequal.zroc_slope), p_value_text(found.unequal.p_equal_variance),
                 std::string(to_string(found.unequal.status))});
    statuses.push_back(found.equal.status);
    statuses.push_back(found.unequal.status);
  }
  return bold("equal variances") + "\n" + equal.text() + "\n" + bold("unequal variances") + "\n" + unequal.text() +
         dim("Maximum likelihood; ± standard error from the observed information, of the trapezoids after DeLong.") +
         "\n" + meanings_of(kRatingMeanings, statuses);
}

int ratings(const RatingsOptions& options) {
  const CsvTable table = CsvTable::read(options.input.file, {"class", "category", "n"}, {"group"});
  std::vector<NamedRatings> rows;
  for (const RowGroup& group : row_groups(table)) {
    const RatingCounts counts = rating_counts(table, group);
    rows.push_back({group, counts, rating_roc(counts.noise, counts.signal)});
  }
  if (options.input.json)
    for (const NamedRatings& row : rows) fmt::print("{}\n", json_line(ratings_json(row)));
  else
    fmt::print("{}", ratings_text(rows));
  return exit_code::kDone;
}

// ---- sureness

struct SurenessOptions {
  CalcInput input;
};

std::vector<SurenessLevel> sureness_levels_of(const CsvTable& table, const RowGroup& group) {
  std::size_t categories = 0;
  std::map<double, std::vector<int>> counts;
  for (const std::size_t row : group.rows) {
    const double delta = table.number(row, "delta", {0, 1e100});
    const auto category = static_cast<std::size_t>(table.integer(row, "category", 1, kMostCategories));
    std::vector<int>& level = counts[delta + 0.0];
    categories = std::max(categories, category);
    level.resize(std::max(level.size(), category), 0);
    add_count(table, row, level[category - 1]);
  }
  std::vector<SurenessLevel> levels;
  for (auto& [delta, level] : counts) {
    level.resize(categories, 0);
    levels.push_back({delta, std::move(level)});
  }
  return levels;
}

struct NamedSureness {
  RowGroup group;
  std::vector<SurenessLevel> levels;
  Sureness found;
};

ordered_json sureness_json(const NamedSureness& named) {
  const Sureness& found = named.found;
  ordered_json out;
  out["group"] = name_json(named.group);
  out["dK"] = ordered_json::array();
  out["counts"] = ordered_json::array();
  for (const SurenessLevel& level : named.levels) {
    out["dK"].push_back(level.delta);
    out["counts"].push_back(level.counts);
  }
  out["categories_used"] = found.categories_used;
  out["loglik_saturated"] = json_number(found.log_likelihood_saturated);
  out["status"] = to_string(found.status);
  out["loglik"] = json_number(found.log_likelihood);
  out["sigma"] = json_number(found.sigma);
  out["criteria"] = json_numbers(found.criteria);
  out["ln_sigma_se"] = json_number(found.ln_sigma_se);
  out["deviance"] = json_number(found.deviance);
  out["sigma_ci"] = ordered_json::array({json_number(found.sigma_low), json_number(found.sigma_high)});
  out["lr_zero_slope"] = json_number(found.lr_zero_slope);
  out["p_zero_slope"] = json_number(found.p_zero_slope);
  return out;
}

constexpr std::pair<SurenessStatus, const char*> kSurenessMeanings[] = {
    {SurenessStatus::flat, "answers do not move towards \"different\" as delta grows: there is no JND"},
    {SurenessStatus::separated, "answers to different deltas do not overlap: the JND is below what these can show"},
    {SurenessStatus::not_identified, "trials at one delta only"},
    {SurenessStatus::no_information, "one and the same answer throughout"},
    {SurenessStatus::missing, "no trial"}};

std::string sureness_text(const std::vector<NamedSureness>& rows) {
  TextTable table(
      {"group", "JND (sigma)", "95 % profile", "se of ln", "deviance", "p of no slope", "criteria", "status"},
      {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right, Align::left});
  std::vector<SurenessStatus> statuses;
  for (const auto& [group, levels, found] : rows) {
    std::string criteria;
    for (const double criterion : found.criteria) {
      if (!criteria.empty()) criteria += ' ';
      criteria += rating_number(criterion);
    }
    table.add({name_text(group), significant(found.sigma),
               range_text(significant(found.sigma_low), significant(found.sigma_high)),
               rating_number(found.ln_sigma_se), rating_number(found.deviance), p_value_text(found.p_zero_slope),
               criteria.empty() ? "-" : criteria, std::string(to_string(found.status))});
    statuses.push_back(found.status);
  }
  return bold("same-different with sureness, ordered probit") + "\n" + table.text() +
         dim("sigma: the difference that adds d' = 1. Maximum likelihood, profile-likelihood interval.") + "\n" +
         meanings_of(kSurenessMeanings, statuses);
}

int run_sureness(const SurenessOptions& options) {
  const CsvTable table = CsvTable::read(options.input.file, {"delta", "category", "n"}, {"group"});
  std::vector<NamedSureness> rows;
  for (const RowGroup& group : row_groups(table)) {
    const std::vector<SurenessLevel> levels = sureness_levels_of(table, group);
    rows.push_back({group, levels, sureness(levels)});
  }
  if (options.input.json)
    for (const NamedSureness& row : rows) fmt::print("{}\n", json_line(sureness_json(row)));
  else
    fmt::print("{}", sureness_text(rows));
  return exit_code::kDone;
}

// ---- identify

struct IdentifyOptions {
  CalcInput input;
  std::vector<std::string> classes;
};

bool is_number(const std::string& text, double& value) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size();
}

// Every name of the file once: numbers by their size where all are numbers, otherwise as texts.
std::vector<std::string> sorted_classes(const CsvTable& table) {
  std::set<std::string> names;
  for (std::size_t row = 0; row < table.rows(); ++row)
    for (const char* column : {"stimulus", "response"}) names.emplace(table.text(row, column));
  std::vector<std::pair<double, std::string>> numbers;
  for (const std::string& name : names) {
    double value = 0;
    if (is_number(name, value)) numbers.emplace_back(value, name);
  }
  if (numbers.size() < names.size()) return {names.begin(), names.end()};
  std::stable_sort(numbers.begin(), numbers.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> out;
  out.reserve(numbers.size());
  for (const auto& [value, name] : numbers) out.push_back(name);
  return out;
}

std::vector<std::string> classes_of(const CsvTable& table, const IdentifyOptions& options) {
  std::vector<std::string> classes = options.classes;
  for (std::size_t i = 0; i < classes.size(); ++i)
    if (std::find(classes.begin(), classes.begin() + static_cast<std::ptrdiff_t>(i), classes[i]) !=
        classes.begin() + static_cast<std::ptrdiff_t>(i))
      throw UsageError(fmt::format("--classes: {} stands there twice", printable(classes[i])));
  if (classes.empty()) classes = sorted_classes(table);
  if (classes.size() > kMostCategories)
    throw UsageError(fmt::format("identify: {} classes; the most is {}", classes.size(), kMostCategories));
  return classes;
}

std::size_t class_place(const CsvTable& table, std::size_t row, const char* column,
                        const std::vector<std::string>& classes) {
  const auto name = table.text(row, column);
  if (name.empty()) table.fail(row, column, "a name is missing", "every stimulus and every response has one");
  const auto found = std::find(classes.begin(), classes.end(), name);
  if (found == classes.end())
    table.fail(row, column, fmt::format("\"{}\" is no class", printable(name)),
               "--classes has to name every stimulus and response");
  return static_cast<std::size_t>(found - classes.begin());
}

struct NamedIdentification {
  RowGroup group;
  Identification found;
};

ordered_json scale_json(const IdentificationScale& scale) {
  ordered_json adjacent = ordered_json::array();
  for (const AdjacentDprime& one : scale.adjacent)
    adjacent.push_back({{"dprime", json_number(one.dprime)}, {"se", json_number(one.se)}});
  return {{"loglik", json_number(scale.log_likelihood)},
          {"criteria", json_numbers(scale.criteria)},
          {"categories_used", scale.categories_used},
          {"mu", json_numbers(scale.mu)},
          {"adjacent", adjacent},
          {"total_dprime", json_number(scale.total_dprime)},
          {"status", to_string(scale.status)}};
}

ordered_json identification_json(const NamedIdentification& named, const std::vector<std::string>& classes) {
  const Identification& found = named.found;
  ordered_json out;
  out["group"] = name_json(named.group);
  out["classes"] = classes;
  out["n"] = found.trials;
  out["information_bits"] = json_number(found.information_bits);
  out["stimulus_entropy_bits"] = json_number(found.stimulus_entropy_bits);
  out["response_entropy_bits"] = json_number(found.response_entropy_bits);
  out["jackknife_bits"] = json_number(found.jackknife_bits);
  out["miller_madow_bits"] = json_number(found.miller_madow_bits);
  out["table_corrected_bits"] = json_number(found.table_corrected_bits);
  out["relative"] = json_number(found.relative);
  out["equivalent_classes"] = json_number(found.equivalent_classes);
  out["proportion_correct"] = json_number(found.proportion_correct);
  out["adjacent_loglinear"] = json_numbers(found.adjacent_loglinear);
  out["ml"] = scale_json(found.ml);
  out["status"] = to_string(found.ml.status);
  return out;
}

constexpr std::pair<IdentificationStatus, const char*> kIdentificationMeanings[] = {
    {IdentificationStatus::separated, "groups of stimuli share no more than one response: d' between them is infinite"},
    {IdentificationStatus::single_class, "trials of one stimulus only"},
    {IdentificationStatus::no_information, "one and the same response throughout"},
    {IdentificationStatus::missing, "no trial"}};

std::string identification_text(const std::vector<NamedIdentification>& rows, const std::vector<std::string>& classes) {
  TextTable information({"group", "trials", "correct", "bits", "jackknife", "Miller-Madow", "table corrected",
                         "of the stimuli's", "equivalent classes", "status"},
                        {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right,
                         Align::right, Align::right, Align::right, Align::left});
  TextTable steps({"group", "from", "to", "d'", "log-linear"},
                  {Align::left, Align::left, Align::left, Align::right, Align::right});
  std::vector<IdentificationStatus> statuses;
  for (const auto& [group, found] : rows) {
    information.add({name_text(group), std::to_string(found.trials), percent_text(found.proportion_correct),
                     rating_number(found.information_bits), rating_number(found.jackknife_bits),
                     rating_number(found.miller_madow_bits), rating_number(found.table_corrected_bits),
                     percent_text(found.relative), rating_number(found.equivalent_classes),
                     std::string(to_string(found.ml.status))});
    for (std::size_t i = 0; i + 1 < classes.size(); ++i)
      steps.add({name_text(group), printable(classes[i]), printable(classes[i + 1]),
                 with_rating_error({found.ml.adjacent[i].dprime, found.ml.adjacent[i].se}),
                 rating_number(found.adjacent_loglinear[i])});
    statuses.push_back(found.ml.status);
  }
  std::string text = bold("information that responses transmit") + "\n" + information.text();
  if (classes.size() > 1) text += "\n" + bold("d' between neighbours") + "\n" + steps.text();
  return text +
         dim("Bits of the counts as they are, and under three corrections of their bias. d': maximum likelihood, criteria "
             "common\nto all stimuli, ± standard error; beside it that of log-linear rates.") +
         "\n" + meanings_of(kIdentificationMeanings, statuses);
}

int identify(const IdentifyOptions& options) {
  const CsvTable table = CsvTable::read(options.input.file, {"stimulus", "response", "n"}, {"group"});
  const std::vector<std::string> classes = classes_of(table, options);
  std::vector<NamedIdentification> rows;
  for (const RowGroup& group : row_groups(table)) {
    std::vector<std::vector<int>> confusion(classes.size(), std::vector<int>(classes.size(), 0));
    for (const std::size_t row : group.rows) {
      const std::size_t stimulus = class_place(table, row, "stimulus", classes);
      const std::size_t response = class_place(table, row, "response", classes);
      add_count(table, row, confusion[stimulus][response]);
    }
    rows.push_back({group, identification(confusion)});
  }
  if (options.input.json)
    for (const NamedIdentification& row : rows) fmt::print("{}\n", json_line(identification_json(row, classes)));
  else
    fmt::print("{}", identification_text(rows, classes));
  return exit_code::kDone;
}

}  // namespace

void add_calc_ratings(CommandTree& calc) {
  const auto [identify_command, identify_options] =
      calc.add("identify", "Information and d' between neighbours of a confusion matrix",
               "jnd calc identify confusion.csv --classes soft,medium,hard", identify);
  add_input(identify_command, identify_options.input, "stimulus, response, n, and group where there are several");
  identify_command
      .add_option("--classes", identify_options.classes,
                  "names of stimuli and responses from low to high; without it sorted, numbers by size")
      .delimiter(',');

  const auto [ratings_command, ratings_options] =
      calc.add("ratings", "d', d_a and the area under the ROC of rated detection",
               "jnd calc ratings ratings.csv --json", ratings);
  add_input(ratings_command, ratings_options.input,
            "class (noise or signal), category (from 1, surely noise), n, and group where there are several");

  const auto [sureness_command, sureness_options] = calc.add(
      "sureness", "The JND of same-different answers with sureness", "jnd calc sureness answers.csv", run_sureness);
  add_input(sureness_command, sureness_options.input,
            "delta (0 on same trials), category (from 1, same and sure), n, and group where there are several");
}

}  // namespace jnd
