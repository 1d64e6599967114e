// Makes a study whose sessions say that people took part, with answers that follow from the plan. The program itself
// refuses real sessions on simulated devices, so that tests of what it shows of them need this.
//
// Usage: real_study FILE PROTOCOL SEED KIND FINISHED OPEN [HOW]
//   KIND real, pilot or simulated; FINISHED whole sessions, then OPEN that stop in the middle. Participants P01, P02,
//   ... of each kind; a file that exists is added to.
//   HOW of the finished ones: whole (default); ended-early, for good in the middle; taken-back, their last answer;
//   by-place, with answers that follow from the trial's place alone.
// Or: real_study --twin PROTOCOL SEED PARTICIPANTS prints the seed of a study that looks the same (tests/twin_plan.h).
#include <exception>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "data/log/event_body.h"
#include "data/study/study.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"
#include "tests/data/study_fixture.h"
#include "tests/twin_plan.h"

namespace jnd {

namespace {

void answer_questions(SessionLog& log, const Protocol& protocol, int after_trial) {
  for (const Question& question : protocol.questions) {
    if (question.kind != Question::Kind::rating || !question.per_condition) continue;
    for (const Condition& condition : protocol.conditions)
      log.append(event_kind::kQuestionAnswered,
                 {{"question", question.id},
                  {"when", "after_session"},
                  {"condition", condition.name},
                  {"answer", "7"},
                  {"after_trial", after_trial},
                  {"kind", "rating"},
                  {"text", question.text}},
                 {1'700'000'800'000'000'000, 800});
  }
}

// Answers with mistakes in a fixed pattern: their number differs between participants, series and conditions. If everybody
// made the same mistakes, the hierarchical model would need seconds.
int answer_of(const Trial& trial, int participant) {
  const int wrong_percent = 4 + 7 * (participant % 4) + 8 * trial.series + 3 * trial.condition;
  const bool wrong = (37 * trial.index + 53 * participant) % 100 < wrong_percent;
  return (trial.target == kClassSame) != wrong ? kClassSame : kClassDifferent;
}

void one_session(Study& study, const Protocol& protocol, std::uint64_t seed, SessionKind kind, int number, bool whole,
                 const std::string& how) {
  const Plan plan = make_plan(protocol, number, seed);
  NewSession session;
  session.participant = fmt::format("P{:02}", number);
  session.id = fmt::format("{}-{}", session.participant, to_string(kind));
  session.participant_number = number;
  session.kind = kind;
  session.responder = kind == SessionKind::simulated ? "profile test" : "keyboard";
  session.rig = protocol.rig.device;
  session.trials_total = main_trial_count(plan);
  session.stamp = {1'700'000'001'000'000'000 + number, 10};
  const std::unique_ptr<SessionLog> log = study.open_session(session);
  int answered = 0;
  for (const Trial& trial : plan.trials) {
    if ((!whole || how == "ended-early") && answered++ * 2 > session.trials_total) break;
    const int answer = how == "by-place" ? trial.index % 2 : answer_of(trial, number);
    log->append(event_kind::kTrialCompleted, to_body(record_of(protocol, trial, answer)), stamp_of(trial));
  }
  if (!whole) return;
  if (how == "ended-early") {
    log->append(event_kind::kLeft, {{"cause", "operator"}, {"reason", "withdrew"}, {"for_good", true}},
                {1'700'000'800'000'000'000, 800});
  } else {
    if (how == "taken-back")
      log->append(event_kind::kTrialVoided, voided_body(protocol, plan.trials.back(), 1, "taken_back"),
                  {1'700'000'800'000'000'000, 800});
    answer_questions(*log, protocol, session.trials_total);
  }
  study.close_session(session.id, {1'700'000'900'000'000'000, 900});
}

int run(int count, char** arguments) {
  if (count == 5 && std::string(arguments[1]) == "--twin") {
    fmt::print("{}\n", test::twin_of(load_protocol(arguments[2]), std::stoull(arguments[3]), std::stoi(arguments[4])));
    return 0;
  }
  if (count != 7 && count != 8) {
    fmt::print(stderr, "usage: real_study FILE PROTOCOL SEED KIND FINISHED OPEN [HOW]\n");
    return 2;
  }
  const std::filesystem::path file = arguments[1];
  const Protocol protocol = load_protocol(arguments[2]);
  const std::uint64_t seed = std::stoull(arguments[3]);
  const SessionKind kind = session_kind_from(arguments[4]).value();
  const int finished = std::stoi(arguments[5]), open = std::stoi(arguments[6]);
  const std::string how = count > 7 ? arguments[7] : "whole";
  const std::unique_ptr<Study> study =
      std::filesystem::exists(file)
          ? Study::open(file, Study::Access::read_write)
          : Study::create(file, protocol.name, protocol.bytes, seed, {1'700'000'000'000'000'001, 5});
  int number = 1;
  for (const SessionInfo& session : study->sessions()) number += session.kind == kind ? 1 : 0;
  for (int i = 0; i < finished + open; ++i) one_session(*study, protocol, seed, kind, number + i, i < finished, how);
  study->close();
  return 0;
}

}  // namespace

}  // namespace jnd

int main(int count, char** arguments) {
  try {
    return jnd::run(count, arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "real_study: {}\n", error.what());
    return 1;
  }
}
