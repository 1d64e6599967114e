// jnd calc mafc, oddity, duo-trio, abx, reminder: d' of tasks with a right answer.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/choice/choice_dprime.h"
#include "analysis/choice/choice_rates.h"
#include "protocols/input/csv_table.h"
#include "runner/calc/calc.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using nlohmann::ordered_json;
using Align = TextTable::Align;

std::string choice_number(double value) {
  return number_text(value, 3);
}

// The name of a row; none in a file without the column.
std::optional<std::string> row_id(const CsvTable& table, std::size_t row) {
  if (!table.has("id")) return std::nullopt;
  return std::string(table.text(row, "id"));
}

ordered_json id_json(const std::optional<std::string>& id) {
  return id ? ordered_json(*id) : ordered_json(nullptr);
}

std::string id_text(const std::optional<std::string>& id) {
  return printable(id.value_or("all"));
}

ordered_json interval_json(double low, double high) {
  return ordered_json::array({json_number(low), json_number(high)});
}

// ---- counts of right answers

struct NamedChoice {
  std::optional<std::string> id;
  ChoiceDprime found;
};

ordered_json choice_json(const NamedChoice& named) {
  const ChoiceDprime& found = named.found;
  ordered_json out;
  out["id"] = id_json(named.id);
  out["n"] = found.n;
  out["correct"] = found.correct;
  out["pc"] = json_number(found.pc);
  out["dprime"] = json_number(found.dprime);
  out["se"] = json_number(found.se);
  out["loglik"] = json_number(found.log_likelihood);
  out["dprime_ci"] = interval_json(found.ci_low, found.ci_high);
  out["status"] = to_string(found.status);
  return out;
}

// What each status means, once for all rows that have it.
std::string choice_meanings(const std::vector<NamedChoice>& rows) {
  static constexpr std::pair<ChoiceStatus, const char*> kMeanings[] = {
      {ChoiceStatus::ceiling, "every answer was right: d' is above what so many trials can show"},
      {ChoiceStatus::floor, "no answer was right, which is worse than chance"},
      {ChoiceStatus::not_above_chance, "no more right answers than by chance"},
      {ChoiceStatus::missing, "no trial"}};
  std::string text;
  for (const auto& [status, meaning] : kMeanings)
    for (const NamedChoice& row : rows)
      if (row.found.status == status) {
        text += warn(fmt::format("{}: {}.", to_string(status), meaning)) + "\n";
        break;
      }
  return text;
}

std::string choice_text(const std::vector<NamedChoice>& rows, const std::string& heading) {
  TextTable table({"id", "correct", "share", "d'", "95 % profile", "se", "status"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::left});
  for (const auto& [id, found] : rows)
    table.add({id_text(id), fmt::format("{}/{}", found.correct, found.n), percent_text(found.pc),
               choice_number(found.dprime), range_text(found.ci_low, found.ci_high, 3), choice_number(found.se),
               std::string(to_string(found.status))});
  return bold(heading) + "\n" + table.text() +
         dim("Maximum likelihood, profile-likelihood interval; se: delta method.") + "\n" + choice_meanings(rows);
}

int choice_of_counts(const CalcInput& input, ChoiceTask task, const std::string& heading) {
  const CsvTable table = CsvTable::read(input.file, {"n", "correct"}, {"id"});
  std::vector<NamedChoice> rows;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const int n = table.integer(row, "n", 0), correct = table.integer(row, "correct", 0);
    if (correct > n)
      table.fail(row, "correct", fmt::format("{} right answers in {} trials", correct, n), "correct is at most n");
    rows.push_back({row_id(table, row), choice_dprime_of_counts(task, correct, n)});
  }
  if (input.json)
    for (const NamedChoice& row : rows) fmt::print("{}\n", json_line(choice_json(row)));
  else
    fmt::print("{}", choice_text(rows, heading));
  return exit_code::kDone;
}

// ---- hits and false alarms

struct NamedRates {
  std::optional<std::string> id;
  RatesDprime found;
};

// Keys of numbers that the task does not have are left out.
ordered_json two_rates_json(RatesTask task, const TwoRates& rates) {
  ordered_json out = {{"H", json_number(rates.hit_rate)},
                      {"F", json_number(rates.false_alarm_rate)},
                      {"z_difference", json_number(rates.z_difference)}};
  if (task != RatesTask::reminder_one_interval) out["pc_unbiased"] = json_number(rates.pc_unbiased);
  if (task == RatesTask::reminder_two_intervals) out["dprime"] = json_number(rates.dprime_differencing);
  out["dprime_differencing"] = json_number(rates.dprime_differencing);
  out["dprime_independent"] = json_number(rates.dprime_independent);
  return out;
}

ordered_json rates_json(RatesTask task, const NamedRates& named) {
  const RatesDprime& found = named.found;
  ordered_json out;
  out["id"] = id_json(named.id);
  out["n_signal"] = found.counts.n_diff;
  out["hits"] = found.counts.hits;
  out["n_noise"] = found.counts.n_same;
  out["false_alarms"] = found.counts.false_alarms;
  out["raw"] = two_rates_json(task, found.raw);
  out["loglinear"] = two_rates_json(task, found.loglinear);
  out["z_difference_se"] = json_number(found.se_z_difference);
  out["z_difference_ci"] = interval_json(found.z_difference_low, found.z_difference_high);
  out["dprime_differencing_ci"] = interval_json(found.differencing_low, found.differencing_high);
  out["dprime_independent_ci"] = interval_json(found.independent_low, found.independent_high);
  out["status"] = to_string(found.status);
  return out;
}

std::string rates_text(const std::vector<NamedRates>& rows, const std::string& heading) {
  TextTable table({"id", "hits", "false alarms", "z(H) - z(F)", "d' differencing", "95 % profile", "d' independent",
                   "95 % profile", "status"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::left});
  for (const auto& [id, found] : rows)
    table.add({id_text(id), fmt::format("{}/{}", found.counts.hits, found.counts.n_diff),
               fmt::format("{}/{}", found.counts.false_alarms, found.counts.n_same),
               choice_number(found.loglinear.z_difference), choice_number(found.loglinear.dprime_differencing),
               range_text(found.differencing_low, found.differencing_high, 3),
               choice_number(found.loglinear.dprime_independent),
               range_text(found.independent_low, found.independent_high, 3), std::string(to_string(found.status))});
  return bold(heading) + "\n" + table.text() +
         dim("d' of log-linear rates; profile-likelihood interval of the raw counts. The two strategies are different "
             "models.") +
         "\n";
}

int choice_of_rates(const CalcInput& input, RatesTask task, const std::string& heading) {
  const CsvTable table = CsvTable::read(input.file, {"n_signal", "hits", "n_noise", "false_alarms"}, {"id"});
  std::vector<NamedRates> rows;
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
  if (input.json)
    for (const NamedRates& row : rows) fmt::print("{}\n", json_line(rates_json(task, row)));
  else
    fmt::print("{}", rates_text(rows, heading));
  return exit_code::kDone;
}

// ---- the commands

constexpr const char* kCountColumns = "n, correct, and id where rows have names";
constexpr const char* kRateColumns = "n_signal, hits, n_noise, false_alarms, and id where rows have names";

struct MafcOptions {
  CalcInput input;
  int alternatives = 2;
};

int mafc(const MafcOptions& options) {
  return choice_of_counts(options.input, mafc_task(options.alternatives).value(),
                          fmt::format("{} alternatives, forced choice", options.alternatives));
}

struct OddityOptions {
  CalcInput input;
};

int oddity(const OddityOptions& options) {
  return choice_of_counts(options.input, ChoiceTask::oddity, "oddity of three (triangle), differencing");
}

struct DuoTrioOptions {
  CalcInput input;
};

int duo_trio(const DuoTrioOptions& options) {
  return choice_of_counts(options.input, ChoiceTask::duo_trio, "duo-trio (2AFC with reminder), differencing");
}

struct AbxOptions {
  CalcInput input;
  std::string strategy;
  bool rates = false;
};

int abx(const AbxOptions& options) {
  if (options.rates == !options.strategy.empty())
    throw UsageError(
        "abx: say --strategy differencing or independent for counts of right answers, or --rates for hits and false "
        "alarms, which give both");
  if (options.rates) return choice_of_rates(options.input, RatesTask::abx, "ABX, hits and false alarms");
  const bool differencing = options.strategy == "differencing";
  return choice_of_counts(options.input, differencing ? ChoiceTask::abx_differencing : ChoiceTask::abx_independent,
                          "ABX, " + std::string(differencing ? "differencing" : "independent observations"));
}

struct ReminderOptions {
  CalcInput input;
  int intervals = 1;
};

int reminder(const ReminderOptions& options) {
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
