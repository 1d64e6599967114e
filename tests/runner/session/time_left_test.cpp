// When the session will be over, as the operator is told before each step: with its breaks and questions, and the same
// whatever the coming trials present.
#include <string>
#include <vector>

#include "protocols/course/duration.h"
#include "runner/console/session_summary.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"

namespace jnd {
namespace {

class TimesLeft final : public SessionView {
 public:
  void time_left(double left_s) override { left.push_back(left_s); }
  std::vector<double> left;
};

Protocol protocol_of_study() {
  return test::small_protocol({{"breaks", {{{"after", "block"}, {"duration_s", 60}}}},
                               {"questions",
                                {{{"id", "ease"},
                                  {"when", "after-session"},
                                  {"kind", "rating"},
                                  {"text", "How easy was it?"},
                                  {"min", 1},
                                  {"max", 9},
                                  {"low", "hard"},
                                  {"high", "easy"}}}},
                               {"design", {{"order", {{"series", "permuted"}, {"conditions", "permuted"}}}}}});
}

std::vector<double> times_left(const Protocol& protocol, int participant) {
  test::Bench bench(protocol, participant);
  bench.person = true;
  TimesLeft view;
  CHECK(bench.run(view) == SessionEnd::completed);
  return view.left;
}

TEST_CASE("What is left of a session holds its trials, breaks and questions, and runs out with it") {
  const Protocol protocol = protocol_of_study();
  const std::vector<double> left = times_left(protocol, 1);
  REQUIRE(left.size() == 16 + 3 + 1);  // trials, breaks, a page of questions
  CHECK(left.front() == Approx(expected_duration_s(protocol)));
  CHECK(left.front() == Approx(16 * expected_trial_s(protocol) + 3 * 60 + 10));
  // At the participant's own pace: 2 x 1 s, a gap of 0.5 s, an answer after 1 s, 0.5 s between trials.
  // Four trials as the protocol has them stand beside those that were.
  const auto pace = [&](int trials) { return (trials * 4 + 4 * expected_trial_s(protocol)) / (trials + 4); };
  CHECK(left[1] == Approx(15 * pace(1) + 3 * 60 + 10));
  CHECK(left[4] == Approx(12 * pace(4) + 3 * 60 + 10));  // the break is due
  CHECK(left[5] == Approx(12 * pace(4) + 2 * 60 + 10));
  CHECK(left.back() == Approx(10));
}

TEST_CASE("What is left of a session does not depend on the conditions and stimuli that are to come") {
  const Protocol protocol = protocol_of_study();
  const std::vector<double> first = times_left(protocol, 1);
  for (const int participant : {2, 3, 4}) CHECK(times_left(protocol, participant) == first);
}

TEST_CASE("A round of practice that comes again is in what is left from its first trial on") {
  Protocol protocol = test::small_protocol(
      {{"practice", {{"trials", 4}, {"series", "1"}, {"criterion_correct", 1}, {"max_rounds", 2}}}});
  test::Bench bench(protocol);
  bench.person = true;
  bench.responder.rule = [](const TrialQuestion&) { return std::optional(kClassSame); };
  TimesLeft view;
  CHECK(bench.run(view) == SessionEnd::completed);
  REQUIRE(view.left.size() == 4 + 4 + 1 + 16);  // rounds, the end of practice, trials
  CHECK(view.left.front() == Approx(20 * expected_trial_s(protocol)));
  // At the pace of the first round, beside four trials as the protocol has them.
  CHECK(view.left[4] == Approx(20 * (4 * 4 + 4 * expected_trial_s(protocol)) / 8));
  CHECK(view.left[7] < view.left[4]);
}

TEST_CASE("The last words of a session say what was done, where it is and what comes next") {
  SessionSummary summary{
      .study = "my study.sqlite", .trials_done = 12, .trials_total = 16, .trials_voided = 3, .run_s = 61};
  CHECK(summary_text(summary) ==
        "  trials    12 of 16, 3 voided\n"
        "  this run  61 s\n"
        "  saved in  my study.sqlite\n"
        "  next      jnd status 'my study.sqlite'\n"
        "            jnd verify 'my study.sqlite'\n"
        "            jnd backup 'my study.sqlite' --to 'my study-copy.sqlite'");
  summary.slowest_presenting_ms = 12.4;
  summary.slowest_waiting_ms = 340.6;
  CHECK(summary_text(summary).find(
            "\n  rig       slowest answer 12 of 100 ms while it presented, 341 of 2000 ms while it waited\n") !=
        std::string::npos);
  summary.study = "Anna's.sqlite";
  CHECK(summary_text(summary).find("jnd verify 'Anna'\\''s.sqlite'\n") != std::string::npos);
  summary.resumable = true;
  CHECK(summary_text(summary).find("next      the same command goes on with it\n            jnd status") !=
        std::string::npos);
  summary.moved = true;
  CHECK(summary_text(summary).find("next      the same command with --study 'Anna'\\''s.sqlite' goes on with it\n") !=
        std::string::npos);
}

}  // namespace
}  // namespace jnd
