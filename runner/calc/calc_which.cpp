// jnd calc which: PSE, JND and order bias of choices between two intervals ("which is stiffer?").
#include "runner/calc/calc_which.h"

#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "runner/calc/calc.h"
#include "runner/calc/trials_input.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

struct WhichOptions {
  CalcInput input;
  TrialOptions trials;
  std::string lapse = "0", link = "probit";
  bool pse_is_standard = false;
};

TwoIntervalOptions which_model(const WhichOptions& options) {
  TwoIntervalOptions model;
  model.link = *value_of(kChoiceLinkWords, options.link);
  model.lapse.reset();
  if (options.lapse == "free") return model;
  model.lapse = number_in_option(options.lapse);
  if (!model.lapse || !(*model.lapse >= 0 && *model.lapse < 1))
    throw UsageError(fmt::format("--lapse: {} is neither a rate from 0 to below 1 nor free", options.lapse));
  return model;
}

// The rows of one group.
struct ChoiceGroup {
  TwoIntervalAnswer answer;
  std::vector<ChoiceRow> rows;
};

ChoiceRow choice_row(const CsvTable& table, std::size_t row) {
  ChoiceRow out;
  out.level = table.number(row, "x");
  out.n = table.integer(row, "n", 0);
  out.chosen = table.integer(row, "k", 0);
  if (out.chosen > out.n)
    table.fail(row, "k", fmt::format("{} choices in {} trials", out.chosen, out.n), "k is at most n");
  if (!table.has("order")) return out;
  out.order = table.integer(row, "order", -1, 1);
  if (out.order == 0)
    table.fail(row, "order", "0 is no order", "write 1 where the comparison came second, -1 where it came first");
  return out;
}

std::vector<ChoiceGroup> counted_groups(const WhichOptions& options, const TwoIntervalOptions& model) {
  refuse_trial_options(options.trials, kWhichUse);
  const std::optional<double> standard = number_in_option(options.trials.standard);
  if (!standard)
    throw UsageError(
        options.trials.standard.empty()
            ? std::string("--standard is needed: what the levels were judged against, in their unit")
            : fmt::format("--standard: {} is not a number (a column goes with --trials)", options.trials.standard));
  const CsvTable table = CsvTable::read(options.input.file, {"x", "n", "k"}, {"group", "order"});
  std::vector<ChoiceGroup> groups;
  std::map<std::optional<std::string>, std::size_t> places;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const ChoiceRow counts = choice_row(table, row);
    std::optional<std::string> name;
    if (table.has("group")) name = table.text(row, "group");
    const auto [place, added] = places.try_emplace(name, groups.size());
    if (added) {
      groups.emplace_back();
      groups.back().answer.group = name;
      groups.back().answer.standard = *standard;
      groups.back().answer.options = model;
      groups.back().answer.options.order_term = table.has("order");
    }
    groups[place->second].rows.push_back(counts);
  }
  return groups;
}

std::vector<ChoiceGroup> trial_groups(const WhichOptions& options, const TwoIntervalOptions& model) {
  if (options.trials.standard.empty() && !names_nothing(options.trials))
    throw UsageError("--standard is needed: what the levels were judged against, a number or a column");
  const TrialTable table = read_trials(options.input.file, options.trials, kWhichUse);
  const bool with_order =
      std::any_of(table.trials.begin(), table.trials.end(), [](const CsvTrial& trial) { return trial.order != 0; });
  std::vector<ChoiceGroup> groups;
  for (const TrialUnit& unit : table.units) {
    ChoiceGroup& group = groups.emplace_back();
    group.answer.group = unit.name();
    group.answer.participant = unit.participant;
    group.answer.condition = unit.condition;
    group.answer.standard = *unit.standard;
    group.answer.options = model;
    group.answer.options.order_term = with_order;
  }
  std::map<std::tuple<std::size_t, double, int>, std::pair<long long, long long>> counts;
  for (const CsvTrial& trial : table.trials) {
    auto& [n, k] = counts[{trial.unit, trial.level, trial.order}];
    ++n;
    if (trial.positive) ++k;
  }
  for (const auto& [place, nk] : counts) {
    const auto& [unit, level, order] = place;
    groups[unit].rows.push_back({level, nk.first, nk.second, order});
  }
  return groups;
}

TwoIntervalAnswer answer_of(const ChoiceGroup& group, bool pse_is_standard) {
  TwoIntervalAnswer answer = group.answer;
  if (pse_is_standard) answer.options.pse = answer.standard;
  answer.fit = fit_two_interval(group.rows, answer.options);
  answer.intervals = two_interval_intervals(group.rows, answer.options);
  if (pse_is_standard) answer.intervals.pse.reset();
  answer.constants = log_binomial_constants(group.rows);
  std::vector<AnsweredLevel> levels;
  for (const ChoiceRow& row : group.rows) levels.push_back({row.level, row.n, row.chosen});
  answer.falling = say_falling(levels, answer.group.value_or(""));
  if (answer.options.order_term) answer.order = test_order_term(group.rows, answer.options, answer.fit);
  return answer;
}

int which(const WhichOptions& options) {
  const TwoIntervalOptions model = which_model(options);
  // The whole file is read before anything is printed: a mistake in the last row leaves no half an answer.
  const std::vector<ChoiceGroup> groups =
      options.trials.trials ? trial_groups(options, model) : counted_groups(options, model);
  std::vector<TwoIntervalAnswer> answers;
  for (const ChoiceGroup& group : groups) {
    answers.push_back(answer_of(group, options.pse_is_standard));
    if (options.input.json) fmt::print("{}\n", json_line(two_interval_json(answers.back())));
  }
  if (!options.input.json) fmt::print("{}", two_interval_text(answers));
  return exit_code::kDone;
}

}  // namespace

void add_calc_which(CommandTree& calc) {
  const auto [command, options] =
      calc.add("which", "\"Which is stiffer?\": PSE and JND of choices between a standard and a comparison",
               "jnd calc which choices.csv --standard 900 --lapse 0.02", which);
  add_input(command, options.input,
            "x, n, k (times the comparison was chosen), and where there are such: group, order (1: the comparison came "
            "second, -1: first)");
  command
      .add_option("--lapse", options.lapse,
                  "share of trials answered by chance: a number such as 0.02, or free (0 to 0.1)")
      .show_default();
  command.add_option("--link", options.link, "probit (normal distribution) or logit (logistic)")
      .one_of({"probit", "logit"})
      .show_default();
  command.add_flag(
      "--pse-is-standard", options.pse_is_standard,
      "the PSE is not estimated: for levels on one side of the standard, which do not tell it from the JND");
  add_trial_options(command, options.trials, kWhichUse);
}

// `jnd calc which --json`.

namespace {

using nlohmann::ordered_json;

ordered_json known(const std::optional<double>& value) {
  return json_number(value.value_or(kNaN));
}

ordered_json bounds_of(const std::optional<ChoiceBounds>& bounds, double factor = 1) {
  if (!bounds) return nullptr;
  return ordered_json::array({json_number(factor * bounds->low), json_number(factor * bounds->high)});
}

void add_jnd(ordered_json& out, const TwoIntervalAnswer& answer, const std::string& name, double factor) {
  const double jnd = factor * answer.fit.s.value_or(kNaN);
  out["jnd_" + name] = json_number(jnd);
  out["weber_" + name] = json_number(answer.standard > 0 ? jnd / answer.standard : kNaN);
}

}  // namespace

ordered_json two_interval_json(const TwoIntervalAnswer& answer) {
  const TwoIntervalFit& fit = answer.fit;
  ordered_json out;
  out["group"] = answer.group ? ordered_json(*answer.group) : ordered_json(nullptr);
  if (answer.participant) out["participant"] = *answer.participant;
  if (answer.condition) out["condition"] = *answer.condition;
  out["standard"] = answer.standard;
  out["link"] = word_of(kChoiceLinkWords, answer.options.link);
  out["status"] = word_of(kTwoIntervalStatusWords, fit.status);
  out["falling"] = answer.falling;
  out["trials"] = fit.trials;
  out["loglik"] = known(fit.log_likelihood);
  out["deviance"] = known(fit.deviance);
  out["loglik_with_binomial_constants"] = json_number(fit.log_likelihood.value_or(kNaN) + answer.constants);
  if (fit.pse_range) out["pse_range"] = bounds_of(fit.pse_range);
  out["pse"] = known(fit.pse);
  out["s"] = known(fit.s);
  if (answer.options.order_term) out["order_b"] = known(fit.order_b);
  out["lapse"] = known(fit.lapse);
  const ChoiceJnds unit = choice_jnds(answer.options.link, 1);
  const std::pair<const char*, double> jnds[] = {
      {"75", unit.jnd_75}, {"84", unit.jnd_84}, {"dprime1", unit.jnd_dprime1}};
  for (const auto& [name, factor] : jnds) add_jnd(out, answer, name, factor);
  out["pse_ci"] = bounds_of(answer.intervals.pse);
  out["s_ci"] = bounds_of(answer.intervals.s);
  for (const auto& [name, factor] : jnds) out[fmt::format("jnd_{}_ci", name)] = bounds_of(answer.intervals.s, factor);
  if (!answer.order) return out;
  out["loglik_without_order"] = json_number(answer.order->log_likelihood_without);
  out["order_lr"] = json_number(answer.order->lr);
  out["order_p"] = json_number(answer.order->p);
  out["order_b_ci"] = bounds_of(answer.intervals.order_b);
  return out;
}

// `jnd calc which` for a person.

namespace {

std::string which_text(double value) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return fmt::format("{:.5g}", value);
}

std::string which_text(const std::optional<ChoiceBounds>& bounds, double factor = 1) {
  if (!bounds) return "-";
  return range_text(which_text(factor * bounds->low), which_text(factor * bounds->high));
}

std::string which_text(const std::optional<double>& value) {
  return which_text(value.value_or(kNaN));
}

// What each status means, once for all rows that have it.
std::string which_meanings(const std::vector<TwoIntervalAnswer>& answers) {
  static constexpr std::pair<TwoIntervalStatus, const char*> kMeanings[] = {
      {TwoIntervalStatus::separated, "a step fits best: the JND is below what these levels can show, the PSE a range"},
      {TwoIntervalStatus::not_identified, "one level only: neither PSE nor JND; add levels"},
      {TwoIntervalStatus::flat, "no slope above 0 fits better than one rate for all levels: there is no PSE"},
      {TwoIntervalStatus::all_same, "one and the same answer throughout: neither PSE nor JND"},
      {TwoIntervalStatus::missing, "no trials"}};
  std::string text;
  for (const auto& [status, meaning] : kMeanings)
    for (const TwoIntervalAnswer& answer : answers)
      if (answer.fit.status == status) {
        text += warn(fmt::format("{}: {}.", word_of(kTwoIntervalStatusWords, status), meaning)) + "\n";
        break;
      }
  return text;
}

std::string order_text(const std::vector<TwoIntervalAnswer>& answers) {
  using Align = TextTable::Align;
  TextTable table({"group", "order b", "95 % profile", "chi-square", "p"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right});
  bool any = false;
  for (const TwoIntervalAnswer& answer : answers) {
    if (!answer.order) continue;
    any = true;
    table.add({printable(answer.group.value_or("all")), which_text(answer.fit.order_b),
               which_text(answer.intervals.order_b), which_text(answer.order->lr), p_value_text(answer.order->p)});
  }
  if (!any) return "";
  return "\n" + table.text() +
         dim("b: in units of s, above 0 where the second interval is favoured; likelihood-ratio test of b = 0.") + "\n";
}

}  // namespace

std::string two_interval_text(const std::vector<TwoIntervalAnswer>& answers) {
  if (answers.empty()) return "";
  using Align = TextTable::Align;
  const TwoIntervalOptions& model = answers.front().options;
  TextTable table({"group", "PSE", "95 % profile", "JND 75 %", "95 % profile", "Weber", "JND 84 %", "JND d' = 1",
                   "lapse", "deviance", "trials", "status"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right, Align::right, Align::right, Align::left});
  const double factor = choice_jnds(model.link, 1).jnd_75;
  for (const TwoIntervalAnswer& answer : answers) {
    const TwoIntervalFit& fit = answer.fit;
    const ChoiceJnds jnds = choice_jnds(model.link, fit.s.value_or(kNaN));
    table.add({printable(answer.group.value_or("all")), which_text(fit.pse), which_text(answer.intervals.pse),
               which_text(jnds.jnd_75), which_text(answer.intervals.s, factor),
               percent_text(answer.standard > 0 ? jnds.jnd_75 / answer.standard : kNaN), which_text(jnds.jnd_84),
               which_text(jnds.jnd_dprime1), which_text(fit.lapse), which_text(fit.deviance),
               std::to_string(fit.trials), std::string(word_of(kTwoIntervalStatusWords, fit.status))});
  }
  const std::string lapse = model.lapse ? fmt::format("lapse {:g}", *model.lapse)
                                        : fmt::format("lapse free (0 to {:g})", kLargestChoiceLapse);
  std::string text = bold(fmt::format("choices between two intervals, {}, {}{}", word_of(kChoiceLinkWords, model.link),
                                      lapse, model.pse ? ", the PSE at the standard" : "")) +
                     "\n";
  text += table.text();
  text +=
      dim(model.link == ChoiceLink::probit
              ? "JND, from the PSE to where the comparison is chosen in 75 % (0.6745 s), 84 % (s) and 76 % (d' = 1,\n"
                "s/sqrt 2) of the trials, without the lapses. Weber: JND 75 % / standard."
              : "JND, from the PSE to where the comparison is chosen in 75 % (1.0986 s), 84 % (1.6683 s) and 76 % (d' = "
                "1,\n1.1541 s) of the trials, without the lapses. Weber: JND 75 % / standard.") +
      "\n";
  return text + order_text(answers) + which_meanings(answers);
}

}  // namespace jnd
