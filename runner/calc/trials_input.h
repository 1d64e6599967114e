// Single trials, a row each, from the table of any program: which columns say what, and the counts of their answers.
// Other columns are passed over. Those of trials.csv of `jnd export` need not be named.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/detection/counts.h"
#include "protocols/input/csv_table.h"
#include "runner/terminal/command_tree.h"

namespace jnd {

// What --trials and the options beside it say. Names are those of columns; empty where not given.
struct TrialOptions {
  bool trials = false;
  std::string participant, condition, level, answer;
  std::string standard;  // a column, or a number
  std::string order;
  std::string positive;                  // the answer that is counted, where the words do not say so themselves
  std::optional<std::string> no_answer;  // what stands in place of a missing answer; may be empty
  std::string sureness, block;
  int sure_from = 2;  // degrees of sureness from here on count as sure
};

// What a command makes of trials.
struct TrialUse {
  const char* positive;  // what the counted answer says, such as "the comparison was chosen"
  // Pairs of words that need no --positive: the counted one first. 1 and 0, yes and no, true and false always do.
  std::vector<std::pair<std::string_view, std::string_view>> words;
  bool with_order = false;     // --order, and the answers first and second by it
  bool differences = false;    // levels are differences: from --standard, where it is given
  bool with_sureness = false;  // --sureness and --block
};

// Of same-different trials: the answer "different", and differences, 0 on same trials. Of choices between two intervals.
extern const TrialUse kSameDifferentUse, kWhichUse;

void add_trial_options(const Command& command, TrialOptions& options, const TrialUse& use);

struct CsvTrial {
  std::size_t unit = 0;  // in TrialTable::units
  double level = 0;      // with `differences` less the standard
  int order = 0;         // 1: the comparison came second, -1: first, 0: not asked for, or the same in all trials
  bool positive = false;
  bool sure = false;  // false where --sureness does not say so
  std::string block;  // which trials it was mixed with; empty without --block
};

// The trials of one participant in one condition (and with one standard), in order of first appearance.
struct TrialUnit {
  std::optional<std::string> participant, condition;
  std::optional<double> standard;
  bool one_of_several = false;  // standards, so that its name says which
  std::string name() const;     // "P01 / V", "P01 / V / 900"; "all" where nothing tells units apart
};

struct TrialTable {
  std::string file;  // its name in messages
  std::vector<TrialUnit> units;
  std::vector<CsvTrial> trials;
};

// Says on standard error how many trials have no answer, and which participants' codes look alike.
// Throws UsageError where options lack --trials or do not go together, InputError with the place where a column is
// missing, a level or standard is not a number, an order is neither 1 nor -1 (or second, first), or there are more than
// two different answers; and where nothing says which answer is counted.
// Where the options name no column the table is trials.csv of an export, of same-different or of "which has more?":
// without practice and trials that a rule excludes; a level of same-different is the difference of the two stimuli.
// Throws UsageError where it is another table, InputError where its task is not the command's.
TrialTable read_trials(const std::string& file, const TrialOptions& options, const TrialUse& use);

// What the text of an option says where it is a finite number and nothing else, such as --standard or --lapse.
std::optional<double> number_in_option(const std::string& text);

// Neither a column nor anything else is said of the table.
bool names_nothing(const TrialOptions& options) noexcept;

// Throws UsageError where an option of trials is given without --trials.
void refuse_trial_options(const TrialOptions& options, const TrialUse& use);

// The trials of a unit by level: the level, n, and how many answers were counted; ascending.
struct TrialCount {
  double level = 0;
  int n = 0, k = 0;
  int sure_k = 0, sure_others = 0;  // of the counted answers, and of the others
};
std::vector<std::vector<TrialCount>> count_trials(const TrialTable& table);  // of each unit

// A row of counts: columns n_diff, hits, n_same, false_alarms. Throws InputError, located, where a count is not a whole
// number of 0 or more, or more answers were counted than trials.
Counts counts_of(const CsvTable& table, std::size_t row);

}  // namespace jnd
