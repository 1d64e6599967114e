// Power is lost at random writes, syncs and renames of sessions that flush every answer: what was acknowledged is
// there, nothing is torn, and the session comes to the same end.
//
// There are 90 in all, times JND_CAMPAIGN. Everything follows from the seed of each case.
#include <fmt/format.h>

#include "data/log/event_body.h"
#include "data/log/replay.h"
#include "data/verify/verify.h"
#include "tests/campaign.h"
#include "tests/catch.h"
#include "tests/data/older_study.h"
#include "tests/faults/faulty_vfs.h"
#include "tests/faults/study_session.h"

namespace jnd::test {
namespace {

int power_losses() {
  return campaign(90);
}

int below(std::mt19937_64& generator, int bound) {
  return static_cast<int>(generator() % static_cast<std::uint64_t>(bound));
}

// How many changes of the disk an undisturbed session makes from `begin` on, to where the study is closed.
int changes_of_a_session() {
  FaultyDisk& disk = use_faulty_disk();
  disk.start_afresh();
  const TemporaryFolder folder;
  OperatorView view;
  StudySession(folder / "study.jnd", SessionKind::pilot).run(view);
  return disk.changes();
}

TEST_CASE("An acknowledged answer survives every power cut", "[power_loss]") {
  FaultyDisk& disk = use_faulty_disk();
  const int changes = changes_of_a_session();
  const int wanted = power_losses();
  std::map<Phase, int> where;
  int losses = 0, studies = 0;
  std::size_t acknowledged = 0;
  while (losses < wanted) {
    const auto seed = static_cast<std::uint64_t>(++studies);
    std::mt19937_64 generator(seed);
    disk.start_afresh();
    const TemporaryFolder folder;
    StudySession session(folder / "study.jnd", studies % 2 == 0 ? SessionKind::real : SessionKind::pilot);
    OperatorView view;
    std::map<int, TableRow> table;
    for (bool completed = false; !completed;) {
      CAPTURE(seed, losses);
      // Some cuts come soon after the start, where there are few changes; some never.
      disk.cut_power_at(1 + below(generator, below(generator, 3) == 0 ? 40 : changes));
      try {
        session.run(view);
        completed = true;
        disk.lift();
      } catch (const StorageError& error) {
        INFO(error.what());
        REQUIRE(disk.off());
        ++where[session.phase()];
        ++losses;
      }
      // Switched off behind the last acknowledged change: nothing told, nothing lost.
      if (disk.off()) disk.power_on(generator);
      REQUIRE(session.check(view.acknowledged, &table) == "");
    }
    REQUIRE((table == session.expected_table()));
    acknowledged += view.acknowledged.size();
  }
  std::string phases;
  for (const auto& [phase, count] : where) phases += fmt::format(", {} in {}", count, to_string(phase));
  fmt::print("{} power cuts in {} studies{}; {} acknowledged answers, 0 lost; 0 torn trials; verify clean\n", losses,
             studies, phases, acknowledged);
}

// The flush of the first trial's mark would hide that one is missing here.
TEST_CASE("What is answered before the first trial survives a power cut right behind it", "[power_loss]") {
  FaultyDisk& disk = use_faulty_disk();
  const Protocol protocol = short_protocol();
  const nlohmann::ordered_json answer = {
      {"question", "effort"}, {"condition", nullptr}, {"after_trial", 0}, {"answer", "5"}};
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    CAPTURE(seed);
    std::mt19937_64 generator(seed);
    disk.start_afresh();
    const TemporaryFolder folder;
    {
      const auto study = Study::create(folder / "study.jnd", protocol.name, protocol.bytes, kStudySeed,
                                       {1'700'000'000'000'000'000, 1});
      const auto log =
          study->open_session(first_session(SessionKind::real, make_plan(protocol, 1, study->info().seed)));
      log->append(event_kind::kQuestionAnswered, answer, {1'700'000'001'000'000'000, 2});
      disk.cut_power_at(1);
      CHECK_THROWS_AS(log->append(event_kind::kQuestionAnswered, answer, {1'700'000'002'000'000'000, 3}), StorageError);
      REQUIRE(disk.off());
    }
    disk.power_on(generator);
    const std::vector<Event> events =
        Study::open(folder / "study.jnd", Study::Access::read_only)->events("P01-session");
    REQUIRE(events.size() == 2);
    CHECK(events.back().kind == event_kind::kQuestionAnswered);
  }
}

TEST_CASE("A study of an older version survives power cuts while it is brought up to date", "[power_loss]") {
  FaultyDisk& disk = use_faulty_disk();
  disk.start_afresh();
  const TemporaryFolder folder;
  write_older_study(folder / "old.jnd");
  const std::string old = bytes_of(folder / "old.jnd");
  const std::string hashes = hashes_in(*open_database(folder / "old.jnd", false));
  const auto copy_to = [&](const std::filesystem::path& path) { std::ofstream(path, std::ios::binary) << old; };
  const auto bring_up_to_date = [](const std::filesystem::path& path) {
    const auto database = open_database(path, true, example_steps());
    with_storage_errors(path, [&] {
      begin_writing(*database);
      end_writing(*database);
    });
  };

  copy_to(folder / "undisturbed.jnd");
  disk.forget_counts();
  bring_up_to_date(folder / "undisturbed.jnd");
  const int changes = disk.changes();
  REQUIRE(changes > 10);

  const int wanted = std::max(30, power_losses() / 10);
  int losses = 0;
  for (std::uint64_t seed = 1; losses < wanted; ++seed) {
    std::mt19937_64 generator(seed);
    const auto path = folder / fmt::format("{}.jnd", seed);
    copy_to(path);
    disk.cut_power_at(1 + below(generator, changes));
    CAPTURE(seed);
    try {
      bring_up_to_date(path);
    } catch (const StorageError&) {
    }
    REQUIRE(disk.off());
    ++losses;
    disk.power_on(generator);
    for (const bool writable : {false, true}) {
      const auto database = open_database(path, writable, example_steps());
      REQUIRE(hashes_in(*database) == hashes);
      if (writable || database->tableExists("length")) REQUIRE(faults_of_second_version(*database) == "");
    }
    disk.start_afresh();
    std::filesystem::remove(path);
  }
  fmt::print("{} power cuts while a study of an older version was brought up to date: whole each time\n", losses);
}

}  // namespace
}  // namespace jnd::test
