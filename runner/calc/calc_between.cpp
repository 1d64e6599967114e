// jnd calc compare with the column group: participants in groups, with one value each or with every condition.
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/group/compare_groups.h"
#include "runner/calc/calc_group.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;
using Align = TextTable::Align;

// ---- JSON

void name_condition(Json& out, const GroupedLongTable& table, std::size_t condition) {
  if (table.mixed()) out["condition"] = table.conditions[condition];
}

Json group_cell_json(const GroupedLongTable& table, const GroupCell& cell) {
  Json out = {{"group", table.groups[cell.group]}};
  name_condition(out, table, cell.condition);
  out["n"] = cell.mean.n;
  out["mean"] = json_number(cell.mean.mean);
  out["sd"] = json_number(cell.mean.sd);
  out["median"] = json_number(cell.median);
  out["ci_low"] = json_number(cell.mean.ci_low);
  out["ci_high"] = json_number(cell.mean.ci_high);
  out["shapiro"] = {
      {"w", json_number(cell.shapiro.w)}, {"p", json_number(cell.shapiro.p)}, {"status", to_text(cell.shapiro.status)}};
  out["status"] = to_text(cell.mean.status);
  return out;
}

Json effect_json(const MixedEffect& effect, bool within) {
  Json out = {{"f", json_number(effect.f)},
              {"df1", effect.df1},
              {"df2", effect.df2},
              {"p", json_number(effect.p)},
              {"ss", json_number(effect.ss)},
              {"ss_error", json_number(effect.ss_error)}};
  if (within) {
    out["p_gg"] = json_number(effect.p_gg);
    out["p_hf"] = json_number(effect.p_hf);
  }
  out["eta2_partial"] = json_number(effect.eta2_partial);
  out["eta2_generalised"] = json_number(effect.eta2_generalised);
  out["status"] = to_text(effect.status);
  return out;
}

Json group_pair_json(const GroupedLongTable& table, const GroupPair& pair) {
  const WelchT& welch = pair.welch;
  const MannWhitney& ranks = pair.ranks;
  Json out = {{"a", table.groups[pair.a]}, {"b", table.groups[pair.b]}};
  name_condition(out, table, pair.condition);
  out["mean_difference"] = json_number(welch.mean_difference);
  out["welch"] = {{"t", json_number(welch.t)},           {"df", json_number(welch.df)},
                  {"p", json_number(welch.p)},           {"p_holm", json_number(pair.welch_p_holm)},
                  {"ci_low", json_number(welch.ci_low)}, {"ci_high", json_number(welch.ci_high)},
                  {"d", json_number(welch.d)},           {"status", to_text(welch.status)}};
  out["mann_whitney"] = {
      {"w", json_number(ranks.w)},
      {"p", json_number(ranks.p)},
      {"p_holm", json_number(pair.ranks_p_holm)},
      {"method", ranks.status == StatisticStatus::ok ? Json(ranks.exact ? "exact" : "normal") : Json()},
      {"ties", ranks.ties},
      {"rank_biserial", json_number(ranks.rank_biserial)},
      {"status", to_text(ranks.status)}};
  return out;
}

}  // namespace

nlohmann::ordered_json groups_json(const GroupedLongTable& table, const GroupComparison& found) {
  const MixedAnova& anova = found.anova;
  Json out = {{"design", table.mixed() ? "mixed" : "between"},
              {"n", table.values.values.n},
              {"groups", table.groups},
              {"conditions", table.conditions},
              {"status", to_text(anova.status)},
              {"descriptives", Json::array()}};
  for (const GroupCell& cell : found.cells) out["descriptives"].push_back(group_cell_json(table, cell));
  out["anova"] = {{"group", effect_json(anova.group, false)}};
  if (table.mixed()) {
    out["anova"]["condition"] = effect_json(anova.condition, true);
    out["anova"]["interaction"] = effect_json(anova.interaction, true);
    out["epsilons"] = {{"gg", json_number(anova.epsilon_gg)}, {"hf", json_number(anova.epsilon_hf)}};
  }
  out["pairs"] = Json::array();
  for (const GroupPair& pair : found.pairs) out["pairs"].push_back(group_pair_json(table, pair));
  out["cautions"] = Json::array();
  if (table.mixed() && anova.unequal) out["cautions"].push_back("unequal_groups");
  return out;
}

namespace {

// ---- text

std::string cells_text(const GroupedLongTable& table, const GroupComparison& found) {
  TextTable text({"group", "condition", "n", "mean", "SD", "median", "95 % CI", "Shapiro W", "p"},
                 {Align::left, Align::left, Align::right, Align::right, Align::right, Align::right, Align::right,
                  Align::right, Align::right});
  for (const GroupCell& cell : found.cells)
    text.add({printable(table.groups[cell.group]), table.mixed() ? printable(table.conditions[cell.condition]) : "",
              std::to_string(cell.mean.n), statistic_text(cell.mean.mean), statistic_text(cell.mean.sd),
              statistic_text(cell.median),
              range_text(statistic_text(cell.mean.ci_low), statistic_text(cell.mean.ci_high)),
              statistic_text(cell.shapiro.w), p_value_text(cell.shapiro.p)});
  return text.text();
}

std::string effects_text(const GroupedLongTable& table, const MixedAnova& anova) {
  TextTable text(
      {"effect", "F", "df", "p", "p Greenhouse-Geisser", "p Huynh-Feldt", "eta2 partial", "generalised"},
      {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right});
  const auto add = [&](const char* name, const MixedEffect& effect) {
    text.add({name, statistic_text(effect.f), fmt::format("{:g}, {:g}", effect.df1, effect.df2), p_value_text(effect.p),
              p_value_text(effect.p_gg), p_value_text(effect.p_hf), statistic_text(effect.eta2_partial),
              statistic_text(effect.eta2_generalised)});
  };
  add("group", anova.group);
  if (table.mixed()) {
    add("condition", anova.condition);
    add("group x condition", anova.interaction);
  }
  return text.text();
}

std::string group_pairs_text(const GroupedLongTable& table, const GroupComparison& found) {
  TextTable text(
      {"pair", "condition", "difference", "95 % CI", "Welch t", "df", "p", "p Holm", "Mann-Whitney W", "p", "p Holm"},
      {Align::left, Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
       Align::right, Align::right, Align::right});
  for (const GroupPair& pair : found.pairs)
    text.add({printable(table.groups[pair.a]) + " - " + printable(table.groups[pair.b]),
              table.mixed() ? printable(table.conditions[pair.condition]) : "",
              statistic_text(pair.welch.mean_difference),
              range_text(statistic_text(pair.welch.ci_low), statistic_text(pair.welch.ci_high)),
              statistic_text(pair.welch.t), statistic_text(pair.welch.df), p_value_text(pair.welch.p),
              p_value_text(pair.welch_p_holm), statistic_text(pair.ranks.w), p_value_text(pair.ranks.p),
              p_value_text(pair.ranks_p_holm)});
  return text.text();
}

std::string groups_text(const GroupedLongTable& table, const GroupComparison& found) {
  std::string text =
      fmt::format("{} in {}, {}\n", counted(static_cast<std::int64_t>(table.values.values.n), "participant"),
                  counted(static_cast<std::int64_t>(table.groups.size()), "group"),
                  table.mixed() ? counted(static_cast<std::int64_t>(table.conditions.size()), "condition") + " each"
                                : "one value each");
  text += cells_text(table, found) + effects_text(table, found.anova) + group_pairs_text(table, found);
  if (table.mixed() && found.anova.unequal)
    text += warn(
                "The groups differ in size: sums of squares are of type I (group, condition, group x condition), as "
                "R's aov.") +
            "\n";
  for (const MixedEffect* effect : {&found.anova.group, &found.anova.condition, &found.anova.interaction})
    if (effect->status == StatisticStatus::no_variance) {
      text += warn("An effect has no error beyond rounding: its F is undefined.") + "\n";
      break;
    }
  if (found.anova.group.status == StatisticStatus::too_few)
    text += warn("Every group has one participant: nothing can be tested.") + "\n";
  return text;
}

}  // namespace

void print_groups(const GroupedLongTable& table, bool json) {
  const GroupComparison found = compare_groups(table.values);
  if (json)
    fmt::print("{}\n", json_line(groups_json(table, found)));
  else
    fmt::print("{}", groups_text(table, found));
}

}  // namespace jnd
