#include "data/verify/chain_check.h"

#include <algorithm>
#include <exception>
#include <map>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "data/log/chain.h"
#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/study/schema.h"
#include "data/study/schema_check.h"
#include "data/study/study_impl.h"
#include "protocols/input/json_text.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostAtOnce = 4096;          // events
constexpr std::size_t kMostBytesAtOnce = 1 << 24;  // of their bodies

struct ChainRow {
  Event event;
  std::string utc, before;  // before: the stored hash of the event before it in its session
  std::int64_t row = 0;     // its place in the file
  bool agrees = false;      // its hash is the one that its columns have
};

void hash_all(std::vector<ChainRow>& rows) {
  const std::size_t threads = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 8);
  const auto hash = [&rows](std::size_t from, std::size_t to) {
    for (ChainRow* row = rows.data() + from; row != rows.data() + to; ++row)
      row->agrees = event_hash(row->before, row->event, row->utc) == row->event.hash;
  };
  if (rows.size() < 2 * threads || threads == 1) return hash(0, rows.size());
  std::vector<std::exception_ptr> failures(threads);
  {
    std::vector<std::jthread> workers;
    workers.reserve(threads);
    for (std::size_t i = 0; i < threads; ++i) {
      const auto work = [&, i]() noexcept {
        try {
          hash(rows.size() * i / threads, rows.size() * (i + 1) / threads);
        } catch (...) {
          failures[i] = std::current_exception();
        }
      };
      try {
        workers.emplace_back(work);
      } catch (const std::system_error&) {
        work();  // no more threads may be made
      }
    }
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

class Walk {
 public:
  Walk(SQLite::Database& database, const StudyFacts& facts, const std::function<void(const Event&)>& each,
       ChainReport& report)
      : database_(database), facts_(facts), each_(each), report_(report) {}

  void run() {
    SQLite::Statement query(database_,
                            "SELECT session, seq, kind, utc, monotonic_ns, version, body, hash, rowid FROM event ORDER "
                            "BY session, seq");
    std::vector<ChainRow> rows;
    std::size_t bytes = 0;
    std::string session, before;
    const auto next = [&] {
      try {
        return query.executeStep();
      } catch (const SQLite::Exception&) {
        take(rows);  // what lies before the damage is told as well
        throw;
      }
    };
    while (next()) {
      ChainRow& row = rows.emplace_back();
      Event& event = row.event;
      event.session = query.getColumn(0).getString();
      event.seq = query.getColumn(1).getInt64();
      event.kind = query.getColumn(2).getString();
      row.utc = query.getColumn(3).getString();
      event.stamp.monotonic_ns = query.getColumn(4).getInt64();
      event.version = query.getColumn(5).getString();
      event.body = query.getColumn(6).getString();
      event.hash = query.getColumn(7).getString();
      row.row = query.getColumn(8).getInt64();
      if (event.session != session) before.clear();
      session = event.session;
      row.before = std::exchange(before, event.hash);  // the stored one: one change is told once, not for all behind it
      bytes += event.body.size();
      if (rows.size() < kMostAtOnce && bytes < kMostBytesAtOnce) continue;
      take(rows);
      bytes = 0;
    }
    take(rows);
    check_ends();
    check_tally();
  }

 private:
  // The chain that is walked just now, and what is kept of each.
  struct End {
    std::string hash;
    std::int64_t seq = 0, row = 0;
    bool closed = false;
  };

  template <typename... Arguments>
  void problem(const std::string& where, fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    report_.problems.push_back(
        {where, where + fmt::format(text, std::forward<Arguments>(arguments)...), Reveals::nothing});
  }

  void take(std::vector<ChainRow>& rows) {
    hash_all(rows);
    for (ChainRow& row : rows) {
      check(row);
      if (each_) each_(row.event);
    }
    rows.clear();
  }

  void check(ChainRow& row) {
    Event& event = row.event;
    ++report_.events;
    End& end = ends_[event.session];
    const bool possible = event.seq >= 1;
    if (!possible)
      problem("Session " + event.session, ": event {} has a number that no event has.", event.seq);
    else if (event.seq - 1 != end.seq)
      problem("Session " + event.session, ": event {} follows event {}: {} missing.", event.seq, end.seq,
              event.seq - 1 - end.seq);
    const std::string where = fmt::format("Session {}, event {}", event.session, event.seq);
    if (!row.agrees)
      problem(where, " ({}): its hash does not match: this event or the one before it was changed.", event.kind);
    else if (end.seq > 0 && row.row <= end.row)
      problem(where, " ({}): lies in the file before the event that it follows: rows were moved.", event.kind);
    try {
      event.stamp.utc_ns = utc_ns_from(row.utc);
    } catch (const StorageError& error) {
      problem(where, ": {}.", error.what());
    }
    if (possible) end.seq = event.seq;
    end.row = row.row;
    end.hash = event.hash;
    if (event.session == kStudyChain) return;
    if (event.kind == event_kind::kSessionClosed) end.closed = true;
    if (event.kind == event_kind::kSessionClosed || event.kind == event_kind::kSessionOpened) check_pin(event, where);
  }

  // Simulated sessions do not say when they begin what the study's own chain was then.
  void check_pin(const Event& event, const std::string& where) {
    const Json body = json_if_valid(event.body);
    if (!body.is_object() || !body.contains(kStudyHeadKey)) return;
    const Json& head = body.at(kStudyHeadKey);
    if (facts_.chain_lost || (head.is_string() && facts_.hashes.contains(head.get<std::string>()))) return;
    problem(where,
            " ({}): names an event of the study itself that is not there: events of the study (exclusions, notes, an "
            "unblinding) were changed or removed.",
            event.kind);
  }

  void check_ends() {
    if (const auto own = ends_.find(kStudyChain); own == ends_.end())
      problem("The study", "'s own events are missing.");
    else
      report_.study_head = own->second.hash;
    for (const auto& [session, end] : ends_) {
      if (session == kStudyChain) continue;
      const std::string where = "Session " + session;
      const auto head = facts_.heads.find(session);
      if (head == facts_.heads.end()) {
        if (end.closed) problem(where, ": is closed, but the study's own events do not say so.");
      } else if (head->second != end.hash) {
        problem(where, ": ends with {}, but was closed with {}: events were changed, added or removed since.", end.hash,
                head->second);
      }
    }
    for (const auto& [session, head] : facts_.heads)
      if (!ends_.contains(session))
        problem("Session " + session, ": was closed with {}, but is not in the file.", head);
  }

  void check_tally() {
    SQLite::Statement query(database_, "SELECT events FROM tally");
    const std::int64_t added = query.executeStep() ? query.getColumn(0).getInt64() : -1;
    if (added < 0)
      problem("The study", ": the count of its events is missing.");
    else if (added != report_.events)
      problem("The study", ": {} events were added to it, and {} are in it: events were removed or slipped in.", added,
              report_.events);
  }

  SQLite::Database& database_;
  const StudyFacts& facts_;
  const std::function<void(const Event&)>& each_;
  ChainReport& report_;
  std::map<std::string, End> ends_;  // of every session that was found
};

// In words that give nothing away.
std::string open_words(const Problem& problem) {
  return problem.reveals == Reveals::nothing ? problem.text : problem.where + ": cannot be read.";
}

}  // namespace

void check_chains(SQLite::Database& database, const StudyFacts& facts, const std::function<void(const Event&)>& each,
                  ChainReport& report) {
  Walk(database, facts, each, report).run();
}

ChainReport require_whole_chains(const Study& study) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  ChainReport report = with_storage_errors(impl.path, [&] {
    SQLite::Transaction reading(impl.database());  // one instant, whatever a session adds meanwhile
    std::vector<Problem> problems;
    const StudyFacts facts = study_facts(impl.database(), impl.info, problems);
    ChainReport found;
    check_chains(impl.database(), facts, {}, found);
    // The chains are read by one index, and what is computed from them by others: what those leave out is missing from
    // the results.
    if (found.problems.empty())
      if (const std::string damage = damage_in(impl.database(), "integrity_check('event')"); damage != "ok")
        problems.push_back({"The file", fmt::format("The file is damaged: {}.", damage), Reveals::nothing});
    if (sha256_hex(impl.info.protocol_bytes) != impl.info.protocol_sha256)
      problems.push_back({"The study", "The study: its protocol was changed.", Reveals::nothing});
    found.problems.insert(found.problems.end(), problems.begin(), problems.end());
    reading.commit();
    return found;
  });
  if (report.problems.empty()) return report;
  const std::size_t more = report.problems.size() - 1;
  throw BrokenChain(
      fmt::format("{}: is not what was recorded, and no results are computed from it.\n  {}{}\n  jnd verify lists what "
                  "is wrong. Go "
                  "on with a backup, or with what jnd recover makes of this file",
                  impl.path.string(), open_words(report.problems.front()),
                  more == 0 ? "" : fmt::format(" And {} more problem{}.", more, more == 1 ? "" : "s")));
}

std::string chain_line(const ChainReport& report) {
  return fmt::format("every hash agrees ({} event{}); head of the study's own chain: {}", report.events,
                     report.events == 1 ? "" : "s", report.study_head);
}

}  // namespace jnd
