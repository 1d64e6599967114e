// What is wrong with a file that a user wrote, and where: every mistake found is reported at once.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace jnd {

// One mistake in an input file. line and column count from 1; 0 means that the place is not known.
struct Diagnostic {
  std::string file;
  int line = 0;
  int column = 0;
  std::string path;        // JSON path of the value, such as "$.series[1].pair"; empty for syntax errors
  std::string message;     // what is wrong, with the value found
  std::string suggestion;  // what would be right; may be empty
};

// "file:line:column: $.path: message (suggestion)", as compilers print it, so that editors jump to the place.
std::string to_text(const Diagnostic& diagnostic);

// The input cannot be used. what() is all diagnostics, a line each. The program exits with 3.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Diagnostic> diagnostics);
  // One mistake that has no place in a file, such as a missing file or an impossible combination of options.
  explicit InputError(const std::string& message);

  const std::vector<Diagnostic>& diagnostics() const noexcept { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace jnd
