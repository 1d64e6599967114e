// jnd verify: recomputes every hash, and every trial's stimuli from the protocol, the seed and the participant.
// data/README.md says what this can and cannot find.
#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "data/chain.h"
#include "data/event_body.h"
#include "data/schema.h"
#include "data/study_impl.h"
#include "data/utc_time.h"
#include "data/verify_schema.h"
#include "data/verify_session.h"
#include "data/verify_telemetry.h"
#include "protocols/input_error.h"
#include "protocols/protocol_json.h"
#include "protocols/sha256.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kKnownKinds = {event_kind::kStudyCreated,
                                    event_kind::kSessionOpened,
                                    event_kind::kSessionResumed,
                                    event_kind::kSessionClosed,
                                    event_kind::kTrialCompleted,
                                    event_kind::kTrialVoided,
                                    event_kind::kTrialsShort,
                                    event_kind::kPracticeEnded,
                                    event_kind::kQuestionAnswered,
                                    event_kind::kBreakTaken,
                                    event_kind::kDeviceFault,
                                    event_kind::kStopCleared,
                                    event_kind::kRealtime,
                                    event_kind::kConnections,
                                    event_kind::kCalibration,
                                    event_kind::kTrialBegan,
                                    event_kind::kBlockEnded,
                                    event_kind::kPaused,
                                    event_kind::kContinued,
                                    event_kind::kLeft,
                                    event_kind::kNote,
                                    event_kind::kChecklist,
                                    event_kind::kInstructed,
                                    event_kind::kConsent,
                                    event_kind::kReadiness,
                                    event_kind::kExplorationBegan,
                                    event_kind::kExploration,
                                    event_kind::kExplorationVoided,
                                    event_kind::kExcluded,
                                    event_kind::kUnblinded,
                                    event_kind::kMerged,
                                    event_kind::kRecovered,
                                    event_kind::kReworded};

bool known_kind(std::string_view kind) {
  return std::find(kKnownKinds.begin(), kKnownKinds.end(), kind) != kKnownKinds.end();
}

// One chain while it is walked.
struct Walk {
  std::string session;
  std::int64_t seq = 0;
  std::string hash;
  std::unique_ptr<SessionCheck> check;  // not of the study's own chain
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
      gather_facts();
      walk_chains();
      check_heads();
      check_exclusions();
      telemetry_.finish(report_.problems);
      check_schema(study_.database(), report_.problems);
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
        if (session != kStudyChain)
          walk.check = std::make_unique<SessionCheck>(session, protocol_ ? &*protocol_ : nullptr, facts_, report_);
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
      if (walk.check)
        walk.check->check(event, body);
      else
        check_study_event(event, body);
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
    } else if (event.kind == event_kind::kExcluded) {
      const auto kind = body.at("kind").get<std::string>();
      if (!session_kind_from(kind)) problem("Study, event {}: unknown kind of session \"{}\".", event.seq, kind);
      if (!exclusions_.insert({kind, body.at("participant").get<std::string>()}).second)
        problem("Study, event {}: participant {} ({} sessions) was excluded before.", event.seq,
                body.at("participant").get<std::string>(), kind);
      body.at("reason").get<std::string>();
      body.at("replace").get<bool>();
    } else if (event.kind == event_kind::kUnblinded) {
      body.at("reason").get<std::string>();
    }
  }

  // What the study's own chain says, before any session is looked at. What cannot be read is reported on the walk.
  void gather_facts() {
    facts_.seeds.insert(std::to_string(study_.info.seed));
    facts_.protocols.insert(study_.info.protocol_sha256);
    SQLite::Statement query(study_.database(), "SELECT kind, body FROM event WHERE session = 'study' ORDER BY seq");
    while (query.executeStep()) {
      const std::string kind = query.getColumn(0).getString();
      try {
        const Json body = Json::parse(query.getColumn(1).getString());
        if (kind == event_kind::kSessionClosed) {
          const auto session = body.at("session").get<std::string>();
          if (!facts_.heads.emplace(session, body.at("head").get<std::string>()).second)
            problem("Session {}: was closed twice in the study's own events.", session);
        } else if (kind == event_kind::kMerged || kind == event_kind::kRecovered) {
          for (const Json& seed : body.at("seeds")) facts_.seeds.insert(seed.get<std::string>());
          if (kind == event_kind::kRecovered)  // a study whose own chain was lost
            for (const Json& sha256 : body.at("protocols")) facts_.protocols.insert(sha256.get<std::string>());
        } else if (kind == event_kind::kReworded) {
          facts_.protocols.insert(body.at("sha256").get<std::string>());
        } else if (kind == event_kind::kExcluded) {
          facts_.excluded[{body.at("kind").get<std::string>(), body.at("participant").get<std::string>()}] =
              body.at("replace").get<bool>();
        }
      } catch (const Json::exception& error) {
        problem("Session {}, {}: the body cannot be read: {}.", kStudyChain, kind, error.what());
      }
    }
  }

  // A participant has one number and every session once; a number is of one participant, unless that one was replaced.
  void check_participant(const SessionCheck& session, const std::string& id) {
    const auto& [kind, participant] = std::tie(session.kind(), session.participant());
    const auto [found, is_new] = numbers_.try_emplace({kind, participant}, session.participant_number());
    if (!is_new && found->second != session.participant_number())
      problem("Session {}: participant {} has number {} here and {} in another session.", id, participant,
              session.participant_number(), found->second);
    const auto [other, first] = sessions_.try_emplace({kind, participant, session.number()}, id);
    if (!first)
      problem("Session {}: is session {} of participant {}, as is session {}.", id, session.number(), participant,
              other->second);
    const auto excluded = facts_.excluded.find({kind, participant});
    if (excluded != facts_.excluded.end() && excluded->second) return;
    const auto [owner, unused] = owners_.try_emplace({kind, session.seed(), session.participant_number()}, participant);
    if (!unused && owner->second != participant)
      problem("Session {}: participants {} and {} both have number {}.", id, owner->second, participant,
              session.participant_number());
  }

  void check_exclusions() {
    for (const auto& [kind, participant] : exclusions_)
      if (!numbers_.contains({kind, participant}))
        problem("Participant {} ({} sessions) was excluded, but has no session in the file.", participant, kind);
  }

  void finish(const Walk& walk) {
    if (walk.session.empty() || walk.session == kStudyChain) {
      study_chain_ = study_chain_ || walk.session == kStudyChain;
      return;
    }
    ++report_.sessions;
    if (walk.check->opened())
      check_participant(*walk.check, walk.session);
    else
      problem("Session {}: has no session.opened.", walk.session);
    ends_[walk.session] = {walk.hash, walk.check->closed()};
  }

  void check_heads() {
    if (!study_chain_) problem("The study's own events are missing.");
    for (const auto& [session, end] : ends_) {
      const auto head = facts_.heads.find(session);
      if (head == facts_.heads.end()) {
        if (end.closed) problem("Session {}: is closed, but the study's own events do not say so.", session);
      } else if (head->second != end.hash) {
        problem("Session {}: ends with {}, but was closed with {}: events were changed, added or removed since.",
                session, end.hash, head->second);
      }
    }
    for (const auto& [session, head] : facts_.heads)
      if (!ends_.contains(session)) problem("Session {}: was closed with {}, but is not in the file.", session, head);
  }

  struct End {
    std::string hash;
    bool closed = false;
  };

  const Study::Impl& study_;
  VerifyReport report_;
  std::optional<Protocol> protocol_;
  StudyFacts facts_;
  std::map<std::string, End> ends_;  // of every session that was found
  // By kind of session and code of the participant.
  std::map<std::pair<std::string, std::string>, int> numbers_;
  std::set<std::pair<std::string, std::string>> exclusions_;
  std::map<std::tuple<std::string, std::string, int>, std::string> sessions_;  // and number of the session
  std::map<std::tuple<std::string, std::string, int>, std::string> owners_;    // by kind, seed and number
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
