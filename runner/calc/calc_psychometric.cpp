// jnd calc fit: psychometric functions of counts, with intervals, goodness of fit and comparisons of groups.
#include "runner/calc/calc_psychometric.h"

#include <charconv>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocols/input/input_error.h"
#include "runner/calc/calc.h"
#include "runner/commands/commands.h"
#include "protocols/input/csv_table.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/progress_bar.h"

namespace jnd {

namespace {

struct FitOptions {
  CalcInput input;
  std::string function, guess, lapse, estimator = "ml", interval = "profile";
  int replicates = 2000;
  std::uint64_t seed = 1;
  double confidence = 0.95;
  bool compare = false;
};

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

struct Group {
  std::optional<std::string> name;
  std::vector<PsychometricLevel> levels;
};

std::vector<Group> groups_of(const CsvTable& table, const PsychometricModel& model) {
  // Trials a level are counted in an int; so are those of all rows of one level together.
  constexpr int kMostTrials = 100'000'000;
  std::vector<Group> groups;
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
    if (added) groups.push_back({name, {}});
    groups[place->second].levels.push_back(level);
  }
  return groups;
}

// Says how far it is where that takes more than some seconds.
PsychometricBootstrap bootstrap_of(const Group& group, const PsychometricModel& model, const FitOptions& options) {
  constexpr double kMostLevelsWithoutWord = 2e5;  // of all replicates
  const double levels = static_cast<double>(group.levels.size()) * options.replicates;
  std::optional<ProgressBar> bar;
  if (levels > kMostLevelsWithoutWord) bar.emplace("fitting replicates", options.replicates);
  return psychometric_bootstrap(group.levels, model, options.replicates, options.seed, options.confidence,
                                [&bar](int done) {
                                  if (bar) bar->update(done);
                                });
}

PsychometricAnswer answer_for(const Group& group, const PsychometricModel& model, const FitOptions& options) {
  PsychometricAnswer answer;
  answer.group = group.name;
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
  const CsvTable table = CsvTable::read(options.input.file, {"x", "n", "k"}, {"group"});
  const std::vector<Group> groups = groups_of(table, model);
  if (options.compare && groups.size() < 2)
    throw InputError(fmt::format("{}: --compare needs a column group with at least two groups", options.input.file));
  std::vector<PsychometricAnswer> answers;
  std::optional<PsychometricComparison> comparison;
  try {
    answers.reserve(groups.size());
    for (const Group& group : groups) answers.push_back(answer_for(group, model, options));
    if (options.compare) {
      std::vector<std::vector<PsychometricLevel>> levels;
      levels.reserve(groups.size());
      for (const Group& group : groups) levels.push_back(group.levels);
      comparison = compare_psychometric(levels, model);
    }
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", options.input.file, error.what()));
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

void add_calc_psychometric(CalcTree& tree) {
  const auto options = std::make_shared<FitOptions>();
  CLI::App* command = tree.add("fit", "Psychometric functions: PSE, JND and slope of answers counted by level",
                               "fit levels.csv --function gaussian --guess 0 --lapse free", options, fit);
  CalcTree::add_input(*command, options->input, "x, n, k, and group where there are several");
  command->add_option("--function", options->function, "logistic, gaussian, weibull or gumbel")
      ->required()
      ->check(CLI::IsMember({"logistic", "gaussian", "weibull", "gumbel"}));
  command->add_option("--guess", options->guess, "rate at the lowest levels: a number such as 0.5, or free (0 to 0.5)")
      ->required();
  command
      ->add_option("--lapse", options->lapse,
                   "1 - rate at the highest levels: a number such as 0.02, or free (0 to 0.1)")
      ->required();
  command->add_option("--estimator", options->estimator, "ml, or map: with a Beta(1.2, 10) prior on the lapse")
      ->check(CLI::IsMember({"ml", "map"}))
      ->capture_default_str();
  command->add_option("--interval", options->interval, "profile (of the likelihood) or bootstrap (parametric)")
      ->check(CLI::IsMember({"profile", "bootstrap"}))
      ->capture_default_str();
  command->add_option("--confidence", options->confidence, "of the intervals")
      ->check(CLI::Range(0.5, 0.9999))
      ->capture_default_str();
  command->add_option("--replicates", options->replicates, "of the bootstrap")
      ->check(CLI::Range(100, 1'000'000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "of the bootstrap")->capture_default_str();
  command->add_flag("--compare", options->compare,
                    "likelihood-ratio tests between groups: own location, own slope, both (maximum likelihood)");
}

}  // namespace jnd
