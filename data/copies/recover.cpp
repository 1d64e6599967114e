#include "data/copies/recover.h"

#include <algorithm>
#include <cerrno>
#include <map>
#include <set>

#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "data/copies/imported_events.h"
#include "data/copies/new_file.h"
#include "data/copies/salvage.h"
#include "data/copies/signs_of_loss.h"
#include "data/files/draft.h"
#include "data/log/event_body.h"
#include "data/log/telemetry.h"
#include "data/study/database.h"
#include "data/study/schema.h"
#include "data/study/study_facts.h"
#include "data/study/study_lock.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"
#include "protocols/reading/protocol_json.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Null where it is no JSON: the hash says what was written, not that it makes sense.
Json body_of(const StoredEvent& stored) {
  return Json::parse(stored.event.body, nullptr, false);
}

std::string text_at(const Json& body, const char* key) {
  if (!body.is_object()) return {};
  const auto found = body.find(key);
  return found != body.end() && found->is_string() ? found->get<std::string>() : std::string();
}

class Recovery {
 public:
  Recovery(const fs::path& damaged, const Salvage& salvage) : damaged_(damaged), salvage_(salvage) {
    for (const std::string& session : salvage_.sessions()) chains_.emplace(session, salvage_.chain(session));
    for (const RowPlace& place : own().kept) own_events_.push_back(salvage_.event(place));
  }

  // What the damaged file and its log say of their own size is doubted where it does not fit what was salvaged.
  void compare_with(Bytes file, Bytes log) {
    for (const auto& [session, chain] : chains_) report_.events_found += static_cast<std::int64_t>(chain.kept.size());
    SignsOfLoss signs = signs_of_loss(file, log, report_.events_found);
    report_.doubts = std::move(signs.doubts);
    report_.pages = signs.pages;
    report_.pages_missing = signs.pages_missing;
    report_.events_added = signs.events_added;
  }

  RecoveryReport write(const fs::path& to, const std::optional<fs::path>& protocol, std::int64_t unreadable,
                       Stamp stamp) {
    report_.unreadable = unreadable;
    read_sessions();
    const StudyInfo info = study_info(protocol);
    StudyWriter writer(to);
    writer.begin(info, stamp);
    for (const auto& [sha256, one] : salvage_.protocols())
      if (sha256 != info.protocol_sha256) writer.keep_protocol(sha256, one.name, one.bytes);
    copy_sessions(writer);
    writer.append(event_kind::kRecovered, recovered_body(), stamp);
    for (const Json& closing : closings_) writer.append(event_kind::kSessionClosed, closing, stamp);
    for (const StoredEvent& stored : own_events_)
      if (is_imported(stored.event.kind) && concerns_a_participant(stored))
        writer.append(stored.event.kind, body_of(stored), stamp);
    report_.verified = writer.finish(StudyWriter::Problems::kept);
    count_trials(to);
    return std::move(report_);
  }

 private:
  const SalvagedChain& own() const {
    static const SalvagedChain nothing;
    const auto found = chains_.find(kStudyChain);
    return found == chains_.end() ? nothing : found->second;
  }

  // As every command counts them. The new study is written by now: a program that is asked to end goes without.
  void count_trials(const fs::path& to) {
    try {
      for (const SessionInfo& info : Study::open(to, Study::Access::read_only)->sessions())
        for (RecoveredChain& one : report_.sessions)
          if (one.session == info.id) one.trials = info.trials_done;
    } catch (const Stopped&) {
      return;
    } catch (const StorageError&) {
      return;  // an event that cannot be read: verification has found it
    }
  }

  // An exclusion of a participant of whom nothing is left is not repeated; the old chain in study.recovered keeps it.
  bool concerns_a_participant(const StoredEvent& stored) const {
    if (stored.event.kind != event_kind::kExcluded) return true;
    const Json body = body_of(stored);
    return std::any_of(report_.sessions.begin(), report_.sessions.end(), [&](const RecoveredChain& one) {
      return one.events > 0 && one.participant == text_at(body, "participant") && one.kind == text_at(body, "kind");
    });
  }

  // What the body of a session's first or last event says of the study's own chain then: it must be among the events
  // that are left.
  bool knows_of_lost_events(const RowPlace& place, const std::set<std::string>& hashes) const {
    const std::string head = text_at(body_of(salvage_.event(place)), kStudyHeadKey);
    return !head.empty() && !hashes.contains(head);
  }

  RecoveredChain fate_of(const std::string& session, const SalvagedChain& chain) const {
    RecoveredChain one;
    one.session = session;
    one.events = static_cast<std::int64_t>(chain.kept.size());
    one.unchained = static_cast<std::int64_t>(chain.unchained.size());
    one.cut = one.unchained > 0;
    one.last_found = one.events;
    if (!chain.unchained.empty())
      one.last_found = std::max(one.last_found, salvage_.event(chain.unchained.back()).event.seq);
    if (chain.kept.empty()) return one;
    const StoredEvent last = salvage_.event(chain.kept.back());
    one.last_kind = last.event.kind;
    one.last_utc = last.utc;
    return one;
  }

  void read_sessions() {
    report_.own = fate_of(kStudyChain, own());
    report_.own.cut = report_.own.unchained > 0 || own_events_.empty();
    for (const auto& [session, chain] : chains_) {
      if (session == kStudyChain) continue;
      RecoveredChain& one = report_.sessions.emplace_back(fate_of(session, chain));
      if (chain.kept.empty()) continue;
      const Json opened = body_of(salvage_.event(chain.kept.front()));
      one.participant = text_at(opened, "participant");
      one.kind = text_at(opened, "kind");
      one.closed = one.last_kind == event_kind::kSessionClosed;
      if (const std::string seed = text_at(opened, "seed"); !seed.empty()) seeds_.push_back(seed);
      if (const std::string sha256 = text_at(opened, "protocol_sha256"); !sha256.empty()) protocols_.push_back(sha256);
    }
    // What the study's own chain says of sessions that were complete.
    std::set<std::string> told;
    for (const StoredEvent& stored : own_events_) {
      if (stored.event.kind != event_kind::kSessionClosed) continue;
      const Json closing = body_of(stored);
      const std::string session = text_at(closing, "session");
      told.insert(session);
      const auto known = std::find_if(report_.sessions.begin(), report_.sessions.end(),
                                      [&](const RecoveredChain& one) { return one.session == session; });
      if (known == report_.sessions.end())
        report_.sessions.push_back({.session = session,
                                    .participant = text_at(closing, "participant"),
                                    .kind = text_at(closing, "kind"),
                                    .cut = true});
      else if (chains_.at(session).head != text_at(closing, "head"))
        known->cut = true;
    }
    // Also what the chains said that this study was made from.
    std::set<std::string> hashes;
    bool lost_before = false;
    for (const StoredEvent& stored : own_events_) {
      hashes.insert(stored.event.hash);
      if (stored.event.kind == event_kind::kMerged || stored.event.kind == event_kind::kRecovered)
        add_kept_hashes(body_of(stored), hashes, lost_before);
    }
    const bool missed = !lost_before && std::any_of(chains_.begin(), chains_.end(), [&](const auto& one) {
      return one.first != kStudyChain && !one.second.kept.empty() &&
             (knows_of_lost_events(one.second.kept.front(), hashes) ||
              knows_of_lost_events(one.second.kept.back(), hashes));
    });
    // A session and the study's own chain are told of its end in one transaction, so that what is told to one of them
    // only was lost from the other.
    const bool untold = std::any_of(report_.sessions.begin(), report_.sessions.end(), [&](const RecoveredChain& one) {
      return one.closed && !told.contains(one.session);
    });
    if ((!untold && !missed) || own_events_.empty()) return;
    report_.own.cut = true;
    report_.doubts.emplace_back(
        "the end of the study's own events is lost: exclusions, notes or an unblinding may be missing");
  }

  // From what hashes protect best to what they do not.
  StudyInfo study_info(const std::optional<fs::path>& file) {
    std::vector<std::string> seeds, protocols;
    if (!own_events_.empty()) {
      const Json created = body_of(own_events_.front());
      seeds.push_back(text_at(created, "seed"));
      protocols.push_back(text_at(created, "protocol_sha256"));
    } else {
      report_.doubts.emplace_back(
          "the study's own events are lost: its exclusions, notes and unblindings are not in the new study");
    }
    for (const Salvage::FoundStudy& one : salvage_.studies()) {
      seeds.push_back(one.seed);
      protocols.push_back(one.protocol_sha256);
    }
    seeds.insert(seeds.end(), seeds_.begin(), seeds_.end());
    protocols.insert(protocols.end(), protocols_.begin(), protocols_.end());
    if (seeds.empty())
      throw StorageError(fmt::format(
          "{}: nothing of a study was found in it: no event follows from a first one; take the latest backup",
          damaged_.string()));
    StudyInfo info;
    const std::optional<std::uint64_t> seed = seed_from(seeds.front());
    if (!seed)
      throw StorageError(
          fmt::format("{}: its seed \"{}\" is not a number of 64 bits", damaged_.string(), seeds.front()));
    info.seed = *seed;
    info.protocol_sha256 = protocols.empty() ? std::string() : protocols.front();
    if (const auto found = salvage_.protocols().find(info.protocol_sha256); found != salvage_.protocols().end()) {
      info.protocol_name = found->second.name;
      info.protocol_bytes = found->second.bytes;
      return info;
    }
    return with_protocol_of(file, std::move(info));
  }

  StudyInfo with_protocol_of(const std::optional<fs::path>& file, StudyInfo info) {
    if (!file)
      throw StorageError(
          fmt::format("{}: its copy of the protocol is lost; give the protocol's file with --protocol (SHA-256 {})",
                      damaged_.string(), info.protocol_sha256));
    info.protocol_bytes = read_input_file(*file);
    const std::string found = sha256_hex(info.protocol_bytes);
    if (found != info.protocol_sha256)
      throw StorageError(fmt::format("{}: is not the protocol of this study: it has SHA-256 {}, the study names {}",
                                     file->string(), found, info.protocol_sha256));
    info.protocol_name = file->stem().string();
    report_.doubts.emplace_back("the study's copy of its protocol is lost; the file given has the same SHA-256");
    return info;
  }

  void copy_sessions(StudyWriter& writer) {
    for (RecoveredChain& one : report_.sessions) {
      const auto chain = chains_.find(one.session);
      if (chain == chains_.end()) continue;
      for (const RowPlace& place : chain->second.kept) {
        stop_if_requested();
        const StoredEvent stored = salvage_.event(place);
        std::vector<TelemetryBlob> blobs;
        for (const TelemetryBlob& named : named_telemetry(body_of(stored))) {
          if (std::optional<TelemetryBlob> blob = salvage_.telemetry(named)) {
            blobs.push_back(std::move(*blob));
            ++one.telemetry;
          } else {
            ++one.telemetry_lost;
            lost_.push_back({{"session", one.session}, {"seq", stored.event.seq}, {"interval", named.interval}});
          }
        }
        writer.copy(stored, blobs);
      }
      if (one.closed)
        closings_.push_back({{"session", one.session},
                             {"participant", one.participant},
                             {"kind", one.kind},
                             {"head", chain->second.head}});
    }
  }

  Json recovered_body() const {
    Json sessions = Json::array();
    for (const RecoveredChain& one : report_.sessions)
      sessions.push_back({{"session", one.session},
                          {"events", one.events},
                          {"unchained", one.unchained},
                          {"telemetry", one.telemetry},
                          {"telemetry_lost", one.telemetry_lost},
                          {"closed", one.closed},
                          {"cut", one.cut}});
    Json chain = Json::array(), unchained = Json::array();
    for (const StoredEvent& stored : own_events_) chain.push_back(kept_event(stored));
    for (const RowPlace& place : own().unchained) unchained.push_back(kept_event(salvage_.event(place)));
    return {{"file", damaged_.filename().string()},
            {"seeds", std::set<std::string>(seeds_.begin(), seeds_.end())},
            {"protocols", std::set<std::string>(protocols_.begin(), protocols_.end())},
            {"unreadable_bytes", report_.unreadable},
            {"doubts", report_.doubts},
            {"sessions", std::move(sessions)},
            {"telemetry_lost", lost_},
            {"study_events_lost", report_.own.cut},
            {"study_events", std::move(chain)},
            {"study_events_unchained", std::move(unchained)}};
  }

  fs::path damaged_;
  const Salvage& salvage_;
  std::map<std::string, SalvagedChain> chains_;  // by session
  std::vector<StoredEvent> own_events_;
  std::vector<std::string> seeds_, protocols_;  // that sessions name, in their order
  std::vector<Json> closings_;
  Json lost_ = Json::array();
  RecoveryReport report_;
};

// The header says so where it is readable (https://sqlite.org/fileformat2.html, section 1.3).
void refuse_before_release(const fs::path& path, Bytes file) {
  constexpr std::size_t kHeader = 100, kApplicationIdAt = 68;
  if (file.size() >= kHeader && big_endian(file, kApplicationIdAt, 4) == kApplicationIdBeforeRelease)
    throw written_before_release(path);
}

}  // namespace

bool RecoveryReport::whole() const noexcept {
  return unreadable == 0 && doubts.empty() && !own.cut && verified.problems.empty() &&
         std::none_of(sessions.begin(), sessions.end(),
                      [](const RecoveredChain& one) { return one.cut || one.telemetry_lost > 0; });
}

RecoveryReport recover(const fs::path& damaged, const fs::path& to, const std::optional<fs::path>& protocol,
                       Stamp stamp) {
  std::error_code error;
  const fs::file_status status = fs::status(damaged, error);
  if (!fs::status_known(status) || status.type() == fs::file_type::not_found) throw cannot_read(damaged, error.value());
  if (fs::is_directory(status)) throw cannot_read(damaged, EISDIR);
  refuse_beside(damaged, to);
  refuse_in_use(damaged);
  const fs::path folder = folder_of(to);
  const PrivateCopy file(damaged, folder), log(damaged.string() + "-wal", folder);
  refuse_before_release(damaged, file.bytes());
  const Salvage salvage(file.bytes(), log.bytes());
  Recovery recovery(damaged, salvage);
  recovery.compare_with(file.bytes(), log.bytes());
  return recovery.write(to, protocol, file.unreadable() + log.unreadable(), stamp);
}

}  // namespace jnd
