// jnd calc compare, wilcoxon, ptukey, qtukey, shapiro: statistics of a group of participants.

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "analysis/group/between_groups.h"
#include "analysis/group/compare.h"
#include "analysis/group/mixed_anova.h"
#include "analysis/group/p_adjust.h"
#include "analysis/group/rank_tests.h"
#include "analysis/group/within_table.h"
#include "analysis/numerics/studentised_range.h"
#include "data/blocks/common_fields.h"
#include "data/blocks/comparison_blocks.h"
#include "data/blocks/statistic_fields.h"
#include "data/fields/number_text.h"
#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "runner/calc/calc.h"
#include "runner/calc/calc_output.h"
#include "runner/results/block_output.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

// Squares and their sums stay far from the limits of double.
constexpr NumberRange kGroupValues{-1e100, 1e100};

struct LongTable {
  std::vector<std::string> participants, conditions;  // in the order of their first row
  WithinTable values;
};

// Where participants are in groups: every one has a value under each condition, or one value alone.
struct GroupedLongTable {
  std::vector<std::string> groups, conditions;  // in the order of their first row
  GroupedTable values;                          // k = 1 where every participant has one value alone
  bool mixed() const noexcept { return values.values.k > 1; }
};

struct PairedColumn {
  std::string item;          // empty without a column of that name
  std::vector<double> x, y;  // of equal size
};

// Names in the order of their first row, and where that is.
class Names {
 public:
  std::size_t add(const CsvTable& csv, std::size_t row, const char* column) {
    const std::string name(csv.text(row, column));
    if (name.empty()) csv.fail(row, column, "is empty", "every row names its " + std::string(column));
    const auto [place, added] = places_.try_emplace(name, names.size());
    if (added) {
      names.push_back(name);
      first_rows.push_back(row);
    }
    return place->second;
  }
  std::vector<std::string> names;
  std::vector<std::size_t> first_rows;

 private:
  std::map<std::string, std::size_t> places_;
};

// "P3 (no SV), P7 (no S, no V)", at the first of them.
void refuse_incomplete(const CsvTable& csv, const Names& participants, const Names& conditions,
                       const std::map<std::pair<std::size_t, std::size_t>, double>& cells) {
  constexpr std::size_t kNamed = 5;
  std::vector<std::string> incomplete;
  std::size_t first = 0;
  for (std::size_t i = 0; i < participants.names.size(); ++i) {
    std::string missing;
    for (std::size_t j = 0; j < conditions.names.size(); ++j)
      if (!cells.contains({i, j})) missing += (missing.empty() ? "no " : ", no ") + conditions.names[j];
    if (missing.empty()) continue;
    if (incomplete.empty()) first = i;
    incomplete.push_back(fmt::format("{} ({})", participants.names[i], missing));
  }
  if (incomplete.empty()) return;
  std::string who;
  for (std::size_t i = 0; i < incomplete.size() && i < kNamed; ++i) who += (i > 0 ? ", " : "") + incomplete[i];
  if (incomplete.size() > kNamed) who += fmt::format(" and {} more", incomplete.size() - kNamed);
  csv.fail(participants.first_rows[first], "participant",
           fmt::format("{} of {} participants lack{} a value: {}", incomplete.size(), participants.names.size(),
                       incomplete.size() == 1 ? "s" : "", who),
           "add the missing rows, or leave out every row of these participants and say so in the report");
}

// Columns participant, condition, value. Throws one located InputError where a participant has no value, or two, under
// a condition: tests within participants have no use for half a row, and dropping a participant is the user's decision.
LongTable long_table(const CsvTable& csv) {
  Names participants, conditions;
  std::map<std::pair<std::size_t, std::size_t>, double> cells;
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    const std::size_t i = participants.add(csv, row, "participant"), j = conditions.add(csv, row, "condition");
    const double value = csv.number(row, "value", kGroupValues);
    if (!cells.try_emplace({i, j}, value).second)
      csv.fail(row, "participant",
               fmt::format("{} has a second value under {}", participants.names[i], conditions.names[j]),
               "keep one row for each participant and condition: delete one of the two, or give their mean");
  }
  if (conditions.names.size() < 2)
    csv.fail(0, "condition", fmt::format("{} is the only condition", conditions.names.front()),
             "a comparison needs at least two");
  if (conditions.names.size() > 1000)
    csv.fail(conditions.first_rows[1000], "condition", "is condition number 1001", "at most 1000 are compared");
  refuse_incomplete(csv, participants, conditions, cells);

  LongTable table;
  table.values.n = participants.names.size();
  table.values.k = conditions.names.size();
  for (const auto& [cell, value] : cells) table.values.values.push_back(value);  // sorted: by participant, condition
  table.participants = std::move(participants.names);
  table.conditions = std::move(conditions.names);
  return table;
}

// Of participants with one value each: the condition is that of the whole group.
void refuse_second_factor(const CsvTable& csv, const Names& participants, const Names& groups,
                          const std::vector<std::size_t>& group_of) {
  std::map<std::size_t, std::string> condition_of;
  for (std::size_t i = 0; i < participants.names.size(); ++i) {
    const std::size_t row = participants.first_rows[i];
    const std::string condition(csv.text(row, "condition"));
    const std::string& first = condition_of.try_emplace(group_of[i], condition).first->second;
    if (first != condition)
      csv.fail(
          row, "condition",
          fmt::format("group {} has {} and {}, and each participant has one of them", groups.names[group_of[i]], first,
                      condition),
          "a comparison has one factor between participants: name group and condition together in the column group");
  }
}

// Columns participant, condition (may be missing where everybody has one row), value, group. Throws one located
// InputError where a participant is in two groups or has half a row, there is one group, or a group of participants
// with one value each has several conditions.
GroupedLongTable grouped_table(const CsvTable& csv) {
  Names participants, conditions, groups;
  std::map<std::pair<std::size_t, std::size_t>, double> cells;
  GroupedLongTable table;
  std::vector<std::size_t>& group_of = table.values.group;
  const bool named = csv.has("condition");
  if (!named) conditions.names = {"all"};
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    const std::size_t i = participants.add(csv, row, "participant");
    const std::size_t j = named ? conditions.add(csv, row, "condition") : 0;
    const std::size_t group = groups.add(csv, row, "group");
    if (i == group_of.size()) group_of.push_back(group);
    if (group_of[i] != group)
      csv.fail(row, "group",
               fmt::format("{} is in two groups: {} and {}", participants.names[i], groups.names[group_of[i]],
                           groups.names[group]),
               "a participant belongs to one group; what every participant has is a condition");
    if (!cells.try_emplace({i, j}, csv.number(row, "value", kGroupValues)).second)
      csv.fail(row, "participant",
               fmt::format("{} has a second value under {}", participants.names[i], conditions.names[j]),
               "keep one row for each participant and condition: delete one of the two, or give their mean");
  }
  if (groups.names.size() < 2)
    csv.fail(0, "group", fmt::format("{} is the only group", groups.names.front()),
             "leave the column out, or add the participants of the others");
  if (groups.names.size() > 1000 || conditions.names.size() > 1000)
    csv.fail(0, "group", "there are more than 1000 groups or conditions", "at most 1000 of each are compared");
  const bool between = cells.size() == participants.names.size();
  if (between && named)
    refuse_second_factor(csv, participants, groups, group_of);
  else if (!between)
    refuse_incomplete(csv, participants, conditions, cells);
  table.values.groups = groups.names.size();
  table.values.values.n = participants.names.size();
  table.values.values.k = between ? 1 : conditions.names.size();
  for (const auto& [cell, value] : cells) table.values.values.values.push_back(value);  // by participant, condition
  table.groups = std::move(groups.names);
  table.conditions = std::move(conditions.names);
  return table;
}

// Columns x, y and perhaps item, in the order of each item's first row.
std::vector<PairedColumn> paired_columns(const CsvTable& csv) {
  Names items;
  std::vector<PairedColumn> columns;
  if (!csv.has("item")) columns.emplace_back();
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    std::size_t place = 0;
    if (csv.has("item")) {
      place = items.add(csv, row, "item");
      if (place == columns.size()) columns.push_back({items.names.back(), {}, {}});
    }
    columns[place].x.push_back(csv.number(row, "x", kGroupValues));
    columns[place].y.push_back(csv.number(row, "y", kGroupValues));
  }
  return columns;
}

using Align = TextTable::Align;
using Json = nlohmann::ordered_json;

struct GroupOptions {
  CalcInput input;
};

// Of values in groups: group, condition (empty where everybody has one value) and participants.
GroupsCompared groups_compared(const GroupedLongTable& table) {
  GroupsCompared compared;
  compared.outcome = compared.title = "value";
  compared.test = table.mixed() ? BetweenTest::mixed_anova : BetweenTest::welch;
  compared.table = table.values;
  compared.comparison = compare_groups(table.values);
  compared.participants.resize(table.values.values.n);
  for (const GroupCell& cell : compared.comparison.cells) {
    const MeanInterval& mean = cell.mean;
    compared.means.push_back({static_cast<int>(cell.group),
                              static_cast<int>(cell.condition),
                              mean.n,
                              {mean.n, mean.mean, mean.sd, mean.ci_low, mean.ci_high},
                              cell.median,
                              cell.shapiro});
  }
  return compared;
}

void print_groups(const GroupedLongTable& table, bool json) {
  const GroupsCompared compared = groups_compared(table);
  const std::vector<std::string> conditions = table.mixed() ? table.conditions : std::vector<std::string>{""};
  std::vector<Block> blocks = group_comparison_blocks(compared, table.groups, conditions);
  Json out = {{"design", table.mixed() ? "mixed" : "between"},
              {"n", table.values.values.n},
              {"groups", table.groups},
              {"conditions", table.conditions},
              {"cautions", Json::array()}};
  if (table.mixed() && compared.comparison.anova.unequal) out["cautions"].push_back("unequal_groups");
  blocks[0].id = "descriptives";
  blocks[1].id = "anova";
  blocks[2].id = "pairs";
  print_object(out, blocks, json);
}

OutcomeComparison compared(const LongTable& table) {
  OutcomeComparison outcome;
  outcome.outcome = outcome.title = "value";
  outcome.participants = table.participants;
  outcome.table = table.values;
  outcome.comparison = compare(table.values);
  outcome.within = outcome.comparison.conditions;
  for (std::size_t i = 0; i < table.values.n; ++i) {
    ParticipantValues one{table.participants[i], {}, {}, {}};
    for (std::size_t j = 0; j < table.values.k; ++j) one.values.push_back(table.values.at(i, j));
    outcome.everyone.push_back(one);
  }
  return outcome;
}

int compare_conditions(const GroupOptions& options) {
  const CsvTable csv = CsvTable::read(options.input.file, {"participant", "value"}, {"condition", "group"});
  if (!csv.has("group") && !csv.has("condition"))
    throw InputError(fmt::format(
        "{}: there is no column \"condition\" (name what is compared within participants there, or groups of "
        "participants in a column \"group\")",
        options.input.file));
  say_look_alikes(csv, "participant", options.input.file);
  if (csv.has("group")) {
    print_groups(grouped_table(csv), options.input.json);
    return exit_code::kDone;
  }
  const LongTable table = long_table(csv);
  const std::vector<OutcomeComparison> outcome = {compared(table)};
  std::vector<Block> blocks = comparison_blocks(outcome, table.conditions, {});
  blocks.pop_back();  // the values, which the file has
  Json out = json_row(blocks[1], 0);
  out["conditions"] = table.conditions;
  blocks[0].id = "descriptives";
  if (options.input.json) blocks.erase(blocks.begin() + 1);  // its one row is the object itself
  print_object(out, blocks, options.input.json);
  return exit_code::kDone;
}

struct WilcoxonRow {
  std::string item;  // empty where the file has no items
  SignedRank test;
  PrattSignedRank pratt;
  double p_holm = 0, p_bh = 0;  // over the items; NaN where test.p is
};

Block wilcoxon_block(const std::vector<WilcoxonRow>& rows) {
  using R = WilcoxonRow;
  using F = Field<R>;
  const auto test = [](auto member) { return [member](const R& r) { return r.test.*member; }; };
  const auto pratt = [](auto member) { return [member](const R& r) { return r.pratt.*member; }; };
  const Fields<R> fields = {
      common<R>("item", &R::item),
      F("n", "differences that are not 0", test(&SignedRank::n)),
      F("zeros", "differences of 0, which are left out", test(&SignedRank::zeros)),
      F("ties", "whether differences are equal in size", test(&SignedRank::ties)),
      F("v", "sum of the ranks of differences above 0", test(&SignedRank::v), {.title = "V"}),
      p_field<R>("p", "two-sided, as R computes it", test(&SignedRank::p)),
      F("method", "what p is", [](const R& r) { return method_of(r.test.status, r.test.exact); },
        {.levels = "exact normal"}),
      p_field<R>("p_exact_permutation", "exact permutation p with midranks", test(&SignedRank::p_exact_permutation),
                 "p(exact)"),
      F("rank_biserial", "effect size, -1 to 1", test(&SignedRank::rank_biserial), {.title = "rank-biserial"}),
      p_field<R>("p_holm", "p with Holm's correction over the items", &R::p_holm, "p(Holm)"),
      p_field<R>("p_bh", "p with Benjamini and Hochberg's", &R::p_bh, "p(BH)"),
      p_field<R>("p_normal", "p of the normal approximation", test(&SignedRank::p_normal)),
      F("pratt.z", "z with Pratt's ranks of zeros", pratt(&PrattSignedRank::z)),
      p_field<R>("pratt.p", "its p", pratt(&PrattSignedRank::p)),
      p_field<R>("pratt.p_exact_permutation", "its exact permutation p", pratt(&PrattSignedRank::p_exact_permutation)),
      F("status", "ok, or why there is no test", [](const R& r) { return status_text(r.test.status); })};
  Block block;
  block.id = "items";
  for (const char* key :
       {"item", "n", "zeros", "ties", "v", "p", "method", "p_exact_permutation", "rank_biserial", "p_holm", "p_bh"})
    block.columns.push_back({key});
  const auto tested =
      std::count_if(rows.begin(), rows.end(), [](const R& row) { return row.test.status == StatisticStatus::ok; });
  if (tested > 1) block.footnotes.push_back(fmt::format("Holm and Benjamini-Hochberg over {} items, from p.", tested));
  if (std::any_of(rows.begin(), rows.end(),
                  [](const R& row) { return row.test.status == StatisticStatus::ok && !row.test.exact; }))
    block.footnotes.emplace_back(
        "normal: ties, zeros or 50 and more differences; p(exact) is the permutation p with midranks.");
  if (tested < static_cast<std::ptrdiff_t>(rows.size()))
    block.footnotes.emplace_back(
        "Without a difference there is nothing to test, and the item does not count in the corrections.");
  return std::move(block.with(fields, rows));
}

int wilcoxon(const GroupOptions& options) {
  const CsvTable csv = CsvTable::read(options.input.file, {"x", "y"}, {"item"});
  std::vector<WilcoxonRow> rows;
  std::vector<double> p;
  for (const PairedColumn& item : paired_columns(csv)) {
    rows.push_back({item.item, signed_rank(item.x, item.y), pratt_signed_rank(item.x, item.y)});
    p.push_back(rows.back().test.p);
  }
  const std::vector<double> by_holm = holm(p), by_bh = benjamini_hochberg(p);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].p_holm = by_holm[i];
    rows[i].p_bh = by_bh[i];
  }
  print_rows({wilcoxon_block(rows)}, options.input.json);
  return exit_code::kDone;
}

struct RangeOptions {
  CalcInput input;
  int groups = 0;
  double df = 0;
};

// One column in, one out: q -> p_upper, or p -> q.
int range_table(const RangeOptions& options, const std::string& from, const std::string& to, NumberRange range,
                double (*of)(double, int, double)) {
  const CsvTable csv = CsvTable::read(options.input.file, {from});
  std::vector<double> values;
  for (std::size_t row = 0; row < csv.rows(); ++row) values.push_back(csv.number(row, from, range));
  TextTable table({from, to}, {Align::right, Align::right});
  for (const double value : values) {
    const double result = of(value, options.groups, options.df);
    if (options.input.json) {
      const nlohmann::ordered_json line = {{from, json_number(value)}, {to, json_number(result)}};
      fmt::print("{}\n", json_line(line));
    } else {
      table.add({fmt::format("{:g}", value), fmt::format("{:.8g}", result)});
    }
  }
  if (!options.input.json) fmt::print("{}", table.text());
  return exit_code::kDone;
}

int ptukey(const RangeOptions& options) {
  return range_table(options, "q", "p_upper", {}, studentised_range_upper);
}
int qtukey(const RangeOptions& options) {
  return range_table(options, "p", "q", {0, 1}, studentised_range_quantile);
}

int shapiro(const GroupOptions& options) {
  const CsvTable csv = CsvTable::read(options.input.file, {"x"});
  std::vector<double> values;
  for (std::size_t row = 0; row < csv.rows(); ++row) values.push_back(csv.number(row, "x", kGroupValues));
  const ShapiroWilk test = shapiro_wilk(values);
  if (options.input.json) {
    const nlohmann::ordered_json line = {
        {"n", test.n}, {"w", json_number(test.w)}, {"p", json_number(test.p)}, {"status", to_text(test.status)}};
    fmt::print("{}\n", json_line(line));
    return exit_code::kDone;
  }
  switch (test.status) {
    case StatisticStatus::too_few:
      fmt::print("undefined: {} value{}, and the test needs 3\n", test.n, test.n == 1 ? "" : "s");
      break;
    case StatisticStatus::too_many:
      fmt::print("undefined: {} values, and the test covers at most 5000\n", test.n);
      break;
    case StatisticStatus::no_variance:
      fmt::print("undefined: all {} values are the same\n", test.n);
      break;
    default:
      fmt::print("Shapiro-Wilk: n = {}, W = {:.5f}, p = {}\n", test.n, test.w, p_value_text(test.p));
  }
  return exit_code::kDone;
}

// Before the example in the help of what ranks.
const std::string kDecimals =
    "Values and differences tie where they are equal as the decimals in the file: 5.50 - 5.45 and 5.40 - 5.35 do. R "
    "ranks\n"
    "their binary forms, unless wilcox.test is told digits.rank = 9.\n\n";

void add_range(CommandTree& calc, const std::string& name, const std::string& what, const std::string& column,
               int (*run)(const RangeOptions&)) {
  const auto [command, options] =
      calc.add(name, what, "jnd calc " + name + " " + column + ".csv --groups 3 --df 34 --json", run);
  add_input(command, options.input, column);
  command.add_option("--groups", options.groups, "how many means are compared (2 to 1000)").required().range(2, 1000);
  command.add_option("--df", options.df, "degrees of freedom of the error, at least 1; inf for a known variance")
      .required()
      .check([](const std::string& text) {
        return std::strtod(text.c_str(), nullptr) >= 1 ? "" : "degrees of freedom are at least 1";
      });
}

}  // namespace

void add_calc_group(CommandTree& calc) {
  const auto [compare, compared] =
      calc.add("compare", "Conditions within participants, or groups of participants: ANOVA, assumptions, every pair",
               "jnd calc compare jnds.csv --json", compare_conditions);
  add_input(compare, compared.input,
            "participant, condition, value (a row for every participant and condition), and "
            "optionally group: of participants with one row each, who need no condition, or with all conditions");
  compare.add_notes(kDecimals);

  const auto [ranks, paired] = calc.add("wilcoxon", "Signed-rank tests of paired ratings, corrected over the items",
                                        "jnd calc wilcoxon ratings.csv --json", wilcoxon);
  add_input(ranks, paired.input, "x, y, and item where there are several");
  ranks.add_notes(kDecimals);

  add_range(calc, "ptukey", "Tail probability of the studentised range", "q", ptukey);
  add_range(calc, "qtukey", "Quantile of the studentised range (p is the lower probability)", "p", qtukey);

  const auto [normal, values] =
      calc.add("shapiro", "Shapiro-Wilk test of normality", "jnd calc shapiro values.csv --json", shapiro);
  add_input(normal, values.input, "x");
}

}  // namespace jnd
