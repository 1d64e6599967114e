#include "data/verify/course_of_questions.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "data/log/body_numbers.h"
#include "data/log/event_body.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

// Why an answer cannot be one to this question; empty where it can.
std::string fault_of(const Question& question, const Json& answer) {
  if (answer.is_null()) return question.required ? "needs an answer and has none" : "";
  const auto text = answer.get<std::string>();
  if (question.kind == Question::Kind::choice)
    return std::find(question.options.begin(), question.options.end(), text) == question.options.end()
               ? "has an answer that is none of its options"
               : "";
  if (question.kind != Question::Kind::rating && question.kind != Question::Kind::number) return {};
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return "has an answer that is no number";
  return number < question.min || number > question.max ? "has an answer outside its range" : "";
}

}  // namespace

CourseOfQuestions::CourseOfQuestions(const Protocol& protocol, const Plan& plan)
    : protocol_(protocol), conditions_(plan.conditions), blocks_(course_blocks(protocol, plan)) {}

std::string CourseOfQuestions::answered(const Json& body) {
  const auto id = body.at("question").get<std::string>();
  const Json& condition = body.at("condition");
  answered_.insert(
      question_key(id, condition.is_null() ? "" : condition.get<std::string>(), whole_at(body, "after_trial")));
  for (const Question& question : protocol_.questions) {
    if (question.id != id) continue;
    const std::string fault = fault_of(question, body.at("answer"));
    return fault.empty() ? "" : fmt::format("question {} {}", id, fault);
  }
  return fmt::format("question {} is not one of the protocol's", id);
}

void CourseOfQuestions::add_missing(const CoursePage& page, std::vector<std::string>& missing) const {
  for (const AskedPlace& asked : questions_on(page, protocol_, conditions_)) {
    const std::string& id = question_of(asked.question, protocol_).id;
    const std::string condition = asked.condition < 0 ? "" : condition_name(protocol_, asked.condition);
    if (!answered_.contains(question_key(id, condition, page.after_trial)))
      missing.push_back(fmt::format("question {}", id));
  }
}

std::vector<std::string> CourseOfQuestions::missing_before(int block) const {
  std::vector<std::string> missing;
  add_missing({Question::When::before_session, -1, 0}, missing);
  for (int number = 1; number < block && number <= static_cast<int>(blocks_.size()); ++number) {
    const CourseBlock& earlier = blocks_[static_cast<std::size_t>(number - 1)];
    for (const CoursePage& page : pages_after(earlier)) add_missing(page, missing);
    if (break_after(earlier, protocol_) != nullptr && !breaks_.contains(earlier.planned))
      missing.push_back(fmt::format("the break after block {}", number));
  }
  return missing;
}

std::vector<std::string> CourseOfQuestions::missing_at_end() const {
  std::vector<std::string> missing;
  add_missing({Question::When::before_session, -1, 0}, missing);
  for (const CourseBlock& block : blocks_)
    for (const CoursePage& page : pages_after(block)) add_missing(page, missing);
  add_missing({Question::When::after_session, -1, 0}, missing);
  return missing;
}

std::optional<int> CourseOfQuestions::missing_break_within(int main_done) const {
  const bool due = break_within_block(main_done, protocol_) != nullptr && !breaks_.contains(main_done);
  return due ? std::optional(main_done) : std::nullopt;
}

}  // namespace jnd
