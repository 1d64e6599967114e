#include "runner/calc/trials_input.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_reader.h"
#include "runner/terminal/exit_code.h"

namespace jnd {

namespace {

std::optional<double> number_in(const std::string& text) {
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// The two answers of a table, in order of first appearance.
class TwoAnswers {
 public:
  TwoAnswers(const CsvTable& table, const std::string& column) {
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const std::string_view word = table.text(row, column);
      if (word.empty())
        table.fail(row, column, "is empty", "a trial without an answer is none: take its row out of the table");
      if (std::find(words_.begin(), words_.end(), word) != words_.end()) continue;
      if (words_.size() == 2)
        table.fail(row, column,
                   fmt::format("{} is neither {} nor {}", in_quotes(word), in_quotes(words_[0]), in_quotes(words_[1])),
                   "write one of two words in every row, and take trials without a valid answer out");
      words_.emplace_back(word);
    }
  }

  bool only(std::string_view first, std::string_view second) const {
    return std::all_of(words_.begin(), words_.end(),
                       [&](const std::string& word) { return word == first || word == second; });
  }
  bool has(const std::string& word) const { return std::find(words_.begin(), words_.end(), word) != words_.end(); }
  std::string listed() const {
    std::string text = in_quotes(words_[0]);
    if (words_.size() > 1) text += " and " + in_quotes(words_[1]);
    return text;
  }
  const std::string& one() const { return words_[0]; }

 private:
  std::vector<std::string> words_;
};

constexpr std::pair<std::string_view, std::string_view> kPlainAnswers[] = {
    {"1", "0"}, {"yes", "no"}, {"Yes", "No"}, {"true", "false"}, {"True", "False"}, {"TRUE", "FALSE"}};

// The word that is counted; none: the interval that was chosen, which the order makes an answer.
std::optional<std::string> counted_word(const std::string& file, const TwoAnswers& answers, const TrialOptions& options,
                                        const TrialUse& use) {
  if (!options.positive.empty()) {
    if (answers.has(options.positive)) return options.positive;
    throw InputError(fmt::format("{}: no answer in column {} is {}, which --positive names; its answers are {}", file,
                                 in_quotes(options.answer), in_quotes(options.positive), answers.listed()));
  }
  for (const auto& [positive, negative] : use.words)
    if (answers.only(positive, negative)) return std::string(positive);
  for (const auto& [positive, negative] : kPlainAnswers)
    if (answers.only(positive, negative)) return std::string(positive);
  if (!options.order.empty() && answers.only("second", "first")) return std::nullopt;
  throw InputError(
      fmt::format("{}: which answer in column {} says that {}? They are {}: give one of them, as in "
                  "--positive {}",
                  file, in_quotes(options.answer), use.positive, answers.listed(), in_quotes(answers.one())));
}

int order_at(const CsvTable& table, std::size_t row, const std::string& column) {
  const std::string_view text = table.text(row, column);
  if (text == "1" || text == "+1" || text == "second") return 1;
  if (text == "-1" || text == "first") return -1;
  table.fail(row, column, fmt::format("{} is no order of the two intervals", in_quotes(text)),
             "write 1 or second where the comparison came second, -1 or first where it came first");
}

std::vector<std::string> wanted_columns(const TrialOptions& options) {
  if (options.level.empty() || options.answer.empty())
    throw UsageError("--trials needs --level and --answer, the columns of the level and of the answer");
  std::vector<std::string> columns = {options.level, options.answer};
  for (const std::string& more : {options.participant, options.condition, options.order})
    if (!more.empty()) columns.push_back(more);
  if (!options.standard.empty() && !number_in(options.standard)) columns.push_back(options.standard);
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (std::find(columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(i), columns[i]) !=
        columns.begin() + static_cast<std::ptrdiff_t>(i))
      throw UsageError(fmt::format("column {} is named for two things: each option takes one of its own", columns[i]));
  return columns;
}

// file: its name in messages.
TrialTable trials_of(const CsvTable& table, const std::string& file, const TrialOptions& options, const TrialUse& use) {
  const TwoAnswers answers(table, options.answer);
  TrialTable out;
  out.file = file;
  const std::optional<std::string> counted = counted_word(out.file, answers, options, use);
  const std::optional<double> one_standard = number_in(options.standard);
  std::map<std::tuple<std::string_view, std::string_view, double>, std::size_t> places;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    TrialUnit unit;
    std::string_view participant, condition;
    if (!options.participant.empty()) unit.participant = participant = table.text(row, options.participant);
    if (!options.condition.empty()) unit.condition = condition = table.text(row, options.condition);
    if (!options.standard.empty()) unit.standard = one_standard ? *one_standard : table.number(row, options.standard);
    const auto [place, added] =
        places.try_emplace({participant, condition, unit.standard.value_or(0)}, out.units.size());
    if (added) out.units.push_back(unit);
    CsvTrial trial;
    trial.unit = place->second;
    trial.level = table.number(row, options.level);
    if (use.differences) trial.level -= unit.standard.value_or(0);
    if (!options.order.empty()) trial.order = order_at(table, row, options.order);
    const std::string_view answer = table.text(row, options.answer);
    trial.positive = counted ? answer == *counted : (answer == "second") == (trial.order == 1);
    out.trials.push_back(trial);
  }
  for (TrialUnit& unit : out.units) unit.one_of_several = !one_standard && !options.standard.empty();
  return out;
}

}  // namespace

const TrialUse kSameDifferentUse = {"the stimuli were different", {{"different", "same"}}, false, true};

void add_trial_options(CLI::App& command, TrialOptions& options, const TrialUse& use) {
  command.add_flag("--trials", options.trials,
                   "the table holds trials, a row each, of any program; the options below name its columns");
  command.add_option("--level", options.level, "with --trials: column of the level");
  command.add_option("--answer", options.answer, "with --trials: column of the answer, one of two words");
  command.add_option("--participant", options.participant, "with --trials: column of the participant");
  command.add_option("--condition", options.condition, "with --trials: column of the condition");
  command.add_option("--standard", options.standard,
                     use.differences ? "with --trials: a number or a column, from which the levels are differences"
                                     : "what the levels are judged against: a number, or with --trials a column");
  if (use.with_order)
    command.add_option("--order", options.order,
                       "with --trials: column that says 1 or second where the comparison came second, -1 or first");
  command.add_option("--positive", options.positive,
                     fmt::format("with --trials: the answer that says that {}", use.positive));
}

void refuse_trial_options(const TrialOptions& options, const TrialUse& use) {
  const std::pair<const char*, const std::string*> given[] = {
      {"--level", &options.level},         {"--answer", &options.answer}, {"--participant", &options.participant},
      {"--condition", &options.condition}, {"--order", &options.order},   {"--positive", &options.positive}};
  for (const auto& [option, value] : given)
    if (!value->empty()) throw UsageError(fmt::format("{} goes with --trials, where rows are trials", option));
  if (use.differences && !options.standard.empty())
    throw UsageError("--standard goes with --trials, where rows are trials");
}

std::string TrialUnit::name() const {
  std::string text = participant.value_or("");
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : " / ") + part; };
  if (condition) add(*condition);
  if (one_of_several && standard) add(fmt::format("{:g}", *standard));
  return text.empty() ? "all" : text;
}

TrialTable read_trials(const std::string& file, const TrialOptions& options, const TrialUse& use) {
  const std::vector<std::string> wanted = wanted_columns(options);
  return trials_of(CsvTable::read_among(file, wanted), file == "-" ? "standard input" : file, options, use);
}

TrialTable parse_trials(std::string text, const std::string& file, const TrialOptions& options, const TrialUse& use) {
  return trials_of(CsvTable::parse_among(std::move(text), file, wanted_columns(options)), file, options, use);
}

std::vector<std::vector<TrialCount>> count_trials(const TrialTable& table) {
  std::vector<std::map<double, TrialCount>> counts(table.units.size());
  for (const CsvTrial& trial : table.trials) {
    TrialCount& count = counts[trial.unit][trial.level];
    count.level = trial.level;
    ++count.n;
    if (trial.positive) ++count.k;
  }
  std::vector<std::vector<TrialCount>> out(counts.size());
  for (std::size_t unit = 0; unit < counts.size(); ++unit)
    for (const auto& [level, count] : counts[unit]) out[unit].push_back(count);
  return out;
}

}  // namespace jnd
