#include "runner/terminal/study_variable.h"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

void tell_study_of_variable(const CLI::App& command, const std::vector<std::string>& arguments) {
  for (const CLI::Option* option : command.get_options(
           [](const CLI::Option* one) { return one->get_envname() == kStudyVariable && one->count() > 0; })) {
    const std::string study = option->results().back();
    const auto says = [&study](const std::string& argument) {
      return argument == study || argument == "--study=" + study;
    };
    if (std::none_of(arguments.begin(), arguments.end(), says))
      print_message("jnd: the study is {} ({})\n", printable(study), kStudyVariable);
  }
}

}  // namespace jnd
