#include "data/verify/verify_deep.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include "data/files/draft.h"
#include "data/log/event_body.h"
#include "data/log/exploration_body.h"
#include "data/log/telemetry.h"
#include "data/log/trace_blob.h"
#include "data/study/study_impl.h"
#include "data/study/study_lock.h"
#include "data/verify/verify_course.h"
#include "data/verify/verify_delivery.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_text.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

class DeepVerifier {
 public:
  explicit DeepVerifier(const Study& study) : study_(study) {}

  DeepReport run() {
    read_file();
    look_beside();
    try {
      const Protocol protocol = parse_protocol(study_.info().protocol_bytes, study_.info().protocol_name);
      for (const SessionInfo& session : study_.sessions()) check_session(protocol, session);
    } catch (const InputError& error) {
      of_file("The stored protocol cannot be read: {}", error.what());
    }
    return std::move(report_);
  }

 private:
  void problem(const Event& event, const std::string& what, Reveals reveals = Reveals::plan) {
    const std::string where = fmt::format("Session {}, event {} ({})", event.session, event.seq, event.kind);
    report_.problems.push_back({where, fmt::format("{}: {}.", where, what), reveals});
  }

  template <typename... Arguments>
  void of_file(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    report_.problems.push_back(
        {"The file", fmt::format(text, std::forward<Arguments>(arguments)...), Reveals::nothing});
  }

  // Through SQLite's own handle: closing another descriptor of this file would drop the locks of this process.
  void read_file() {
    const Study::Impl& impl = study_.impl();
    const std::scoped_lock lock(impl.mutex);
    sqlite3_file* file = nullptr;
    sqlite3_int64 size = 0;
    if (sqlite3_file_control(impl.database().getHandle(), "main", SQLITE_FCNTL_FILE_POINTER, &file) != SQLITE_OK ||
        file == nullptr || file->pMethods == nullptr || file->pMethods->xFileSize(file, &size) != SQLITE_OK)
      throw StorageError(fmt::format("{}: cannot be read", impl.path.string()));
    std::vector<char> piece(1U << 20U);
    for (sqlite3_int64 at = 0; at < size; at += static_cast<sqlite3_int64>(piece.size())) {
      const auto length = static_cast<int>(std::min(size - at, static_cast<sqlite3_int64>(piece.size())));
      if (file->pMethods->xRead(file, piece.data(), length, at) != SQLITE_OK)
        of_file("The file: bytes {} to {} cannot be read from the disk.", at, at + length - 1);
      else
        report_.bytes += length;
    }
    const auto pages = [&](const char* pragma) {
      return with_storage_errors(impl.path, [&] { return impl.database().execAndGet(pragma).getInt64(); });
    };
    const std::int64_t expected = pages("PRAGMA page_count") * pages("PRAGMA page_size");
    const bool log = fs::exists(impl.path.string() + "-wal");
    if (size != expected && !log) of_file("The file: has {} bytes; its header says {}.", size, expected);
  }

  void look_beside() {
    const fs::path& path = study_.impl().path;
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return;
    if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0)
      of_file("The file: others may write to it (mode {:o}); chmod 600 ends that.",
              static_cast<unsigned>(status.st_mode) & 0777U);
    else if ((status.st_mode & (S_IRGRP | S_IROTH)) != 0)
      report_.findings.push_back(fmt::format("others may read the file (mode {:o}); chmod 600 ends that",
                                             static_cast<unsigned>(status.st_mode) & 0777U));
    const auto beside = [&](const char* suffix) {
      std::error_code ignored;
      return fs::exists(path.string() + suffix, ignored);
    };
    if (in_use(path)) {
      report_.findings.emplace_back("a session or another command is writing to this study just now");
    } else {
      if (beside(".lock"))
        report_.findings.push_back(fmt::format("{}.lock was left by a program that was killed; the next one removes it",
                                               path.filename().string()));
      if (beside("-wal") || beside("-journal"))
        report_.findings.emplace_back(
            "a program that wrote to this study was killed; what it had saved is here, and the next one that writes "
            "puts it into the file");
    }
    for (const fs::path& draft : left_drafts(path))
      report_.findings.push_back(
          fmt::format("{} was left by a program that was killed before it had finished it", draft.filename().string()));
  }

  void check_session(const Protocol& protocol, const SessionInfo& session) {
    const std::vector<Event> events = study_.events(session.id);
    if (events.empty()) return;
    try {
      const Plan plan = make_plan(protocol, session.participant_number, seed_of(events.front()), session.number);
      check_course(protocol, plan, events, [this](const Event& event, const std::string& what, Reveals reveals) {
        problem(event, what, reveals);
      });
      ++report_.sessions;
      for (const Event& event : events) check_telemetry(protocol, event);
    } catch (const std::invalid_argument& error) {
      problem(events.front(), fmt::format("there is no plan: {}", error.what()));
    } catch (const Json::exception& error) {
      problem(events.front(), fmt::format("an event of this session cannot be read: {}", error.what()));
    } catch (const StorageError& error) {
      problem(events.front(), fmt::format("an event of this session cannot be read: {}", error.what()));
    }
  }

  static std::uint64_t seed_of(const Event& opened) {
    const auto text = json_from(opened.body).at("seed").get<std::string>();
    const std::optional<std::uint64_t> seed = seed_from(text);
    if (!seed) throw StorageError(fmt::format("the seed \"{}\" is not a number of 64 bits", text));
    return *seed;
  }

  void check_telemetry(const Protocol& protocol, const Event& event) {
    const bool exploration = event.kind == event_kind::kExploration;
    if (event.kind != event_kind::kTrialCompleted && !exploration) return;
    const std::vector<TelemetryBlob> blobs = study_.telemetry(event.session, event.seq);
    if (blobs.empty()) return;
    const Json body = json_from(event.body);
    const Unit unit = protocol.stimulus.unit;
    for (const TelemetryBlob& blob : blobs) {
      if (is_trace(blob.bytes)) continue;  // nothing of the event was computed from it
      const Telemetry telemetry = decode_telemetry(blob.bytes);
      const auto tell = [&](const std::string& what) {
        problem(event, exploration ? what : fmt::format("interval {}: {}", blob.interval + 1, what));
      };
      ++report_.intervals;
      if (exploration) {
        report_.numbers += check_delivery(exploration_from(body, unit).presentations, telemetry, unit, tell);
        continue;
      }
      const TrialRecord record = trial_record_from(body);
      const auto condition = static_cast<std::size_t>(record.trial.condition);
      if (condition >= protocol.conditions.size() || blob.interval < 0 ||
          static_cast<std::size_t>(blob.interval) >= record.presentations.size())
        continue;  // verify says so
      report_.numbers += check_delivery(record.presentations[static_cast<std::size_t>(blob.interval)], telemetry,
                                        protocol.conditions[condition].cues, unit, tell);
    }
  }

  const Study& study_;
  DeepReport report_;
};

}  // namespace

DeepReport verify_deep(const Study& study) {
  return DeepVerifier(study).run();
}

}  // namespace jnd
