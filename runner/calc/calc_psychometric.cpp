// jnd calc fit: psychometric functions of counts, with intervals, goodness of fit and comparisons of groups.
#include "runner/calc/calc_psychometric.h"

#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "runner/calc/calc.h"
#include "runner/calc/trials_input.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/progress_bar.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"
#include "runner/terminal/work_line.h"

namespace jnd {

namespace {

struct FitOptions {
  CalcInput input;
  TrialOptions trials;
  std::string function, guess, lapse, estimator = "ml", interval = "profile";
  int replicates = 2000;
  std::uint64_t seed = 1;
  double confidence = 0.95;
  bool compare = false;
};

const TrialUse kFitUse = {"grows more frequent with the level", {}, false, true};

// A rate in 0 to below 1; none where the text is "free".
std::optional<double> rate_from(const std::string& text, const char* option) {
  if (text == "free") return std::nullopt;
  double value = -1;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || !(value >= 0 && value < 1))
    throw UsageError(fmt::format("{}: {} is neither a rate from 0 to below 1 nor free", option, text));
  return value;
}

PsychometricModel model_from(const FitOptions& options) {
  PsychometricModel model;
  model.function = psychometric_function_from(options.function).value_or(PsychometricFunction::logistic);
  model.guess = rate_from(options.guess, "--guess");
  model.lapse = rate_from(options.lapse, "--lapse");
  if (model.guess.value_or(kLargestGuess) + model.lapse.value_or(kLargestLapse) >= 1)
    throw UsageError("--guess and --lapse together must stay below 1, so that something is left for the levels");
  if (options.estimator == "map") {
    if (model.lapse) throw UsageError("--estimator map puts a prior on a free lapse: say --lapse free");
    model.estimator = PsychometricEstimator::map;
  }
  return model;
}

struct LevelGroup {
  std::optional<std::string> name, participant, condition;
  std::vector<PsychometricLevel> levels;
};

std::vector<LevelGroup> groups_of(const CsvTable& table, const PsychometricModel& model) {
  // Trials a level are counted in an int; so are those of all rows of one level together.
  constexpr int kMostTrials = 100'000'000;
  std::vector<LevelGroup> groups;
  std::map<std::optional<std::string>, std::size_t> places;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    PsychometricLevel level;
    level.x = table.number(row, "x");
    if (model.function == PsychometricFunction::weibull && level.x <= 0)
      table.fail(row, "x", fmt::format("{:g} is no level of a Weibull function", level.x),
                 "its levels are above 0; for others use gumbel, its form on a linear axis");
    level.n = table.integer(row, "n", 0, kMostTrials);
    level.k = table.integer(row, "k", 0, kMostTrials);
    if (level.k > level.n)
      table.fail(row, "k", fmt::format("{} answers in {} trials", level.k, level.n), "k is at most n");
    std::optional<std::string> name;
    if (table.has("group")) name = table.text(row, "group");
    const auto [place, added] = places.try_emplace(name, groups.size());
    if (added) groups.push_back({name, {}, {}, {}});
    groups[place->second].levels.push_back(level);
  }
  return groups;
}

std::vector<LevelGroup> groups_of_trials(const FitOptions& options, const PsychometricModel& model) {
  const TrialTable table = read_trials(options.input.file, options.trials, kFitUse);
  const std::vector<std::vector<TrialCount>> counts = count_trials(table);
  std::vector<LevelGroup> groups;
  for (std::size_t unit = 0; unit < counts.size(); ++unit) {
    groups.push_back({table.units[unit].name(), table.units[unit].participant, table.units[unit].condition, {}});
    for (const TrialCount& count : counts[unit]) groups.back().levels.push_back({count.level, count.n, count.k});
    if (model.function == PsychometricFunction::weibull && counts[unit].front().level <= 0)
      throw InputError(
          fmt::format("{}: {}: {:g} is no level of a Weibull function (its levels are above 0; for others "
                      "use gumbel, its form on a linear axis)",
                      table.file, groups.back().name.value(), counts[unit].front().level));
  }
  return groups;
}

// Says how far it is where that takes more than some seconds.
PsychometricBootstrap bootstrap_of(const LevelGroup& group, const PsychometricModel& model, const FitOptions& options) {
  constexpr double kMostLevelsWithoutWord = 2e5;  // of all replicates
  const double levels = static_cast<double>(group.levels.size()) * options.replicates;
  std::optional<ProgressBar> bar;
  if (levels > kMostLevelsWithoutWord) bar.emplace("fitting replicates", options.replicates);
  return psychometric_bootstrap(group.levels, model, options.replicates, options.seed, options.confidence,
                                [&bar](int done) {
                                  if (bar) bar->update(done);
                                });
}

PsychometricAnswer answer_for(const LevelGroup& group, const PsychometricModel& model, const FitOptions& options) {
  PsychometricAnswer answer;
  answer.group = group.name;
  answer.participant = group.participant;
  answer.condition = group.condition;
  answer.fit = fit_psychometric(group.levels, model);
  if (options.interval == "bootstrap") {
    answer.bootstrap = bootstrap_of(group, model, options);
    answer.intervals = answer.bootstrap->intervals;
  } else {
    answer.intervals = psychometric_profile(group.levels, model, options.confidence);
  }
  return answer;
}

int fit(const FitOptions& options) {
  const PsychometricModel model = model_from(options);
  std::vector<LevelGroup> groups;
  if (options.trials.trials) {
    groups = groups_of_trials(options, model);
  } else {
    refuse_trial_options(options.trials, kFitUse);
    groups = groups_of(CsvTable::read(options.input.file, {"x", "n", "k"}, {"group"}), model);
  }
  if (options.compare && groups.size() < 2)
    throw InputError(
        fmt::format("{}: --compare needs a column group (of trials: --participant or --condition) "
                    "with at least two groups",
                    options.input.file));
  std::vector<PsychometricAnswer> answers;
  std::optional<PsychometricComparison> comparison;
  try {
    const WorkLine working("fitting " + options.input.file);
    answers.reserve(groups.size());
    for (const LevelGroup& group : groups) answers.push_back(answer_for(group, model, options));
    if (options.compare) {
      std::vector<std::vector<PsychometricLevel>> levels;
      levels.reserve(groups.size());
      for (const LevelGroup& group : groups) levels.push_back(group.levels);
      comparison = compare_psychometric(levels, model);
    }
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", options.input.file, error.what()));
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    std::vector<AnsweredLevel> levels;
    for (const PsychometricLevel& one : groups[i].levels) levels.push_back({one.x, one.n, one.k});
    answers[i].falling = say_falling(levels, groups[i].name.value_or(""));
  }
  if (options.input.json) {
    for (const PsychometricAnswer& answer : answers) fmt::print("{}\n", json_line(psychometric_json(answer)));
    if (comparison) fmt::print("{}\n", json_line(psychometric_json(*comparison)));
  } else {
    fmt::print("{}", psychometric_text(answers));
    if (comparison) fmt::print("\n{}", psychometric_text(*comparison));
  }
  return exit_code::kDone;
}

}  // namespace

void add_calc_psychometric(CommandTree& calc) {
  const auto [command, options] =
      calc.add("fit", "Psychometric functions: PSE, JND and slope of answers counted by level",
               "jnd calc fit levels.csv --function gaussian --guess 0 --lapse free", fit);
  add_input(command, options.input, "x, n, k, and group where there are several");
  command.add_option("--function", options.function, "logistic, gaussian, weibull or gumbel")
      .required()
      .one_of({"logistic", "gaussian", "weibull", "gumbel"});
  command.add_option("--guess", options.guess, "rate at the lowest levels: a number such as 0.5, or free (0 to 0.5)")
      .required();
  command
      .add_option("--lapse", options.lapse, "1 - rate at the highest levels: a number such as 0.02, or free (0 to 0.1)")
      .required();
  command.add_option("--estimator", options.estimator, "ml, or map: with a Beta(1.2, 10) prior on the lapse")
      .one_of({"ml", "map"})
      .show_default();
  command.add_option("--interval", options.interval, "profile (of the likelihood) or bootstrap (parametric)")
      .one_of({"profile", "bootstrap"})
      .show_default();
  command.add_option("--confidence", options.confidence, "coverage of the intervals").range(0.5, 0.9999).show_default();
  command.add_option("--replicates", options.replicates, "how many samples the bootstrap draws")
      .range(100, 1'000'000)
      .show_default();
  command.add_option("--seed", options.seed, "seed of the bootstrap").show_default();
  command.add_flag("--compare", options.compare,
                   "likelihood-ratio tests between groups: own location, own slope, both (maximum likelihood)");
  add_trial_options(command, options.trials, kFitUse);
}

// `jnd calc fit --json`.

namespace {

using nlohmann::ordered_json;

ordered_json bounds_json(const ConfidenceBounds& bounds) {
  return ordered_json::array({json_number(bounds.low), json_number(bounds.high)});
}

// The parameters in their order: the two of the function, then the rates that are free.
template <typename Entry>
ordered_json parameters_json(const PsychometricFit& fit, Entry entry) {
  const auto [location, second] = parameter_names(fit.model.function);
  ordered_json out = ordered_json::object();
  out[std::string(location)] = entry(fit.location);
  out[std::string(second)] = entry(fit.second);
  if (!fit.model.lapse) out["lapse"] = entry(fit.lapse);
  if (!fit.model.guess) out["guess"] = entry(fit.guess);
  return out;
}

// What the chi-square p of the deviance is.
constexpr std::string_view kFewTrials = "few_trials";
std::string_view p_status(const PsychometricFit& fit) {
  if (std::isnan(fit.deviance)) return "no_information";
  return fit.degrees_of_freedom < 1 ? "no_degrees_of_freedom" : fit.few_trials ? kFewTrials : "ok";
}

ordered_json bootstrap_json(const PsychometricBootstrap& bootstrap) {
  return {{"replicates", bootstrap.replicates},
          {"estimates", bootstrap.estimates},
          {"separated", bootstrap.separated},
          {"not_increasing", bootstrap.not_increasing},
          {"others", bootstrap.others},
          {"with_pse", bootstrap.with_pse},
          {"deviance_p", json_number(bootstrap.deviance_p)}};
}

}  // namespace

ordered_json psychometric_json(const PsychometricAnswer& answer) {
  const PsychometricFit& fit = answer.fit;
  const PsychometricIntervals& intervals = answer.intervals;
  ordered_json out;
  out["group"] = answer.group ? ordered_json(*answer.group) : ordered_json(nullptr);
  if (answer.participant) out["participant"] = *answer.participant;
  if (answer.condition) out["condition"] = *answer.condition;
  out["function"] = to_string(fit.model.function);
  out["estimator"] = to_string(fit.model.estimator);
  out["parameters"] = parameters_json(fit, [](const PsychometricEstimate& one) { return json_number(one.value); });
  out["se"] = parameters_json(fit, [](const PsychometricEstimate& one) { return json_number(one.se); });
  // A fixed rate is known, whatever the data.
  out["guess"] = json_number(fit.model.guess.value_or(fit.guess.value));
  out["lapse"] = json_number(fit.model.lapse.value_or(fit.lapse.value));
  out["log_likelihood"] = json_number(fit.log_likelihood);
  out["deviance"] = json_number(fit.deviance);
  out["degrees_of_freedom"] = fit.degrees_of_freedom;
  out["deviance_p"] = json_number(fit.deviance_p);
  out["deviance_p_status"] = p_status(fit);
  out["pse"] = json_number(fit.pse.value);
  out["jnd"] = json_number(fit.jnd.value);
  out["slope"] = json_number(fit.slope.value);
  out["se_pse"] = json_number(fit.pse.se);
  out["se_jnd"] = json_number(fit.jnd.se);
  out["se_slope"] = json_number(fit.slope.se);
  const auto [location, second] = parameter_names(fit.model.function);
  ordered_json ci = {{"pse", bounds_json(intervals.pse)},
                     {"jnd", bounds_json(intervals.jnd)},
                     {"slope", bounds_json(intervals.slope)}};
  ci[std::string(location)] = bounds_json(intervals.location);
  ci[std::string(second)] = bounds_json(intervals.second);
  if (!fit.model.lapse) ci["lapse"] = bounds_json(intervals.lapse);
  if (!fit.model.guess) ci["guess"] = bounds_json(intervals.guess);
  out["ci"] = ci;
  out["interval"] = answer.bootstrap ? "bootstrap" : "profile";
  out["confidence"] = intervals.confidence;
  if (answer.bootstrap) out["bootstrap"] = bootstrap_json(*answer.bootstrap);
  out["falling"] = answer.falling;
  out["levels"] = fit.levels;
  out["trials"] = fit.trials;
  out["status"] = to_string(fit.status);
  return out;
}

ordered_json psychometric_json(const PsychometricComparison& comparison) {
  ordered_json models = ordered_json::array(), tests = ordered_json::array();
  for (const SharingFit& fit : comparison.fits)
    models.push_back({{"model", to_string(fit.sharing)},
                      {"parameters", fit.parameters},
                      {"log_likelihood", json_number(fit.log_likelihood)},
                      {"lapse", json_number(fit.lapse)},
                      {"guess", json_number(fit.guess)},
                      {"status", to_string(fit.status)}});
  for (const SharingTest& test : comparison.tests)
    tests.push_back({{"simpler", to_string(test.simpler)},
                     {"general", to_string(test.general)},
                     {"chi2", json_number(test.chi_square)},
                     {"df", test.df},
                     {"p", json_number(test.p)},
                     {"status", to_string(test.status)}});
  return {{"comparison", {{"groups", comparison.groups}, {"models", models}, {"tests", tests}}}};
}

// `jnd calc fit` for a person.

namespace {

using Align = TextTable::Align;

std::string fit_number(double value) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return fmt::format("{:.5g}", value);
}

std::string fit_interval(const ConfidenceBounds& bounds) {
  return range_text(fit_number(bounds.low), fit_number(bounds.high));
}

std::string with_error(const PsychometricEstimate& estimate) {
  return std::isnan(estimate.se) ? fit_number(estimate.value)
                                 : fit_number(estimate.value) + " ± " + fmt::format("{:.2g}", estimate.se);
}

std::string p_text(double p) {
  if (std::isnan(p)) return "-";
  return p < 0.0001 ? "< 0.0001" : fmt::format("{:.4f}", p);
}

std::string rate_text(const char* name, const std::optional<double>& rate, double most) {
  return rate ? fmt::format("{} {:g}", name, *rate) : fmt::format("{} free (0 to {:g})", name, most);
}

std::string heading(const PsychometricModel& model) {
  return fmt::format("{} function, {}, {}, {}", to_string(model.function),
                     rate_text("guess", model.guess, kLargestGuess), rate_text("lapse", model.lapse, kLargestLapse),
                     model.estimator == PsychometricEstimator::ml
                         ? std::string("maximum likelihood")
                         : fmt::format("prior Beta({:g}, {:g}) on the lapse", model.prior.a, model.prior.b));
}

// What each status means, once for all rows that have it.
std::string meanings_text(const std::vector<PsychometricAnswer>& answers) {
  using Status = PsychometricStatus;
  static constexpr std::pair<Status, const char*> kMeanings[] = {
      {Status::lapse_at_bound, "the free lapse is at the end of its range; the errors take it as known"},
      {Status::guess_at_bound, "the free guess is at the end of its range; the errors take it as known"},
      {Status::not_increasing, "no slope above 0 fits better than one rate for all levels: there is no threshold"},
      {Status::separated, "a step fits best: the slope is infinite and the JND below what these levels can show"},
      {Status::no_information, "one and the same answer throughout"},
      {Status::not_identified, "too few different levels for the free parameters"}};
  std::string text;
  for (const auto& [status, meaning] : kMeanings)
    for (const PsychometricAnswer& answer : answers)
      if (answer.fit.status == status) {
        text += warn(fmt::format("{}: {}.", to_string(status), meaning)) + "\n";
        break;
      }
  for (const PsychometricAnswer& answer : answers)
    if (p_status(answer.fit) == kFewTrials)
      return text +
             warn(
                 "few_trials: the chi-square p of the deviance needs 5 trials per level on average, and one of "
                 "each\nanswer; --interval bootstrap draws a p without it.") +
             "\n";
  return text;
}

}  // namespace

std::string psychometric_text(const std::vector<PsychometricAnswer>& answers) {
  if (answers.empty()) return "";
  const PsychometricModel& model = answers.front().fit.model;
  const bool bootstrap = answers.front().bootstrap.has_value();
  const std::string confidence =
      fmt::format("{:g} % {}", 100 * answers.front().intervals.confidence, bootstrap ? "bootstrap" : "profile");
  const auto [location, second] = parameter_names(model.function);
  TextTable thresholds({"group", "PSE", confidence, "JND", confidence, "slope", "deviance", "df", "p",
                        bootstrap ? "p bootstrap" : "", "status"},
                       {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                        Align::right, Align::right, Align::right, Align::left});
  TextTable parameters({"group", std::string(location), confidence, std::string(second), confidence, "lapse", "guess",
                        "log-likelihood", "trials"},
                       {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                        Align::right, Align::right});
  for (const PsychometricAnswer& answer : answers) {
    const PsychometricFit& fit = answer.fit;
    const std::string group = printable(answer.group.value_or("all"));
    thresholds.add({group, fit_number(fit.pse.value), fit_interval(answer.intervals.pse), fit_number(fit.jnd.value),
                    fit_interval(answer.intervals.jnd), fit_number(fit.slope.value), fit_number(fit.deviance),
                    std::to_string(fit.degrees_of_freedom),
                    p_status(fit) == kFewTrials ? std::string(kFewTrials) : p_text(fit.deviance_p),
                    answer.bootstrap ? p_text(answer.bootstrap->deviance_p) : "", std::string(to_string(fit.status))});
    parameters.add({group, with_error(fit.location), fit_interval(answer.intervals.location), with_error(fit.second),
                    fit_interval(answer.intervals.second),
                    model.lapse ? fit_number(*model.lapse) : with_error(fit.lapse),
                    model.guess ? fit_number(*model.guess) : with_error(fit.guess), fit_number(fit.log_likelihood),
                    std::to_string(fit.trials)});
  }
  std::string text = bold(heading(model)) + "\n" + thresholds.text();
  text +=
      dim("PSE: F = 0.5; JND: from there to F = 0.75; slope dF/dx at the PSE; all without guess and lapse.") + "\n\n";
  text += parameters.text() + dim("± standard error from the observed information.") + "\n";
  return text + meanings_text(answers);
}

std::string psychometric_text(const PsychometricComparison& comparison) {
  const auto words = [](PsychometricSharing sharing) {
    std::string text(to_string(sharing));
    for (char& c : text)
      if (c == '_') c = ' ';
    return text;
  };
  TextTable models({"model", "parameters", "log-likelihood", "status"},
                   {Align::left, Align::right, Align::right, Align::left});
  for (const SharingFit& fit : comparison.fits)
    models.add({words(fit.sharing), std::to_string(fit.parameters),
                std::isnan(fit.log_likelihood) ? "-" : fmt::format("{:.3f}", fit.log_likelihood),
                std::string(to_string(fit.status))});
  TextTable tests({"test", "against", "chi-square", "df", "p", "status"},
                  {Align::left, Align::left, Align::right, Align::right, Align::right, Align::left});
  for (const SharingTest& test : comparison.tests)
    tests.add({words(test.general), words(test.simpler),
               std::isnan(test.chi_square) ? "-" : fmt::format("{:.3f}", test.chi_square), std::to_string(test.df),
               p_text(test.p), std::string(to_string(test.status))});
  return bold(fmt::format("Do the {} groups differ?", comparison.groups)) + "\n" + models.text() + "\n" + tests.text() +
         dim("Likelihood ratios of nested models, maximum likelihood; location: PSE; a free lapse or guess is common "
             "to "
             "all groups.") +
         "\n";
}

}  // namespace jnd
