#include "data/copies/merge.h"

#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <unistd.h>

#include "analysis/numerics/stop_request.h"
#include "data/copies/imported_events.h"
#include "data/copies/merge_source.h"
#include "data/copies/new_file.h"
#include "data/copies/study_writer.h"
#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/study/schema.h"
#include "data/study/study_lock.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

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
    Json body = Json::parse(event.body);
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
