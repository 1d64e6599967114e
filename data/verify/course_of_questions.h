// Which questions and breaks a protocol wants at which place of a session, and which of them the log has. Internal to
// verify_deep.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "protocols/course/course.h"
#include "protocols/planning/plan.h"
#include "protocols/protocol.h"

namespace jnd {

class CourseOfQuestions {
 public:
  CourseOfQuestions(const Protocol& protocol, const Plan& plan);

  // Why the body of a questionnaire.answered cannot be; empty where it can.
  std::string answered(const nlohmann::ordered_json& body);
  void took_break(int after_trial) { breaks_.insert(after_trial); }

  // What is missing before the first trial of a block of the main part, and at the end of a session, in words.
  std::vector<std::string> missing_before(int block) const;
  std::vector<std::string> missing_at_end() const;
  // After how many trials a break is due that was not taken. main_done: answered or given up.
  std::optional<int> missing_break_within(int main_done) const;

 private:
  void add_missing(const CoursePage& page, std::vector<std::string>& missing) const;

  const Protocol& protocol_;
  std::vector<int> conditions_;      // that the participant gets
  std::vector<CourseBlock> blocks_;  // in order, from block 1
  std::set<std::string> answered_;   // question_key of each
  std::set<int> breaks_;
};

}  // namespace jnd
