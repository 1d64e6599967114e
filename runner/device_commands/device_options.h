// What the device commands share: the options that several of them have.
#pragma once

#include <set>
#include <string>

#include <CLI/CLI.hpp>

#include "analysis/numerics/words.h"
#include "runner/device_commands/device_output.h"

namespace jnd {

// --json, and --csv where the answer can be a table: what_csv says what it writes, empty where there is none.
void add_output(CLI::App& command, DeviceOutput& output, const std::string& what_csv);

// Refuses what is no finite number.
const CLI::Validator& finite();

// An option that is a finite number, or several of them. value: a number, std::optional or std::vector of it.
template <typename T>
CLI::Option* add_number(CLI::App& command, const std::string& name, T& value, const std::string& what) {
  return command.add_option(name, value, what)->check(finite());
}

// An option whose value is one of some words. value: Enum or std::optional<Enum>.
template <typename Enum, std::size_t N, typename Value>
void add_choice(CLI::App& command, const std::string& name, Value& value, const WordTable<Enum, N>& words,
                const std::string& what) {
  std::set<std::string> known;  // in alphabetical order in the help
  for (const auto& [word, its_value] : words) known.emplace(word);
  command
      .add_option_function<std::string>(
          name, [&value, words](const std::string& word) { value = value_of(words, word).value(); }, what)
      ->check(CLI::IsMember(known));
}

}  // namespace jnd
