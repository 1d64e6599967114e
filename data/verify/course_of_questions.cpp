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
    : protocol_(protocol), conditions_(plan.conditions) {
  int planned = 0;
  const auto add = [&](int block, int condition) {
    ++planned;
    if (blocks_.empty() || blocks_.back().block != block) blocks_.push_back({block, condition, 0, false});
    blocks_.back().condition = condition;
    blocks_.back().planned = planned;
  };
  const Trial* before = nullptr;
  for (const Trial& trial : plan.trials) {
    if (trial.practice) continue;
    if (before != nullptr && before->series != trial.series && before->block != trial.block)
      blocks_.back().series_over = true;
    add(trial.block, trial.condition);
    before = &trial;
  }
  if (before != nullptr) blocks_.back().series_over = true;
  for (const ExplorationSlot& slot : plan.explorations) add(slot.block, slot.condition);
}

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

void CourseOfQuestions::add_missing(Question::When when, int condition, int after_trial,
                                    std::vector<std::string>& missing) const {
  const auto name = [&](int place) {
    return place < 0 ? std::string() : protocol_.conditions[static_cast<std::size_t>(place)].name;
  };
  const auto look = [&](const Question& question, int place) {
    if (!answered_.contains(question_key(question.id, name(place), after_trial)))
      missing.push_back(fmt::format("question {}", question.id));
  };
  for (const Question& question : protocol_.questions) {
    if (question.when != when) continue;
    if (question.per_condition) {
      for (const int one : conditions_) look(question, one);
    } else {
      look(question, condition);
    }
  }
}

void CourseOfQuestions::add_missing_after(const Block& block, std::vector<std::string>& missing) const {
  if (protocol_.design.arrangement == Arrangement::blocked)
    add_missing(Question::When::after_condition, block.condition, block.planned, missing);
  if (block.series_over) add_missing(Question::When::after_series, -1, block.planned, missing);
}

std::vector<std::string> CourseOfQuestions::missing_before(int block) const {
  std::vector<std::string> missing;
  add_missing(Question::When::before_session, -1, 0, missing);
  for (const Block& earlier : blocks_) {
    if (earlier.block >= block) break;
    add_missing_after(earlier, missing);
    const bool due = std::any_of(protocol_.breaks.begin(), protocol_.breaks.end(), [&](const Break& pause) {
      return pause.after == Break::After::block || (pause.after == Break::After::series && earlier.series_over) ||
             (pause.after == Break::After::trials && earlier.planned % pause.trials == 0);
    });
    if (due && !breaks_.contains(earlier.planned))
      missing.push_back(fmt::format("the break after block {}", earlier.block));
  }
  return missing;
}

std::vector<std::string> CourseOfQuestions::missing_at_end() const {
  std::vector<std::string> missing;
  add_missing(Question::When::before_session, -1, 0, missing);
  for (const Block& block : blocks_) add_missing_after(block, missing);
  add_missing(Question::When::after_session, -1, 0, missing);
  return missing;
}

std::optional<int> CourseOfQuestions::missing_break_within(int main_done) const {
  for (const Break& pause : protocol_.breaks)
    if (pause.after == Break::After::trials && main_done > 0 && main_done % pause.trials == 0 &&
        !breaks_.contains(main_done))
      return main_done;
  return std::nullopt;
}

}  // namespace jnd
