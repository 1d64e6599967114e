// What a shell may offer in the place of a value.
#pragma once

#include <string>
#include <vector>

#include "runner/help/command_page.h"

namespace jnd {

struct CompletedValue {
  std::vector<std::string> words;  // of which one may be meant: values, or shipped names
  // Which files: "*.sqlite"; "*" any; "/" folders alone; empty: none.
  std::string files;
  bool nothing() const noexcept { return words.empty() && files.empty(); }
};

// Of an option that takes a value, or of an argument: by its words, and by the name of what it takes.
CompletedValue completed_value(const OptionPage& option);
// Of all the arguments of a command together: a shell does not count them.
CompletedValue completed_arguments(const CommandPage& page);

}  // namespace jnd
