// jnd calc hierarchical: one model of everybody's answers, the JND of the group and of each person.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/hierarchical/hierarchical_bootstrap.h"
#include "analysis/hierarchical/hierarchical_fit.h"
#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "runner/calc/calc.h"
#include "runner/calc/calc_hierarchical_check.h"
#include "runner/calc/trials_input.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/progress_bar.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using nlohmann::ordered_json;

struct HierarchicalCommand {
  CalcInput input;
  TrialOptions trials;
  std::string task, observer = "yes-no", random = "tu,tv,tw", lapse = "0";
  bool one_jnd = false, people = false, overdispersion = false, drift = false;
  int bootstrap = 0, check = 0, threads = 0;
  std::uint64_t seed = 1;
};

// The option's own words: of either task.
const TrialUse kHierarchicalUse = {"the stimuli were different, or the comparison was chosen", {}, false, false, true};

// What the analysis was made of, and by which names.
struct NamedAnswers {
  std::vector<std::string> participants, conditions;
  std::vector<HierarchicalCell> cells;
  std::optional<double> standard;
  bool graded = false;  // it was told which answers were sure

  int participant(const std::string& name) { return place(participants, name); }
  int condition(const std::string& name) { return place(conditions, name); }

 private:
  static int place(std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<int>(found - names.begin());
    names.push_back(name);
    return static_cast<int>(names.size()) - 1;
  }
};

HierarchicalModel model_of(const HierarchicalCommand& options) {
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
      {"tu", &model.tu}, {"tv", &model.tv}, {"tw", &model.tw}, {"rho", &model.rho}};
  for (const std::string& name : CLI::detail::split(options.random, ',')) {
    const std::string word = CLI::detail::trim_copy(name);
    if (word == "none" || word.empty()) continue;
    const auto part = parts.find(word);
    if (part == parts.end())
      throw UsageError(
          fmt::format("--random: {} is none of tu, tv, tw, rho (with commas between them), or none", word));
    *part->second = true;
  }
  if (model.rho && !(model.tu && model.tw)) throw UsageError("--random: rho, their correlation, goes with tu and tw");
  return model;
}

// The trials of somebody that were mixed: the observer of independent observations needs to know of equal stimuli which
// difference the others of their block had.
struct BlockPlace {
  int participant = 0, condition = 0;
  std::string block;  // its name, empty where blocks have none
  auto operator<=>(const BlockPlace&) const = default;
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
    const bool second = options.drift && 2 * seen[trial.unit]++ >= trials[trial.unit];
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

struct HierarchicalResult {
  NamedAnswers answers;
  HierarchicalModel model;
  HierarchicalFit fit;
  std::vector<SharedEstimate> shared;      // but criteria of sureness
  std::optional<HierarchicalFit> without;  // with nothing shared estimated, where something is
  std::vector<ConditionDifference> differences;
  std::vector<PersonEstimate> people;
  std::optional<EqualityBootstrap> bootstrap;
  std::optional<PredictiveCheck> check;
  std::vector<SharedEstimate> sureness;  // its criteria, below and above; empty where it was not told
  std::vector<double> narrower;          // by condition: see narrower_by()

  bool choice() const noexcept { return model.response == ResponseModel::choice; }
  double origin() const noexcept { return choice() ? answers.standard.value_or(0) : 0; }  // of the levels
};

// Of the model, and where there is a test of the one with one JND.
bool settled(const HierarchicalFit& fit) {
  return fit.maximum.converged && (fit.df == 0 || fit.common.converged);
}

// By which share the interval of ln JND is narrower than that of the same answers without their sureness; NaN where
// one of the two has an open end.
std::vector<double> narrower_by(const HierarchicalResult& result) {
  std::vector<HierarchicalCell> cells = result.answers.cells;
  for (HierarchicalCell& cell : cells) cell.sure_positive = cell.sure_negative = 0;
  HierarchicalModel model = result.model;
  model.estimated = model.estimated.with(SharedParameter::sure_below, false).with(SharedParameter::sure_above, false);
  HierarchicalAnalysis analysis(std::move(cells), model);
  const std::vector<ConditionMean>& without = analysis.add_intervals().conditions;
  std::vector<double> shares;
  const auto width = [](const ConditionMean& one) { return one.ends.high - one.ends.low; };
  for (std::size_t c = 0; c < without.size(); ++c) {
    const double share = 1 - width(result.fit.conditions[c]) / width(without[c]);
    shares.push_back(std::isfinite(width(without[c])) && std::isfinite(share) ? share : kNaN);
  }
  return shares;
}

// ---- JSON

ordered_json ends_json(const ProfileEnds& ends, bool as_ratio = false) {
  const auto number = [as_ratio](double end) { return json_number(as_ratio ? std::exp(end) : end); };
  return ordered_json::array({number(ends.low), number(ends.high)});
}

ordered_json people_json(const HierarchicalResult& result) {
  ordered_json people = ordered_json::array();
  const std::size_t conditions = result.answers.conditions.size();
  for (std::size_t i = 0; i < result.people.size(); ++i) {
    const PersonEstimate& one = result.people[i];
    ordered_json person;
    person["participant"] = result.answers.participants[i / conditions];
    person["condition"] = result.answers.conditions[i % conditions];
    person["jnd"] = json_number(std::exp(one.mean));
    person["mu"] = json_number(one.mean);
    person["mu_sd"] = json_number(one.sd);
    person["jnd_alone"] = json_number(std::exp(one.alone));
    person["status_alone"] = word_of(kSlopeStatusWords, one.status);
    people.push_back(std::move(person));
  }
  return people;
}

ordered_json sureness_json(const HierarchicalResult& result) {
  if (!result.answers.graded) return nullptr;
  ordered_json out;
  for (const auto& [name, one] : {std::pair("below", result.sureness.at(0)), {"above", result.sureness.at(1)}}) {
    out[name] = json_number(one.value);
    out[fmt::format("{}_ci", name)] = ends_json(one.ends);
    out[fmt::format("{}_status", name)] = word_of(kSharedStatusWords, one.status);
  }
  ordered_json narrower = ordered_json::array();
  for (const double share : result.narrower) narrower.push_back(json_number(share));
  out["narrower"] = std::move(narrower);
  return out;
}

ordered_json shared_json(const HierarchicalResult& result) {
  ordered_json shared = ordered_json::array();
  for (const SharedEstimate& one : result.shared)
    shared.push_back({{"parameter", word_of(kSharedParameterWords, one.parameter)},
                      {"status", word_of(kSharedStatusWords, one.status)},
                      {"value", json_number(one.value)},
                      {"ci", ends_json(one.ends)},
                      {"lr", json_number(one.lr)},
                      {"p", json_number(one.p)}});
  return shared;
}

ordered_json without_json(const HierarchicalResult& result) {
  const HierarchicalFit& fit = *result.without;
  ordered_json mu = ordered_json::array(), jnd = mu, mu_ci = mu, jnd_ci = mu;
  const std::size_t means = result.model.one_mean ? 1 : fit.conditions.size();
  for (std::size_t c = 0; c < means; ++c) {
    const ConditionMean& one = fit.conditions[c];
    mu.push_back(json_number(one.mu));
    jnd.push_back(json_number(std::exp(one.mu)));
    mu_ci.push_back(ends_json(one.ends));
    jnd_ci.push_back(ends_json(one.ends, true));
  }
  return {{"converged", settled(fit)}, {"loglik", json_number(fit.maximum.log_likelihood)},
          {"mu", std::move(mu)},       {"group_jnd", std::move(jnd)},
          {"mu_ci", std::move(mu_ci)}, {"jnd_ci", std::move(jnd_ci)}};
}

ordered_json hierarchical_json(const HierarchicalResult& result) {
  const HierarchicalFit& fit = result.fit;
  const HierarchicalPlace& place = fit.maximum.place;
  ordered_json out;
  out["conditions"] = result.answers.conditions;
  out["participants"] = fit.participants;
  out["trials"] = std::llround(fit.trials);
  out["observer"] = word_of(kResponseModelWords, result.model.response);
  out["lapse"] = fit.maximum.shared.lapse;
  out["converged"] = settled(fit);
  out["loglik"] = json_number(fit.maximum.log_likelihood);
  if (result.without) {
    out["shared"] = shared_json(result);
    out["without"] = without_json(result);
  }
  const std::size_t means = result.model.one_mean ? 1 : fit.conditions.size();
  ordered_json status = ordered_json::array(), mu = status, jnd = status, criteria = status, mu_ci = status,
               jnd_ci = status;
  for (std::size_t c = 0; c < fit.conditions.size(); ++c) {
    const ConditionMean& one = fit.conditions[c];
    criteria.push_back(json_number(one.criterion));
    if (c >= means) continue;
    status.push_back(word_of(kSlopeStatusWords, one.status));
    mu.push_back(json_number(one.mu));
    jnd.push_back(json_number(std::exp(one.mu)));
    mu_ci.push_back(ends_json(one.ends));
    jnd_ci.push_back(ends_json(one.ends, true));
  }
  out["status"] = std::move(status);
  out["mu"] = std::move(mu);
  out["group_jnd"] = std::move(jnd);
  out[result.choice() ? "alpha" : "kappa"] = std::move(criteria);
  out["tu"] = place.tu;
  out["tv"] = place.tv;
  out["tw"] = place.tw;
  out["rho"] = result.model.rho ? json_number(place.rho) : ordered_json(nullptr);
  for (const auto& [name, one] : {std::pair{"tu_status", fit.tu}, {"tv_status", fit.tv}, {"tw_status", fit.tw}})
    out[name] = word_of(kSpreadStatusWords, one);
  out["sureness"] = sureness_json(result);
  if (fit.df > 0) {
    out["loglik_equal_mu"] = json_number(fit.common.log_likelihood);
    out["lr_equal_mu"] = json_number(fit.lr);
    out["df"] = fit.df;
    out["p_equal_mu"] = json_number(fit.p);
    out["mu_equal"] = json_number(fit.common.place.mu.front());
  }
  if (result.bootstrap)
    out["bootstrap"] = {{"replicates", result.bootstrap->replicates},
                        {"as_large", result.bootstrap->as_large},
                        {"p_equal_mu", result.bootstrap->p}};
  out["mu_ci"] = std::move(mu_ci);
  out["jnd_ci"] = std::move(jnd_ci);
  ordered_json differences = ordered_json::array();
  for (const ConditionDifference& one : result.differences)
    differences.push_back({{"a", one.a + 1},
                           {"b", one.b + 1},
                           {"diff", json_number(one.difference)},
                           {"ci", ends_json(one.ends)},
                           {"ratio", json_number(std::exp(one.difference))},
                           {"ratio_ci", ends_json(one.ends, true)},
                           {"lr", json_number(one.lr)},
                           {"p", json_number(one.p)}});
  out["mu_diff"] = std::move(differences);
  out["people"] = people_json(result);
  if (result.check) out["check"] = predictive_json(*result.check, result.answers.conditions, result.origin());
  return out;
}

// ---- for a person

using Align = TextTable::Align;

std::string four_digits(double value) {
  if (std::isnan(value)) return "-";
  return std::isinf(value) ? "inf" : fmt::format("{:.4g}", value);
}

std::string jnd_range(const ProfileEnds& ends) {
  if (std::isnan(ends.low)) return "-";
  return range_text(four_digits(std::exp(ends.low)), four_digits(std::exp(ends.high)));
}

std::string conditions_text(const HierarchicalResult& result) {
  const double standard = result.answers.standard.value_or(kNaN);
  std::vector<std::string> header = {"condition", "JND", "95 % profile"};
  std::vector<Align> align = {Align::left, Align::right, Align::right};
  if (standard > 0) {
    header.emplace_back("Weber");
    align.push_back(Align::right);
  }
  header.emplace_back(result.choice()                                        ? "PSE"
                      : result.model.response == ResponseModel::differencing ? "ln tau"
                                                                             : "criterion");
  header.emplace_back("status");
  align.push_back(Align::right);
  align.push_back(Align::left);
  TextTable table(header, align);
  for (std::size_t c = 0; c < result.fit.conditions.size(); ++c) {
    const ConditionMean& one = result.fit.conditions[c];
    std::vector<std::string> row = {printable(result.answers.conditions[c]), four_digits(std::exp(one.mu)),
                                    jnd_range(one.ends)};
    if (standard > 0) row.push_back(percent_text(std::exp(one.mu) / standard));
    row.push_back(result.choice() ? four_digits(standard + one.criterion) : number_text(one.criterion, 3));
    row.emplace_back(word_of(kSlopeStatusWords, one.status));
    table.add(row);
  }
  return table.text();
}

std::string differences_text(const HierarchicalResult& result) {
  if (result.differences.empty()) return "";
  TextTable table({"conditions", "ratio of JNDs", "95 % profile", "chi-square", "p"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right});
  for (const ConditionDifference& one : result.differences)
    table.add({printable(result.answers.conditions[one.a] + " : " + result.answers.conditions[one.b]),
               number_text(std::exp(one.difference), 3), range_text(std::exp(one.ends.low), std::exp(one.ends.high), 3),
               number_text(one.lr, 2), p_value_text(one.p)});
  std::string text = "\n" + table.text();
  text += fmt::format("One JND for all conditions: chi-square {} with {} df, p {}.\n", number_text(result.fit.lr, 2),
                      result.fit.df, p_value_text(result.fit.p));
  if (result.bootstrap)
    text += fmt::format("In {} of {} studies drawn without a difference it is as large: p {}.\n",
                        result.bootstrap->as_large, result.bootstrap->replicates, p_value_text(result.bootstrap->p));
  return text;
}

std::string spreads_text(const HierarchicalResult& result) {
  const HierarchicalFit& fit = result.fit;
  const HierarchicalPlace& place = fit.maximum.place;
  TextTable table({"standard deviation between people", "", "of", "status"},
                  {Align::left, Align::right, Align::left, Align::left});
  const auto add = [&table](const char* name, double value, const char* of, SpreadStatus status) {
    if (status == SpreadStatus::not_asked) return;
    table.add({name, four_digits(value), of, std::string(word_of(kSpreadStatusWords, status))});
  };
  add("persons (tu)", place.tu, "ln JND", fit.tu);
  add("persons by condition (tv)", place.tv, "ln JND", fit.tv);
  add(result.choice() ? "PSE (tw)" : "criterion (tw)", place.tw, result.choice() ? "the level's unit" : "z", fit.tw);
  std::string text = "\n" + table.text();
  if (result.model.rho) text += fmt::format("Correlation of the first and the last: {}.\n", number_text(place.rho, 3));
  return text;
}

const char* shared_name(SharedParameter parameter, bool choice) {
  switch (parameter) {
    case SharedParameter::lapse:
      return "share of trials answered by chance";
    case SharedParameter::overdispersion:
      return "correlation of answers at one level";
    case SharedParameter::drift_ln_s:
      return "ln JND, second half less first";
    case SharedParameter::sure_below:
      return "same, sure: below";
    case SharedParameter::sure_above:
      return "different, sure: above";
    case SharedParameter::drift_criterion:
      break;
  }
  return choice ? "PSE, second half less first" : "criterion, second half less first";
}

// What is the same for everybody, and what its estimation does to the means.
std::string shared_text(const HierarchicalResult& result) {
  if (!result.without) return "";
  TextTable table({"the same for everybody", "", "95 % profile", "chi-square", "p", "status"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::left});
  for (const SharedEstimate& one : result.shared)
    table.add({shared_name(one.parameter, result.choice()), four_digits(one.value),
               std::isnan(one.ends.low) ? "-" : range_text(four_digits(one.ends.low), four_digits(one.ends.high)),
               number_text(one.lr, 2), p_value_text(one.p), std::string(word_of(kSharedStatusWords, one.status))});
  TextTable means({"condition", "JND", "95 % profile", "without these", "95 % profile"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right});
  for (std::size_t c = 0; c < result.fit.conditions.size(); ++c) {
    const ConditionMean &with = result.fit.conditions[c], &without = result.without->conditions[c];
    means.add({printable(result.answers.conditions[c]), four_digits(std::exp(with.mu)), jnd_range(with.ends),
               four_digits(std::exp(without.mu)), jnd_range(without.ends)});
  }
  std::string text = "\n" + table.text() +
                     dim("chi-square, p: of none. A share and a correlation cannot be below 0: p is half of that of "
                         "chi-square.") +
                     "\n\n" + means.text();
  if (!settled(*result.without)) text += warn("Without these the search did not settle.") + "\n";
  return text;
}

std::string sureness_text(const HierarchicalResult& result) {
  if (!result.answers.graded) return "";
  TextTable table({"criteria of sureness", "from the criterion", "95 % profile", "status"},
                  {Align::left, Align::right, Align::right, Align::left});
  for (const SharedEstimate& one : result.sureness)
    table.add({shared_name(one.parameter, false), number_text(one.value, 3),
               std::isnan(one.ends.low) ? "-" : range_text(four_digits(one.ends.low), four_digits(one.ends.high)),
               std::string(word_of(kSharedStatusWords, one.status))});
  std::string text = "\n" + table.text();
  for (std::size_t c = 0; c < result.narrower.size(); ++c)
    text += fmt::format("{}{} {}", c == 0 ? "Intervals of ln JND narrower than without the sureness: " : ", ",
                        printable(result.answers.conditions[c]),
                        std::isnan(result.narrower[c]) ? "-" : percent_text(result.narrower[c]));
  return text + ".\n";
}

// What the model takes for granted, as far as it still does.
std::string assumptions_of(const HierarchicalResult& result) {
  if (result.fit.shared.has(SharedParameter::drift_ln_s))
    return "Assumed: ln JND differs between people, and their criteria do, as normal distributions do, by the same "
           "spreads in every condition, and both change from the first half of the trials to the second by as much for "
           "everybody.";
  return std::string(kHierarchicalAssumptions);
}

std::string people_text(const HierarchicalResult& result) {
  TextTable table({"participant", "condition", "JND", "68 % of it", "from these answers alone", "status"},
                  {Align::left, Align::left, Align::right, Align::right, Align::right, Align::left});
  const std::size_t conditions = result.answers.conditions.size();
  for (std::size_t i = 0; i < result.people.size(); ++i) {
    const PersonEstimate& one = result.people[i];
    table.add({printable(result.answers.participants[i / conditions]),
               printable(result.answers.conditions[i % conditions]), four_digits(std::exp(one.mean)),
               range_text(four_digits(std::exp(one.mean - one.sd)), four_digits(std::exp(one.mean + one.sd))),
               four_digits(std::exp(one.alone)), std::string(word_of(kSlopeStatusWords, one.status))});
  }
  return "\n" + table.text() +
         dim("JND: given everybody's answers, at the group's estimates, which draws those with few answers towards the\n"
             "group; its range does not say how uncertain the group's estimates are.") +
         "\n";
}

std::string meanings_text(const HierarchicalResult& result) {
  const auto any = [&result](SlopeStatus status) {
    return std::any_of(result.fit.conditions.begin(), result.fit.conditions.end(),
                       [status](const ConditionMean& one) { return one.status == status; });
  };
  std::string text;
  if (any(SlopeStatus::no_sensitivity))
    text +=
        warn("no_sensitivity: the answers do not change with the level; there is no JND within 12 times the levels.") +
        "\n";
  if (any(SlopeStatus::ceiling))
    text += warn("ceiling: a step fits; the JND is below a twelfth of what the levels differ by.") + "\n";
  if (std::any_of(result.sureness.begin(), result.sureness.end(),
                  [](const SharedEstimate& one) { return one.status == SharedStatus::not_identified; }))
    text +=
        warn(
            "not_identified, of sureness: nobody gave both answers, sure and unsure, on that side; they count as one.") +
        "\n";
  if (!settled(result.fit))
    text += warn("The search for the largest likelihood did not settle: take no number from here.") + "\n";
  return text;
}

std::string hierarchical_text(const HierarchicalResult& result) {
  const HierarchicalFit& fit = result.fit;
  const char* const what =
      result.choice()                                       ? "choices between two intervals"
      : result.model.response == ResponseModel::yes_no      ? "same-different, decided on the difference"
      : result.model.response == ResponseModel::independent ? "same-different, decided by each interval itself"
                                                            : "same-different, decided on the size of the difference";
  std::string text =
      bold(fmt::format("hierarchical model: {}, lapse {:g}; {}, {:.0f} trials", what, fit.maximum.shared.lapse,
                       counted(static_cast<std::int64_t>(fit.participants), "participant"), fit.trials)) +
      "\n";
  text += conditions_text(result);
  text += dim(result.choice() ? "JND: s, from the PSE to where the comparison is chosen in 84 % of the trials, of the "
                                "median person."
                              : "JND: the difference of which d' is 1, of the median person.") +
          "\n";
  text += differences_text(result) + spreads_text(result) + sureness_text(result) + shared_text(result);
  if (!result.people.empty()) text += people_text(result);
  if (result.check) text += predictive_text(*result.check, result.answers.conditions, result.origin());
  constexpr std::size_t kColumns = 104;
  for (const std::string& line : wrapped_words(assumptions_of(result), kColumns)) text += dim(line) + "\n";
  return text + meanings_text(result);
}

int hierarchical(const HierarchicalCommand& options) {
  HierarchicalResult result;
  result.model = model_of(options);
  result.answers = options.trials.trials ? trial_answers(options) : counted_answers(options);
  refuse_empty(options, result.answers);
  if (options.bootstrap > 0 && (options.one_jnd || result.answers.conditions.size() < 2))
    throw UsageError("--bootstrap tests one JND for all conditions: it takes several conditions, without --one-jnd");
  if (options.check < 0 || options.check > 10'000) throw UsageError("--check=N: from 1 to 10000 draws");
  if (options.check > 0 && (options.overdispersion || options.drift))
    throw UsageError("--check draws independent answers that do not drift: leave --overdispersion and --drift out");
  if (result.answers.graded && options.overdispersion && options.bootstrap > 0)
    throw UsageError("--bootstrap draws no over-dispersed answers with sureness: leave one of the three out");
  const SharedForm others = result.model.estimated;
  SharedForm of_sureness;
  if (result.answers.graded)
    of_sureness = of_sureness.with(SharedParameter::sure_below).with(SharedParameter::sure_above);
  for (const SharedParameter which : kSharedParameters)
    if (of_sureness.has(which)) result.model.estimated = result.model.estimated.with(which);
  HierarchicalAnalysis analysis(result.answers.cells, result.model);
  analysis.add_intervals();
  result.fit = analysis.fit();
  result.differences = analysis.differences();
  for (const SharedEstimate& one : analysis.shared_estimates())
    (of_sureness.has(one.parameter) ? result.sureness : result.shared).push_back(one);
  if (result.answers.graded) result.narrower = narrower_by(result);
  if (others.any()) {
    HierarchicalModel plain = result.model;
    plain.estimated = of_sureness;
    result.without = HierarchicalAnalysis(result.answers.cells, plain).add_intervals();
  }
  if (options.people || options.input.json) result.people = analysis.people();
  if (options.check > 0) {
    HierarchicalModel found = result.model;
    found.shared = result.fit.maximum.shared;
    result.check = predictive_check(result.answers.cells, found, result.fit.maximum.place, options.check, options.seed);
  }
  if (options.bootstrap > 0) {
    const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    ProgressBar bar("drawing studies", options.bootstrap);
    result.bootstrap =
        equality_bootstrap(result.answers.cells, result.model, result.fit, options.bootstrap, options.seed,
                           options.threads > 0 ? options.threads : processors, [&bar](int done) { bar.update(done); });
  }
  if (options.input.json)
    fmt::print("{}\n", json_line(hierarchical_json(result)));
  else
    fmt::print("{}", hierarchical_text(result));
  return exit_code::kDone;
}

}  // namespace

void add_calc_hierarchical(CommandTree& calc) {
  const auto [command, options] =
      calc.add("hierarchical", "One model of everybody's answers: the group's JND, ratios of conditions, each person's",
               "jnd calc hierarchical answers.csv --task same-different", hierarchical);
  add_input(
      command, options.input,
      "participant, condition, n, k, and delta (the difference, 0 on same trials; k: answers \"different\") or x "
      "(the comparison's level; k: times it was chosen); for k may stand category (1: same sure, 2: same unsure, 3: "
      "different unsure, 4: different sure); with --observer independent also block, where there are several "
      "differences");
  command.add_option("--task", options.task, "what was asked")
      ->check(CLI::IsMember({"same-different", "which"}))
      ->required();
  command
      .add_option(
          "--observer", options.observer,
          "of same-different: decided on the difference (yes-no), on its size (differencing), or by each interval "
          "itself (independent)")
      ->check(CLI::IsMember({"yes-no", "differencing", "independent"}))
      ->capture_default_str();
  command
      .add_option("--lapse", options.lapse,
                  "share of trials answered by chance: a number, or shared (estimated, the same for everybody)")
      ->capture_default_str();
  command.add_flag("--overdispersion", options.overdispersion,
                   "estimate how much more alike the answers of one person, condition and level are than independent "
                   "ones");
  command.add_flag("--drift", options.drift,
                   "estimate the change from the first half of each person's trials in a condition to the second: "
                   "counts have a column half (1 or 2), rows of --trials stand in the order of the trials");
  command
      .add_option("--random", options.random,
                  "what differs between people, with commas: tu (JND), tv (JND by condition), tw (criterion, PSE), rho "
                  "(correlation of tu and tw); none")
      ->capture_default_str();
  command.add_flag("--one-jnd", options.one_jnd, "one JND for all conditions");
  command.add_flag("--people", options.people, "also each person's JND, beside the one from their answers alone");
  command
      .add_option("--bootstrap", options.bootstrap,
                  "draw so many studies without a difference between conditions, for the test of one JND")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  command.add_flag(fmt::format("--check{{{}}}", kPredictiveDraws), options.check,
                   fmt::format("whether the model draws answers like these: a posterior predictive check by {} draws, "
                               "or --check=N",
                               kPredictiveDraws));
  command.add_option("--seed", options.seed, "of the drawn studies and of the check")->capture_default_str();
  command.add_option("--threads", options.threads, "drawn studies at a time (default: one a processor)")
      ->check(CLI::Range(1, 1024));
  add_trial_options(command, options.trials, kHierarchicalUse);
}

}  // namespace jnd
