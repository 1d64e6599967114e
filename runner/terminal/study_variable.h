// JND_STUDY: the study of a command that takes STUDY and is given none.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace jnd {

inline constexpr const char* kStudyVariable = "JND_STUDY";

// After the arguments were read: says on standard error which study the command took from the variable; nothing where
// it was given one. A command that writes must not leave that to be guessed.
void tell_study_of_variable(const CLI::App& command, const std::vector<std::string>& arguments);

}  // namespace jnd
