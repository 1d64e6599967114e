#include "data/copies/recover.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "data/copies/damaged_file.h"
#include "data/copies/new_file.h"
#include "data/copies/salvage.h"
#include "data/copies/study_writer.h"
#include "data/files/draft.h"
#include "data/log/event_body.h"
#include "data/log/telemetry.h"
#include "data/study/database.h"
#include "data/study/schema.h"
#include "data/study/study_facts.h"
#include "data/study/study_lock.h"
#include "protocols/input/json_text.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"
#include "protocols/reading/protocol_json.h"

namespace jnd {

namespace {

struct SignsOfLoss {
  std::vector<std::string> doubts;           // in words; empty where the file says that nothing is missing
  std::optional<std::int64_t> pages;         // that the file had by its header; none where that is damaged
  std::int64_t pages_missing = 0;            // of them, neither in the file nor in its log
  std::optional<std::int64_t> events_added;  // ever, by the study's own count; none where that is lost
};

constexpr std::size_t kHeader = 100;
constexpr std::string_view kMagic("SQLite format 3\0", 16);

// What the first page says (https://sqlite.org/fileformat2.html, section 1.3).
struct FileHeader {
  PageGeometry geometry;
  std::uint32_t pages = 0;
  bool logged = false;  // in write-ahead mode, as a study is until it is closed
};

// None where it is damaged: sizes that cannot be, or a page count of another state of the file than the rest.
std::optional<FileHeader> header_of(Bytes page) {
  if (page.size() < kHeader || !std::equal(kMagic.begin(), kMagic.end(), page.begin(),
                                           [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; }))
    return std::nullopt;
  const auto number = [&](std::size_t at, std::size_t length) { return big_endian(page, at, length); };
  const std::size_t stated = number(16, 2), size = stated == 1 ? 65536 : stated, reserved = page[20];
  const bool possible = size >= 512 && (size & (size - 1)) == 0 && size - reserved >= 480;
  FileHeader header{{size, size - reserved}, number(28, 4), page[18] == 2 || page[19] == 2};
  if (!possible || header.pages == 0 || number(24, 4) != number(92, 4)) return std::nullopt;
  return header;
}

// The newest first page: of the log, else of the file.
std::optional<FileHeader> newest_header(Bytes file, Bytes log) {
  std::optional<FileHeader> header = header_of(file);
  for (const PageGeometry& geometry : geometries_of(file, log))
    for (const LogPage& page : pages_of_log(log, geometry))
      if (page.number == 1)
        if (std::optional<FileHeader> newer = header_of(page.bytes)) header = newer;
  return header;
}

// Without counting page by page: a damaged header may say any number.
std::size_t missing_pages(Bytes file, Bytes log, const FileHeader& header) {
  const std::size_t whole = file.size() / header.geometry.page_size;
  if (header.pages <= whole) return 0;
  std::set<std::uint32_t> behind;
  for (const LogPage& page : pages_of_log(log, header.geometry))
    if (page.number > whole && page.number <= header.pages) behind.insert(page.number);
  return header.pages - whole - behind.size();
}

// The number in the only row of the table `tally`: a leaf with one cell, which ends with the page and holds a NULL (the
// row's own number) and an integer.
std::optional<std::int64_t> tally_in(Bytes page, const PageGeometry& geometry) {
  constexpr std::size_t kCell = 12;  // where the page says at which byte its first cell begins, and behind it
  if (page.size() < geometry.page_size || page[0] != 0x0D || big_endian(page, 3, 2) != 1) return std::nullopt;
  const std::size_t at = big_endian(page, 8, 2);
  if (at < kCell || at + 5 > geometry.usable) return std::nullopt;
  const std::size_t payload = page[at], serial = page[at + 4];
  constexpr std::array<std::size_t, 7> kLength = {0, 1, 2, 3, 4, 6, 8};
  const bool constant = serial == 8 || serial == 9;
  const std::size_t length = constant ? 0 : serial < kLength.size() ? kLength[serial] : page.size();
  if (page[at + 1] != 1 || page[at + 2] != 3 || page[at + 3] != 0 || serial == 0 || payload != 3 + length ||
      at + 2 + payload != geometry.usable)
    return std::nullopt;
  if (constant) return static_cast<std::int64_t>(serial - 8);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < length; ++i) value = value << 8U | page[at + 5 + i];
  return static_cast<std::int64_t>(value);
}

// It only ever rises: of all versions of the page the highest number is the newest.
std::optional<std::int64_t> highest_tally(Bytes file, Bytes log, const PageGeometry& geometry) {
  std::optional<std::int64_t> highest;
  const auto look = [&](Bytes page) {
    if (const std::optional<std::int64_t> found = tally_in(page, geometry)) highest = std::max(highest, found);
  };
  for (std::size_t at = geometry.page_size; at + geometry.page_size <= file.size(); at += geometry.page_size)
    look(file.subspan(at, geometry.page_size));
  for (const LogPage& page : pages_of_log(log, geometry)) look(page.bytes);
  return highest;
}

// What speaks against everything having been found. found: events whose hashes follow from each other, of all chains.
SignsOfLoss signs_of_loss(Bytes file, Bytes log, std::int64_t found) {
  SignsOfLoss signs;
  const std::optional<FileHeader> header = newest_header(file, log);
  if (!header) {
    signs.doubts.emplace_back(
        "the file's header is damaged: how long the file was, and how many events were in it, is not known");
    return signs;
  }
  signs.pages = header->pages;
  if (header->logged && log.empty())
    signs.doubts.emplace_back(
        "the study was not closed, and its log (-wal) is missing or empty: whether something was only in the log is "
        "not known");
  signs.pages_missing = static_cast<std::int64_t>(missing_pages(file, log, *header));
  if (signs.pages_missing > 0)
    signs.doubts.push_back(fmt::format("the file ends early: {} of its {} pages are missing, and what was on them",
                                       signs.pages_missing, header->pages));
  const std::optional<std::int64_t> added = signs.events_added = highest_tally(file, log, header->geometry);
  if (!added)
    signs.doubts.emplace_back("the count of the study's events is lost: whether all of them were found is not known");
  else if (*added < found)
    signs.doubts.push_back(fmt::format(
        "the newest count of the study's events is lost ({} are counted, {} were found): whether all of them were "
        "found is not known",
        *added, found));
  else if (*added != found)
    signs.doubts.push_back(fmt::format("{} events were added to the study, and {} of them were found", *added, found));
  return signs;
}

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Null where it is no JSON: the hash says what was written, not that it makes sense.
Json body_of(const StoredEvent& stored) {
  return json_if_valid(stored.event.body);
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

  void doubt(std::string why) { report_.doubts.push_back(std::move(why)); }

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
  std::optional<Salvage> salvage(std::in_place, file.bytes(), log.bytes());
  const bool foreign = salvage->is_mixed();
  if (foreign) salvage.emplace(file.bytes(), Bytes());
  Recovery recovery(damaged, *salvage);
  recovery.compare_with(file.bytes(), foreign ? Bytes() : log.bytes());
  if (foreign) recovery.doubt("the log (-wal) beside the file belongs to another study and was left out");
  return recovery.write(to, protocol, file.unreadable() + log.unreadable(), stamp);
}

}  // namespace jnd
