#include "data/verify/verify_session.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "data/log/body_numbers.h"
#include "data/log/plain_name.h"
#include "data/log/storage_error.h"
#include "data/verify/verify_fields.h"
#include "protocols/course/prescription.h"
#include "protocols/planning/allotment.h"
#include "protocols/tasks/task.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

bool within(int place, std::size_t size) noexcept {
  return place >= 0 && place < static_cast<int>(size);
}

}  // namespace

void SessionCheck::add(const Event& event, const std::string& what, Reveals reveals) {
  const std::string where = fmt::format("Session {}, event {}", session_, event.seq);
  report_.problems.push_back({where, fmt::format("{}: {}", where, what), reveals});
}

void SessionCheck::check(const Event& event, const Json& body) {
  check_fields(event.kind, body);
  if (closed_) open_problem(event, "({}): comes after session.closed.", event.kind);
  if (event.kind == event_kind::kSessionOpened) {
    open(event, body);
  } else if (event.kind == event_kind::kSessionClosed) {
    closed_ = true;
  } else if (event.kind == event_kind::kTrialBegan) {
    check_began(event, body);
  } else if (event.kind == event_kind::kTrialCompleted) {
    check_completed(event, body);
  } else if (event.kind == event_kind::kTrialVoided) {
    check_voided(event, body);
  } else if (event.kind == event_kind::kTrialsShort) {
    check_planned(event, trial_from(body));
  } else if (event.kind == event_kind::kBlockEnded) {
    check_block_ended(event, body);
  } else if (event.kind == event_kind::kDeviceFault) {
    if (body.contains("index") && !explorations_.contains(whole_at(body, "index")))
      planned_index(event, whole_at(body, "index"));
  } else if (event.kind == event_kind::kExploration || event.kind == event_kind::kExplorationVoided ||
             event.kind == event_kind::kExplorationBegan) {
    check_exploration(event, body);
  }
}

void SessionCheck::open(const Event& event, const Json& body) {
  if (event.seq != 1) open_problem(event, "session.opened is not the first event.");
  opened_ = true;
  participant_ = body.at("participant").get<std::string>();
  if (!plain_name(participant_)) open_problem(event, "the participant code cannot be one.");
  kind_ = body.at("kind").get<std::string>();
  participant_number_ = whole_at(body, "participant_number");
  number_ = whole_or(body, "session_number", 1);
  seed_ = body.at("seed").get<std::string>();
  if (!session_kind_from(kind_)) open_problem(event, "unknown kind of session \"{}\".", kind_);
  if (!facts_.seeds.contains(seed_) || !facts_.protocols.contains(body.at("protocol_sha256").get<std::string>()))
    problem(event, "was opened for another study (its seed or protocol is not this study's).");
  else
    make_the_plan();
  if (protocol_ != nullptr && !has_plan_)
    open_problem(event, "no plan for session {} of participant number {}, so that no trial can be compared with it.",
                 number_, participant_number_);
  if (has_plan_) check_group(event, body);
}

// Numbers are allotted to groups by the study's seed, or by the group that the operator said.
void SessionCheck::check_group(const Event& event, const Json& body) {
  const auto found = body.find("group");
  const std::string recorded = found != body.end() && found->is_string() ? found->get<std::string>() : std::string();
  const std::string_view allotted = group_name(*protocol_, group_);
  if (recorded == allotted) return;
  problem(event, "is of group \"{}\"; participant number {} is allotted to {}.", recorded, participant_number_,
          group_ ? fmt::format("\"{}\"", allotted) : "none, the protocol has no groups");
}

void SessionCheck::make_the_plan() {
  const std::optional<std::uint64_t> seed = seed_from(seed_);
  if (protocol_ == nullptr || !seed) return;
  try {
    const Plan plan = make_plan(*protocol_, participant_number_, *seed, number_);
    group_ = plan.group;
    for (const Trial& trial : plan.trials) planned_[trial.index] = trial;
    for (const ExplorationSlot& slot : plan.explorations) explorations_[slot.index] = slot;
    adaptive_.emplace(*protocol_);
    has_plan_ = true;
  } catch (const std::invalid_argument&) {
    planned_.clear();
  }
}

bool SessionCheck::planned_index(const Event& event, int index) {
  if (!has_plan_ || planned_.contains(index)) return has_plan_;
  open_problem(event, "trial {} is not in the plan of participant {}.", index, participant_);
  return false;
}

std::vector<SessionCheck::Given>::iterator SessionCheck::given(int index) {
  return std::find_if(given_.begin(), given_.end(), [&](const Given& one) { return one.trial.index == index; });
}

void SessionCheck::check_began(const Event& event, const Json& body) {
  const int index = whole_at(body, "index");
  if (pending_)
    open_problem(event, "trial {} began while trial {}, which had begun before, had neither an answer nor a void.",
                 index, pending_->index);
  pending_ = PendingTrial{index, whole_at(body, "attempt")};
  if (planned_index(event, index) && given(index) != given_.end())
    open_problem(event, "trial {} began although it was answered, and its answer was not taken back.", index);
}

void SessionCheck::check_completed(const Event& event, const Json& body) {
  const TrialRecord record = trial_record_from(body);
  const Trial& trial = record.trial;
  if (!trial.practice) ++report_.trials;
  if (given(trial.index) != given_.end()) open_problem(event, "trial {} was completed before.", trial.index);
  if (given_up_.contains(trial.index))
    open_problem(event, "trial {} was completed after its block had been ended.", trial.index);
  if (pending_ && (pending_->index != trial.index || pending_->attempt != record.attempt))
    open_problem(event, "trial {}, attempt {}, was completed while trial {}, attempt {}, was presented.", trial.index,
                 record.attempt, pending_->index, pending_->attempt);
  pending_.reset();
  check_planned(event, trial);
  // As planned, so that one changed trial is one problem.
  const auto planned = planned_.find(trial.index);
  if (planned != planned_.end()) adaptive_->answered(planned->second, record.answer);
  given_.push_back({trial, planned != planned_.end() ? planned->second : trial, record.attempt, record.answer});
  const std::optional<bool> correct = is_correct(trial, record.answer);
  const Json& told = body.at("correct");
  if ((told.is_null() ? std::nullopt : std::optional(told.get<bool>())) != correct ||
      body.at("saturated_share").get<double>() != largest_saturated_share(record))
    problem(event, "trial {}: \"correct\" or \"saturated_share\" contradicts the rest of the event.", trial.index);
  check_names(event, record);
  check_settings(event, record);
  if (has_plan_ && within(trial.condition, protocol_->conditions.size()) &&
      record.breach != breach_of(trial, record.presentations, *protocol_))
    problem(event, "trial {}: \"breach\" is not what follows from its presentations.", trial.index);
}

// A setting that was accepted is the last that was presented, each one came from the one before it, and the first is
// where the trial was planned to start.
void SessionCheck::check_settings(const Event& event, const TrialRecord& record) {
  if (!has_plan_) return;
  const Task& task = task_of(protocol_->task.kind);
  const std::vector<double>& settings = record.settings;
  if (task.adjusts() == settings.empty()) {
    problem(event, "trial {}: \"settings\" {}.", record.trial.index,
            settings.empty() ? "are missing" : "belong to a task whose answers move a stimulus");
    return;
  }
  if (settings.empty() || !within(record.trial.series, protocol_->series.size())) return;
  Intervals now = record.trial.stimuli;
  bool follows = settings.front() == now[now.size() - 1];
  for (std::size_t i = 1; i < settings.size() && follows; ++i) {
    follows = false;
    for (int said = 0; said < static_cast<int>(protocol_->task.classes.size()); ++said) {
      const std::optional<Intervals> next = task.moved(now, {.said = said}, record.trial, *protocol_);
      if (!next || (*next)[now.size() - 1] != settings[i]) continue;
      now = *next;
      follows = true;
      break;
    }
  }
  if (!follows || record.answer.number != settings.back())
    problem(event, "trial {}: \"settings\" are not the way from its start to its answer.", record.trial.index);
}

void SessionCheck::check_names(const Event& event, const TrialRecord& record) {
  if (!has_plan_) return;
  const Trial& trial = record.trial;
  if (!record.answer.number && record.answer_word != said_word(protocol_->task, record.answer.said))
    problem(event, "trial {}: the answer {} is not the word of what was said.", trial.index, record.answer_word);
  if (within(trial.series, protocol_->series.size()) && within(trial.condition, protocol_->conditions.size()) &&
      (record.series_name != protocol_->series[static_cast<std::size_t>(trial.series)].name ||
       record.condition_name != protocol_->conditions[static_cast<std::size_t>(trial.condition)].name))
    problem(event, "trial {}: series {} or condition {} is not the name that the protocol gives it.", trial.index,
            record.series_name, record.condition_name);
}

// An answer that is taken back no longer moves the levels. What was presented is then compared with the answer's own
// event: the levels have moved on since.
void SessionCheck::check_voided(const Event& event, const Json& body) {
  ++report_.voided;
  const Trial trial = trial_from(body);
  if (pending_ && pending_->index == trial.index) pending_.reset();
  const auto answer = given(trial.index);
  if (answer == given_.end() || answer->attempt != whole_at(body, "attempt")) {
    if (answer != given_.end())
      open_problem(event, "trial {}: attempt {} is voided, but attempt {} was answered.", trial.index,
                   whole_at(body, "attempt"), answer->attempt);
    check_planned(event, trial);
    return;
  }
  if (answer->trial != trial)
    problem(event, "trial {}: takes an answer back, but is not the trial that was answered.", trial.index);
  if (!trial.practice) --report_.trials;
  given_.erase(answer);
  replay_answers();
}

void SessionCheck::replay_answers() {
  if (!has_plan_) return;
  adaptive_.emplace(*protocol_);
  for (const Given& one : given_)
    if (planned_.contains(one.trial.index)) adaptive_->answered(one.planned, one.answer);
}

void SessionCheck::check_block_ended(const Event& event, const Json& body) {
  const int block = whole_at(body, "block");
  for (const Json& place : body.at("trials")) {
    const int index = whole(place);
    if (!has_plan_ || !planned_index(event, index)) continue;
    const Trial& trial = planned_.at(index);
    if (!trial.practice && trial.block != block)
      open_problem(event, "trial {} is given up with block {}, but is of block {}.", index, block, trial.block);
    if (given(index) != given_.end()) open_problem(event, "trial {} is given up although it was answered.", index);
    // Practice may come again after an interruption.
    if (!trial.practice) given_up_.insert(index);
  }
}

void SessionCheck::check_exploration(const Event& event, const Json& body) {
  const int index = whole_at(body, "index");
  if (!has_plan_) return;
  const auto planned = explorations_.find(index);
  if (planned == explorations_.end()) {
    open_problem(event, "free interaction {} is not in the plan of participant {}.", index, participant_);
    return;
  }
  if (event.kind == event_kind::kExplorationVoided) explored_.erase(index);
  if (event.kind != event_kind::kExploration) return;
  if (!explored_.insert(index).second) open_problem(event, "free interaction {} was completed before.", index);
  const ExplorationSlot& slot = planned->second;
  const std::string condition = protocol_->conditions.at(static_cast<std::size_t>(slot.condition)).name;
  const std::string object =
      protocol_->explore ? protocol_->explore->objects.at(static_cast<std::size_t>(slot.object)) : std::string();
  if (whole_at(body, "block") != slot.block || body.at("condition").get<std::string>() != condition ||
      body.at("object").get<std::string>() != object)
    problem(event,
            "free interaction {} was with {} in condition {}; the plan of participant {} has {} in condition {}.",
            index, body.at("object").get<std::string>(), body.at("condition").get<std::string>(), participant_, object,
            condition);
}

void SessionCheck::check_planned(const Event& event, Trial trial) {
  if (!planned_index(event, trial.index)) return;
  // An adaptive level follows from the answers up to here.
  const Trial planned = adaptive_->resolved(planned_.at(trial.index));
  if (adaptive_->over(planned))
    problem(event, "trial {} comes after its track, {} of condition {}, had ended.", trial.index, planned.track,
            planned.condition + 1);
  // Older sessions have sums that were not rounded.
  const auto nearly = [&](double a, double b) {
    return std::abs(a - b) <= 1e-11 * (std::abs(b) + std::abs(planned.standard));
  };
  if (nearly(trial.standard, planned.standard)) trial.standard = planned.standard;
  if (std::equal(trial.stimuli.begin(), trial.stimuli.end(), planned.stimuli.begin(), planned.stimuli.end(), nearly))
    trial.stimuli = planned.stimuli;
  check_presented(event, trial, planned);
}

void SessionCheck::check_presented(const Event& event, const Trial& trial, const Trial& planned) {
  if (planned.stimuli != trial.stimuli || planned.unit != trial.unit) {
    problem(event, "trial {} presented {} {}; the plan of participant {} has {} {}{}.", trial.index,
            fmt::join(trial.stimuli, " and "), to_string(trial.unit), participant_, fmt::join(planned.stimuli, " and "),
            to_string(planned.unit), planned.track > 0 ? " after the answers before it" : "");
  } else if (planned != trial) {
    problem(event, "trial {}: its block, series or condition is not the one planned for participant {}.", trial.index,
            participant_);
  }
}

}  // namespace jnd
