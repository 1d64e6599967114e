// jnd calc fit: psychometric functions of counts, with intervals, goodness of fit and comparisons of groups.
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "analysis/psychometric/psychometric_compare.h"
#include "analysis/psychometric/psychometric_interval.h"
#include "data/blocks/common_fields.h"
#include "data/blocks/part_fields.h"
#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "runner/calc/calc.h"
#include "runner/calc/calc_output.h"
#include "runner/calc/interval_fields.h"
#include "runner/calc/trials_input.h"
#include "runner/results/block_output.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/progress_bar.h"
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

struct FittedGroup {
  LevelGroup of;
  PsychometricFit fit;
  PsychometricIntervals intervals;
  bool falling = false;                            // the counted answer is rarer at higher levels (falling_answers)
  std::optional<PsychometricBootstrap> bootstrap;  // where the intervals come from it
};

FittedGroup fitted(const LevelGroup& group, const PsychometricModel& model, const FitOptions& options) {
  FittedGroup out{group, fit_psychometric(group.levels, model), {}, false, {}};
  if (options.interval == "bootstrap") {
    out.bootstrap = bootstrap_of(group, model, options);
    out.intervals = out.bootstrap->intervals;
  } else {
    out.intervals = psychometric_profile(group.levels, model, options.confidence);
  }
  return out;
}

// A quantity of a fit, with its standard error and its interval.
struct FitQuantity {
  std::string name;
  PsychometricEstimate PsychometricFit::*estimate;
  ConfidenceBounds PsychometricIntervals::*bounds;
};

const FitQuantity kThresholds[] = {{"pse", &PsychometricFit::pse, &PsychometricIntervals::pse},
                                   {"jnd", &PsychometricFit::jnd, &PsychometricIntervals::jnd},
                                   {"slope", &PsychometricFit::slope, &PsychometricIntervals::slope}};

// The two of the function, then the rates that are free.
std::vector<FitQuantity> parameters_of(const PsychometricModel& model) {
  const auto [location, second] = parameter_names(model.function);
  std::vector<FitQuantity> all = {{std::string(location), &PsychometricFit::location, &PsychometricIntervals::location},
                                  {std::string(second), &PsychometricFit::second, &PsychometricIntervals::second}};
  if (!model.lapse) all.push_back({"lapse", &PsychometricFit::lapse, &PsychometricIntervals::lapse});
  if (!model.guess) all.push_back({"guess", &PsychometricFit::guess, &PsychometricIntervals::guess});
  return all;
}

// Of the chi-square p of the deviance: ok, or why there is none.
std::string_view p_status(const PsychometricFit& fit) {
  if (std::isnan(fit.deviance)) return "no_information";
  return fit.degrees_of_freedom < 1 ? "no_degrees_of_freedom" : fit.few_trials ? "few_trials" : "ok";
}

void add_quantity(Fields<FittedGroup>& fields, const FitQuantity& of, const std::string& value,
                  const std::string& error) {
  using R = FittedGroup;
  add_parts(
      fields, "", "estimate and its standard error", {},
      [of](const R& r) -> const PsychometricEstimate& { return r.fit.*of.estimate; }, value,
      &PsychometricEstimate::value, error, &PsychometricEstimate::se);
  add_interval(fields, "ci." + of.name, [of](const R& r) {
    return std::vector<double>{(r.intervals.*of.bounds).low, (r.intervals.*of.bounds).high};
  });
}

Fields<FittedGroup> fit_fields(const FittedGroup& first) {
  using R = FittedGroup;
  using P = PsychometricFit;
  using M = PsychometricModel;
  using B = PsychometricBootstrap;
  Fields<R> fields = unit_fields<R>(first.of);
  add_parts(
      fields, "", "what was fitted", {}, [](const R& r) -> const M& { return r.fit.model; }, "function", &M::function,
      "estimator", &M::estimator);
  add_parts(
      fields, "", "the fit, its rates and the counts behind it", {}, &R::fit, "guess",
      [](const P& fit) { return fit.model.guess.value_or(fit.guess.value); }, "lapse",
      [](const P& fit) { return fit.model.lapse.value_or(fit.lapse.value); }, "deviance", &P::deviance,
      "degrees_of_freedom", &P::degrees_of_freedom, "deviance_p_status", p_status, "levels", &P::levels, "trials",
      &P::trials, "status", &P::status);
  add_parts(fields, "", "without binomial constants", {.shown = Shown::given}, &R::fit, "log_likelihood",
            &P::log_likelihood);
  add_parts(fields, "", "p of the deviance by chi-square", {.shown = Shown::p_value}, &R::fit, "deviance_p",
            &P::deviance_p);
  for (const FitQuantity& one : kThresholds) add_quantity(fields, one, one.name, "se_" + one.name);
  for (const FitQuantity& one : parameters_of(first.fit.model))
    add_quantity(fields, one, "parameters." + one.name, "se." + one.name);
  fields.emplace_back("interval", "kind of the intervals",
                      [](const R& r) { return r.bootstrap ? "bootstrap" : "profile"; });
  fields.emplace_back("confidence", "their coverage", [](const R& r) { return r.intervals.confidence; });
  fields.emplace_back("falling", "the answer is rarer at higher levels", &R::falling);
  if (!first.bootstrap) return fields;
  const auto bootstrap = [](const R& r) -> const B& { return *r.bootstrap; };
  add_parts(fields, "bootstrap.", "samples, by their fit", {}, bootstrap, "replicates", &B::replicates, "estimates",
            &B::estimates, "separated", &B::separated, "not_increasing", &B::not_increasing, "others", &B::others,
            "with_pse", &B::with_pse);
  add_parts(fields, "bootstrap.", "Monte Carlo p of the deviance", {.shown = Shown::p_value}, bootstrap, "deviance_p",
            &B::deviance_p);
  return fields;
}

std::string rate_text(const char* name, const std::optional<double>& rate, double most) {
  return rate ? fmt::format("{} {:g}", name, *rate) : fmt::format("{} free (0 to {:g})", name, most);
}

std::string fit_title(const PsychometricModel& model) {
  return fmt::format("{} function, {}, {}, {}", to_string(model.function),
                     rate_text("guess", model.guess, kLargestGuess), rate_text("lapse", model.lapse, kLargestLapse),
                     model.estimator == PsychometricEstimator::ml
                         ? std::string("maximum likelihood")
                         : fmt::format("prior Beta({:g}, {:g}) on the lapse", model.prior.a, model.prior.b));
}

// What the functions say, and below it their parameters.
std::vector<Block> fit_blocks(const std::vector<FittedGroup>& groups) {
  const FittedGroup& first = groups.front();
  const std::string confidence =
      fmt::format("{:g} % {}", 100 * first.intervals.confidence, first.bootstrap ? "bootstrap" : "profile");
  std::vector<Block> blocks(2);
  for (Block& block : blocks) block.with(fit_fields(first), groups);
  Block& functions = blocks[0];
  Block& parameters = blocks[1];
  functions.title = fit_title(first.fit.model);
  functions.note = "PSE: F = 0.5; JND: from there to F = 0.75; slope dF/dx at the PSE; all without guess and lapse.";
  functions.columns = columns("name", titled("pse", "PSE"), interval_column("ci.pse", confidence), titled("jnd", "JND"),
                              interval_column("ci.jnd", confidence), "slope", "deviance",
                              titled("degrees_of_freedom", "df"), titled("deviance_p", "p"), "status");
  if (first.bootstrap)
    functions.columns.insert(functions.columns.end() - 1, titled("bootstrap.deviance_p", "p bootstrap"));
  explain(functions, "status",
          {{"lapse_at_bound", "the free lapse is at the end of its range; the errors take it as known"},
           {"guess_at_bound", "the free guess is at the end of its range; the errors take it as known"},
           {"not_increasing", "no slope above 0 fits better than one rate for all levels: there is no threshold"},
           {"separated", "a step fits best: the slope is infinite and the JND below what these levels can show"},
           {"no_information", "one and the same answer throughout"},
           {"not_identified", "too few different levels for the free parameters"}});
  explain(functions, "deviance_p_status",
          {{"few_trials",
            "the chi-square p of the deviance needs 5 trials per level on average, and one of each answer; --interval "
            "bootstrap draws a p without it"}});
  parameters.note = "SE: standard error from the observed information.";
  parameters.columns = columns("name", titled("log_likelihood", "log-likelihood"), "trials");
  for (const FitQuantity& one : parameters_of(first.fit.model))
    for (const TableColumn& column : {titled("parameters." + one.name, one.name),
                                      interval_column("ci." + one.name, confidence), titled("se." + one.name, "SE")})
      parameters.columns.insert(parameters.columns.end() - 2, column);
  return blocks;
}

// What the groups share, and which of it makes a difference.
std::vector<Block> sharing_blocks(const PsychometricComparison& comparison) {
  using S = SharingFit;
  using T = SharingTest;
  const auto fit = [](const S& row) -> const S& { return row; };
  const auto test = [](const T& row) -> const T& { return row; };
  std::vector<Block> blocks(2);
  Fields<S> model_fields;
  add_parts(model_fields, "", "of the model", {}, fit, "model", &S::sharing, "parameters", &S::parameters, "lapse",
            &S::lapse, "guess", &S::guess, "status", &S::status);
  add_parts(model_fields, "", "without binomial constants", {.shown = Shown::given}, fit, "log_likelihood",
            &S::log_likelihood);
  blocks[0].with(model_fields, std::vector(comparison.fits.begin(), comparison.fits.end()));
  blocks[0].title = fmt::format("Do the {} groups differ?", comparison.groups);
  blocks[0].columns = columns("model", "parameters", titled("log_likelihood", "log-likelihood"), "status");
  Fields<T> test_fields;
  add_parts(test_fields, "", "of the test", {}, test, "simpler", &T::simpler, "general", &T::general, "chi2",
            &T::chi_square, "df", &T::df, "status", &T::status);
  add_parts(test_fields, "", "of the test", {.shown = Shown::p_value}, test, "p", &T::p);
  blocks[1].with(test_fields, std::vector(comparison.tests.begin(), comparison.tests.end()));
  blocks[1].columns = columns(titled("general", "test"), titled("simpler", "against"), titled("chi2", "chi-square"),
                              "df", "p", "status");
  blocks[1].footnotes = {
      "Likelihood ratios of nested models, maximum likelihood; location: PSE; a free lapse or guess is common to all "
      "groups."};
  return blocks;
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
  std::vector<FittedGroup> fits;
  std::optional<PsychometricComparison> comparison;
  try {
    const WorkLine working("fitting " + options.input.file);
    for (const LevelGroup& group : groups) fits.push_back(fitted(group, model, options));
    if (options.compare) {
      std::vector<std::vector<PsychometricLevel>> levels;
      for (const LevelGroup& group : groups) levels.push_back(group.levels);
      comparison = compare_psychometric(levels, model);
    }
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", options.input.file, error.what()));
  }
  if (fits.empty()) return exit_code::kDone;  // no trial with an answer
  for (FittedGroup& one : fits) {
    std::vector<AnsweredLevel> levels;
    for (const PsychometricLevel& level : one.of.levels) levels.push_back({level.x, level.n, level.k});
    one.falling = say_falling(levels, one.of.name.value_or(""));
  }
  std::vector<Block> blocks = fit_blocks(fits);
  std::vector<Block> sharing;
  if (comparison) sharing = sharing_blocks(*comparison);
  blocks.insert(blocks.end(), sharing.begin(), sharing.end());
  print_rows(blocks, options.input.json);
  if (options.input.json && comparison)
    print_json(
        {{"comparison",
          {{"groups", comparison->groups}, {"models", json_rows(sharing[0])}, {"tests", json_rows(sharing[1])}}}});
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

}  // namespace jnd
