// jnd verify: recomputes every hash, and every trial's stimuli from the protocol, the seed and the participant.
// data/README.md says what this can and cannot find.
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "data/chain.h"
#include "data/event_body.h"
#include "data/schema.h"
#include "data/study_impl.h"
#include "data/utc_time.h"
#include "data/verify_telemetry.h"
#include "protocols/adaptive_run.h"
#include "protocols/input_error.h"
#include "protocols/plan.h"
#include "protocols/protocol_json.h"
#include "protocols/sha256.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

bool known_kind(std::string_view kind) {
  for (const std::string_view one :
       {event_kind::kStudyCreated, event_kind::kSessionOpened, event_kind::kSessionResumed, event_kind::kSessionClosed,
        event_kind::kTrialCompleted, event_kind::kTrialVoided, event_kind::kTrialsShort, event_kind::kPracticeEnded,
        event_kind::kQuestionAnswered, event_kind::kBreakTaken, event_kind::kDeviceFault, event_kind::kStopCleared,
        event_kind::kRealtime})
    if (kind == one) return true;
  return false;
}

// One chain while it is walked.
struct Walk {
  std::string session;
  std::int64_t seq = 0;
  std::string hash;
  bool opened = false, closed = false;
  std::string kind, participant;
  std::map<int, Trial> planned;  // by index
  bool has_plan = false;
  std::optional<AdaptiveRun> adaptive;  // as far as the chain has been walked
  std::set<int> completed;
};

class Verifier {
 public:
  explicit Verifier(const Study::Impl& study) : study_(study), telemetry_(study.database()) {}

  VerifyReport run() {
    try {
      // One view of the file from beginning to end, whatever a session adds meanwhile.
      SQLite::Transaction reading(study_.database());
      check_file();
      check_protocol();
      walk_chains();
      check_heads();
      telemetry_.finish(report_.problems);
      report_.telemetry = telemetry_.blobs();
      reading.commit();
    } catch (const SQLite::Exception& error) {
      problem("The file is damaged: it could not be read to its end ({}).", error.what());
    }
    return std::move(report_);
  }

 private:
  void walk_chains() {
    SQLite::Statement query(study_.database(),
                            "SELECT session, seq, kind, utc, monotonic_ns, version, body, hash FROM event ORDER BY "
                            "session, seq");
    Walk walk;
    while (query.executeStep()) {
      const std::string session = query.getColumn(0).getString();
      if (session != walk.session) {
        finish(walk);
        walk = Walk{};
        walk.session = session;
      }
      Event event;
      event.session = session;
      event.seq = query.getColumn(1).getInt64();
      event.kind = query.getColumn(2).getString();
      const std::string utc = query.getColumn(3).getString();
      event.stamp.monotonic_ns = query.getColumn(4).getInt64();
      event.version = query.getColumn(5).getString();
      event.body = query.getColumn(6).getString();
      event.hash = query.getColumn(7).getString();
      check_chain(walk, event, utc);
      check_body(walk, event);
    }
    finish(walk);
  }

  template <typename... Arguments>
  void problem(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    report_.problems.push_back(fmt::format(text, std::forward<Arguments>(arguments)...));
  }

  void check_file() {
    SQLite::Statement check(study_.database(), "PRAGMA integrity_check(10)");
    while (check.executeStep())
      if (check.getColumn(0).getString() != "ok") problem("The file is damaged: {}.", check.getColumn(0).getString());
    SQLite::Statement keys(study_.database(), "PRAGMA foreign_key_check");
    if (keys.executeStep()) problem("Table {} refers to a row that is not there.", keys.getColumn(0).getString());
  }

  void check_protocol() {
    const StudyInfo& info = study_.info;
    const std::string found = sha256_hex(info.protocol_bytes);
    if (found != info.protocol_sha256)
      problem("The stored protocol has SHA-256 {}, but the study was created with {}.", found, info.protocol_sha256);
    try {
      protocol_ = parse_protocol(info.protocol_bytes, info.protocol_name);
    } catch (const InputError& error) {
      problem("The stored protocol cannot be read, so that no trial can be compared with its plan: {}", error.what());
    }
  }

  void check_chain(Walk& walk, const Event& event, const std::string& utc) {
    ++report_.events;
    if (event.seq != walk.seq + 1)
      problem("Session {}: event {} follows event {}: {} missing.", event.session, event.seq, walk.seq,
              event.seq - walk.seq - 1);
    walk.seq = event.seq;
    if (event_hash(walk.hash, event, utc) != event.hash)
      problem("Session {}, event {} ({}): its hash does not match: this event or the one before it was changed.",
              event.session, event.seq, event.kind);
    walk.hash = event.hash;  // the stored one: one change is reported once, not for every event after it
    if (!known_kind(event.kind))
      problem("Session {}, event {}: unknown kind \"{}\".", event.session, event.seq, event.kind);
    if (walk.closed)
      problem("Session {}, event {} ({}): comes after session.closed.", event.session, event.seq, event.kind);
    try {
      utc_ns_from(utc);
    } catch (const StorageError& error) {
      problem("Session {}, event {}: {}.", event.session, event.seq, error.what());
    }
  }

  void check_body(Walk& walk, const Event& event) {
    try {
      const Json body = Json::parse(event.body);
      telemetry_.check(event, body, report_.problems);
      if (walk.session == kStudyChain) {
        check_study_event(event, body);
      } else if (event.kind == event_kind::kSessionOpened) {
        open(walk, event, body);
      } else if (event.kind == event_kind::kSessionClosed) {
        walk.closed = true;
      } else if (event.kind == event_kind::kTrialCompleted) {
        check_completed(walk, event, body);
      } else if (event.kind == event_kind::kTrialVoided || event.kind == event_kind::kTrialsShort) {
        if (event.kind == event_kind::kTrialVoided) ++report_.voided;
        check_planned(walk, event, trial_from(body));
      } else if (event.kind == event_kind::kDeviceFault) {
        const int index = body.at("index").get<int>();
        if (walk.has_plan && !walk.planned.contains(index))
          problem("Session {}, event {}: trial {} is not in the plan of participant {}.", event.session, event.seq,
                  index, walk.participant);
      }
    } catch (const StorageError& error) {
      problem("Session {}, event {} ({}): {}.", event.session, event.seq, event.kind, error.what());
    } catch (const Json::exception& error) {
      problem("Session {}, event {} ({}): the body cannot be read: {}.", event.session, event.seq, event.kind,
              error.what());
    }
  }

  void check_study_event(const Event& event, const Json& body) {
    if (event.kind == event_kind::kStudyCreated) {
      if (body.at("seed").get<std::string>() != std::to_string(study_.info.seed))
        problem("The study's seed is {}, but study.created says {}.", study_.info.seed,
                body.at("seed").get<std::string>());
      if (body.at("protocol_sha256").get<std::string>() != study_.info.protocol_sha256)
        problem("The study's protocol is {}, but study.created says {}.", study_.info.protocol_sha256,
                body.at("protocol_sha256").get<std::string>());
    } else if (event.kind == event_kind::kSessionClosed) {
      heads_[body.at("session").get<std::string>()] = body.at("head").get<std::string>();
    }
  }

  void open(Walk& walk, const Event& event, const Json& body) {
    if (event.seq != 1)
      problem("Session {}, event {}: session.opened is not the first event.", event.session, event.seq);
    walk.opened = true;
    walk.participant = body.at("participant").get<std::string>();
    walk.kind = body.at("kind").get<std::string>();
    const int number = body.at("participant_number").get<int>();
    if (!session_kind_from(walk.kind)) problem("Session {}: unknown kind of session \"{}\".", event.session, walk.kind);
    if (body.at("seed").get<std::string>() != std::to_string(study_.info.seed) ||
        body.at("protocol_sha256").get<std::string>() != study_.info.protocol_sha256)
      problem("Session {}: was opened for another study (its seed or protocol is not this study's).", event.session);
    const auto [found, is_new] = participants_.try_emplace({walk.kind, walk.participant}, number);
    if (!is_new && found->second != number)
      problem("Session {}: participant {} has number {} here and {} in another session.", event.session,
              walk.participant, number, found->second);
    if (!protocol_) return;
    try {
      for (const Trial& trial : make_plan(*protocol_, number, study_.info.seed).trials)
        walk.planned[trial.index] = trial;
      walk.adaptive.emplace(*protocol_);
      walk.has_plan = true;
    } catch (const std::invalid_argument& error) {
      problem("Session {}: no plan for participant number {}: {}.", event.session, number, error.what());
    }
  }

  void check_completed(Walk& walk, const Event& event, const Json& body) {
    const TrialRecord record = trial_record_from(body);
    if (!record.trial.practice) ++report_.trials;
    if (!walk.completed.insert(record.trial.index).second)
      problem("Session {}, event {}: trial {} was completed before.", event.session, event.seq, record.trial.index);
    check_planned(walk, event, record.trial);
    // As planned, so that one changed trial is one problem.
    if (walk.has_plan && walk.planned.contains(record.trial.index))
      walk.adaptive->answered(walk.planned.at(record.trial.index), record.answer.judgement);
    const bool correct = (record.answer.judgement == Judgement::same) == record.trial.same;
    if (body.at("correct").get<bool>() != correct ||
        body.at("saturated_share").get<double>() != largest_saturated_share(record))
      problem("Session {}, event {}: trial {}: \"correct\" or \"saturated_share\" contradicts the rest of the event.",
              event.session, event.seq, record.trial.index);
    if (!protocol_ || !walk.has_plan) return;
    const Trial& trial = record.trial;
    if (trial.series >= 0 && trial.series < static_cast<int>(protocol_->series.size()) && trial.condition >= 0 &&
        trial.condition < static_cast<int>(protocol_->conditions.size()) &&
        (record.series_name != protocol_->series[static_cast<std::size_t>(trial.series)].name ||
         record.condition_name != protocol_->conditions[static_cast<std::size_t>(trial.condition)].name))
      problem("Session {}, event {}: trial {}: series {} or condition {} is not the name that the protocol gives it.",
              event.session, event.seq, trial.index, record.series_name, record.condition_name);
  }

  void check_planned(const Walk& walk, const Event& event, const Trial& trial) {
    if (!walk.has_plan) return;
    const auto found = walk.planned.find(trial.index);
    if (found == walk.planned.end()) {
      problem("Session {}, event {}: trial {} is not in the plan of participant {}.", event.session, event.seq,
              trial.index, walk.participant);
      return;
    }
    // An adaptive level follows from the answers up to here.
    const Trial planned = walk.adaptive->resolved(found->second);
    if (walk.adaptive->over(planned))
      problem("Session {}, event {}: trial {} comes after its track, {} of condition {}, had ended.", event.session,
              event.seq, trial.index, planned.track, planned.condition + 1);
    if (planned.stimuli != trial.stimuli || planned.unit != trial.unit) {
      problem("Session {}, event {}: trial {} presented {} and {} {}; the plan of participant {} has {} and {} {}{}.",
              event.session, event.seq, trial.index, trial.stimuli[0], trial.stimuli[1], to_string(trial.unit),
              walk.participant, planned.stimuli[0], planned.stimuli[1], to_string(planned.unit),
              planned.track > 0 ? " after the answers before it" : "");
    } else if (planned != trial) {
      problem(
          "Session {}, event {}: trial {}: its block, series or condition is not the one planned for participant {}.",
          event.session, event.seq, trial.index, walk.participant);
    }
  }

  void finish(const Walk& walk) {
    if (walk.session.empty() || walk.session == kStudyChain) {
      study_chain_ = study_chain_ || walk.session == kStudyChain;
      return;
    }
    ++report_.sessions;
    if (!walk.opened) problem("Session {}: has no session.opened.", walk.session);
    ends_[walk.session] = {walk.hash, walk.closed};
  }

  void check_heads() {
    if (!study_chain_) problem("The study's own events are missing.");
    for (const auto& [session, end] : ends_) {
      const auto head = heads_.find(session);
      if (head == heads_.end()) {
        if (end.closed) problem("Session {}: is closed, but the study's own events do not say so.", session);
      } else if (head->second != end.hash) {
        problem("Session {}: ends with {}, but was closed with {}: events were changed, added or removed since.",
                session, end.hash, head->second);
      }
    }
    for (const auto& [session, head] : heads_)
      if (!ends_.contains(session)) problem("Session {}: was closed with {}, but is not in the file.", session, head);
  }

  struct End {
    std::string hash;
    bool closed = false;
  };

  const Study::Impl& study_;
  VerifyReport report_;
  std::optional<Protocol> protocol_;
  std::map<std::string, std::string> heads_;  // what the study's chain says of closed sessions
  std::map<std::string, End> ends_;           // what was found
  std::map<std::pair<std::string, std::string>, int> participants_;
  bool study_chain_ = false;
  TelemetryCheck telemetry_;
};

}  // namespace

VerifyReport verify(const Study& study) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  return with_storage_errors(impl.path, [&] { return Verifier(impl).run(); });
}

}  // namespace jnd
