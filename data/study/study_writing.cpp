// How events reach the disk: what is flushed when, and what happens when the disk fails.
#include <fmt/format.h>
#include <sqlite3.h>

#include "data/study/schema.h"
#include "data/study/study_impl.h"

namespace jnd {

namespace {

// Checkpoints cost two flushes each; without people waiting they may come every 32 MB instead of every 4.
constexpr int kCheckpointPagesSimulated = 8000;
constexpr int kCheckpointPages = 1000;

int checkpoint_pages(bool people) noexcept {
  return people ? kCheckpointPages : kCheckpointPagesSimulated;
}

}  // namespace

void Study::Impl::synchronize(bool full) {
  if (relaxed == !full) return;
  database().exec(full ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL");
  relaxed = !full;
}

void Study::Impl::set_durability(SessionKind kind) {
  people = people || kind != SessionKind::simulated;
  synchronize(people);
  sqlite3_wal_autocheckpoint(database().getHandle(), checkpoint_pages(people));
}

// A mark may go with a power cut. No checkpoint comes with it: that would flush, and a flush that fails unseen would
// leave a hole in the write-ahead log before the answers that follow.
void Study::Impl::append_mark(const std::string& session, std::string_view kind, const std::string& body, Stamp stamp) {
  sqlite3* handle = database().getHandle();
  const auto restore = [&] {
    sqlite3_wal_autocheckpoint(handle, checkpoint_pages(people));
    synchronize(people);
  };
  synchronize(false);
  sqlite3_wal_autocheckpoint(handle, 0);
  try {
    append(session, kind, body, stamp);
  } catch (...) {
    restore();
    throw;
  }
  restore();
}

void Study::Impl::add_study_event(std::string_view kind, const std::string& body, Stamp stamp) {
  const bool was_relaxed = relaxed;
  synchronize(true);
  try {
    append(kStudyChain, kind, body, stamp);
  } catch (...) {
    synchronize(!was_relaxed);
    throw;
  }
  synchronize(!was_relaxed);
}

// A flush that failed is not made good by one that succeeds: the kernel has called the lost pages clean. So before
// anything is added after an error, all that is committed goes into the study itself, flushed there, and the
// write-ahead log begins anew.
void Study::Impl::steady() {
  if (!shaken) return;
  SQLite::Statement checkpoint(database(), "PRAGMA wal_checkpoint(TRUNCATE)");
  if (checkpoint.executeStep() && checkpoint.getColumn(0).getInt() != 0)
    throw StorageTrouble(
        fmt::format("{}: after the disk's error another program that reads the study is in the way: this event is not "
                    "saved, all earlier ones are. Close that program and try again",
                    path.string()));
  shaken = false;
}

// SQLite rolls back by itself in most cases, but does not promise it.
void Study::Impl::tidy_after_failure() const {
  if (!connection) return;
  if (insert) insert->tryReset();
  if (sqlite3_get_autocommit(connection->getHandle()) == 0)
    sqlite3_exec(connection->getHandle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

}  // namespace jnd
