#include "tests/faults/study_session.h"

#include <fmt/format.h>

#include "data/log/event_body.h"
#include "data/log/replay.h"
#include "data/verify/verify.h"
#include "protocols/tasks/task.h"

namespace jnd::test {

namespace {

constexpr const char* kSessionId = "P01-session";

int rule(const Trial& trial) {
  return trial.index % 3 == 0 ? kClassDifferent : (trial.target == kClassSame) ? kClassSame : kClassDifferent;
}

const SessionInfo* only_session(const std::vector<SessionInfo>& sessions) {
  return sessions.empty() ? nullptr : &sessions.front();
}

}  // namespace

NewSession first_session(SessionKind kind, const Plan& plan) {
  NewSession session;
  session.id = kSessionId;
  session.participant = "P01";
  session.participant_number = 1;
  session.kind = kind;
  session.responder = "keyboard";
  session.rig = "ideal";
  session.rig_mode = "ideal";
  session.tracker = "none";
  session.trials_total = main_trial_count(plan);
  session.stamp = {1'700'000'000'000'000'000, 1};
  return session;
}

Protocol short_protocol() {
  return small_protocol(nlohmann::json::parse(R"({
    "series": [{"name": "1", "pair": [500, 900]}],
    "practice": {"trials": 2, "series": "1", "criterion_correct": 0, "max_rounds": 1},
    "breaks": [{"after": "block", "duration_s": 30}],
    "questions": [{"id": "effort", "when": "after-condition", "kind": "rating", "text": "Effort?", "min": 1, "max": 9,
                   "low": "none", "high": "much"}]
  })"));
}

std::string_view to_string(Phase phase) noexcept {
  switch (phase) {
    case Phase::create:
      return "create";
    case Phase::open:
      return "open";
    case Phase::session:
      return "session";
    case Phase::close:
      return "close";
    case Phase::done:
      return "done";
  }
  return "";
}

void OperatorView::saved(const TrialOutline&, const Answer& answer) {
  acknowledged[asked_last()] = answer.said;
}

bool OperatorView::storage_trouble(const std::string& message) {
  troubles.push_back(message);
  return on_trouble();
}

StudySession::StudySession(std::filesystem::path path, SessionKind kind)
    : path_(std::move(path)), kind_(kind), protocol_(short_protocol()) {}

void StudySession::run(OperatorView& view) {
  const bool exists = std::filesystem::exists(path_);
  phase_ = exists ? Phase::open : Phase::create;
  const auto study = exists ? Study::open(path_, Study::Access::read_write)
                            : Study::create(path_, protocol_.name, protocol_.bytes, kStudySeed, {1, 1});
  const Plan plan = make_plan(protocol_, 1, study->info().seed);
  const std::vector<SessionInfo> sessions = study->sessions();
  const SessionInfo* begun = only_session(sessions);
  if (begun == nullptr || begun->state == "open") {
    phase_ = Phase::session;
    SimulatedClock clock(1'700'000'000'000'000'000);
    const auto log =
        begun == nullptr ? study->open_session(first_session(kind_, plan)) : study->resume_session(begun->id);
    const SessionState state = replay(log->events());
    clock.sleep_until_ns(state.last_monotonic_ns + 1);
    if (begun != nullptr) log->append(event_kind::kSessionResumed, {{"gap_s", 1}}, {clock.utc_ns(), clock.now_ns()});
    IdealRig rig(clock);
    RuleResponder responder(clock);
    int asked = 0;
    responder.rule = [&](const TrialQuestion& question) {
      asked = question.trial.index;
      return std::optional(rule(question.trial));
    };
    view.asked_last = [&] { return asked; };
    const Interrupts interrupts;
    const SessionParts parts{.protocol = protocol_,
                             .plan = plan,
                             .rig = rig,
                             .responder = responder,
                             .log = *log,
                             .clock = clock,
                             .view = view,
                             .interrupts = interrupts,
                             .record = RecordPolicy::events,
                             .person = true};
    if (SessionEngine(parts).run(state) != SessionEnd::completed)
      throw std::logic_error("the session ended though nobody had asked for it");
    phase_ = Phase::close;
    study->close_session(kSessionId, {clock.utc_ns(), clock.now_ns()});
  }
  phase_ = Phase::close;
  study->close();
  phase_ = Phase::done;
}

std::string StudySession::check(const std::map<int, int>& acknowledged, std::map<int, TableRow>* table) const {
  if (!std::filesystem::exists(path_))
    return acknowledged.empty() && phase_ == Phase::create ? "" : "the study is gone";
  const auto study = Study::open(path_, Study::Access::read_only);
  if (const VerifyReport report = verify(*study); !report.problems.empty())
    return "verify: " + report.problems.front().text;
  const StudyInfo& info = study->info();
  const Plan plan = make_plan(parse_protocol(info.protocol_bytes, info.protocol_name), 1, info.seed);
  if (plan.trials != make_plan(protocol_, 1, kStudySeed).trials) return "the plan is another one";
  std::map<int, TableRow> rows;
  for (const SessionInfo& session : study->sessions())
    for (const TrialRecord& record : replay(study->events(session.id)).completed) {
      const std::size_t place = static_cast<std::size_t>(record.trial.index) - 1;
      if (place >= plan.trials.size() || record.trial != plan.trials[place])
        return fmt::format("trial {} is not the planned one", record.trial.index);
      for (const Presentation& presentation : record.presentations)
        if (presentation.fingers.size() != 2) return fmt::format("trial {} is torn", record.trial.index);
      rows[record.trial.index] = {record.trial, record.answer.said};
    }
  for (const auto& [index, answer] : acknowledged)
    if (!rows.contains(index) || rows.at(index).answer != answer)
      return fmt::format("the acknowledged answer to trial {} is lost", index);
  if (table != nullptr) *table = std::move(rows);
  return "";
}

std::map<int, TableRow> StudySession::expected_table() const {
  std::map<int, TableRow> rows;
  for (const Trial& trial : make_plan(protocol_, 1, kStudySeed).trials) rows[trial.index] = {trial, rule(trial)};
  return rows;
}

}  // namespace jnd::test
