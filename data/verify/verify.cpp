#include "data/verify/verify.h"

// jnd verify: recomputes every hash, and every trial's stimuli from the protocol, the seed and the participant.
// data/README.md says what this can and cannot find.
#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "data/log/event_body.h"
#include "data/log/telemetry.h"
#include "data/log/trace_blob.h"
#include "data/study/schema.h"
#include "data/study/schema_check.h"
#include "data/study/study_facts.h"
#include "data/study/study_impl.h"
#include "data/verify/chain_check.h"
#include "data/verify/verify_fields.h"
#include "data/verify/verify_session.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_text.h"
#include "protocols/input/sha256.h"
#include "protocols/reading/protocol_json.h"

namespace jnd {

namespace {

// How many records a blob has, and how many were lost before.
std::pair<std::int64_t, std::int64_t> held_by(const std::string& bytes) {
  if (is_trace(bytes)) {
    const Trace trace = decode_trace(bytes);
    return {static_cast<std::int64_t>(trace.samples.size()), trace.dropped};
  }
  const Telemetry telemetry = decode_telemetry(bytes);
  return {static_cast<std::int64_t>(telemetry.ticks.size()), telemetry.dropped};
}

// What is wrong with a stored blob, in words; empty where nothing is.
std::string fault_of(const TelemetryBlob& stored, const TelemetryBlob& named) {
  if (sha256_hex(stored.bytes) != named.sha256) return "was changed: its SHA-256 is not the one in the event";
  if (stored.sha256 != named.sha256 || stored.ticks != named.ticks || stored.dropped != named.dropped)
    return "has a SHA-256, ticks or dropped beside it that contradict the event";
  try {
    const auto [ticks, dropped] = held_by(stored.bytes);
    if (ticks != named.ticks || dropped != named.dropped)
      return fmt::format("holds {} ticks and {} dropped ones; the event says {} and {}", ticks, dropped, named.ticks,
                         named.dropped);
  } catch (const StorageError& error) {
    return error.what();
  }
  return {};
}

// The telemetry of a study against what its events say of it.
class TelemetryCheck {
 public:
  // lost: keys of what a recovery could not save; must outlive this.
  TelemetryCheck(SQLite::Database& database, const std::set<std::string>& lost) : database_(database), lost_(lost) {}

  // For every event, in the order of session and seq: recomputes the hash of each blob that its body names, and reads
  // it. Throws StorageError where the body's "telemetry" cannot be read.
  void check(const Event& event, const nlohmann::ordered_json& body, std::vector<Problem>& problems) {
    const std::vector<TelemetryBlob> named = named_telemetry(body);
    if (named.empty()) return;
    for (const TelemetryBlob& one : named) {
      const auto problem = [&](std::string_view what) {
        const std::string where = fmt::format("Session {}, event {} ({})", event.session, event.seq, event.kind);
        problems.push_back({where, fmt::format("{}: the telemetry of interval {} {}.", where, one.interval + 1, what),
                            Reveals::nothing});
      };
      named_.push_back(telemetry_key(event.session, event.seq, one.interval));
      SQLite::Statement query(
          database_,
          "SELECT sha256, ticks, dropped, bytes FROM telemetry WHERE session = ? AND seq = ? AND interval = ?");
      query.bind(1, event.session);
      query.bind(2, event.seq);
      query.bind(3, one.interval);
      if (!query.executeStep()) {
        if (lost_.contains(named_.back()))
          ++missing_;
        else
          problem("is missing");
        continue;
      }
      ++blobs_;
      const TelemetryBlob stored{one.interval, query.getColumn(0).getString(), query.getColumn(1).getInt64(),
                                 query.getColumn(2).getInt64(), query.getColumn(3).getString()};
      if (const std::string fault = fault_of(stored, one); !fault.empty()) problem(fault);
    }
  }

  // At the end: the blobs that no event names.
  void finish(std::vector<Problem>& problems) {
    std::sort(named_.begin(), named_.end());
    SQLite::Statement query(database_, "SELECT session, seq, interval FROM telemetry ORDER BY session, seq, interval");
    while (query.executeStep()) {
      const std::string session = query.getColumn(0).getString();
      const std::int64_t seq = query.getColumn(1).getInt64();
      const int interval = query.getColumn(2).getInt();
      if (std::binary_search(named_.begin(), named_.end(), telemetry_key(session, seq, interval))) continue;
      const std::string where = fmt::format("Session {}, event {}", session, seq);
      problems.push_back(
          {where,
           fmt::format("{}: there is telemetry of interval {} that the event does not name.", where, interval + 1),
           Reveals::nothing});
    }
  }

  std::int64_t blobs() const noexcept { return blobs_; }
  std::int64_t lost() const noexcept { return missing_; }  // named, and said to be lost

 private:
  SQLite::Database& database_;
  const std::set<std::string>& lost_;
  std::int64_t blobs_ = 0, missing_ = 0;
  std::vector<std::string> named_;  // keys
};

using Json = nlohmann::ordered_json;

constexpr std::array kKnownKinds = {event_kind::kStudyCreated,      event_kind::kSessionOpened,
                                    event_kind::kSessionResumed,    event_kind::kSessionClosed,
                                    event_kind::kTrialCompleted,    event_kind::kTrialVoided,
                                    event_kind::kTrialsShort,       event_kind::kPracticeEnded,
                                    event_kind::kQuestionAnswered,  event_kind::kBreakTaken,
                                    event_kind::kDeviceFault,       event_kind::kStopCleared,
                                    event_kind::kRealtime,          event_kind::kConnections,
                                    event_kind::kCalibration,       event_kind::kTrialBegan,
                                    event_kind::kBlockEnded,        event_kind::kPaused,
                                    event_kind::kContinued,         event_kind::kLeft,
                                    event_kind::kSessionUnblinded,  event_kind::kNote,
                                    event_kind::kChecklist,         event_kind::kInstructed,
                                    event_kind::kConsent,           event_kind::kReadiness,
                                    event_kind::kExplorationBegan,  event_kind::kExploration,
                                    event_kind::kExplorationVoided, event_kind::kExcluded,
                                    event_kind::kUnblinded,         event_kind::kMerged,
                                    event_kind::kRecovered,         event_kind::kReworded};

bool known_kind(std::string_view kind) {
  return std::find(kKnownKinds.begin(), kKnownKinds.end(), kind) != kKnownKinds.end();
}

class Verifier {
 public:
  explicit Verifier(const Study::Impl& study) : study_(study) {}

  VerifyReport run() {
    try {
      // One view of the file from beginning to end, whatever a session adds meanwhile.
      SQLite::Transaction reading(study_.database());
      try {
        check_file();
      } catch (const SQLite::Exception& error) {
        throw_if_stopped(error);
        // It looks into events for their columns: which one it is comes out below.
        problem("The file", " is damaged ({}).", error.what());
      }
      facts_ = study_facts(study_.database(), study_.info, report_.problems);
      check_protocol();
      telemetry_.emplace(study_.database(), facts_.telemetry_lost);
      walk_chains();
      check_exclusions();
      telemetry_->finish(report_.problems);
      check_schema();
      reading.commit();
    } catch (const SQLite::Exception& error) {
      throw_if_stopped(error);
      problem("The file", " is damaged: it could not be read to its end ({}).", error.what());
    }
    if (telemetry_) {
      report_.telemetry = telemetry_->blobs();
      report_.telemetry_lost = telemetry_->lost();
    }
    return std::move(report_);
  }

 private:
  void walk_chains() {
    ChainReport chains;
    const auto keep = [&] {
      finish();
      report_.events = chains.events;
      report_.study_head = std::move(chains.study_head);
      // Before what follows from them.
      report_.problems.insert(report_.problems.begin(), std::make_move_iterator(chains.problems.begin()),
                              std::make_move_iterator(chains.problems.end()));
    };
    try {
      check_chains(
          study_.database(), facts_, [this](const Event& event) { take(event); }, chains);
    } catch (const SQLite::Exception&) {
      keep();
      throw;
    }
    keep();
  }

  // text: what comes behind `where`.
  template <typename... Arguments>
  void problem(const std::string& where, fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    report_.problems.push_back(
        {where, where + fmt::format(text, std::forward<Arguments>(arguments)...), Reveals::nothing});
  }
  // The same of what names the seed, or quotes an event.
  template <typename... Arguments>
  void sealed_problem(const std::string& where, fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    report_.problems.push_back({where, where + fmt::format(text, std::forward<Arguments>(arguments)...)});
  }

  void check_file() {
    SQLite::Statement check(study_.database(), "PRAGMA integrity_check(10)");
    while (check.executeStep())
      if (check.getColumn(0).getString() != "ok")
        problem("The file", " is damaged: {}.", check.getColumn(0).getString());
    SQLite::Statement keys(study_.database(), "PRAGMA foreign_key_check");
    if (keys.executeStep()) problem("Table " + keys.getColumn(0).getString(), " refers to a row that is not there.");
  }

  void check_schema() {
    for (const SchemaDifference& one : schema_differences(study_.database()))
      problem("The file", " is not as this program makes a study: {}.", to_string(one));
  }

  void check_protocol() {
    const StudyInfo& info = study_.info;
    const std::string found = sha256_hex(info.protocol_bytes);
    if (found != info.protocol_sha256)
      problem("The stored protocol", " has SHA-256 {}, but the study was created with {}.", found,
              info.protocol_sha256);
    try {
      protocol_ = parse_protocol(info.protocol_bytes, info.protocol_name);
    } catch (const InputError& error) {
      problem("The stored protocol", " cannot be read, so that no trial can be compared with its plan: {}",
              error.what());
    }
    SQLite::Statement query(study_.database(), "SELECT sha256, name, bytes FROM protocol WHERE sha256 <> ?");
    query.bind(1, info.protocol_sha256);
    while (query.executeStep()) check_other_protocol(query);
  }

  // A merged study keeps every wording of its protocol.
  void check_other_protocol(SQLite::Statement& row) {
    const std::string sha256 = row.getColumn(0).getString(), name = row.getColumn(1).getString();
    const std::string where = fmt::format("The protocol {} ({}...)", name, sha256.substr(0, 12));
    if (!facts_.protocols.contains(sha256)) problem(where, " is kept in the file, but no event of the study names it.");
    if (sha256_hex(row.getColumn(2).getString()) != sha256)
      problem(where, " does not have the SHA-256 that it has as name.");
    const auto known = facts_.protocol_names.find(sha256);
    if (known != facts_.protocol_names.end() && known->second != name)
      problem(where, " is called {} in the study's own events.", known->second);
  }

  void take(const Event& event) {
    if (event.session != session_) {
      finish();
      session_ = event.session;
      check_.reset();
      if (session_ != kStudyChain)
        check_ = std::make_unique<SessionCheck>(session_, protocol_ ? &*protocol_ : nullptr, facts_, report_);
    }
    const std::string where = fmt::format("Session {}, event {}", event.session, event.seq);
    if (!known_kind(event.kind)) problem(where, ": unknown kind \"{}\".", event.kind);
    try {
      const Json body = json_from(event.body);
      telemetry_->check(event, body, report_.problems);
      if (check_)
        check_->check(event, body);
      else
        check_study_event(event, body);
    } catch (const StorageError& error) {
      sealed_problem(where, " ({}): {}.", event.kind, error.what());
    } catch (const Json::exception& error) {
      sealed_problem(where, " ({}): the body cannot be read: {}.", event.kind, error.what());
    }
  }

  void check_study_event(const Event& event, const Json& body) {
    check_fields(event.kind, body);
    const std::string where = fmt::format("Study, event {}", event.seq);
    if ((event.kind == event_kind::kStudyCreated) != (event.seq == 1))
      problem(where, " ({}): the first event, and no other, is study.created.", event.kind);
    if (event.kind == event_kind::kExcluded) {
      const auto kind = body.at("kind").get<std::string>();
      if (!session_kind_from(kind)) problem(where, ": unknown kind of session \"{}\".", kind);
      if (!exclusions_.insert({kind, body.at("participant").get<std::string>()}).second)
        problem(where, ": participant {} ({} sessions) was excluded before.", body.at("participant").get<std::string>(),
                kind);
    }
  }

  // A participant has one number and every session once; a number is of one participant, unless that one was replaced.
  void check_participant(const SessionCheck& session) {
    const auto& [kind, participant] = std::tie(session.kind(), session.participant());
    const std::string where = "Session " + session_;
    const auto [found, is_new] = numbers_.try_emplace({kind, participant}, session.participant_number());
    if (!is_new && found->second != session.participant_number())
      problem(where, ": participant {} has number {} here and {} in another session.", participant,
              session.participant_number(), found->second);
    const auto [other, first] = sessions_.try_emplace({kind, participant, session.number()}, session_);
    if (!first)
      problem(where, ": is session {} of participant {}, as is session {}.", session.number(), participant,
              other->second);
    const auto excluded = facts_.excluded.find({kind, participant});
    if (excluded != facts_.excluded.end() && excluded->second) return;
    const auto [owner, unused] = owners_.try_emplace({kind, session.seed(), session.participant_number()}, participant);
    if (!unused && owner->second != participant)
      problem(where, ": participants {} and {} both have number {}.", owner->second, participant,
              session.participant_number());
  }

  void check_exclusions() {
    for (const auto& [kind, participant] : exclusions_)
      if (!numbers_.contains({kind, participant}))
        problem("Participant " + participant, " ({} sessions) was excluded, but has no session in the file.", kind);
  }

  // The session that was walked last.
  void finish() {
    if (!check_) return;
    ++report_.sessions;
    if (check_->opened())
      check_participant(*check_);
    else
      problem("Session " + session_, ": has no session.opened.");
    check_.reset();
  }

  const Study::Impl& study_;
  VerifyReport report_;
  std::optional<Protocol> protocol_;
  StudyFacts facts_;
  std::string session_;                  // that is walked just now
  std::unique_ptr<SessionCheck> check_;  // not of the study's own chain
  // By kind of session and code of the participant.
  std::map<std::pair<std::string, std::string>, int> numbers_;
  std::set<std::pair<std::string, std::string>> exclusions_;
  std::map<std::tuple<std::string, std::string, int>, std::string> sessions_;  // and number of the session
  std::map<std::tuple<std::string, std::string, int>, std::string> owners_;    // by kind, seed and number
  std::optional<TelemetryCheck> telemetry_;
};

}  // namespace

VerifyReport verify(const Study& study) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  return with_storage_errors(impl.path, [&] { return Verifier(impl).run(); });
}

}  // namespace jnd
