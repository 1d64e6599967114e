// jnd calc staircase, jnd calc quest: the levels of an adaptive procedure from the answers given.
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/procedures/quest.h"
#include "analysis/procedures/staircase.h"
#include "analysis/thresholds/adaptive_threshold.h"
#include "data/fields/number_text.h"
#include "protocols/input/csv_table.h"
#include "runner/calc/calc.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/text_table.h"

namespace jnd {
namespace {

using Json = nlohmann::ordered_json;
using Align = TextTable::Align;

struct StaircaseOptions {
  CalcInput input;
  StaircaseRule rule;
  std::vector<double> clamp;
};

int staircase(const StaircaseOptions& options) {
  StaircaseRule rule = options.rule;
  if (!options.clamp.empty()) rule.clamp = std::array<double, 2>{options.clamp[0], options.clamp[1]};
  if (const std::string problem = problem_of(rule); !problem.empty()) throw InputError(problem);
  const CsvTable csv = CsvTable::read(options.input.file, {"response"});
  Staircase run(rule);
  std::vector<double> levels;
  TextTable table({"trial", "level", "answer", ""}, {Align::right, Align::right, Align::left, Align::left});
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    const bool correct = csv.integer(row, "response", 0, 1) == 1;
    levels.push_back(run.level());
    const std::size_t before = run.reversals().size();
    run.answer(correct);
    table.add({std::to_string(row + 1), fmt::format("{:g}", levels.back()), correct ? "correct" : "wrong",
               run.reversals().size() > before ? "reversal" : ""});
  }
  if (options.input.json) {
    print_json({{"levels", json_numbers(levels)},
                {"next", json_number(run.level())},
                {"reversals", json_numbers(run.reversals())},
                {"target", json_number(staircase_target(rule))}});
    return exit_code::kDone;
  }
  fmt::print("{}next level {:g}; the rule settles where {:.1f} % of the answers are correct\n", table.text(),
             run.level(), 100 * staircase_target(rule));
  const ReversalMean mean = mean_of_reversals(run.reversals(), static_cast<int>(run.reversals().size()));
  if (mean.n > 0)
    fmt::print("mean of the last {} reversals {:g}, standard deviation {:g}\n", mean.n, mean.mean, mean.sd);
  return exit_code::kDone;
}

enum class Placement { mean, mode, median };
constexpr auto kPlacementWords =
    words<Placement>({{"mean", Placement::mean}, {"mode", Placement::mode}, {"median", Placement::median}});

struct QuestOptions {
  CalcInput input;
  QuestParameters parameters;
  Placement place = Placement::mean;
};

double recommended(const QuestEstimate& estimate, Placement place) {
  return place == Placement::mean ? estimate.mean : place == Placement::mode ? estimate.mode : estimate.median;
}

constexpr double kFarLog10 = 2;  // a hundredfold

int quest(const QuestOptions& options) {
  if (const std::string problem = problem_of(options.parameters); !problem.empty()) throw InputError(problem);
  const CsvTable csv = CsvTable::read(options.input.file, {"response"}, {"x"});
  Quest run(options.parameters);
  Json out;
  TextTable table({"trial", "level", "answer", "mean", "mode", "median", "sd"},
                  {Align::right, Align::right, Align::left, Align::right, Align::right, Align::right, Align::right});
  QuestEstimate estimate = run.estimate();
  const double half = options.parameters.range / 2;
  std::optional<double> beyond;  // the first level that no threshold of the grid can have made
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    const bool correct = csv.integer(row, "response", 0, 1) == 1;
    const bool shown = csv.has("x") && !csv.text(row, "x").empty();
    const double level = shown ? csv.number(row, "x") : recommended(estimate, options.place);
    if (!beyond && std::abs(level - options.parameters.t_guess) > half + kFarLog10) beyond = level;
    run.answer(level, correct);
    estimate = run.estimate();
    std::vector<std::string> cells = {std::to_string(row + 1)};
    const std::pair<const char*, double> numbers[] = {{"levels", level},
                                                      {"mean", estimate.mean},
                                                      {"mode", estimate.mode},
                                                      {"median", estimate.median},
                                                      {"sd", estimate.sd}};
    for (const auto& [key, number] : numbers) {
      out[key].push_back(json_number(number));
      cells.push_back(number_text(number, 4));
    }
    cells.insert(cells.begin() + 2, correct ? "correct" : "wrong");
    table.add(cells);
  }
  if (beyond)
    write_marked_message(fmt::format(
        "{}: level {:g} lies far beyond the grid of thresholds, {:g} to {:g}: are the levels log10 of the stimulus?",
        options.input.file == "-" ? "standard input" : options.input.file, *beyond, options.parameters.t_guess - half,
        options.parameters.t_guess + half));
  if (options.input.json)
    print_json(out);
  else
    fmt::print("{}next level {:.4f}\n", table.text(), recommended(estimate, options.place));
  return exit_code::kDone;
}

}  // namespace

void add_calc_adaptive(CommandTree& calc) {
  {
    const auto [command, options] =
        calc.add("staircase", "The levels of an up-down staircase (Levitt 1971, Kaernbach 1991)",
                 "jnd calc staircase answers.csv --start 400 --up 1 --down 2 --step-up 50 --step-down 50", staircase);
    add_input(command, options.input, "response (1 = correct, 0 = wrong)");
    StaircaseRule& rule = options.rule;
    command.add_option("--start", rule.start, "first level").required();
    command.add_option("--up", rule.up, "so many wrong answers in a row raise the level").required();
    command.add_option("--down", rule.down, "so many correct answers in a row lower it").required();
    command.add_option("--step-up", rule.step_up, "added to the level; with --multiplicative it is multiplied by it")
        .required();
    command
        .add_option("--step-down", rule.step_down,
                    "subtracted from the level; with --multiplicative it is divided by it")
        .required();
    command.add_flag("--multiplicative", rule.multiplicative, "steps multiply and divide; above 1");
    command
        .add_option("--halve-after", rule.halve_after,
                    "reversals, counted from 1, that halve the steps (those that multiply: on the logarithm)")
        .delimiter(',');
    command.add_flag("--accelerated", rule.accelerated,
                     "steps shrink (Kesten 1958): divided by 1 and 2 at the first answers, then by 2 + reversals; with "
                     "--up 1 --down 1. Steps of 90 up and 10 down go to 90 % correct");
    command.add_option("--clamp", options.clamp, "lowest and highest level: LO,HI").delimiter(',').values(2, 2);
  }
  const auto [command, options] =
      calc.add("quest", "A threshold by QUEST (Watson & Pelli 1983); levels are log10 of the stimulus",
               "jnd calc quest answers.csv --t-guess 2.4 --t-guess-sd 0.5 --gamma 0.1", quest);
  add_input(command, options.input,
            "response (1 = correct, 0 = wrong) and, optionally, x: the level really shown (else the "
            "recommended one)");
  QuestParameters& p = options.parameters;
  command.add_option("--t-guess", p.t_guess, "expected threshold").required();
  command.add_option("--t-guess-sd", p.t_guess_sd, "standard deviation of that guess").required();
  command.add_option("--p-threshold", p.p_threshold, "share correct at threshold").show_default();
  command.add_option("--beta", p.beta, "slope of the psychometric function").show_default();
  command.add_option("--delta", p.delta, "share of answers given blindly").show_default();
  command.add_option("--gamma", p.gamma, "share correct without a stimulus").show_default();
  command.add_option("--grain", p.grain, "step of the grid of thresholds").show_default();
  command.add_option("--range", p.range, "width of the grid, about the guess").show_default();
  command.add_choice("--place", options.place, kPlacementWords,
                     "recommended level: mean (King-Smith et al. 1994; default), mode (Watson & Pelli), median");
}

}  // namespace jnd
