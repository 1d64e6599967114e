#include "data/study/continuation.h"

#include <cstdint>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "data/log/chain.h"

namespace jnd {

namespace {

// The events of a file in the order in which they were added.
class Rows {
 public:
  explicit Rows(SQLite::Database& database)
      : query_(database,
               "SELECT rowid, session, hash, seq, kind, utc, monotonic_ns, version, body FROM event NOT INDEXED ORDER "
               "BY rowid") {}

  bool next() {
    if (count > 0) heads_[session_] = hash;
    if (!query_.executeStep()) return false;
    ++count;
    row = query_.getColumn(0).getInt64();
    session_ = query_.getColumn(1).getString();
    hash = query_.getColumn(2).getString();
    return true;
  }
  // Whether its hash follows from the event before it in its session.
  bool follows() {
    Event event;
    event.session = session_;
    event.seq = query_.getColumn(3).getInt64();
    event.kind = query_.getColumn(4).getString();
    event.stamp.monotonic_ns = query_.getColumn(6).getInt64();
    event.version = query_.getColumn(7).getString();
    event.body = query_.getColumn(8).getString();
    return event_hash(heads_[session_], event, query_.getColumn(5).getString()) == hash;
  }
  std::string name() { return fmt::format("event {} of session {}", query_.getColumn(3).getInt64(), session_); }

  std::int64_t count = 0, row = 0;
  std::string hash;

 private:
  SQLite::Statement query_;
  std::string session_;
  std::map<std::string, std::string> heads_;  // by session: hash of the event before this one
};

std::int64_t tally_of(SQLite::Database& database) {
  return database.execAndGet("SELECT events FROM tally").getInt64();
}

// As far as the file can be read.
class OwnRows {
 public:
  explicit OwnRows(SQLite::Database* database) : database_(database) {
    if (database_ == nullptr) return;
    try {
      rows_.emplace(*database_);
    } catch (const SQLite::Exception&) {
      return;
    }
    next();
  }

  void next() {
    try {
      if (rows_->next()) return;
      counts_ = rows_->count == tally_of(*database_);
    } catch (const SQLite::Exception&) {
      counts_ = false;
    }
    rows_.reset();
  }
  Rows* at() { return rows_ ? &*rows_ : nullptr; }
  // Whether all of it was read, as many events as were ever added.
  bool counts() const noexcept { return counts_; }

 private:
  SQLite::Database* database_;
  std::optional<Rows> rows_;
  bool counts_ = false;
};

}  // namespace

std::string why_no_continuation(SQLite::Database* alone, SQLite::Database& both) {
  const auto lacks = [](Rows& row) { return row.name() + " is not in it"; };
  OwnRows own(alone);
  Rows all(both);
  while (all.next()) {
    // A row that does not follow is one of a page that was cut short: no event was ever that.
    for (; own.at() != nullptr && own.at()->row < all.row; own.next())
      if (own.at()->follows()) return lacks(*own.at());
    const bool same_row = own.at() != nullptr && own.at()->row == all.row;
    const bool known = same_row && own.at()->hash == all.hash;
    if (same_row && !known && own.at()->follows()) return lacks(*own.at());
    if (!known && !all.follows()) return all.name() + " in it does not follow from the event before it";
    if (same_row) own.next();
  }
  for (; own.at() != nullptr; own.next())
    if (own.at()->follows()) return lacks(*own.at());
  if (own.counts() && tally_of(both) != all.count) return "its count of events is another";
  return {};
}

}  // namespace jnd
