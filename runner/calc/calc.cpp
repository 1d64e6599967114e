#include "runner/calc/calc.h"

#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "protocols/input/look_alikes.h"
#include "runner/calc/trials_input.h"
#include "runner/terminal/standard_streams.h"

namespace jnd {

std::string not_above_0(const std::string& text) {
  return number_in_option(text).value_or(0) > 0 ? "" : text + " is not a number above 0";
}

void add_input(const Command& command, CalcInput& input, const std::string& columns) {
  command.add_option("FILE", input.file, "a CSV file with the columns " + columns + "; - reads standard input")
      .required();
  command.add_flag("--json", input.json, "machine-readable");
}

void say_look_alikes(const CsvTable& table, const std::string& column, const std::string& file) {
  if (!table.has(column)) return;
  std::set<std::string> codes;
  for (std::size_t row = 0; row < table.rows(); ++row) codes.emplace(table.text(row, column));
  const std::string alike = look_alikes({codes.begin(), codes.end()});
  if (!alike.empty())
    write_marked_message(
        fmt::format("{}: {} look alike, and count as different people: write each person's code in one way",
                    file == "-" ? "standard input" : file, alike));
}

bool say_falling(std::vector<AnsweredLevel> levels, const std::string& group) {
  const std::optional<FallingAnswers> falling = falling_answers(std::move(levels));
  if (!falling) return false;
  const auto end = [](const FallingAnswers::End& one) {
    return fmt::format("{} of {} at {:g}{}", one.k, one.n, one.from,
                       one.to == one.from ? "" : fmt::format(" to {:g}", one.to));
  };
  write_marked_message(fmt::format(
      "{}the counted answers fall with the level, from {} to {}. Perhaps they are coded the other way round: "
      "count the other answer (n - k in place of k; of single trials another --positive)",
      group.empty() ? "" : group + ": ", end(falling->low), end(falling->high)));
  return true;
}

void add_calc_commands(CommandTree& program) {
  CommandTree calc =
      program.add_group("calc", "The statistics on any CSV, without a study", "jnd calc sdt counts.csv --json");
  add_calc_detection(calc);
  add_calc_choice(calc);
  add_calc_ratings(calc);
  add_calc_jnd(calc);
  add_calc_group(calc);
  add_calc_psychometric(calc);
  add_calc_which(calc);
  add_calc_hierarchical(calc);
  add_calc_adaptive(calc);
  add_calc_scaling(calc);
  add_calc_posterior(calc);
  add_calc_selftest(calc);
}

}  // namespace jnd
