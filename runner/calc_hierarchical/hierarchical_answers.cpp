#include "runner/calc_hierarchical/hierarchical_answers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "runner/calc/calc.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

HierarchicalModel hierarchical_model_of(const HierarchicalCommand& options) {
  HierarchicalModel model;
  model.response = options.task == "which"              ? ResponseModel::choice
                   : options.observer == "differencing" ? ResponseModel::differencing
                   : options.observer == "independent"  ? ResponseModel::independent
                                                        : ResponseModel::yes_no;
  if (options.task == "which" && options.observer != "yes-no")
    throw UsageError("--observer goes with --task same-different: how \"different\" is decided");
  if (options.lapse == "shared") {
    model.estimated = model.estimated.with(SharedParameter::lapse);
  } else {
    const std::optional<double> lapse = number_in_option(options.lapse);
    if (!lapse || !(*lapse >= 0 && *lapse < 1))
      throw UsageError(fmt::format("--lapse: {} is neither a rate from 0 to below 1 nor shared", options.lapse));
    model.shared.lapse = *lapse;
  }
  if (options.overdispersion) model.estimated = model.estimated.with(SharedParameter::overdispersion);
  if (options.drift)
    model.estimated = model.estimated.with(SharedParameter::drift_ln_s).with(SharedParameter::drift_criterion);
  if (model.estimated.any() && options.bootstrap > 0)
    throw UsageError("--bootstrap goes with a fixed --lapse, without --overdispersion and --drift");
  model.tu = model.tv = model.tw = false;
  model.one_mean = options.one_jnd;
  const std::map<std::string, bool*, std::less<>> parts = {
      {"tu", &model.tu}, {"tv", &model.tv}, {"own_tv", &model.own_tv}, {"tw", &model.tw}, {"rho", &model.rho}};
  std::istringstream names(options.random);
  for (std::string word; std::getline(names, word, ',');) {
    word = word.substr(std::min(word.find_first_not_of(' '), word.size()));
    word.erase(word.find_last_not_of(' ') + 1);
    if (word == "none" || word.empty()) continue;
    const auto part = parts.find(word);
    if (part == parts.end())
      throw UsageError(
          fmt::format("--random: {} is none of tu, tv, own_tv, tw, rho (with commas between them), or none", word));
    *part->second = true;
  }
  model.tv = model.tv || model.own_tv;
  if (model.rho && !(model.tu && model.tw)) throw UsageError("--random: rho, their correlation, goes with tu and tw");
  return model;
}

namespace {

// The trials of somebody that were mixed: the observer of independent observations needs to know of equal stimuli which
// difference the others of their block had.
struct BlockPlace {
  int participant = 0, condition = 0;
  std::string block;  // its name, empty where blocks have none
  bool operator<(const BlockPlace& other) const {
    return std::tie(participant, condition, block) < std::tie(other.participant, other.condition, other.block);
  }
};

class BlockDifferences {
 public:
  // Levels >= 0.
  void add(const BlockPlace& place, double level) {
    if (level > 0) differences_[place].insert(level);
  }
  // Throws InputError where the block has no difference, or several.
  double of(const BlockPlace& place, const NamedAnswers& answers, const std::string& file) const {
    const auto found = differences_.find(place);
    if (found != differences_.end() && found->second.size() == 1) return *found->second.begin();
    std::string where = fmt::format("{}: participant {}, condition {}", file,
                                    printable(answers.participants[static_cast<std::size_t>(place.participant)]),
                                    printable(answers.conditions[static_cast<std::size_t>(place.condition)]));
    if (!place.block.empty()) where += fmt::format(", block {}", printable(place.block));
    throw InputError(
        fmt::format("{} has equal stimuli mixed with {} difference, and the independent observer needs one ({})", where,
                    found == differences_.end() ? "no" : "more than one",
                    found == differences_.end() ? "leave these rows out"
                                                : "name the blocks: a column block, or --block with --trials"));
  }

 private:
  std::map<BlockPlace, std::set<double>> differences_;
};

std::string file_name(const HierarchicalCommand& options) {
  return options.input.file == "-" ? "standard input" : options.input.file;
}

// Sureness and blocks are those of same-different.
void refuse_grades(const HierarchicalCommand& options) {
  if (options.task == "which" && !(options.trials.sureness.empty() && options.trials.block.empty()))
    throw UsageError("--sureness and --block go with --task same-different");
  if (options.observer != "independent" && !options.trials.block.empty())
    throw UsageError("--block goes with --observer independent");
}

// The answers of a row are counted by k, or its category is given.
void check_columns(const CsvTable& table, const HierarchicalCommand& options) {
  const std::string file = file_name(options);
  if (table.has("category") == table.has("k"))
    throw InputError(
        fmt::format("{}: columns k and category: one of them says what was answered (k: how often "
                    "\"different\", or the comparison; category, from 1: same sure, same unsure, different "
                    "unsure, different sure)",
                    file));
  if (options.task == "which" && (table.has("category") || table.has("block")))
    throw InputError(fmt::format("{}: columns category and block go with --task same-different", file));
}

NamedAnswers counted_answers(const HierarchicalCommand& options) {
  refuse_trial_options(options.trials, kHierarchicalUse);
  const bool which = options.task == "which";
  NamedAnswers answers;
  if (which) {
    answers.standard = number_in_option(options.trials.standard);
    if (!answers.standard)
      throw UsageError("--standard is needed: the number that the levels were judged against, in their unit");
  } else if (!options.trials.standard.empty()) {
    answers.standard = number_in_option(options.trials.standard);
    if (!answers.standard) throw UsageError("--standard: a number (a column goes with --trials)");
  }
  const std::string level = which ? "x" : "delta";
  std::vector<std::string> needed = {"participant", level, "n"}, further = {"condition", "k", "category", "block"};
  (options.drift ? needed : further).emplace_back("half");
  const CsvTable table = CsvTable::read(options.input.file, needed, further);
  say_look_alikes(table, "participant", options.input.file);
  const bool graded = table.has("category");
  check_columns(table, options);
  BlockDifferences blocks;
  std::vector<BlockPlace> places;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    HierarchicalCell cell;
    cell.participant = answers.participant(std::string(table.text(row, "participant")));
    cell.condition = answers.condition(table.has("condition") ? std::string(table.text(row, "condition")) : "all");
    cell.level = which ? table.number(row, level) - *answers.standard : table.number(row, level, {0, 1e300});
    const int n = table.integer(row, "n", 0);
    if (graded) {
      const int category = table.integer(row, "category", 1, 4);
      (category > 2 ? cell.positive : cell.negative) = n;
      if (category == 1) cell.sure_negative = n;
      if (category == 4) cell.sure_positive = n;
    } else {
      const int k = table.integer(row, "k", 0);
      if (k > n) table.fail(row, "k", fmt::format("{} answers in {} trials", k, n), "k is at most n");
      cell.positive = k;
      cell.negative = n - k;
    }
    if (options.drift) cell.second_half = table.integer(row, "half", 1, 2) == 2;
    answers.cells.push_back(cell);
    places.push_back(
        {cell.participant, cell.condition, table.has("block") ? std::string(table.text(row, "block")) : ""});
    if (n > 0) blocks.add(places.back(), cell.level);
  }
  if (options.observer == "independent")
    for (std::size_t i = 0; i < places.size(); ++i)
      if (HierarchicalCell& cell = answers.cells[i]; cell.level == 0 && cell.counts().trials() > 0)
        cell.level = -blocks.of(places[i], answers, file_name(options));
  answers.graded = graded;
  return answers;
}

// Levels of trials are differences, and of equal stimuli of the independent observer minus that of their block.
void pair_with_blocks(TrialTable& table, const HierarchicalCommand& options) {
  NamedAnswers names;
  std::vector<BlockPlace> units;
  for (const TrialUnit& unit : table.units)
    units.push_back(
        {names.participant(unit.participant.value_or("all")), names.condition(unit.condition.value_or("all")), ""});
  const auto place_of = [&units](const CsvTrial& trial) {
    BlockPlace place = units[trial.unit];
    place.block = trial.block;
    return place;
  };
  BlockDifferences blocks;
  for (CsvTrial& trial : table.trials) {
    trial.level = std::abs(trial.level);
    blocks.add(place_of(trial), trial.level);
  }
  if (options.observer != "independent") return;
  for (CsvTrial& trial : table.trials)
    if (trial.level == 0) trial.level = -blocks.of(place_of(trial), names, table.file);
}

NamedAnswers trial_answers(const HierarchicalCommand& options) {
  const bool which = options.task == "which";
  refuse_grades(options);
  TrialTable table = read_trials(options.input.file, options.trials, which ? kWhichUse : kSameDifferentUse);
  if (!which) pair_with_blocks(table, options);
  std::vector<std::size_t> trials(table.units.size(), 0), seen = trials;
  for (const CsvTrial& trial : table.trials) ++trials[trial.unit];
  // Of the first half of each participant's trials in each condition, and of the second; of all, without drift.
  TrialTable halves[2] = {{table.file, table.units, {}}, {table.file, table.units, {}}};
  for (const CsvTrial& trial : table.trials) {
    const bool second = options.drift && in_second_half(seen[trial.unit]++, trials[trial.unit]);
    halves[second ? 1 : 0].trials.push_back(trial);
  }
  const std::vector<std::vector<TrialCount>> counts[2] = {count_trials(halves[0]), count_trials(halves[1])};
  NamedAnswers answers;
  answers.graded = !options.trials.sureness.empty();
  for (std::size_t unit = 0; unit < table.units.size(); ++unit) {
    const TrialUnit& of = table.units[unit];
    if (!of.participant) throw UsageError("--participant is needed: the column that tells people apart");
    if (which && !of.standard)
      throw UsageError("--standard is needed: what the levels were judged against, a number or a column");
    for (const bool second : {false, true})
      for (const TrialCount& count : counts[second ? 1 : 0][unit]) {
        HierarchicalCell cell;
        cell.participant = answers.participant(*of.participant);
        cell.condition = answers.condition(of.condition.value_or("all"));
        cell.level = which ? count.level - *of.standard : count.level;
        cell.positive = count.k;
        cell.negative = count.n - count.k;
        cell.second_half = second;
        cell.sure_positive = count.sure_k;
        cell.sure_negative = count.sure_others;
        answers.cells.push_back(cell);
      }
    if (answers.standard && of.standard && *answers.standard != *of.standard)
      throw InputError(
          fmt::format("{}: the levels were judged against several standards, {:g} and {:g} (give the rows of one)",
                      table.file, *answers.standard, *of.standard));
    if (of.standard) answers.standard = of.standard;
  }
  return answers;
}

void refuse_empty(const HierarchicalCommand& options, const NamedAnswers& answers) {
  const std::string file = file_name(options);
  for (std::size_t c = 0; c < answers.conditions.size(); ++c)
    if (std::none_of(answers.cells.begin(), answers.cells.end(), [c](const HierarchicalCell& cell) {
          return cell.condition == static_cast<int>(c) && cell.positive + cell.negative > 0;
        }))
      throw InputError(
          fmt::format("{}: condition {} has no trials (leave its rows out)", file, printable(answers.conditions[c])));
  const auto differs = [&](const HierarchicalCell& cell) { return cell.level != answers.cells.front().level; };
  if (options.task == "which"
          ? std::none_of(answers.cells.begin(), answers.cells.end(), differs)
          : std::none_of(answers.cells.begin(), answers.cells.end(), [](const auto& cell) { return cell.level != 0; }))
    throw InputError(
        fmt::format("{}: there is one level only, which tells no JND (give rows of several levels)", file));
}

}  // namespace

NamedAnswers named_answers(const HierarchicalCommand& options) {
  NamedAnswers answers = options.trials.trials ? trial_answers(options) : counted_answers(options);
  refuse_empty(options, answers);
  answers.pooled = pooled(answers.cells);
  return answers;
}

}  // namespace jnd
