// jnd calc mafc, oddity, duo-trio, abx, reminder: d' of tasks with a right answer.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/choice/choice_dprime.h"
#include "data/blocks/part_fields.h"
#include "protocols/input/csv_table.h"
#include "runner/calc/calc.h"
#include "runner/calc/calc_output.h"
#include "runner/calc/interval_fields.h"
#include "runner/terminal/exit_code.h"

namespace jnd {

namespace {

// A row of the file. Found: what its counts say.
template <typename Found>
struct NamedRow {
  std::optional<std::string> id;  // null in a file without the column
  Found found;
};

std::optional<std::string> row_id(const CsvTable& table, std::size_t row) {
  if (!table.has("id")) return std::nullopt;
  return std::string(table.text(row, "id"));
}

int choice_of_counts(const CalcInput& input, ChoiceTask task, const std::string& heading) {
  using R = NamedRow<ChoiceDprime>;
  using C = ChoiceDprime;
  const CsvTable table = CsvTable::read(input.file, {"n", "correct"}, {"id"});
  std::vector<R> rows;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const int n = table.integer(row, "n", 0), correct = table.integer(row, "correct", 0);
    if (correct > n)
      table.fail(row, "correct", fmt::format("{} right answers in {} trials", correct, n), "correct is at most n");
    rows.push_back({row_id(table, row), choice_dprime_of_counts(task, correct, n)});
  }
  Fields<R> fields = name_fields<R>("id", &R::id);
  add_parts(fields, "", "trials, and right answers", {}, &R::found, "n", &C::n, "correct", &C::correct);
  add_parts(fields, "", "correct / n", {.shown = Shown::percent}, &R::found, "pc", &C::pc);
  add_parts(fields, "", "of the fit", {}, &R::found, "dprime", &C::dprime, "se", &C::se, "loglik", &C::log_likelihood);
  add_interval(fields, "dprime_ci", ends(&R::found, &C::ci_low, &C::ci_high));
  add_parts(fields, "", "ok, or what d' is", {}, &R::found, "status", &C::status);
  Block block;
  block.title = heading;
  block.note = "Maximum likelihood, profile-likelihood interval; se: delta method.";
  block.columns = columns("name", share("correct", "n", "correct", "/"), titled("pc", "share"), titled("dprime", "d'"),
                          interval_column("dprime_ci", "95 % profile"), "se", "status");
  block.with(fields, rows);
  explain(block, "status",
          {{"ceiling", "every answer was right: d' is above what so many trials can show"},
           {"floor", "no answer was right, which is worse than chance"},
           {"not_above_chance", "no more right answers than by chance"},
           {"missing", "no trial"}});
  print_rows({block}, input.json);
  return exit_code::kDone;
}

int choice_of_rates(const CalcInput& input, RatesTask task, const std::string& heading) {
  using R = NamedRow<RatesDprime>;
  using D = RatesDprime;
  using T = TwoRates;
  const CsvTable table = CsvTable::read(input.file, {"n_signal", "hits", "n_noise", "false_alarms"}, {"id"});
  std::vector<R> rows;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const Counts counts{table.integer(row, "n_signal", 0), table.integer(row, "hits", 0),
                        table.integer(row, "n_noise", 0), table.integer(row, "false_alarms", 0)};
    if (counts.hits > counts.n_diff)
      table.fail(row, "hits", fmt::format("{} hits of {} trials with the signal", counts.hits, counts.n_diff),
                 "hits are at most n_signal");
    if (counts.false_alarms > counts.n_same)
      table.fail(row, "false_alarms",
                 fmt::format("{} false alarms of {} trials without the signal", counts.false_alarms, counts.n_same),
                 "false_alarms are at most n_noise");
    rows.push_back({row_id(table, row), dprime_of_rates(task, counts)});
  }
  Fields<R> fields = name_fields<R>("id", &R::id);
  add_parts(
      fields, "", "trials, and of them those answered as with the signal", {},
      [](const R& r) { return r.found.counts; }, "n_signal", &Counts::n_diff, "hits", &Counts::hits, "n_noise",
      &Counts::n_same, "false_alarms", &Counts::false_alarms);
  const auto add_rates = [&](const std::string& key, T D::*rates) {
    const auto part = [rates](const R& r) { return r.found.*rates; };
    const std::string means = "rates and what follows from them";
    add_parts(fields, key, means, {}, part, "H", &T::hit_rate, "F", &T::false_alarm_rate, "z_difference",
              &T::z_difference, "dprime_differencing", &T::dprime_differencing, "dprime_independent",
              &T::dprime_independent);
    if (task != RatesTask::reminder_one_interval)
      add_parts(fields, key, means, {}, part, "pc_unbiased", &T::pc_unbiased);
    if (task == RatesTask::reminder_two_intervals)
      add_parts(fields, key, means, {}, part, "dprime", &T::dprime_differencing);
  };
  add_rates("raw.", &D::raw);
  add_rates("loglinear.", &D::loglinear);
  add_parts(fields, "", "of the log-linear rates", {}, &R::found, "z_difference_se", &D::se_z_difference, "status",
            &D::status);
  add_interval(fields, "z_difference_ci", ends(&R::found, &D::z_difference_low, &D::z_difference_high));
  add_interval(fields, "dprime_differencing_ci", ends(&R::found, &D::differencing_low, &D::differencing_high));
  add_interval(fields, "dprime_independent_ci", ends(&R::found, &D::independent_low, &D::independent_high));
  Block block;
  block.title = heading;
  block.note =
      "d' of log-linear rates; profile-likelihood interval of the raw counts. The two strategies are different models.";
  block.columns = columns(
      "name", share("hits", "n_signal", "hits", "/"), share("false_alarms", "n_noise", "false alarms", "/"),
      titled("loglinear.z_difference", "z(H) - z(F)"), titled("loglinear.dprime_differencing", "d' differencing"),
      interval_column("dprime_differencing_ci", "95 % profile"),
      titled("loglinear.dprime_independent", "d' independent"),
      interval_column("dprime_independent_ci", "95 % profile"), "status");
  print_rows({block.with(fields, rows)}, input.json);
  return exit_code::kDone;
}

constexpr const char* kCountColumns = "n, correct, and id where rows have names";
constexpr const char* kRateColumns = "n_signal, hits, n_noise, false_alarms, and id where rows have names";

struct ChoiceOptions {
  CalcInput input;
  int alternatives = 2, intervals = 1;
  std::string strategy;
  bool rates = false;
};

int mafc(const ChoiceOptions& options) {
  return choice_of_counts(options.input, mafc_task(options.alternatives).value(),
                          fmt::format("{} alternatives, forced choice", options.alternatives));
}

int oddity(const ChoiceOptions& options) {
  return choice_of_counts(options.input, ChoiceTask::oddity, "oddity of three (triangle), differencing");
}

int duo_trio(const ChoiceOptions& options) {
  return choice_of_counts(options.input, ChoiceTask::duo_trio, "duo-trio (2AFC with reminder), differencing");
}

int abx(const ChoiceOptions& options) {
  if (options.rates == !options.strategy.empty())
    throw UsageError(
        "abx: say --strategy differencing or independent for counts of right answers, or --rates for hits and false "
        "alarms, which give both");
  if (options.rates) return choice_of_rates(options.input, RatesTask::abx, "ABX, hits and false alarms");
  const bool differencing = options.strategy == "differencing";
  return choice_of_counts(options.input, differencing ? ChoiceTask::abx_differencing : ChoiceTask::abx_independent,
                          "ABX, " + std::string(differencing ? "differencing" : "independent observations"));
}

int reminder(const ChoiceOptions& options) {
  if (options.intervals == 1)
    return choice_of_rates(options.input, RatesTask::reminder_one_interval, "reminder, then one stimulus");
  return choice_of_rates(options.input, RatesTask::reminder_two_intervals, "reminder, then both stimuli");
}

}  // namespace

void add_calc_choice(CommandTree& calc) {
  const auto [mafc_command, mafc_options] =
      calc.add("mafc", "d' of m-alternative forced choice: which interval held the signal",
               "jnd calc mafc counts.csv --alternatives 3 --json", mafc);
  add_input(mafc_command, mafc_options.input, kCountColumns);
  mafc_command.add_option("--alternatives", mafc_options.alternatives, "intervals a trial: 2, 3 or 4")
      .required()
      .one_of({"2", "3", "4"});

  const auto [oddity_command, oddity_options] =
      calc.add("oddity", "d' of oddity: which of three is the odd one", "jnd calc oddity counts.csv", oddity);
  add_input(oddity_command, oddity_options.input, kCountColumns);

  const auto [duo_trio_command, duo_trio_options] = calc.add(
      "duo-trio", "d' of duo-trio: which of two equals the reminder", "jnd calc duo-trio counts.csv", duo_trio);
  add_input(duo_trio_command, duo_trio_options.input, kCountColumns);

  const auto [abx_command, abx_options] =
      calc.add("abx", "d' of ABX: is X like A or like B", "jnd calc abx counts.csv --strategy differencing", abx);
  add_input(abx_command, abx_options.input, std::string(kCountColumns) + "; with --rates " + kRateColumns);
  abx_command
      .add_option("--strategy", abx_options.strategy,
                  "how the observer decides: differencing or independent (observations)")
      .one_of({"differencing", "independent"});
  abx_command.add_flag("--rates", abx_options.rates, "hits and false alarms instead of right answers: free of bias");

  const auto [reminder_command, reminder_options] =
      calc.add("reminder", "d' of a task whose trials begin with the standard, from hits and false alarms",
               "jnd calc reminder counts.csv --intervals 1", reminder);
  add_input(reminder_command, reminder_options.input, kRateColumns);
  reminder_command.add_option("--intervals", reminder_options.intervals, "after the reminder: 1 or 2")
      .required()
      .one_of({"1", "2"});
}

}  // namespace jnd
