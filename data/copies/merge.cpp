#include "data/copies/merge.h"

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "analysis/numerics/stop_request.h"
#include "data/copies/new_file.h"
#include "data/copies/study_writer.h"
#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/study/problem.h"
#include "data/study/schema.h"
#include "data/study/study.h"
#include "data/study/study_impl.h"
#include "data/study/study_lock.h"
#include "data/verify/verify.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_text.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct SourceSession {
  SessionInfo info;
  std::string seed, protocol_sha256;  // that it was opened with
};

struct SourceProtocol {
  std::string sha256, name, bytes;
};

struct SourceStudy {
  std::filesystem::path path;
  std::unique_ptr<Study> study;
  std::vector<SourceSession> sessions;
  std::vector<SourceProtocol> protocols;  // all that the file keeps
  std::vector<Event> own;                 // the study's chain
  std::vector<Problem> damage;            // what verify finds
};

std::vector<SourceProtocol> protocols_in(const Study& study) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  return with_storage_errors(impl.path, [&] {
    std::vector<SourceProtocol> protocols;
    SQLite::Statement query(impl.database(), "SELECT sha256, name, bytes FROM protocol ORDER BY sha256");
    while (query.executeStep())
      protocols.push_back(
          {query.getColumn(0).getString(), query.getColumn(1).getString(), query.getColumn(2).getString()});
    return protocols;
  });
}

SourceStudy open_source(const fs::path& path) {
  SourceStudy source;
  source.path = path;
  source.study = Study::open(path, Study::Access::read_only);
  source.damage = verify(*source.study).problems;
  if (!source.damage.empty()) return source;
  source.protocols = protocols_in(*source.study);
  source.own = source.study->events(kStudyChain);
  for (const SessionInfo& info : source.study->sessions()) {
    const std::vector<Event> events = source.study->events(info.id);
    const Json opened = json_from(events.front().body);
    source.sessions.push_back(
        {info, opened.at("seed").get<std::string>(), opened.at("protocol_sha256").get<std::string>()});
  }
  return source;
}

[[noreturn]] void refuse(const std::vector<std::string>& reasons) {
  std::string text = "these studies cannot be merged; nothing was written:";
  for (const std::string& reason : reasons) text += "\n" + reason;
  throw InputError(text);
}

// Everything that is found, so that one look shows all that is to be done.
class Conflicts {
 public:
  explicit Conflicts(const std::vector<SourceStudy>& sources) : sources_(sources) {}

  std::vector<std::string> find() {
    for (const SourceStudy& source : sources_) check_protocol(source);
    if (!reasons_.empty()) return std::move(reasons_);  // studies of their own: what they share has no meaning
    for (const SourceStudy& source : sources_)
      for (const SourceSession& session : source.sessions) check_session(source, session);
    for (const SourceStudy& source : sources_) check_exclusions(source);
    return std::move(reasons_);
  }

 private:
  using Code = std::pair<SessionKind, std::string>;
  struct Owner {
    const SourceStudy* source = nullptr;
    std::string participant;
  };

  template <typename... Arguments>
  void reason(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    reasons_.push_back(fmt::format(text, std::forward<Arguments>(arguments)...));
  }

  // JSON compared as documents: neither spaces nor the order of keys have a meaning in a protocol.
  void check_protocol(const SourceStudy& source) {
    const StudyInfo &first = sources_.front().study->info(), &info = source.study->info();
    if (info.protocol_sha256 == first.protocol_sha256 ||
        nlohmann::json::parse(info.protocol_bytes, nullptr, false) ==
            nlohmann::json::parse(first.protocol_bytes, nullptr, false))
      return;
    reason("{}: is of another protocol ({}, SHA-256 {}...) than {} ({}, {}...)", source.path.string(),
           info.protocol_name, info.protocol_sha256.substr(0, 12), sources_.front().path.string(), first.protocol_name,
           first.protocol_sha256.substr(0, 12));
  }

  void check_session(const SourceStudy& source, const SourceSession& session) {
    const SessionInfo& info = session.info;
    const auto [twin, is_new] = sessions_.emplace(info.id, &source);
    if (!is_new) {
      reason("session {} (participant {}) is in {} and in {}: the same session twice", info.id, info.participant,
             twin->second->path.string(), source.path.string());
      return;
    }
    const Owner owner{&source, info.participant};
    const auto code = codes_.emplace(Code{info.kind, info.participant}, owner).first;
    if (code->second.source != &source)
      reason("participant {} ({}) is in {} and in {}: a code stands for one person", info.participant,
             to_string(info.kind), code->second.source->path.string(), source.path.string());
    if (!info.replaced) {
      const auto number = numbers_.emplace(std::tuple{session.seed, info.kind, info.participant_number}, owner).first;
      if (number->second.source != &source)
        reason("participant number {} ({}) is {} in {} and {} in {}, with one seed: both had the same plan",
               info.participant_number, to_string(info.kind), number->second.participant,
               number->second.source->path.string(), info.participant, source.path.string());
    }
    if (info.state != "closed" && !info.excluded && session.seed != std::to_string(sources_.front().study->info().seed))
      reason(
          "session {} of participant {} in {} is still open, and nobody could go on with it in a study with another "
          "seed: finish it first, or exclude the participant, or name {} first",
          info.id, info.participant, source.path.string(), source.path.string());
  }

  void check_exclusions(const SourceStudy& source) {
    for (const Event& event : source.own) {
      if (event.kind != event_kind::kExcluded) continue;
      const Json body = json_from(event.body);
      const std::optional<SessionKind> kind = session_kind_from(body.value("kind", ""));
      if (!kind) continue;
      const std::string participant = body.value("participant", "");
      const auto found = codes_.find({*kind, participant});
      if (found != codes_.end() && found->second.source != &source)
        reason("{} excludes participant {} ({}), who is somebody else in {}", source.path.string(), participant,
               to_string(*kind), found->second.source->path.string());
    }
  }

  const std::vector<SourceStudy>& sources_;
  std::vector<std::string> reasons_;
  std::map<std::string, const SourceStudy*> sessions_;
  std::map<Code, Owner> codes_;
  std::map<std::tuple<std::string, SessionKind, int>, Owner> numbers_;
};

// Throw InputError.
void refuse_same_files(const std::vector<fs::path>& paths) {
  std::error_code ignored;
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (fs::equivalent(paths[i], paths[j], ignored))
        refuse({fmt::format("{} and {} are the same file", paths[j].string(), paths[i].string())});
}

// Reads and verifies every source; throws also what Study::open throws, all of it in one message.
std::vector<SourceStudy> open_sources(const std::vector<fs::path>& paths) {
  std::vector<SourceStudy> sources;
  std::vector<std::string> reasons;
  for (const fs::path& path : paths) {
    try {
      SourceStudy& source = sources.emplace_back(open_source(path));
      if (const std::size_t count = source.damage.size(); count > 0)
        reasons.push_back(fmt::format("{}: {} problem{}; jnd verify lists {}, jnd recover may help", path.string(),
                                      count, count == 1 ? "" : "s", count == 1 ? "it" : "them"));
    } catch (const StorageError& error) {
      reasons.emplace_back(error.what());
    }
  }
  if (!reasons.empty()) refuse(reasons);
  return sources;
}

void refuse_conflicts(const std::vector<SourceStudy>& sources) {
  if (const std::vector<std::string> reasons = Conflicts(sources).find(); !reasons.empty()) refuse(reasons);
}

StoredEvent stored(const Event& event) {
  return {event, to_iso8601(event.stamp.utc_ns)};
}

// Keeps writers out while we read, where we may say so.
std::unique_ptr<StudyLock> hold(const fs::path& study) {
  if (fs::exists(study) && ::access(folder_of(study).c_str(), W_OK) == 0) return std::make_unique<StudyLock>(study);
  refuse_in_use(study);
  return nullptr;
}

Json merged_body(const std::vector<SourceStudy>& sources) {
  std::set<std::string> seeds, protocols;
  Json described = Json::array();
  for (const SourceStudy& source : sources) {
    Json sessions = Json::array(), events = Json::array();
    for (const SourceSession& session : source.sessions) {
      seeds.insert(session.seed);
      protocols.insert(session.protocol_sha256);
      sessions.push_back({{"session", session.info.id}, {"head", session.info.head}, {"state", session.info.state}});
    }
    for (const Event& event : source.own) events.push_back(kept_event(stored(event)));
    described.push_back({{"file", source.path.filename().string()},
                         {"seed", std::to_string(source.study->info().seed)},
                         {"protocol_sha256", source.study->info().protocol_sha256},
                         {"protocol_name", source.study->info().protocol_name},
                         {"sessions", std::move(sessions)},
                         {"study_events", std::move(events)}});
  }
  return {{"seeds", seeds}, {"protocols", protocols}, {"sources", std::move(described)}};
}

void copy_session(StudyWriter& writer, const Study& study, const std::string& session, std::int64_t& events) {
  for (const Event& event : study.events(session)) {
    stop_if_requested();
    writer.copy(stored(event), study.telemetry(session, event.seq));
    ++events;
  }
}

// The rest of a source's chain that goes on to hold; `source` says where it came from, its own chain when.
void import_events(StudyWriter& writer, const SourceStudy& source, MergedSource& report, Stamp stamp) {
  for (const Event& event : source.own) {
    if (!is_imported(event.kind)) continue;
    Json body = json_from(event.body);
    if (!body.contains("source")) body["source"] = source.path.filename().string();
    writer.append(event.kind, body, stamp);
    ++report.imported;
    report.unblinded = report.unblinded || event.kind == event_kind::kUnblinded;
  }
}

}  // namespace

MergeReport merge(const std::vector<fs::path>& paths, const fs::path& to, Stamp stamp) {
  refuse_same_files(paths);
  for (const fs::path& path : paths) refuse_beside(path, to);
  std::vector<std::unique_ptr<StudyLock>> locks;
  for (const fs::path& path : paths) locks.push_back(hold(path));
  const std::vector<SourceStudy> sources = open_sources(paths);
  refuse_conflicts(sources);

  StudyWriter writer(to);
  const StudyInfo& info = sources.front().study->info();
  writer.begin(info, stamp);
  MergeReport report;
  std::set<std::string> kept = {info.protocol_sha256}, reworded;
  for (const SourceStudy& source : sources) {
    MergedSource& one = report.sources.emplace_back();
    one.file = source.path.string();
    one.sessions = static_cast<int>(source.sessions.size());
    one.reworded = source.study->info().protocol_sha256 != info.protocol_sha256;
    for (const SourceProtocol& protocol : source.protocols)
      if (kept.insert(protocol.sha256).second) {
        writer.keep_protocol(protocol.sha256, protocol.name, protocol.bytes);
        reworded.insert(protocol.sha256);
      }
    for (const SourceSession& session : source.sessions)
      copy_session(writer, *source.study, session.info.id, one.events);
  }
  writer.append(event_kind::kMerged, merged_body(sources), stamp);
  for (const std::string& sha256 : reworded)
    writer.append(event_kind::kReworded, {{"sha256", sha256}, {"protocol_sha256", info.protocol_sha256}}, stamp);
  for (const SourceStudy& source : sources)
    for (const SourceSession& session : source.sessions)
      if (session.info.state == "closed")
        writer.append(event_kind::kSessionClosed,
                      {{"session", session.info.id},
                       {"participant", session.info.participant},
                       {"kind", to_string(session.info.kind)},
                       {"head", session.info.head}},
                      stamp);
  for (std::size_t i = 0; i < sources.size(); ++i) import_events(writer, sources[i], report.sources[i], stamp);
  report.verified = writer.finish(StudyWriter::Problems::refused);
  return report;
}

}  // namespace jnd
