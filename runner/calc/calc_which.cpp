// jnd calc which: PSE, JND and order bias of choices between two intervals ("which is stiffer?").
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/choice/two_interval.h"
#include "data/blocks/common_fields.h"
#include "data/blocks/part_fields.h"
#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "runner/calc/calc.h"
#include "runner/calc/calc_output.h"
#include "runner/calc/interval_fields.h"
#include "runner/calc/trials_input.h"
#include "runner/results/block_output.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"

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

struct ChoiceGroup {
  std::optional<std::string> name, participant, condition;
  double standard = 0;  // in the unit of the levels; without a Weber fraction where it is not above 0
  TwoIntervalOptions options;
  std::vector<ChoiceRow> rows;
};

// What the choices of a group say.
struct ChoiceAnswer {
  ChoiceGroup of;
  TwoIntervalFit fit;
  TwoIntervalIntervals intervals;
  std::optional<OrderTermTest> order;  // where an order was given
  bool falling = false;                // the comparison is chosen less often at higher levels (falling_answers)
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

std::vector<ChoiceGroup> counted_groups(const WhichOptions& options, TwoIntervalOptions model) {
  refuse_trial_options(options.trials, kWhichUse);
  const std::optional<double> standard = number_in_option(options.trials.standard);
  if (!standard)
    throw UsageError(
        options.trials.standard.empty()
            ? std::string("--standard is needed: what the levels were judged against, in their unit")
            : fmt::format("--standard: {} is not a number (a column goes with --trials)", options.trials.standard));
  const CsvTable table = CsvTable::read(options.input.file, {"x", "n", "k"}, {"group", "order"});
  model.order_term = table.has("order");
  std::vector<ChoiceGroup> groups;
  std::map<std::optional<std::string>, std::size_t> places;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const ChoiceRow counts = choice_row(table, row);
    std::optional<std::string> name;
    if (table.has("group")) name = table.text(row, "group");
    const auto [place, added] = places.try_emplace(name, groups.size());
    if (added) groups.push_back({name, {}, {}, *standard, model, {}});
    groups[place->second].rows.push_back(counts);
  }
  return groups;
}

std::vector<ChoiceGroup> trial_groups(const WhichOptions& options, TwoIntervalOptions model) {
  if (options.trials.standard.empty() && !names_nothing(options.trials))
    throw UsageError("--standard is needed: what the levels were judged against, a number or a column");
  const TrialTable table = read_trials(options.input.file, options.trials, kWhichUse);
  model.order_term =
      std::any_of(table.trials.begin(), table.trials.end(), [](const CsvTrial& trial) { return trial.order != 0; });
  std::vector<ChoiceGroup> groups;
  for (const TrialUnit& unit : table.units)
    groups.push_back({unit.name(), unit.participant, unit.condition, *unit.standard, model, {}});
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

ChoiceAnswer choice_answer(const ChoiceGroup& group) {
  ChoiceAnswer answer{
      group, fit_two_interval(group.rows, group.options), two_interval_intervals(group.rows, group.options), {}, false};
  if (group.options.pse) answer.intervals.pse.reset();
  std::vector<AnsweredLevel> levels;
  for (const ChoiceRow& row : group.rows) levels.push_back({row.level, row.n, row.chosen});
  answer.falling = say_falling(levels, group.name.value_or(""));
  if (group.options.order_term) answer.order = test_order_term(group.rows, group.options, answer.fit);
  return answer;
}

std::optional<std::vector<double>> ends_of(const std::optional<ChoiceBounds>& bounds, double factor = 1) {
  if (!bounds) return std::nullopt;
  return std::vector<double>{factor * bounds->low, factor * bounds->high};
}

// JND_NAME, WEBER_NAME, JND_NAME_CI. factor: of s.
void add_choice_jnd(Fields<ChoiceAnswer>& fields, const std::string& name, double factor) {
  using R = ChoiceAnswer;
  const auto jnd = [factor](const R& r) { return factor * r.fit.s.value_or(kNaN); };
  fields.emplace_back("jnd_" + name, "from the PSE to that share", jnd);
  fields.emplace_back(
      "weber_" + name, "JND / standard",
      [jnd](const R& r) { return r.of.standard > 0 ? jnd(r) / r.of.standard : kNaN; },
      FieldTraits{.title = "Weber", .shown = Shown::percent});
  add_interval(fields, "jnd_" + name + "_ci", [factor](const R& r) { return ends_of(r.intervals.s, factor); });
}

Fields<ChoiceAnswer> choice_fields(const ChoiceGroup& first) {
  using R = ChoiceAnswer;
  using C = TwoIntervalFit;
  using T = OrderTermTest;
  const auto known = [](auto member) { return [member](const C& fit) { return (fit.*member).value_or(kNaN); }; };
  Fields<R> fields = unit_fields<R>(first);
  add_parts(
      fields, "", "what was judged, and whether the comparison is chosen less often at higher levels", {},
      [](const R& r) -> const R& { return r; }, "standard", [](const R& r) { return r.of.standard; }, "link",
      [](const R& r) { return word_of(kChoiceLinkWords, r.of.options.link); }, "falling", &R::falling,
      "loglik_with_binomial_constants",
      [](const R& r) { return r.fit.log_likelihood.value_or(kNaN) + log_binomial_constants(r.of.rows); });
  add_parts(
      fields, "", "the fit", {}, &R::fit, "status",
      [](const C& fit) { return word_of(kTwoIntervalStatusWords, fit.status); }, "trials", &C::trials, "loglik",
      known(&C::log_likelihood), "deviance", known(&C::deviance), "pse_range",
      [](const C& fit) { return ends_of(fit.pse_range); }, "pse", known(&C::pse), "s", known(&C::s), "lapse",
      known(&C::lapse));
  const ChoiceJnds unit = choice_jnds(first.options.link, 1);
  add_choice_jnd(fields, "75", unit.jnd_75);
  add_choice_jnd(fields, "84", unit.jnd_84);
  add_choice_jnd(fields, "dprime1", unit.jnd_dprime1);
  add_interval(fields, "pse_ci", [](const R& r) { return ends_of(r.intervals.pse); });
  add_interval(fields, "s_ci", [](const R& r) { return ends_of(r.intervals.s); });
  if (!first.options.order_term) return fields;
  const auto test = [](const R& r) -> const T& { return *r.order; };
  add_parts(fields, "", "in units of s", {}, &R::fit, "order_b", known(&C::order_b));
  add_parts(fields, "", "likelihood ratio", {}, test, "loglik_without_order", &T::log_likelihood_without, "order_lr",
            &T::lr);
  add_parts(fields, "", "its p", {.shown = Shown::p_value}, test, "order_p", &T::p);
  add_interval(fields, "order_b_ci", [](const R& r) { return ends_of(r.intervals.order_b); });
  return fields;
}

// The estimates, and the order's where there is one.
std::vector<Block> choice_blocks(const std::vector<ChoiceAnswer>& answers) {
  const ChoiceGroup& first = answers.front().of;
  const TwoIntervalOptions& model = first.options;
  const std::string lapse = model.lapse ? fmt::format("lapse {:g}", *model.lapse)
                                        : fmt::format("lapse free (0 to {:g})", kLargestChoiceLapse);
  const ChoiceJnds unit = choice_jnds(model.link, 1);
  const char* const interval = "95 % profile";
  Block estimates, order;
  estimates.with(choice_fields(first), answers);
  estimates.title = fmt::format("choices between two intervals, {}, {}{}", word_of(kChoiceLinkWords, model.link), lapse,
                                model.pse ? ", the PSE at the standard" : "");
  estimates.columns =
      columns("name", titled("pse", "PSE"), interval_column("pse_ci", interval), titled("jnd_75", "JND 75 %"),
              interval_column("jnd_75_ci", interval), "weber_75", titled("jnd_84", "JND 84 %"),
              titled("jnd_dprime1", "JND d' = 1"), "lapse", "deviance", "trials", "status");
  estimates.footnotes = {fmt::format(
      "JND, from the PSE to where the comparison is chosen in 75 % ({:.4f} s), 84 % ({:.4f} s) and 76 % (d' = 1, {:.4f} "
      "s) of the trials, without the lapses. Weber: JND 75 % / standard.",
      unit.jnd_75, unit.jnd_84, unit.jnd_dprime1)};
  explain(estimates, "status",
          {{"separated", "a step fits best: the JND is below what these levels can show, the PSE a range"},
           {"not_identified", "one level only: neither PSE nor JND; add levels"},
           {"flat", "no slope above 0 fits better than one rate for all levels: there is no PSE"},
           {"all_same", "one and the same answer throughout: neither PSE nor JND"},
           {"missing", "no trials"}});
  if (!model.order_term) return {estimates};
  order.with(choice_fields(first), answers);
  order.columns = columns("name", titled("order_b", "order b"), interval_column("order_b_ci", interval),
                          titled("order_lr", "chi-square"), titled("order_p", "p"));
  order.footnotes = {
      "b: in units of s, above 0 where the second interval is favoured; likelihood-ratio test of b = 0."};
  return {estimates, order};
}

int which(const WhichOptions& options) {
  const TwoIntervalOptions model = which_model(options);
  // The whole file is read before anything is printed: a mistake in the last row leaves no half an answer.
  std::vector<ChoiceAnswer> answers;
  for (ChoiceGroup& group : options.trials.trials ? trial_groups(options, model) : counted_groups(options, model)) {
    if (options.pse_is_standard) group.options.pse = group.standard;
    answers.push_back(choice_answer(group));
  }
  if (answers.empty()) return exit_code::kDone;  // no trial with an answer
  const std::vector<Block> blocks = choice_blocks(answers);
  if (!options.input.json) {
    print_rows(blocks, false);
    return exit_code::kDone;
  }
  for (nlohmann::ordered_json& line : json_rows(blocks[0])) {
    if (line["pse_range"].is_null()) line.erase("pse_range");
    print_json(line);
  }
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

}  // namespace jnd
