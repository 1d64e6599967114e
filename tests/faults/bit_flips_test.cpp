// A bit that flips in a study is found by verify or by SQLite, or it was in bytes that nothing reads: then everything
// that the study says is as before.
//
// Six bits of each page flip, times JND_CAMPAIGN.
#include <fmt/format.h>
#include <sqlite3.h>

#include "data/verify/verify.h"
#include "tests/campaign.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"
#include "tests/faults/faulty_vfs.h"
#include "tests/faults/study_session.h"

namespace jnd::test {
namespace {

constexpr std::size_t kPage = 4096;

// Everything in the tables and views that people and analyses read; throws where it cannot be read.
std::string all_of(const std::filesystem::path& path) {
  SQLite::Database database(path.string(), SQLite::OPEN_READWRITE);
  std::string text;
  for (const char* table : {"study", "protocol", "event", "telemetry", "sessions", "trials", "voided", "participants",
                            "counts", "answers"}) {
    SQLite::Statement rows(database, fmt::format("SELECT * FROM {} ORDER BY 1, 2", table));
    while (rows.executeStep())
      for (int i = 0; i < rows.getColumnCount(); ++i) text += rows.getColumn(i).getString() + '\x1f';
  }
  return text;
}

// What the program says to the damage; empty: nothing.
std::string found(const std::filesystem::path& path) {
  try {
    const auto study = Study::open(path, Study::Access::read_only);
    const VerifyReport report = verify(*study);
    return report.problems.empty() ? "" : report.problems.front().text;
  } catch (const StorageError& error) {
    return error.what();
  }
}

void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

TEST_CASE("A flipped bit at rest is found, or nothing has changed", "[storage]") {
  FaultyDisk& disk = use_faulty_disk();
  disk.start_afresh();
  const TemporaryFolder folder;
  OperatorView view;
  StudySession(folder / "study.jnd", SessionKind::pilot).run(view);
  const std::string whole = bytes_of(folder / "study.jnd"), expected = all_of(folder / "study.jnd");
  REQUIRE(found(folder / "study.jnd") == "");
  const int each = campaign(6);
  std::mt19937_64 generator(1);
  int flips = 0, noticed = 0;
  const auto path = folder / "flipped.jnd";
  for (std::size_t page = 0; page * kPage < whole.size(); ++page)
    for (int i = 0; i < each; ++i) {
      const std::size_t byte = page * kPage + generator() % kPage;
      const int bit = static_cast<int>(generator() % 8);
      disk.start_afresh();
      write_file(path, whole);
      flip_bit_at_rest(path.string(), static_cast<std::int64_t>(byte), bit);
      CAPTURE(page, byte, bit, whole.substr(byte - std::min<std::size_t>(byte, 60), 120));
      ++flips;
      if (!found(path).empty())
        ++noticed;
      else if (all_of(path) != expected)
        FAIL("what the study says has changed, and nobody noticed");
    }
  CHECK(noticed > flips / 10);
  fmt::print("{} flipped bits on {} pages: {} found, {} in bytes that nothing reads\n", flips, whole.size() / kPage,
             noticed, flips - noticed);
}

TEST_CASE("A bit that flips on its way from the disk is found, or nothing has changed", "[storage]") {
  FaultyDisk& disk = use_faulty_disk();
  disk.start_afresh();
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  OperatorView view;
  StudySession(path, SessionKind::pilot).run(view);
  const std::string expected = all_of(path);
  disk.forget_counts();
  REQUIRE(found(path) == "");
  const int reads = disk.count(Step::read);
  std::mt19937_64 generator(1);
  int noticed = 0;
  for (int nth = 1; nth <= reads; ++nth) {
    disk.forget_counts();
    disk.flip_on_read({nth, static_cast<int>(generator() % (kPage * 8))});
    const bool was_noticed = !found(path).empty();
    noticed += was_noticed ? 1 : 0;
    // Damage may make it read less, and then the flip has not come yet.
    disk.lift();
    CAPTURE(nth);
    REQUIRE((all_of(path) == expected));
  }
  CHECK(noticed > 0);
  CHECK(reads > 10);
}

}  // namespace
}  // namespace jnd::test
