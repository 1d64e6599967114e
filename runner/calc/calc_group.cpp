// jnd calc compare, wilcoxon, ptukey, qtukey, shapiro: statistics of a group of participants.
#include "runner/calc/calc_group.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "analysis/group/p_adjust.h"
#include "analysis/numerics/studentised_range.h"
#include "runner/calc/calc.h"
#include "runner/calc/calc_group_input.h"
#include "runner/commands/commands.h"
#include "protocols/input/csv_table.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Align = TextTable::Align;

struct GroupOptions {
  CalcInput input;
};

int compare_conditions(const GroupOptions& options) {
  const CsvTable csv = CsvTable::read(options.input.file, {"participant", "condition", "value"});
  LongTable table = long_table(csv);
  const NamedComparison named{std::move(table.conditions), compare(table.values)};
  if (options.input.json)
    fmt::print("{}\n", json_line(comparison_json(named)));
  else
    fmt::print("{}", comparison_text(named));
  return exit_code::kDone;
}

int wilcoxon(const GroupOptions& options) {
  const CsvTable csv = CsvTable::read(options.input.file, {"x", "y"}, {"item"});
  std::vector<WilcoxonRow> rows;
  std::vector<double> p;
  for (const PairedColumn& item : paired_columns(csv)) {
    WilcoxonRow row;
    row.item = item.item;
    row.test = signed_rank(item.x, item.y);
    row.pratt = pratt_signed_rank(item.x, item.y);
    p.push_back(row.test.p);
    rows.push_back(row);
  }
  const std::vector<double> by_holm = holm(p), by_bh = benjamini_hochberg(p);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].p_holm = by_holm[i];
    rows[i].p_bh = by_bh[i];
    if (options.input.json) fmt::print("{}\n", json_line(wilcoxon_json(rows[i])));
  }
  if (!options.input.json) fmt::print("{}", wilcoxon_text(rows));
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
    case TestStatus::too_few:
      fmt::print("undefined: {} value{}, and the test needs 3\n", test.n, test.n == 1 ? "" : "s");
      break;
    case TestStatus::too_many:
      fmt::print("undefined: {} values, and the test covers at most 5000\n", test.n);
      break;
    case TestStatus::no_variance:
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

CLI::App* add_range(CalcTree& tree, const std::string& name, const std::string& what, const std::string& column,
                    int (*run)(const RangeOptions&)) {
  const auto options = std::make_shared<RangeOptions>();
  CLI::App* command = tree.add(name, what, name + " " + column + ".csv --groups 3 --df 34 --json", options, run);
  CalcTree::add_input(*command, options->input, column);
  command->add_option("--groups", options->groups, "how many means are compared (2 to 1000)")
      ->required()
      ->check(CLI::Range(2, 1000));
  command->add_option("--df", options->df, "degrees of freedom of the error, at least 1; inf for a known variance")
      ->required()
      ->check([](const std::string& text) {
        double df = 0;
        return CLI::detail::lexical_cast(text, df) && df >= 1 ? std::string() : "degrees of freedom are at least 1";
      });
  return command;
}

}  // namespace

void add_calc_group(CalcTree& tree) {
  const auto compared = std::make_shared<GroupOptions>();
  CLI::App* compare = tree.add("compare", "Conditions within participants: ANOVA, assumptions, every pair",
                               "compare jnds.csv --json", compared, compare_conditions);
  CalcTree::add_input(*compare, compared->input,
                      "participant, condition, value (a row for every participant and condition)");
  compare->footer(kDecimals + compare->get_footer());

  const auto paired = std::make_shared<GroupOptions>();
  CLI::App* ranks = tree.add("wilcoxon", "Signed-rank tests of paired ratings, corrected over the items",
                             "wilcoxon ratings.csv --json", paired, wilcoxon);
  CalcTree::add_input(*ranks, paired->input, "x, y, and item where there are several");
  ranks->footer(kDecimals + ranks->get_footer());

  add_range(tree, "ptukey", "Tail probability of the studentised range", "q", ptukey);
  add_range(tree, "qtukey", "Quantile of the studentised range (p is the lower probability)", "p", qtukey);

  const auto normality = std::make_shared<GroupOptions>();
  CLI::App* normal =
      tree.add("shapiro", "Shapiro-Wilk test of normality", "shapiro values.csv --json", normality, shapiro);
  CalcTree::add_input(*normal, normality->input, "x");
}

}  // namespace jnd
