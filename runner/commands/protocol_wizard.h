// The questions of `jnd init`: what a protocol is to be, one thing after the other. Each answer is tried at once, in the
// protocol as it would be, so that a mistake is told where it is made.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "runner/commands/starting_protocol.h"

namespace jnd {

class ProtocolWizard {
 public:
  // answers: lines of a person or of a pipe. Questions go to standard output.
  explicit ProtocolWizard(std::istream& answers) : answers_(answers) {}

  // What is still to be chosen of the file's name; given: as the command line has it, or empty.
  std::filesystem::path ask_file(const std::string& given);
  // Throws UsageError where the answers end before the questions do.
  StartingPoint ask();

 private:
  // Takes an answer, and returns why it cannot be taken; empty: it was.
  using Taker = std::function<std::string(const std::string&)>;
  using Choices = std::vector<std::pair<std::string, std::string>>;  // words, and what each means
  // Asks until the answer is taken. fallback: what Enter takes.
  void ask_for(const std::string& what, const std::string& fallback, const Taker& take);
  // One of the words, with which change is made.
  void ask_choice(const char* heading, const std::string& what, const std::string& fallback, const Choices& choices,
                  const std::function<void(StartingPoint&, const std::string&)>& change);
  std::string line();
  // The point with the change, where the protocol has no mistake then.
  std::string attempt(const std::function<void(StartingPoint&)>& change);

  void ask_task();
  void ask_rig();
  void ask_procedure();
  void ask_stimulus();
  void ask_levels();
  void ask_conditions();
  void ask_participants();
  void ask_ratings();
  void ask_texts();
  std::string take_conditions(const std::string& answer, const std::vector<std::string_view>& cues);

  std::istream& answers_;
  StartingPoint point_;
};

}  // namespace jnd
