// jnd calc compare, wilcoxon, ptukey, qtukey, shapiro: statistics of a group of participants.
#include "runner/calc/calc_group.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/group/p_adjust.h"
#include "analysis/numerics/studentised_range.h"
#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "runner/calc/calc.h"
#include "runner/calc/calc_group_input.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Align = TextTable::Align;

struct GroupOptions {
  CalcInput input;
};

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

namespace {

using Json = nlohmann::ordered_json;

Json shapiro_json(const ShapiroWilk& test) {
  return {{"w", json_number(test.w)}, {"p", json_number(test.p)}, {"status", to_text(test.status)}};
}

Json condition_json(const std::string& name, const ConditionSummary& of) {
  return {{"condition", name},
          {"n", of.n},
          {"mean", json_number(of.mean)},
          {"sd", json_number(of.sd)},
          {"median", json_number(of.median)},
          {"ci_low", json_number(of.ci_low)},
          {"ci_high", json_number(of.ci_high)},
          {"ci_within_low", json_number(of.ci_within_low)},
          {"ci_within_high", json_number(of.ci_within_high)},
          {"shapiro", shapiro_json(of.shapiro)},
          {"status", to_text(of.status)}};
}

Json t_json(const PairComparison& pair) {
  const PairedT& t = pair.t;
  return {{"t", json_number(t.t)},
          {"df", json_number(t.df)},
          {"p", json_number(t.p)},
          {"p_holm", json_number(pair.t_p_holm)},
          {"p_bh", json_number(pair.t_p_bh)},
          {"p_bonferroni", json_number(pair.t_p_bonferroni)},
          {"ci_low", json_number(t.ci_low)},
          {"ci_high", json_number(t.ci_high)},
          {"dz", json_number(t.dz)},
          {"d_av", json_number(t.d_av)},
          {"status", to_text(t.status)}};
}

Json games_howell_json(const PairComparison& pair, int groups) {
  const GamesHowell& test = pair.games_howell;
  const double half_width = games_howell_half_width(test, groups);
  return {{"q", json_number(test.q)},
          {"df", json_number(test.df)},
          {"p", json_number(test.p)},
          {"se", json_number(test.se)},
          {"ci_low", json_number(pair.mean_difference - half_width)},
          {"ci_high", json_number(pair.mean_difference + half_width)},
          {"status", to_text(test.status)}};
}

// How p was had.
Json method_json(const SignedRank& test) {
  if (test.status != StatisticStatus::ok) return nullptr;
  return test.exact ? "exact" : "normal";
}

Json wilcoxon_of_pair(const PairComparison& pair) {
  const SignedRank& test = pair.wilcoxon;
  return {{"v", json_number(test.v)},
          {"p", json_number(test.p)},
          {"p_holm", json_number(pair.wilcoxon_p_holm)},
          {"p_bh", json_number(pair.wilcoxon_p_bh)},
          {"method", method_json(test)},
          {"p_exact_permutation", json_number(test.p_exact_permutation)},
          {"rank_biserial", json_number(test.rank_biserial)},
          {"status", to_text(test.status)}};
}

Json pair_json(const NamedComparison& named, const PairComparison& pair) {
  return {
      {"a", named.conditions[pair.a]},
      {"b", named.conditions[pair.b]},
      {"mean_difference", json_number(pair.mean_difference)},
      {"t", t_json(pair)},
      {"games_howell", games_howell_json(pair, static_cast<int>(named.comparison.k))},
      {"tukey",
       {{"q", json_number(pair.tukey.q)}, {"p", json_number(pair.tukey.p)}, {"status", to_text(pair.tukey.status)}}},
      {"wilcoxon", wilcoxon_of_pair(pair)}};
}

// The test over all conditions, its assumptions and its sizes.
void add_anova(Json& out, const RepeatedMeasures& anova) {
  const WithinEffect& effect = anova.effect;
  out["mauchly"] = {{"w", json_number(effect.mauchly.w)},
                    {"p", json_number(effect.mauchly.p)},
                    {"status", to_text(effect.mauchly.status)}};
  out["epsilons"] = {{"gg", json_number(effect.epsilon_gg)}, {"hf", json_number(effect.epsilon_hf)}};
  out["anova"] = {{"f", json_number(effect.f)},
                  {"df1", json_number(effect.df1)},
                  {"df2", json_number(effect.df2)},
                  {"p", json_number(effect.p)},
                  {"p_gg", json_number(effect.p_gg)},
                  {"p_hf", json_number(effect.p_hf)},
                  {"p_lower_bound", json_number(effect.p_lower_bound)},
                  {"ss", json_number(effect.ss)},
                  {"ss_error", json_number(effect.ss_error)},
                  {"ss_subjects", json_number(anova.ss_subjects)},
                  {"status", to_text(anova.status)}};
  out["effect"] = {{"eta2_generalised", json_number(anova.eta2_generalised)},
                   {"eta2_partial", json_number(effect.eta2_partial)},
                   {"omega2_partial", json_number(anova.omega2_partial)},
                   {"cohen_f", json_number(anova.cohen_f)}};
  out["multivariate"] = {{"t2", json_number(effect.hotelling_t2)},   {"f", json_number(effect.hotelling_f)},
                         {"df1", json_number(effect.hotelling_df1)}, {"df2", json_number(effect.hotelling_df2)},
                         {"p", json_number(effect.hotelling_p)},     {"status", to_text(effect.hotelling_status)}};
}

}  // namespace

Json comparison_json(const NamedComparison& named) {
  const Comparison& comparison = named.comparison;
  Json out = {{"n", comparison.n}, {"conditions", named.conditions}, {"status", to_text(comparison.status)}};
  out["descriptives"] = Json::array();
  for (std::size_t j = 0; j < comparison.conditions.size(); ++j)
    out["descriptives"].push_back(condition_json(named.conditions[j], comparison.conditions[j]));
  out["residuals"] = {{"shapiro", shapiro_json(comparison.residuals)}};
  add_anova(out, comparison.anova);
  const Friedman& friedman = comparison.friedman;
  out["friedman"] = {{"chi2", json_number(friedman.chi2)},
                     {"df", friedman.df},
                     {"p", json_number(friedman.p)},
                     {"kendall_w", json_number(friedman.kendall_w)},
                     {"f_iman_davenport", json_number(friedman.f_iman_davenport)},
                     {"p_iman_davenport", json_number(friedman.p_iman_davenport)},
                     {"status", to_text(friedman.status)}};
  out["pairs"] = Json::array();
  for (const PairComparison& pair : comparison.pairs) out["pairs"].push_back(pair_json(named, pair));
  return out;
}

Json wilcoxon_json(const WilcoxonRow& row) {
  const SignedRank& test = row.test;
  Json out;
  out["item"] = row.item.empty() ? Json(nullptr) : Json(row.item);
  out["n"] = test.n;
  out["zeros"] = test.zeros;
  out["ties"] = test.ties;
  out["v"] = json_number(test.v);
  out["p"] = json_number(test.p);
  out["method"] = method_json(test);
  out["p_exact_permutation"] = json_number(test.p_exact_permutation);
  out["rank_biserial"] = json_number(test.rank_biserial);
  out["p_holm"] = json_number(row.p_holm);
  out["p_bh"] = json_number(row.p_bh);
  out["p_normal"] = json_number(test.p_normal);
  out["pratt"] = {{"z", json_number(row.pratt.z)},
                  {"p", json_number(row.pratt.p)},
                  {"p_exact_permutation", json_number(row.pratt.p_exact_permutation)}};
  out["status"] = to_text(test.status);
  return out;
}

namespace {

using Align = TextTable::Align;

std::string interval_text(double low, double high) {
  return range_text(statistic_text(low), statistic_text(high));
}

std::string conditions_text(const NamedComparison& named) {
  TextTable table({"condition", "n", "mean", "SD", "median", "95 % CI", "within-subject CI", "Shapiro W", "p"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right});
  for (std::size_t j = 0; j < named.conditions.size(); ++j) {
    const ConditionSummary& of = named.comparison.conditions[j];
    table.add({printable(named.conditions[j]), std::to_string(of.n), statistic_text(of.mean), statistic_text(of.sd),
               statistic_text(of.median), interval_text(of.ci_low, of.ci_high),
               interval_text(of.ci_within_low, of.ci_within_high), statistic_text(of.shapiro.w),
               p_value_text(of.shapiro.p)});
  }
  return table.text();
}

std::string df_text(double df1, double df2) {
  return std::isnan(df2) ? "-" : fmt::format("{}, {}", statistic_text(df1), statistic_text(df2));
}

std::string overall_text(const Comparison& comparison) {
  const RepeatedMeasures& anova = comparison.anova;
  const WithinEffect& effect = anova.effect;
  TextTable table({"all conditions", "statistic", "df", "p"}, {Align::left, Align::left, Align::right, Align::right});
  const auto corrected = [&](const char* name, double epsilon, double p) {
    const double used = std::min(1.0, epsilon);
    table.add({name, std::isnan(epsilon) ? "-" : "epsilon = " + statistic_text(epsilon),
               std::isnan(epsilon) ? "-" : df_text(used * effect.df1, used * effect.df2), p_value_text(p)});
  };
  table.add({"repeated-measures ANOVA", "F = " + statistic_text(effect.f), df_text(effect.df1, effect.df2),
             p_value_text(effect.p)});
  corrected("  Greenhouse-Geisser", effect.epsilon_gg, effect.p_gg);
  corrected("  Huynh-Feldt", effect.epsilon_hf, effect.p_hf);
  table.add({"  sphericity (Mauchly)", "W = " + statistic_text(effect.mauchly.w), "", p_value_text(effect.mauchly.p)});
  table.add({"  normal residuals (Shapiro-Wilk)", "W = " + statistic_text(comparison.residuals.w), "",
             p_value_text(comparison.residuals.p)});
  table.add({"Hotelling's T2 (needs no sphericity)", "F = " + statistic_text(effect.hotelling_f),
             df_text(effect.hotelling_df1, effect.hotelling_df2), p_value_text(effect.hotelling_p)});
  table.add({"Friedman", "chi2 = " + statistic_text(comparison.friedman.chi2), std::to_string(comparison.friedman.df),
             p_value_text(comparison.friedman.p)});
  return table.text() + fmt::format("  eta squared: generalised {}, partial {}; Kendall's W {}\n",
                                    statistic_text(anova.eta2_generalised), statistic_text(effect.eta2_partial),
                                    statistic_text(comparison.friedman.kendall_w));
}

std::string pair_name(const NamedComparison& named, const PairComparison& pair) {
  return printable(named.conditions[pair.a]) + " - " + printable(named.conditions[pair.b]);
}

std::string paired_text(const NamedComparison& named) {
  TextTable table({"pair", "difference", "95 % CI", "t", "df", "p", "p Holm", "dz", "Wilcoxon V", "p", "p Holm"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right, Align::right, Align::right});
  for (const PairComparison& pair : named.comparison.pairs)
    table.add({pair_name(named, pair), statistic_text(pair.mean_difference),
               interval_text(pair.t.ci_low, pair.t.ci_high), statistic_text(pair.t.t), statistic_text(pair.t.df),
               p_value_text(pair.t.p), p_value_text(pair.t_p_holm), statistic_text(pair.t.dz),
               statistic_text(pair.wilcoxon.v), p_value_text(pair.wilcoxon.p), p_value_text(pair.wilcoxon_p_holm)});
  return table.text();
}

std::string unpaired_text(const NamedComparison& named) {
  TextTable table({"pair", "Games-Howell q", "df", "p", "Tukey q", "p"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right});
  for (const PairComparison& pair : named.comparison.pairs)
    table.add({pair_name(named, pair), statistic_text(pair.games_howell.q), statistic_text(pair.games_howell.df),
               p_value_text(pair.games_howell.p), statistic_text(pair.tukey.q), p_value_text(pair.tukey.p)});
  return table.text();
}

std::string cautions_text(const Comparison& comparison) {
  std::string text;
  const RepeatedMeasures& anova = comparison.anova;
  if (anova.status == StatisticStatus::too_few)
    text += warn("One participant: nothing can be tested.") + "\n";
  else if (anova.status == StatisticStatus::no_variance)
    text += warn("The participants differ alike in every condition: F, Tukey and the epsilons are undefined.") + "\n";
  switch (anova.effect.mauchly.status) {
    case StatisticStatus::not_applicable:
      text += "Two conditions: the question of sphericity does not arise.\n";
      break;
    case StatisticStatus::singular:
      text += "The covariance is singular (a condition follows from the others): no Mauchly and no Hotelling test.\n";
      break;
    case StatisticStatus::too_few:
      if (anova.status == StatisticStatus::ok)
        text += "Fewer participants than conditions: no Mauchly and no Hotelling test.\n";
      break;
    default:
      break;
  }
  for (const PairComparison& pair : comparison.pairs) {
    if (pair.t.status != StatisticStatus::no_variance) continue;
    text += "A pair of which all differences are equal has no t test.\n";
    break;
  }
  return text;
}

}  // namespace

std::string statistic_text(double value) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const double size = std::abs(value);
  return size >= 1000 && size < 1e7 ? fmt::format("{:.1f}", value) : fmt::format("{:.4g}", value);
}

std::string comparison_text(const NamedComparison& named) {
  const Comparison& comparison = named.comparison;
  std::string text =
      bold(fmt::format("{} participant{}, {} conditions", comparison.n, comparison.n == 1 ? "" : "s", comparison.k)) +
      "\n\n";
  text += conditions_text(named) + "\n" + overall_text(comparison) + "\n";
  text += paired_text(named) + "\n" + unpaired_text(named);
  text += dim("  Games-Howell takes the conditions for separate groups, Tukey pools the error of all pairs: both "
              "ignore the "
              "pairing. Prefer the paired tests.") +
          "\n";
  const std::string cautions = cautions_text(comparison);
  if (!cautions.empty()) text += "\n" + cautions;
  return text;
}

std::string wilcoxon_text(const std::vector<WilcoxonRow>& rows) {
  TextTable table({"item", "n", "zeros", "ties", "V", "p", "method", "p exact", "rank-biserial", "p Holm", "p BH"},
                  {Align::left, Align::right, Align::right, Align::left, Align::right, Align::right, Align::left,
                   Align::right, Align::right, Align::right, Align::right});
  bool approximate = false;
  std::size_t tested = 0;
  for (const WilcoxonRow& row : rows) {
    const SignedRank& test = row.test;
    approximate = approximate || (test.status == StatisticStatus::ok && !test.exact);
    tested += test.status == StatisticStatus::ok ? 1 : 0;
    table.add({row.item.empty() ? "-" : printable(row.item), std::to_string(test.n), std::to_string(test.zeros),
               test.ties ? "yes" : "no", statistic_text(test.v), p_value_text(test.p),
               test.status != StatisticStatus::ok ? "-"
               : test.exact                       ? "exact"
                                                  : "normal",
               p_value_text(test.p_exact_permutation), statistic_text(test.rank_biserial), p_value_text(row.p_holm),
               p_value_text(row.p_bh)});
  }
  std::string text = table.text();
  if (tested > 1) text += dim(fmt::format("  Holm and Benjamini-Hochberg over {} items, from p.", tested)) + "\n";
  if (approximate)
    text += dim("  normal: ties, zeros or 50 and more differences; p exact is the permutation p with midranks.") + "\n";
  if (tested < rows.size())
    text += "Without a difference there is nothing to test, and the item does not count in the corrections.\n";
  return text;
}

}  // namespace jnd
