// Codes of people and numbers of the plan, where a command line may give either.
#include "runner/opening/participant_names.h"

#include "runner/terminal/exit_code.h"
#include "tests/catch.h"

namespace jnd {
namespace {

SessionInfo session(const std::string& code, int number, bool replaced = false) {
  SessionInfo info;
  info.participant = code;
  info.participant_number = number;
  info.replaced = replaced;
  return info;
}

}  // namespace

TEST_CASE("a person is meant by the code, or by the number that jnd writes as a code") {
  const std::vector<SessionInfo> study = {session("P01", 1), session("12", 2), session("4711", 3)};
  CHECK(participant_meant("P01", study) == "P01");
  CHECK(participant_meant("1", study) == "P01");
  CHECK(participant_meant("01", study) == "P01");
  CHECK(participant_meant("12", study) == "12");  // somebody is called so
  CHECK(participant_meant("13", study) == "P13");
  CHECK(participant_meant("4711", study) == "4711");
  CHECK(participant_meant("4712", study) == "4712");  // a laboratory's own codes
  CHECK(participant_meant("0", study) == "0");
  CHECK(participant_meant("AB7", study) == "AB7");
  CHECK(participant_meant("7", {}) == "P07");
}

TEST_CASE("a place in the plan is meant by its number, or by who has it") {
  const std::vector<SessionInfo> study = {session("P07", 1), session("P02", 2), session("8", 3), session("9", 9)};
  CHECK(plan_number_meant("7", {}) == 7);
  CHECK(plan_number_meant("P07", {}) == 7);
  CHECK(plan_number_meant("P07", study) == 1);
  CHECK(plan_number_meant("7", study) == 7);
  CHECK(plan_number_meant("9", study) == 9);
  CHECK_THROWS_AS(plan_number_meant("8", study), UsageError);    // the code of number 3
  CHECK_THROWS_AS(plan_number_meant("P05", study), UsageError);  // has no place yet
  for (const char* wrong : {"0", "-1", "100001", "many", "P", "P0", "", "7x"})
    CHECK_THROWS_AS(plan_number_meant(wrong, {}), UsageError);
  const std::vector<SessionInfo> twice = {session("P01", 1), session("P01", 4)};
  CHECK_THROWS_AS(plan_number_meant("P01", twice), UsageError);
}

TEST_CASE("a plan's heading says the code, and of a study who has the place") {
  CHECK(participant_title(7, nullptr) == "participant P07");
  const std::vector<SessionInfo> study = {session("P07", 1, true), session("Q1", 1)};
  CHECK(participant_title(1, &study) == "participant Q1, number 1 of the plan");
  CHECK(participant_title(5, &study) == "number 5 of the plan, which nobody has yet");
}

}  // namespace jnd
