// jnd calc ratings, sureness, identify: answers in ordered categories.
#include <algorithm>
#include <charconv>
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
#include "data/blocks/part_fields.h"
#include "data/fields/number_text.h"
#include "protocols/input/csv_table.h"
#include "runner/calc/calc.h"
#include "runner/calc/calc_output.h"
#include "runner/calc/interval_fields.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"

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

constexpr int kMostCategories = 100;  // and classes: the work grows with the third power

struct RatingsOptions {
  CalcInput input;
  std::vector<std::string> classes{};  // of identify
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

template <typename Roc>
auto value_of(RatingEstimate Roc::*estimate) {
  return [estimate](const Roc& of) { return (of.*estimate).value; };
}
template <typename Roc>
auto se_of(RatingEstimate Roc::*estimate) {
  return [estimate](const Roc& of) { return null_if_nan((of.*estimate).se); };
}
template <typename Roc>
auto criteria_of(double RatingEstimate::*part) {
  return [part](const Roc& of) {
    std::vector<double> values;
    for (const RatingEstimate& one : of.criteria) values.push_back(one.*part);
    return values;
  };
}

std::vector<Block> ratings_blocks(const std::vector<NamedRatings>& rows) {
  using R = NamedRatings;
  using E = EqualVarianceRoc;
  using U = UnequalVarianceRoc;
  const auto equal_roc = [](const R& r) { return r.found.equal; };
  const auto unequal_roc = [](const R& r) { return r.found.unequal; };
  const std::string fit = "of the fit", estimate = "estimate, or its standard error";
  Fields<R> fields = name_fields<R>("group", [](const R& r) { return r.group.name; });
  add_parts(fields, "equal_variance.", fit, {}, equal_roc, "loglik", &E::log_likelihood, "deviance", &E::deviance,
            "criteria", criteria_of<E>(&RatingEstimate::value), "criteria_se", criteria_of<E>(&RatingEstimate::se),
            "status", &E::status);
  add_parts(fields, "equal_variance.", estimate, {}, equal_roc, "dprime", value_of(&E::dprime), "dprime_se",
            se_of(&E::dprime), "A_z", value_of(&E::area), "A_z_se", se_of(&E::area));
  add_parts(fields, "unequal_variance.", fit, {}, unequal_roc, "loglik", &U::log_likelihood, "deviance", &U::deviance,
            "criteria", criteria_of<U>(&RatingEstimate::value), "criteria_se", criteria_of<U>(&RatingEstimate::se),
            "lr_equal_variance", &U::lr_equal_variance, "status", &U::status);
  add_parts(fields, "unequal_variance.", "of lr_equal_variance", {.shown = Shown::p_value}, unequal_roc,
            "p_equal_variance", &U::p_equal_variance);
  add_parts(fields, "unequal_variance.", estimate, {}, unequal_roc, "mu", value_of(&U::mu), "mu_se", se_of(&U::mu),
            "ln_sigma", value_of(&U::ln_sigma), "ln_sigma_se", se_of(&U::ln_sigma), "sigma", value_of(&U::sigma),
            "zroc_slope", value_of(&U::zroc_slope), "zroc_slope_se", se_of(&U::zroc_slope), "d_a", value_of(&U::d_a),
            "d_a_se", se_of(&U::d_a), "A_z", value_of(&U::area), "A_z_se", se_of(&U::area));
  add_parts(fields, "", "area below the trapezoids", {}, &R::found, "auc_trapezoid",
            value_of(&RatingRoc::area_trapezoid), "auc_delong_se", se_of(&RatingRoc::area_trapezoid));
  add_parts(fields, "", fit, {}, equal_roc, "status", &E::status);
  add_parts(fields, "", fit, {}, unequal_roc, "unequal_variance_status", &U::status);
  Block equal, unequal;
  equal.title = "equal variances";
  equal.columns = columns("name", with_se("equal_variance.dprime", "d'"), with_se("equal_variance.A_z", "A_z"),
                          titled("equal_variance.deviance", "deviance"),
                          share("auc_trapezoid", "auc_delong_se", "trapezoids", " ± "), "status");
  unequal.title = "unequal variances";
  unequal.note = "Maximum likelihood; ± standard error from the observed information, of the trapezoids after DeLong.";
  unequal.columns = columns("name", with_se("unequal_variance.d_a", "d_a"), with_se("unequal_variance.A_z", "A_z"),
                            with_se("unequal_variance.zroc_slope", "slope of z-ROC"),
                            titled("unequal_variance.p_equal_variance", "p of equal variances"),
                            titled("unequal_variance_status", "status"));
  equal.with(fields, rows);
  unequal.with(fields, rows);
  explain(equal, "status",
          {{"separated", "noise and signal share one category at most: d' is infinite"},
           {"no_information", "one and the same rating throughout"},
           {"missing", "no trial of one class"}});
  explain(unequal, "unequal_variance_status",
          {{"unbounded", "some of the ratings say nothing about sigma: equal variances, or the trapezoids, remain"},
           {"not_applicable", "unequal variances need three categories in use, and classes that overlap"}});
  return {equal, unequal};
}

int ratings(const RatingsOptions& options) {
  const CsvTable table = CsvTable::read(options.input.file, {"class", "category", "n"}, {"group"});
  std::vector<NamedRatings> rows;
  for (const RowGroup& group : row_groups(table)) {
    const RatingCounts counts = rating_counts(table, group);
    rows.push_back({group, counts, rating_roc(counts.noise, counts.signal)});
  }
  print_rows(ratings_blocks(rows), options.input.json, [&](ordered_json& line, std::size_t row) {
    line["noise"] = rows[row].counts.noise;
    line["signal"] = rows[row].counts.signal;
    line["categories_used"] = rows[row].found.categories_used;
    // What there is no model for is null; its status says why.
    if (rows[row].found.unequal.status == RatingStatus::not_applicable) line["unequal_variance"] = nullptr;
  });
  return exit_code::kDone;
}

// ---- sureness

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

std::string criteria_text(const Sureness& of) {
  std::string text;
  for (const double one : of.criteria) text.append(text.empty() ? "" : " ").append(number_text(one, 3));
  return text;
}

Block sureness_block(const std::vector<NamedSureness>& rows) {
  using R = NamedSureness;
  using S = Sureness;
  Fields<R> fields = name_fields<R>("group", [](const R& r) { return r.group.name; });
  add_parts(fields, "", "of the ordered probit model", {}, &R::found, "loglik_saturated", &S::log_likelihood_saturated,
            "status", &S::status, "loglik", &S::log_likelihood, "sigma", &S::sigma, "criteria", &S::criteria,
            "ln_sigma_se", &S::ln_sigma_se, "deviance", &S::deviance, "lr_zero_slope", &S::lr_zero_slope);
  add_parts(fields, "", "of lr_zero_slope", {.shown = Shown::p_value}, &R::found, "p_zero_slope", &S::p_zero_slope);
  add_interval(fields, "sigma_ci", ends(&R::found, &S::sigma_low, &S::sigma_high));
  add_parts(fields, "", "the criteria for tables", {.place = Place::table}, &R::found, "criteria_text", criteria_text);
  Block block;
  block.title = "same-different with sureness, ordered probit";
  block.note = "sigma: the difference that adds d' = 1. Maximum likelihood, profile-likelihood interval.";
  block.columns = columns("name", titled("sigma", "JND (sigma)"), interval_column("sigma_ci", "95 % profile"),
                          titled("ln_sigma_se", "se of ln"), "deviance", titled("p_zero_slope", "p of no slope"),
                          titled("criteria_text", "criteria"), "status");
  block.with(fields, rows);
  explain(block, "status",
          {{"flat", "answers do not move towards \"different\" as delta grows: there is no JND"},
           {"separated", "answers to different deltas do not overlap: the JND is below what these can show"},
           {"not_identified", "trials at one delta only"},
           {"no_information", "one and the same answer throughout"},
           {"missing", "no trial"}});
  return block;
}

int run_sureness(const RatingsOptions& options) {
  const CsvTable table = CsvTable::read(options.input.file, {"delta", "category", "n"}, {"group"});
  std::vector<NamedSureness> rows;
  for (const RowGroup& group : row_groups(table)) {
    const std::vector<SurenessLevel> levels = sureness_levels_of(table, group);
    rows.push_back({group, levels, sureness(levels)});
  }
  print_rows({sureness_block(rows)}, options.input.json, [&](ordered_json& line, std::size_t row) {
    line["categories_used"] = rows[row].found.categories_used;
    for (const SurenessLevel& level : rows[row].levels) {
      line["dK"].push_back(level.delta);
      line["counts"].push_back(level.counts);
    }
  });
  return exit_code::kDone;
}

// ---- identify

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

std::vector<std::string> classes_of(const CsvTable& table, const RatingsOptions& options) {
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

struct IdentifiedStep {
  std::string group, from, to;
  double dprime;
  std::optional<double> dprime_se;
  double loglinear;
};

std::vector<Block> identification_blocks(const std::vector<NamedIdentification>& rows,
                                         const std::vector<std::string>& classes) {
  using R = NamedIdentification;
  using I = Identification;
  using S = IdentificationScale;
  Fields<R> fields = name_fields<R>("group", [](const R& r) { return r.group.name; });
  add_parts(fields, "", "trials, and bits of information", {}, &R::found, "n", &I::trials, "information_bits",
            &I::information_bits, "stimulus_entropy_bits", &I::stimulus_entropy_bits, "response_entropy_bits",
            &I::response_entropy_bits, "jackknife_bits", &I::jackknife_bits, "miller_madow_bits", &I::miller_madow_bits,
            "table_corrected_bits", &I::table_corrected_bits, "equivalent_classes", &I::equivalent_classes,
            "adjacent_loglinear", &I::adjacent_loglinear);
  add_parts(fields, "", "shares", {.shown = Shown::percent}, &R::found, "relative", &I::relative, "proportion_correct",
            &I::proportion_correct);
  const auto scale = [](const R& r) { return r.found.ml; };
  add_parts(fields, "ml.", "of the scale by maximum likelihood", {}, scale, "loglik", &S::log_likelihood, "criteria",
            &S::criteria, "mu", &S::mu, "total_dprime", &S::total_dprime, "status", &S::status);
  add_parts(fields, "", "of that scale", {}, scale, "status", &S::status);
  Block information, steps;
  information.title = "information that responses transmit";
  information.columns =
      columns("name", titled("n", "trials"), titled("proportion_correct", "correct"),
              titled("information_bits", "bits"), titled("jackknife_bits", "jackknife"),
              titled("miller_madow_bits", "Miller-Madow"), titled("table_corrected_bits", "table corrected"),
              titled("relative", "of the stimuli's"), titled("equivalent_classes", "equivalent classes"), "status");
  information.note = "Bits of the counts as they are, and under three corrections of their bias.";
  information.with(fields, rows);
  explain(information, "status",
          {{"separated", "groups of stimuli share no more than one response: d' between them is infinite"},
           {"single_class", "trials of one stimulus only"},
           {"no_information", "one and the same response throughout"},
           {"missing", "no trial"}});
  using T = IdentifiedStep;
  std::vector<T> neighbours;
  for (const auto& [group, found] : rows)
    for (std::size_t i = 0; i + 1 < classes.size(); ++i)
      neighbours.push_back({group.name.value_or("all"), classes[i], classes[i + 1], found.ml.adjacent[i].dprime,
                            null_if_nan(found.ml.adjacent[i].se), found.adjacent_loglinear[i]});
  Fields<T> step_fields;
  add_parts(
      step_fields, "", "of two neighbours", {}, [](const T& r) { return r; }, "group", &T::group, "from", &T::from,
      "to", &T::to, "dprime", &T::dprime, "dprime_se", &T::dprime_se, "log-linear", &T::loglinear);
  steps.title = "d' between neighbours";
  steps.note =
      "d': maximum likelihood, criteria common to all stimuli, ± standard error; beside it that of log-linear rates.";
  steps.columns = columns("group", "from", "to", with_se("dprime", "d'"), "log-linear");
  return {information, steps.with(step_fields, std::move(neighbours))};
}

int identify(const RatingsOptions& options) {
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
  print_rows(identification_blocks(rows, classes), options.input.json, [&](ordered_json& line, std::size_t row) {
    const IdentificationScale& scale = rows[row].found.ml;
    line["classes"] = classes;
    line["ml"]["categories_used"] = scale.categories_used;
    line["ml"]["adjacent"] = ordered_json::array();
    for (const AdjacentDprime& one : scale.adjacent)
      line["ml"]["adjacent"].push_back({{"dprime", json_number(one.dprime)}, {"se", json_number(one.se)}});
  });
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
