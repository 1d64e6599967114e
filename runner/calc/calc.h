// `jnd calc`: the statistics on any CSV, without a study. Each calc_*.cpp adds its commands; runner/calc/calc.cpp
// collects them.
#pragma once

#include <string>
#include <vector>

#include "analysis/behaviour/falling_answers.h"
#include "protocols/input/csv_table.h"
#include "runner/terminal/command_tree.h"

namespace jnd {

// Adds the whole tree `jnd calc ...`.
void add_calc_commands(CommandTree& program);

// What every command of the tree reads and how it answers.
struct CalcInput {
  std::string file;   // a CSV file, or "-": standard input
  bool json = false;  // JSON as machines want it; otherwise tables for a person
};

// The positional FILE ("-": standard input) and --json. columns: for the help, such as "id, n_diff, hits".
void add_input(const Command& command, CalcInput& input, const std::string& columns);

// A caution on standard error, where there is such a column, and codes in it look alike: they count as different people.
// file: "-" is standard input.
void say_look_alikes(const CsvTable& table, const std::string& column, const std::string& file);

// A caution on standard error if the answers of one group grow rarer with the level (true), so that they are perhaps coded
// the other way round. group: its name; empty if there is one only.
bool say_falling(std::vector<AnsweredLevel> levels, const std::string& group);

// What is wrong with a text that is no finite number above 0; empty where it is one.
std::string not_above_0(const std::string& text);

void add_calc_detection(CommandTree& calc);     // sdt, coverage
void add_calc_choice(CommandTree& calc);        // mafc, oddity, duo-trio, abx, reminder
void add_calc_ratings(CommandTree& calc);       // identify, ratings, sureness
void add_calc_jnd(CommandTree& calc);           // jnd
void add_calc_group(CommandTree& calc);         // compare, wilcoxon, ptukey, qtukey, shapiro
void add_calc_psychometric(CommandTree& calc);  // fit
void add_calc_which(CommandTree& calc);         // which
void add_calc_hierarchical(CommandTree& calc);  // hierarchical
void add_calc_adaptive(CommandTree& calc);      // staircase, quest
void add_calc_scaling(CommandTree& calc);       // magnitude, adjust
void add_calc_posterior(CommandTree& calc);     // posterior
void add_calc_selftest(CommandTree& calc);      // selftest

}  // namespace jnd
