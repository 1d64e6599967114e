// Sessions of free interaction, with the answers to their questions.
#pragma once

#include <memory>
#include <string>

#include "data/log/exploration_body.h"
#include "data/log/replay.h"
#include "tests/data/study_fixture.h"

namespace jnd {

inline const Protocol& experiment2() {
  static const Protocol protocol =
      load_protocol(std::string(JND_SOURCE_DIR) + "/protocols/chinello2017-experiment2.json");
  return protocol;
}

// A session in which every item has the rating `c` in C and `n` in N.
inline void run_exploration(Study& study, int number, int c, int n, const std::string& preference,
                            double duration_s = 150) {
  const Protocol& protocol = experiment2();
  const NewSession session = new_session(number);
  const std::unique_ptr<SessionLog> log = study.open_session(session);
  std::int64_t now = 100;
  const auto stamp = [&now] { return Stamp{1'700'000'001'000'000'000 + ++now, now}; };
  int done = 0;
  for (const ExplorationSlot& slot : make_plan(protocol, number, kSeed).explorations) {
    ExplorationRecord record = exploration_of(protocol, slot, 1);
    record.duration_s = duration_s;
    record.ended_early = duration_s < slot.duration_s;
    log->append(event_kind::kExploration, to_body(record, protocol.stimulus.unit), stamp());
    if (++done % 2 != 0) continue;
    const std::string& condition = protocol.conditions[static_cast<std::size_t>(slot.condition)].name;
    for (const Question& question : protocol.questions)
      if (question.when == Question::When::after_condition)
        log->append(event_kind::kQuestionAnswered,
                    question_body(question, condition, std::to_string(condition == "C" ? c : n), done), stamp());
  }
  for (const Question& question : protocol.questions) {
    if (question.when != Question::When::after_session) continue;
    const std::string answer = question.kind == Question::Kind::choice ? preference : "7";
    log->append(event_kind::kQuestionAnswered, question_body(question, "", answer, 0), stamp());
  }
  study.close_session(session.id, {1'700'000'900'000'000'000, 900});
}

}  // namespace jnd
