#include "data/verify/verify_course.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "data/log/body_numbers.h"
#include "data/log/event_body.h"
#include "protocols/course/course.h"
#include "protocols/input/json_text.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/tasks/task.h"

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

// Which questions and breaks a protocol wants at which place of a session, and which of them the log has.
class CourseOfQuestions {
 public:
  CourseOfQuestions(const Protocol& protocol, const Plan& plan)
      : protocol_(protocol), conditions_(plan.conditions), blocks_(course_blocks(protocol, plan)) {}

  // Why the body of a questionnaire.answered cannot be; empty where it can.
  std::string answered(const Json& body) {
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

  void took_break(int after_trial) { breaks_.insert(after_trial); }

  // What is missing before the first trial of a block of the main part, and at the end of a session, in words.
  std::vector<std::string> missing_before(int block) const {
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

  std::vector<std::string> missing_at_end() const {
    std::vector<std::string> missing;
    add_missing({Question::When::before_session, -1, 0}, missing);
    for (const CourseBlock& block : blocks_)
      for (const CoursePage& page : pages_after(block)) add_missing(page, missing);
    add_missing({Question::When::after_session, -1, 0}, missing);
    return missing;
  }

  // After how many trials a break is due that was not taken. main_done: answered or given up.
  std::optional<int> missing_break_within(int main_done) const {
    const bool due = break_within_block(main_done, protocol_) != nullptr && !breaks_.contains(main_done);
    return due ? std::optional(main_done) : std::nullopt;
  }

 private:
  void add_missing(const CoursePage& page, std::vector<std::string>& missing) const {
    for (const AskedPlace& asked : questions_on(page, protocol_, conditions_)) {
      const std::string& id = question_of(asked.question, protocol_).id;
      const std::string condition = asked.condition < 0 ? "" : condition_name(protocol_, asked.condition);
      if (!answered_.contains(question_key(id, condition, page.after_trial)))
        missing.push_back(fmt::format("question {}", id));
    }
  }

  const Protocol& protocol_;
  std::vector<int> conditions_;      // that the participant gets
  std::vector<CourseBlock> blocks_;  // in order, from block 1
  std::set<std::string> answered_;   // question_key of each
  std::set<int> breaks_;
};

// A key that came at the time-out's last instant is read a little later.
constexpr double kTimeOutSlack_s = 0.05;

class LoggedCourse {
 public:
  LoggedCourse(const Protocol& protocol, const Plan& plan, bool marks, const TellCourse& problem)
      : protocol_(protocol),
        plan_(plan),
        questions_(protocol, plan),
        adaptive_(protocol),
        marks_(marks),
        tell_(problem) {
    for (const Trial& trial : plan.trials) planned_[trial.index] = &trial;
  }

  void follow(const Event& event, const Json& body) {
    event_ = &event;
    if (event.kind == event_kind::kSessionOpened) {
      person_ = body.value("responder", "") == "keyboard";
    } else if (event.kind == event_kind::kSessionResumed) {
      resumed_ = true;
      if (body.value("practice_again", false)) practice_over_ = false;
    } else if (event.kind == event_kind::kTrialBegan) {
      begin(whole_at(body, "index"), whole_at(body, "attempt"));
      pending_ = {whole_at(body, "index"), whole_at(body, "attempt")};
    } else if (event.kind == event_kind::kTrialCompleted) {
      complete(trial_record_from(body));
    } else if (event.kind == event_kind::kTrialVoided) {
      take_void(body);
    } else if (event.kind == event_kind::kTrialsShort) {
      give_up(trial_from(body).index);
    } else if (event.kind == event_kind::kBlockEnded) {
      for (const Json& index : body.at("trials")) give_up(whole(index));
      if (body.value("practice", false)) practice_over_ = true;
    } else if (event.kind == event_kind::kPracticeEnded) {
      end_practice(body);
    } else if (event.kind == event_kind::kConsent) {
      consented_ = !body.value("refused", false);
    } else if (event.kind == event_kind::kLeft) {
      for_good_ = body.value("for_good", false);
    } else if (event.kind == event_kind::kBreakTaken) {
      questions_.took_break(whole_at(body, "after_trial"));
    } else if (event.kind == event_kind::kQuestionAnswered) {
      if (const std::string fault = questions_.answered(body); !fault.empty()) problem("{}", fault);
    } else if (event.kind == event_kind::kExploration || event.kind == event_kind::kExplorationVoided) {
      explore(body, event.kind == event_kind::kExploration);
    } else if (event.kind == event_kind::kSessionClosed) {
      close(body);
    }
  }

 private:
  struct Answered {
    Trial trial;
    int attempt = 1;
    Answer answer;
  };

  template <typename... Arguments>
  void problem(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    tell_(*event_, fmt::format(text, std::forward<Arguments>(arguments)...), Reveals::plan);
  }
  // The same of places, numbers of attempts and times, which give nothing away.
  template <typename... Arguments>
  void open_problem(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    tell_(*event_, fmt::format(text, std::forward<Arguments>(arguments)...), Reveals::nothing);
  }

  // An attempt at a trial begins here.
  void begin(int index, int attempt) {
    const auto found = planned_.find(index);
    if (found == planned_.end()) return;  // verify says so
    const Trial& trial = *found->second;
    if (pending_) open_problem("trial {} begins while trial {} has no end yet", index, pending_->index);
    int& highest = attempts_[index];
    if (attempt != highest + 1)
      open_problem("trial {}: is attempt {}, and the next one is {}", index, attempt, highest + 1);
    highest = std::max(highest, attempt);
    if (used_[index] >= protocol_.timeline.max_attempts)
      open_problem("trial {} comes again although its {} attempts were used up", index, used_[index]);
    if (finished_.contains(index)) open_problem("trial {} comes again after it was answered or given up", index);
    if (trial.practice) {
      if (practice_over_) open_problem("trial {}: is practice, which had ended", index);
    } else {
      begin_main(trial);
    }
    resumed_ = false;
  }

  void give_up(int index) {
    const auto found = planned_.find(index);
    if (finished_.insert(index).second && found != planned_.end() && !found->second->practice) ++main_given_up_;
  }

  void begin_main(const Trial& trial) {
    if (protocol_.practice && !practice_over_) open_problem("trial {}: comes before practice had ended", trial.index);
    if (person_ && !protocol_.consent.empty() && !consented_)
      open_problem("trial {}: comes before the participant's consent", trial.index);
    if (trial.block != block_) {
      block_ = trial.block;
      for (const Trial& other : plan_.trials)
        if (!other.practice && other.block < trial.block && !finished_.contains(other.index) &&
            !adaptive_.over(other)) {
          open_problem("trial {}: of block {} comes while block {} still has trials", trial.index, trial.block,
                       other.block);
          break;
        }
      for (const std::string& missing : questions_.missing_before(trial.block))
        problem("trial {}: of block {} comes without {}, which the protocol wants before it", trial.index, trial.block,
                missing);
    }
    if (marks_ && !resumed_)
      if (const std::optional<int> due = questions_.missing_break_within(main_done_ + main_given_up_))
        open_problem("trial {}: comes before the break that is due after {} trials", trial.index, *due);
  }

  void complete(const TrialRecord& record) {
    const int index = record.trial.index;
    if (pending_ && pending_->index == index) {
      if (pending_->attempt != record.attempt)
        open_problem("trial {}: attempt {} began, and attempt {} was answered", index, pending_->attempt,
                     record.attempt);
      pending_.reset();
    } else {
      begin(index, record.attempt);
    }
    const double time_s = record.answer.response_time_s, limit_s = protocol_.timeline.answer_time_out_s;
    if (!std::isfinite(time_s) || time_s < 0)
      open_problem("trial {}: a response time of {} s cannot be", index, time_s);
    else if (limit_s > 0 && time_s > limit_s + kTimeOutSlack_s)
      open_problem("trial {}: was answered after {:.3f} s, and the time-out is {} s", index, time_s, limit_s);
    else if (record.duration_s < time_s)
      open_problem("trial {}: took {} s, less than its answer alone, {} s", index, record.duration_s, time_s);
    finished_.insert(index);
    answered_.push_back({record.trial, record.attempt, record.answer});
    if (!record.trial.practice) ++main_done_;
    if (planned_.contains(index)) adaptive_.answered(*planned_.at(index), record.answer);
  }

  // Also of an answer that is taken back.
  void take_void(const Json& body) {
    ++voided_;
    const Trial trial = trial_from(body);
    const int attempt = whole_at(body, "attempt");
    const auto answered = std::find_if(answered_.begin(), answered_.end(), [&](const Answered& one) {
      return one.trial.index == trial.index && one.attempt == attempt;
    });
    if (answered != answered_.end()) {
      if (!trial.practice) --main_done_;
      answered_.erase(answered);
      finished_.erase(trial.index);
      block_ = 0;
      adaptive_ = AdaptiveRun(protocol_);
      for (const Answered& one : answered_)
        if (planned_.contains(one.trial.index)) adaptive_.answered(*planned_.at(one.trial.index), one.answer);
    } else if (pending_ && pending_->index == trial.index && pending_->attempt == attempt) {
      pending_.reset();
    } else {
      begin(trial.index, attempt);
    }
    if (body.value("counts", true)) ++used_[trial.index];
  }

  void end_practice(const Json& body) {
    practice_over_ = true;
    if (!protocol_.practice) {
      open_problem("the protocol has no practice");
      return;
    }
    const int round = whole_at(body, "rounds");
    const double share = body.at("share_correct").get<double>();
    if (round > protocol_.practice->max_rounds)
      open_problem("practice took {} rounds, and the protocol allows {}", round, protocol_.practice->max_rounds);
    const auto trials = std::count_if(plan_.trials.begin(), plan_.trials.end(),
                                      [&](const Trial& one) { return one.practice && one.round == round; });
    const auto correct = std::count_if(answered_.begin(), answered_.end(), [&](const Answered& one) {
      return one.trial.practice && one.trial.round == round && is_correct(one.trial, one.answer).value_or(true);
    });
    const double computed = trials > 0 ? static_cast<double>(correct) / static_cast<double>(trials) : 0;
    if (std::abs(computed - share) > 1e-9)
      problem("practice ended with a share correct of {}; its answers give {}", share, computed);
    if (body.at("passed").get<bool>() != (share >= protocol_.practice->criterion_correct))
      problem("practice was {}passed, against the protocol's criterion", body.at("passed").get<bool>() ? "" : "not ");
  }

  // Objects are met in the planned order, each until it was explored for its time or given up.
  void explore(const Json& body, bool completed) {
    const int index = whole_at(body, "index");
    if (!completed) {
      if (!body.value("will_repeat", true)) explored_.insert(index);
      return;
    }
    const auto slot = std::find_if(plan_.explorations.begin(), plan_.explorations.end(),
                                   [&](const ExplorationSlot& one) { return one.index == index; });
    if (slot == plan_.explorations.end()) return open_problem("object {} is not in the plan", index);
    for (const ExplorationSlot& one : plan_.explorations)
      if (one.index < index && !explored_.contains(one.index))
        open_problem("object {} was explored before object {} was over", index, one.index);
    if (!explored_.insert(index).second) open_problem("object {} was explored after it was over", index);
    const double duration_s = body.at("duration_s").get<double>();
    if (!body.value("ended_early", false) && duration_s < slot->duration_s - kTimeOutSlack_s)
      open_problem("object {} was explored for {} s of {} s", index, duration_s, slot->duration_s);
  }

  void close(const Json& body) {
    if (whole_at(body, "trials_completed") != main_done_ || whole_at(body, "trials_voided") != voided_)
      open_problem("closes with {} trials and {} voided ones; its events are {} and {}",
                   whole_at(body, "trials_completed"), whole_at(body, "trials_voided"), main_done_, voided_);
    if (for_good_) return;  // the operator ended it, or there was no consent: short, and the log says so
    if (pending_) open_problem("closes while trial {} has no end", pending_->index);
    const auto left = std::count_if(plan_.trials.begin(), plan_.trials.end(), [&](const Trial& one) {
      return !one.practice && !finished_.contains(one.index) && !adaptive_.over(one);
    });
    if (left > 0) open_problem("closes with {} trial{} still to do", left, left == 1 ? "" : "s");
    for (const ExplorationSlot& one : plan_.explorations)
      if (!explored_.contains(one.index)) open_problem("closes before object {} was explored", one.index);
    for (const std::string& missing : questions_.missing_at_end()) problem("closes without {}", missing);
  }

  const Protocol& protocol_;
  const Plan& plan_;
  CourseOfQuestions questions_;
  AdaptiveRun adaptive_;
  bool marks_;  // the program says when a trial begins; earlier ones took fewer breaks after an interruption
  TellCourse tell_;
  const Event* event_ = nullptr;
  std::map<int, const Trial*> planned_;
  std::map<int, int> attempts_, used_;  // by trial: the highest one; those that count
  std::set<int> finished_, explored_;
  std::vector<Answered> answered_;
  std::optional<PendingTrial> pending_;
  int main_done_ = 0, main_given_up_ = 0;  // answered; breaks come after so many of both
  int voided_ = 0, block_ = 0;
  bool person_ = false, consented_ = false, practice_over_ = false, for_good_ = false, resumed_ = false;
};

}  // namespace

void check_course(const Protocol& protocol, const Plan& plan, const std::vector<Event>& events,
                  const TellCourse& problem) {
  const bool marks = std::any_of(events.begin(), events.end(),
                                 [](const Event& event) { return event.kind == event_kind::kTrialBegan; });
  LoggedCourse course(protocol, plan, marks, problem);
  for (const Event& event : events) course.follow(event, json_from(event.body));
}

}  // namespace jnd
