#include "runner/calc/trials_input.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/numerics/decimal_order.h"
#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/number_from.h"
#include "runner/calc/calc.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"

namespace jnd {

namespace {

// The two answers of a table, in order of first appearance.
class TwoAnswers {
 public:
  // missing: what stands in place of a missing answer.
  TwoAnswers(const CsvTable& table, const std::string& column, const std::optional<std::string>& missing = {}) {
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const std::string_view word = table.text(row, column);
      if (word == missing) continue;
      if (word.empty()) table.fail(row, column, "is empty", "to leave out trials without an answer: --no-answer \"\"");
      if (std::find(words_.begin(), words_.end(), word) != words_.end()) continue;
      if (words_.size() == 2)
        table.fail(row, column,
                   fmt::format("{} is neither {} nor {}", in_quotes(word), in_quotes(words_[0]), in_quotes(words_[1])),
                   "write one of two words in every row; the word for no answer is said with --no-answer");
      words_.emplace_back(word);
    }
    if (words_.empty()) table.fail(0, column, "no trial has an answer", "which word is no answer?");
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
  for (const std::string& more :
       {options.participant, options.condition, options.order, options.sureness, options.block})
    if (!more.empty()) columns.push_back(more);
  if (!options.standard.empty() && !number_in_option(options.standard)) columns.push_back(options.standard);
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (std::find(columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(i), columns[i]) !=
        columns.begin() + static_cast<std::ptrdiff_t>(i))
      throw UsageError(fmt::format("column {} is named for two things: each option takes one of its own", columns[i]));
  return columns;
}

// What --sureness and --block say of a trial.
void read_sureness(CsvTrial& trial, const CsvTable& table, std::size_t row, const TrialOptions& options) {
  constexpr int kMostDegrees = 100;
  if (!options.sureness.empty())
    trial.sure = table.integer(row, options.sureness, 0, kMostDegrees) >= options.sure_from;
  if (!options.block.empty()) trial.block = table.text(row, options.block);
}

// file: its name in messages.
TrialTable trials_of(const CsvTable& table, const std::string& file, const TrialOptions& options, const TrialUse& use) {
  const TwoAnswers answers(table, options.answer, options.no_answer);
  say_look_alikes(table, options.participant, file);
  TrialTable out;
  out.file = file;
  const std::optional<std::string> counted = counted_word(out.file, answers, options, use);
  const std::optional<double> one_standard = number_in_option(options.standard);
  std::map<std::tuple<std::string_view, std::string_view, double>, std::size_t> places;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.text(row, options.answer) == options.no_answer) continue;
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
    if (use.differences) trial.level = plain_sum(trial.level, -unit.standard.value_or(0));
    if (!options.order.empty()) trial.order = order_at(table, row, options.order);
    const std::string_view answer = table.text(row, options.answer);
    trial.positive = counted ? answer == *counted : (answer == "second") == (trial.order == 1);
    read_sureness(trial, table, row, options);
    out.trials.push_back(trial);
  }
  for (TrialUnit& unit : out.units) unit.one_of_several = !one_standard && !options.standard.empty();
  if (options.no_answer)
    write_marked_message(fmt::format("{}: {} of {} trials have no answer ({}) and are left out", file,
                                     table.rows() - out.trials.size(), table.rows(), in_quotes(*options.no_answer)));
  return out;
}

// Columns of trials.csv that no other program has together; data/export/export_tables.cpp writes them.
bool is_own_export(const CsvTable& table) {
  constexpr const char* kAlways[] = {"participant", "condition", "practice", "answer", "excluded", "protocol_sha256"};
  return std::all_of(std::begin(kAlways), std::end(kAlways), [&](const char* name) { return table.has(name); });
}

// The column of an export whose name ends with the study's unit; empty where there is none.
std::string column_with_unit(const CsvTable& table, std::string_view beginning) {
  for (const std::string& name : table.columns())
    if (name.starts_with(beginning)) return name;
  return {};
}

// Of which task an export is, as far as these commands know it.
struct OwnExport {
  std::string first, second, standard;  // columns of the stimuli and of the standard
  bool same_different = false;
  std::string more_first, more_second;  // answers: the first has more, the second has
};

OwnExport own_export(const CsvTable& table, const std::string& file, const TrialUse& use) {
  OwnExport own;
  own.first = column_with_unit(table, "stimulus_1_");
  own.second = column_with_unit(table, "stimulus_2_");
  if (own.first.empty()) throw InputError(file + ": an export without stimuli: the study is blinded, or has none");
  own.standard = "standard" + own.first.substr(std::string_view("stimulus_1").size());
  own.same_different = table.has("same");
  // The curve of `fit`, which has no words of its own, goes with either.
  const bool fits = own.same_different ? use.differences : use.with_order || use.words.empty();
  const bool known = own.same_different || (table.has(own.standard) && table.has("target") && !own.second.empty() &&
                                            column_with_unit(table, "stimulus_3_").empty());
  if (fits && known) return own;
  throw InputError(fmt::format(
      "{}: an export of another task: sdt, jnd and fit take trials of same-different, which and fit trials of \"which "
      "has more?\"; the results of every task are in its other files",
      file));
}

// 1 where the first is larger, -1 where the second is, 0 where neither is.
int larger_first(double first, double second) noexcept {
  return first > second ? 1 : first < second ? -1 : 0;
}

// Which words say that the first, or the second, has more: `target` is the right answer, "chosen" of the protocol may
// ask for what has less.
void learn_words(OwnExport& own, const CsvTable& table) {
  const TwoAnswers answers(table, "answer");
  for (const auto& [one, other] : {std::pair("first", "second"), std::pair("left", "right")})
    if (answers.only(one, other)) own.more_first = one, own.more_second = other;
  if (own.more_first.empty()) table.fail(0, "answer", "is no answer to \"which has more?\"", "take another export");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const int more = larger_first(table.number(row, own.first), table.number(row, own.second));
    const std::string_view target = table.text(row, "target");
    if (more == 0 || target.empty()) continue;
    if ((target == own.more_first) != (more > 0)) std::swap(own.more_first, own.more_second);
    return;
  }
}

TrialTable trials_of_export(const CsvTable& table, const std::string& file, const TrialOptions& options,
                            const TrialUse& use) {
  OwnExport own = own_export(table, file, use);
  for (const auto& [option, column] : {std::pair("--sureness", options.sureness), {"--block", options.block}})
    if (!column.empty() && !table.has(column))
      throw UsageError(fmt::format("{}: {} has no column {}", option, file, in_quotes(column)));
  if (!own.same_different) learn_words(own, table);
  TrialTable out;
  out.file = file;
  std::map<std::tuple<std::string_view, std::string_view, double>, std::size_t> places;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.integer(row, "practice", 0, 1) == 1 || table.integer(row, "excluded", 0, 1) == 1) continue;
    TrialUnit unit{.participant = std::string(table.text(row, "participant")),
                   .condition = std::string(table.text(row, "condition")),
                   .standard = std::nullopt,
                   .one_of_several = !own.same_different};
    if (!own.same_different) unit.standard = table.number(row, own.standard);
    const auto [place, added] = places.try_emplace(
        {table.text(row, "participant"), table.text(row, "condition"), unit.standard.value_or(0)}, out.units.size());
    if (added) out.units.push_back(unit);
    const double first = table.number(row, own.first), second = table.number(row, own.second);
    const std::string_view answer = table.text(row, "answer");
    CsvTrial trial;
    trial.unit = place->second;
    if (own.same_different) {
      trial.level = plain_distance(first, second);
      trial.positive = answer == "different";
      read_sureness(trial, table, row, options);
    } else {
      // Where a level may equal the standard the values do not tell which is which.
      const bool comparison_second =
          table.has("standard_interval") ? table.integer(row, "standard_interval", 1, 2) == 1 : first == *unit.standard;
      trial.level = comparison_second ? second : first;
      if (use.differences) trial.level = plain_sum(trial.level, -*unit.standard);
      trial.order = use.with_order ? (comparison_second ? 1 : -1) : 0;
      trial.positive = answer == (comparison_second ? own.more_second : own.more_first);
    }
    out.trials.push_back(trial);
  }
  if (out.trials.empty()) throw InputError(file + ": no trial that counts: all are practice or excluded");
  const int order = out.trials.front().order;
  if (std::all_of(out.trials.begin(), out.trials.end(),
                  [order](const CsvTrial& trial) { return trial.order == order; }))
    for (CsvTrial& trial : out.trials) trial.order = 0;
  return out;
}

TrialTable trials_without_names(const CsvTable& table, const std::string& file, const TrialOptions& options,
                                const TrialUse& use) {
  if (is_own_export(table)) return trials_of_export(table, file, options, use);
  throw UsageError(
      fmt::format("--trials needs --level and --answer, the columns of the level and of the answer (only trials.csv of "
                  "jnd export needs no names); {} has the columns {}",
                  file, fmt::join(table.columns(), ", ")));
}

}  // namespace

const TrialUse kSameDifferentUse = {"the stimuli were different", {{"different", "same"}}, false, true};
const TrialUse kWhichUse = {"the comparison was chosen", {{"comparison", "standard"}}, true, false};

void add_trial_options(const Command& command, TrialOptions& options, const TrialUse& use) {
  command.add_flag("--trials", options.trials,
                   "the table holds trials, a row each, of any program; the options below name its columns (trials.csv "
                   "of jnd export needs none)");
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
  if (use.with_sureness) {
    command.add_option("--sureness", options.sureness,
                       "with --trials, of same-different: column of how sure the answer was, a whole number");
    command.add_option("--sure-from", options.sure_from, "the least --sureness that counts as sure")
        .range(1, 100)
        .show_default();
    command.add_option("--block", options.block,
                       "with --trials and --observer independent: column that names the trials that were mixed, of one "
                       "difference");
  }
  command.add_option(
      "--no-answer", options.no_answer,
      "with --trials: what stands in place of a missing answer, such as -1, NA or \"\": these trials are left out");
  command.add_option("--positive", options.positive,
                     fmt::format("with --trials: the answer that says that {}", use.positive));
}

void refuse_trial_options(const TrialOptions& options, const TrialUse& use) {
  const std::pair<const char*, const std::string*> given[] = {
      {"--level", &options.level},         {"--answer", &options.answer}, {"--participant", &options.participant},
      {"--condition", &options.condition}, {"--order", &options.order},   {"--positive", &options.positive},
      {"--sureness", &options.sureness},   {"--block", &options.block}};
  for (const auto& [option, value] : given)
    if (!value->empty()) throw UsageError(fmt::format("{} goes with --trials, where rows are trials", option));
  if (options.no_answer) throw UsageError("--no-answer goes with --trials, where rows are trials");
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

std::optional<double> number_in_option(const std::string& text) {
  const std::optional<double> value = number_from<double>(text);
  return value && std::isfinite(*value) ? std::optional(plain_decimal(*value)) : std::nullopt;
}

bool names_nothing(const TrialOptions& options) noexcept {
  return options.level.empty() && options.answer.empty() && options.participant.empty() && options.condition.empty() &&
         options.standard.empty() && options.order.empty() && options.positive.empty() && !options.no_answer;
}

TrialTable read_trials(const std::string& file, const TrialOptions& options, const TrialUse& use) {
  const std::string name = file == "-" ? "standard input" : file;
  if (names_nothing(options)) return trials_without_names(CsvTable::read_among(file, {}), name, options, use);
  const std::vector<std::string> wanted = wanted_columns(options);
  return trials_of(CsvTable::read_among(file, wanted), name, options, use);
}

std::vector<std::vector<TrialCount>> count_trials(const TrialTable& table) {
  std::vector<std::map<double, TrialCount>> counts(table.units.size());
  for (const CsvTrial& trial : table.trials) {
    TrialCount& count = counts[trial.unit][trial.level];
    count.level = trial.level;
    ++count.n;
    if (trial.positive) ++count.k;
    if (trial.sure) ++(trial.positive ? count.sure_k : count.sure_others);
  }
  std::vector<std::vector<TrialCount>> out(counts.size());
  for (std::size_t unit = 0; unit < counts.size(); ++unit)
    for (const auto& [level, count] : counts[unit]) out[unit].push_back(count);
  return out;
}

Counts counts_of(const CsvTable& table, std::size_t row) {
  Counts counts;
  counts.n_diff = table.integer(row, "n_diff", 0);
  counts.hits = table.integer(row, "hits", 0);
  counts.n_same = table.integer(row, "n_same", 0);
  counts.false_alarms = table.integer(row, "false_alarms", 0);
  if (counts.hits > counts.n_diff)
    table.fail(row, "hits", fmt::format("{} hits of {} trials with different stimuli", counts.hits, counts.n_diff),
               "hits are at most n_diff");
  if (counts.false_alarms > counts.n_same)
    table.fail(row, "false_alarms",
               fmt::format("{} false alarms of {} trials with equal stimuli", counts.false_alarms, counts.n_same),
               "false_alarms are at most n_same");
  return counts;
}

}  // namespace jnd
