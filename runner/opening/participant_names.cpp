#include "runner/opening/participant_names.h"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocols/input/number_from.h"
#include "runner/session/simulate.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

constexpr int kLargestNumber = 100'000;
constexpr std::size_t kMostDigits = 3;  // of what is a number: longer ones are codes of the laboratory's own

bool has_code(const std::vector<SessionInfo>& sessions, const std::string& code) {
  return std::any_of(sessions.begin(), sessions.end(),
                     [&code](const SessionInfo& session) { return session.participant == code; });
}

std::set<int> numbers_of(const std::vector<SessionInfo>& sessions, const std::string& code) {
  std::set<int> numbers;
  for (const SessionInfo& session : sessions)
    if (session.participant == code) numbers.insert(session.participant_number);
  return numbers;
}

int in_range(int number, const std::string& text) {
  if (number < 1 || number > kLargestNumber)
    throw UsageError(fmt::format("--participant {}: a number of the plan is 1 to {}", printable(text), kLargestNumber));
  return number;
}

// A text of digits is a place, unless somebody with another place is called so.
int place_of_digits(int number, const std::string& text, const std::set<int>& of_code) {
  if (!of_code.empty() && of_code != std::set<int>{number})
    throw UsageError(fmt::format("--participant {}: is the code of number {} of the plan, and a number itself; give {}",
                                 printable(text), fmt::join(of_code, " and "), fmt::join(of_code, " or ")));
  return in_range(number, text);
}

}  // namespace

std::string participant_meant(const std::string& text, const std::vector<SessionInfo>& sessions) {
  if (has_code(sessions, text) || text.size() > kMostDigits) return text;
  const std::optional<int> number = number_from<int>(text);
  return number && *number > 0 ? participant_code(*number) : text;
}

int plan_number_meant(const std::string& text, const std::vector<SessionInfo>& sessions) {
  const std::set<int> of_code = numbers_of(sessions, text);
  if (const std::optional<int> number = number_from<int>(text)) return place_of_digits(*number, text, of_code);
  if (of_code.size() == 1) return *of_code.begin();
  if (of_code.size() > 1)
    throw UsageError(
        fmt::format("--participant {}: sessions of several kinds have this code, with the numbers {}; give "
                    "one of these",
                    printable(text), fmt::join(of_code, " and ")));
  const bool of_plan = text.starts_with('P') || text.starts_with('p');
  const std::optional<int> number = of_plan ? number_from<int>(std::string_view(text).substr(1)) : std::nullopt;
  if (number && sessions.empty()) return in_range(*number, text);
  if (sessions.empty())
    throw UsageError(
        fmt::format("--participant {}: is neither a number of the plan, such as 7, nor P07", printable(text)));
  throw UsageError(
      fmt::format("--participant {}: has no session in this study, and so no place in the plan yet; give a "
                  "number of the plan, such as 7",
                  printable(text)));
}

std::string participant_title(int number, const std::vector<SessionInfo>* sessions) {
  if (sessions == nullptr) return "participant " + participant_code(number);
  std::set<std::string> codes;
  for (const SessionInfo& session : *sessions)
    if (session.participant_number == number && !session.replaced) codes.insert(session.participant);
  if (codes.empty()) return fmt::format("number {} of the plan, which nobody has yet", number);
  return fmt::format("participant {}, number {} of the plan", printable(fmt::format("{}", fmt::join(codes, " and "))),
                     number);
}

}  // namespace jnd
