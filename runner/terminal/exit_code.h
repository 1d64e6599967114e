// How a command ends: the exit codes that scripts rely on, and the error of wrong options.
#pragma once

#include <stdexcept>

namespace jnd {

namespace exit_code {
inline constexpr int kDone = 0;
inline constexpr int kProblemFound = 1;
inline constexpr int kUsage = 2;
inline constexpr int kInvalidInput = 3;
inline constexpr int kDevice = 4;
inline constexpr int kStorage = 5;
inline constexpr int kInterrupted = 130;
}  // namespace exit_code

// The options do not fit each other or the study. The program exits with 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace jnd
