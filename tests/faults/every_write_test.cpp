// The disk is full, or fails, at every write and every sync of a short session, one by one: the operator hears of it in
// one clear message, and the session comes to the same final table, whether they wait until there is room or give up.
//
// A full disk that is waited for, and every failed sync, come at each step; the other kinds at every seventh.
// JND_CAMPAIGN=7 takes each step of each kind.
#include <fmt/format.h>
#include <sqlite3.h>

#include "tests/campaign.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"
#include "tests/faults/faulty_vfs.h"
#include "tests/faults/study_session.h"

namespace jnd::test {
namespace {

struct Kind {
  const char* name;
  Step step;
  int code;
  double arrived;
};

// From the first on, so many steps apart.
int stride(const Kind& kind, bool lasting) {
  return campaign_stride(kind.step == Step::sync || (kind.code == SQLITE_FULL && !lasting) ? 1 : 7);
}

constexpr Kind kKinds[] = {{"disk full at a write", Step::write, SQLITE_FULL, 0.5},
                           {"I/O error at a write", Step::write, SQLITE_IOERR_WRITE, 0},
                           {"I/O error at a sync", Step::sync, SQLITE_IOERR_FSYNC, 0}};

// Every step of this kind that an undisturbed session takes.
int steps_of_a_session(Step step) {
  FaultyDisk& disk = use_faulty_disk();
  disk.start_afresh();
  const TemporaryFolder folder;
  OperatorView view;
  StudySession(folder / "study.jnd", SessionKind::pilot).run(view);
  return disk.count(step);
}

// One message that names the file, the fault and what to do.
void check_message(const std::string& message) {
  CAPTURE(message);
  CHECK(message.find("study.jnd") != std::string::npos);
  CHECK((message.find("disk is full") != std::string::npos || message.find("disk reported") != std::string::npos ||
         message.find("cannot be") != std::string::npos));
  CHECK(message.find('\n') == std::string::npos);
}

struct Tally {
  int struck = 0, waited = 0, gave_up = 0, unnoticed = 0;
};

// A start of the program during which the fault strikes; afterwards the fault is lifted and the program is started
// until the session is done.
void strike(const PlannedFault& fault, bool waits, Tally& tally) {
  FaultyDisk& disk = use_faulty_disk();
  disk.start_afresh();
  const TemporaryFolder folder;
  StudySession session(folder / "study.jnd", SessionKind::pilot);
  OperatorView view;
  // An operator who makes room and tries again, or gives up.
  view.on_trouble = [&] {
    if (waits) disk.lift();
    return waits;
  };
  disk.fail(fault);
  std::string message;
  bool in_session = false;
  try {
    session.run(view);
  } catch (const StorageError& error) {
    message = error.what();
    in_session = session.phase() == Phase::session;
    // Only the disk is to blame, and a trial may be tried again: those who catch it can tell.
    if (in_session) CHECK(dynamic_cast<const StorageTrouble*>(&error) != nullptr);
  }
  REQUIRE(disk.struck() > 0);
  ++tally.struck;
  disk.lift();
  for (const std::string& trouble : view.troubles) check_message(trouble);
  if (!message.empty()) check_message(message);
  if (!view.troubles.empty()) ++(waits ? tally.waited : tally.gave_up);
  if (view.troubles.empty() && message.empty()) ++tally.unnoticed;  // at a checkpoint, which comes again by itself
  // Who waits in the middle of the session is not thrown out of it.
  if (waits && !view.troubles.empty()) CHECK_FALSE(in_session);
  if (session.phase() != Phase::done) {
    REQUIRE(session.check(view.acknowledged) == "");
    session.run(view);
  }
  std::map<int, TableRow> table;
  REQUIRE(session.check(view.acknowledged, &table) == "");
  REQUIRE((table == session.expected_table()));
  REQUIRE_FALSE(std::filesystem::exists((folder / "study.jnd-wal").string()));
}

TEST_CASE("Disk full and I/O errors at every write and sync: a message, and the same final table", "[storage]") {
  for (const Kind& kind : kKinds) {
    const int steps = steps_of_a_session(kind.step);
    REQUIRE(steps > 20);
    for (const bool lasting : {false, true}) {
      Tally tally;
      for (int nth = 1; nth <= steps; nth += stride(kind, lasting)) {
        CAPTURE(kind.name, lasting, nth);
        strike({kind.step, nth, kind.code, lasting, kind.arrived}, !lasting, tally);
      }
      fmt::print(
          "{}, {}, {} of {} steps: {} waited for, {} given up on, {} at checkpoints; the same table every time\n",
          kind.name, lasting ? "until the operator gave up" : "once", tally.struck, steps, tally.waited, tally.gave_up,
          tally.unnoticed);
    }
  }
}

TEST_CASE("A disk that fills up at any byte of a session pauses it until there is room", "[storage]") {
  FaultyDisk& disk = use_faulty_disk();
  for (std::int64_t room = 0; room <= 400'000; room += 26'001) {
    disk.start_afresh();
    const TemporaryFolder folder;
    StudySession session(folder / "study.jnd", SessionKind::pilot);
    OperatorView view;
    view.on_trouble = [&] {
      disk.lift();
      return true;
    };
    disk.leave_room(room);
    CAPTURE(room);
    try {
      session.run(view);
    } catch (const StorageError& error) {
      check_message(error.what());
      CHECK(session.phase() != Phase::session);
    }
    disk.lift();
    if (session.phase() != Phase::done) session.run(view);
    std::map<int, TableRow> table;
    REQUIRE(session.check(view.acknowledged, &table) == "");
    REQUIRE((table == session.expected_table()));
  }
}

}  // namespace
}  // namespace jnd::test
