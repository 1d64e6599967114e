// Studies that become one, and new files that are in nobody's way.
#include "data/copies/merge.h"

#include <sys/stat.h>

#include "data/copies/backup.h"
#include "data/copies/new_file.h"
#include "data/copies/rescued_copy.h"
#include "data/study/schema.h"
#include "data/study/study_admin.h"
#include "protocols/input/input_error.h"
#include "tests/data/damage_fixture.h"

namespace jnd {
namespace {

// Studies of one protocol become one, to the letter; what does not fit is refused by name.

constexpr std::uint64_t kOtherSeed = 7;

std::unique_ptr<Study> study_with_seed(const std::filesystem::path& path, std::uint64_t seed,
                                       const std::string& protocol = tutorial().bytes) {
  return Study::create(path, "tutorial", protocol, seed, {1'700'000'000'000'000'001, 5});
}

// A whole session of a participant, with answers to the plan of the study's own seed.
void run_session(Study& study, const NewSession& session) {
  const auto log = study.open_session(session);
  for (const Trial& trial : make_plan(tutorial(), session.participant_number, study.info().seed).trials)
    log->append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), trial, usual_answer(trial))),
                stamp_of(trial));
  study.close_session(session.id, kLater);
}

NewSession session_of(const std::string& participant, int number, SessionKind kind = SessionKind::real) {
  NewSession session = new_session(number, kind);
  session.participant = participant;
  session.id = participant + "-" + std::string(to_string(kind));
  return session;
}

std::string refusal(const TemporaryFolder& folder, const std::vector<std::filesystem::path>& sources) {
  try {
    merge(sources, folder / "merged.jnd", kLater);
  } catch (const InputError& error) {
    CHECK_FALSE(std::filesystem::exists(folder / "merged.jnd"));
    CHECK_FALSE(std::filesystem::exists(folder / "merged.jnd.new"));
    return error.what();
  }
  return "";
}

TEST_CASE("merged sessions are the same to the letter, and verify", "[data]") {
  const TemporaryFolder folder;
  const auto a = filled_study(folder), b = folder / "b.jnd";
  {
    const auto study = study_with_seed(b, kOtherSeed);
    run_session(*study, session_of("Q01", 1));
    run_session(*study, session_of("Q02", 2, SessionKind::simulated));
  }
  const std::string bytes_a = bytes_of(a), bytes_b = bytes_of(b);
  const MergeReport report = merge({a, b}, folder / "merged.jnd", kLater);
  CHECK(report.verified.problems == std::vector<Problem>{});
  CHECK(report.verified.sessions == 5);
  CHECK(report.sources[0].sessions == 3);
  CHECK(report.sources[1].sessions == 2);
  const StudyContent first = content_of(a), second = content_of(b), merged = content_of(folder / "merged.jnd");
  for (const auto& [session, events] : first.events) CHECK(kept_of(first, merged, session) == events.size());
  for (const auto& [session, events] : second.events) CHECK(kept_of(second, merged, session) == events.size());
  CHECK(merged.telemetry == first.telemetry);
  CHECK(bytes_of(a) == bytes_a);
  CHECK(bytes_of(b) == bytes_b);

  // Nothing of the sources' own chains is lost.
  const auto study = Study::open(folder / "merged.jnd", Study::Access::read_only);
  CHECK(study->info().seed == kSeed);
  const auto own = study->events(kStudyChain);
  REQUIRE(own.size() == 2 + 2 + 2);
  REQUIRE(own[1].kind == event_kind::kMerged);
  const auto body = nlohmann::ordered_json::parse(own[1].body);
  CHECK(body.at("seeds") == nlohmann::ordered_json({std::to_string(kSeed), std::to_string(kOtherSeed)}));
  const std::vector<Event> own_b = Study::open(b, Study::Access::read_only)->events(kStudyChain);
  REQUIRE(body.at("sources")[1].at("study_events").size() == own_b.size());
  for (std::size_t i = 0; i < own_b.size(); ++i)
    CHECK(body.at("sources")[1].at("study_events")[i].at("hash") == own_b[i].hash);
}

TEST_CASE("exclusions, notes and unblindings of the sources go on to hold", "[data]") {
  const TemporaryFolder folder;
  const auto a = folder / "a.jnd", b = folder / "b.jnd";
  {
    const auto study = study_with_seed(a, kSeed);
    run_session(*study, session_of("P01", 1));
    run_session(*study, session_of("P02", 2));
    exclude_participant(*study, "P02", SessionKind::real, "felt ill", true, kLater);
    add_note(*study, "lab repainted", kLater);
    const auto other = study_with_seed(b, kSeed);
    run_session(*other, session_of("R02", 2));  // the number that P02 made free
    unblind(*other, "safety", kLater);
  }
  const MergeReport report = merge({a, b}, folder / "merged.jnd", kLater);
  CHECK_FALSE(report.sources[0].unblinded);
  CHECK(report.sources[1].unblinded);
  CHECK(report.sources[0].imported == 2);
  const auto study = Study::open(folder / "merged.jnd", Study::Access::read_only);
  CHECK(is_unblinded(*study));
  REQUIRE(excluded_from(*study).size() == 1);
  CHECK(excluded_from(*study)[0].participant == "P02");
  for (const SessionInfo& session : study->sessions()) CHECK(session.excluded == (session.participant == "P02"));
  // Merged once more, with another one.
  const auto c = folder / "c.jnd";
  run_session(*study_with_seed(c, kOtherSeed), session_of("S01", 1));
  CHECK(merge({folder / "merged.jnd", c}, folder / "all.jnd", kLater).verified.sessions == 4);
  CHECK(excluded_from(*Study::open(folder / "all.jnd", Study::Access::read_only)).size() == 1);
}

TEST_CASE("a protocol with other spaces means the same", "[data]") {
  const TemporaryFolder folder;
  const auto a = folder / "a.jnd", b = folder / "b.jnd";
  const std::string reworded = nlohmann::json::parse(tutorial().bytes).dump();
  run_session(*study_with_seed(a, kSeed), session_of("P01", 1));
  run_session(*study_with_seed(b, kSeed, reworded), session_of("P02", 2));
  const MergeReport report = merge({a, b}, folder / "merged.jnd", kLater);
  CHECK_FALSE(report.sources[0].reworded);
  CHECK(report.sources[1].reworded);
  CHECK(report.verified.problems == std::vector<Problem>{});
  SQLite::Database database((folder / "merged.jnd").string());
  CHECK(database.execAndGet("SELECT count(*) FROM protocol").getInt() == 2);
}

TEST_CASE("what would confuse people or plans is refused, all of it at once", "[data]") {
  const TemporaryFolder folder;
  const auto a = folder / "a.jnd", b = folder / "b.jnd", c = folder / "c.jnd", other = folder / "other.jnd";
  run_session(*study_with_seed(a, kSeed), session_of("P01", 1));
  {
    const auto study = study_with_seed(b, kSeed);
    run_session(*study, session_of("P01", 3));
    run_session(*study, session_of("X01", 1));
  }
  const std::string both = refusal(folder, {a, b});
  CHECK_THAT(both, Catch::Contains("session P01-real (participant P01) is in") && Catch::Contains("twice"));
  CHECK_THAT(both, Catch::Contains("participant number 1 (real) is P01 in"));
  {
    const auto study = study_with_seed(c, kOtherSeed);
    NewSession again = session_of("P01", 5);
    again.id = "another";
    run_session(*study, again);
    run_session(*study, session_of("Y01", 1));  // the same number under another seed is another plan
    study->open_session(session_of("Y02", 2));
  }
  const std::string with_c = refusal(folder, {a, c});
  CHECK_THAT(with_c, Catch::Contains("participant P01 (real) is in") && Catch::Contains("one person"));
  CHECK_THAT(with_c, Catch::Contains("session Y02-real") && Catch::Contains("still open"));
  CHECK_THAT(with_c, !Catch::Contains("number 1"));
  Study::create(other, "chinello2017", chinello().bytes, 3, kLater);
  CHECK_THAT(refusal(folder, {a, other}), Catch::Contains("of another protocol (chinello2017"));
  // Whatever the names of its sessions.
  Study::open(other, Study::Access::read_write)->open_session(session_of("P01", 1));
  const std::string with_other = refusal(folder, {a, other});
  CHECK_THAT(with_other, Catch::Contains("of another protocol (chinello2017") && !Catch::Contains("twice"));
  CHECK_THAT(refusal(folder, {a, folder / "." / "a.jnd"}), Catch::Contains("are the same file"));
  CHECK_THAT(refusal(folder, {a, folder / "none.jnd"}), Catch::Contains("there is no such study"));
}

TEST_CASE("damaged and busy sources are refused", "[data]") {
  const TemporaryFolder folder;
  const auto a = folder / "a.jnd", b = folder / "b.jnd";
  run_session(*study_with_seed(a, kSeed), session_of("P01", 1));
  run_session(*study_with_seed(b, kSeed), session_of("P02", 2));
  {
    const auto open = Study::open(b, Study::Access::read_write);
    CHECK_THROWS_WITH(merge({a, b}, folder / "merged.jnd", kLater), Catch::Contains("writing to this study"));
  }
  raw_sql(b, "DROP TRIGGER event_no_update; UPDATE event SET monotonic_ns = 1 WHERE seq = 7");
  CHECK_THAT(refusal(folder, {a, b}), Catch::Contains("b.jnd: ") && Catch::Contains("jnd recover"));
  CHECK_THROWS_WITH(merge({a, b}, a, kLater), Catch::Contains("is the study itself"));
  CHECK_FALSE(std::filesystem::exists(a.string() + ".lock"));
}

// What a new file is made from is never in its way.

namespace fs = std::filesystem;

TEST_CASE("a source that lies under the name of the new file's lock is refused and kept", "[data]") {
  const TemporaryFolder folder;
  const fs::path source = folder / "s.lock", to = folder / "s", other = folder / "other";
  fill_study(*new_study(source));
  Study::create(other, "tutorial", tutorial().bytes, 7, kLater)->close();
  const std::string before = bytes_of(source);
  const auto refused = Catch::Contains("would overwrite " + source.string());
  CHECK_THROWS_WITH(back_up(*Study::open(source, Study::Access::read_only), to, false), refused);
  CHECK_THROWS_WITH(recover(source, to, std::nullopt, kLater), refused);
  CHECK_THROWS_WITH(merge({other, source}, to, kLater), refused);
  CHECK(bytes_of(source) == before);
  CHECK_FALSE(fs::exists(to));
  CHECK(back_up(*Study::open(source, Study::Access::read_only), folder / "t", false).written);
}

TEST_CASE("files that have names like a draft's are nobody's to take", "[data]") {
  const TemporaryFolder folder;
  const fs::path source = folder / "study.jnd", to = folder / "copy.jnd";
  fill_study(*new_study(source));
  for (const char* name : {"copy.jnd.new", "copy.jnd.new-wal", "copy.jnd.jnd-draft-", "copy.jnd.lock"})
    write_bytes(folder / name, "mine");
  CHECK_THROWS_WITH(back_up(*Study::open(source, Study::Access::read_only), to, false),
                    Catch::Contains("is no lock file of jnd"));
  CHECK(bytes_of(folder / "copy.jnd.lock") == "mine");
  fs::remove(folder / "copy.jnd.lock");
  CHECK(back_up(*Study::open(source, Study::Access::read_only), to, false).written);
  for (const char* name : {"copy.jnd.new", "copy.jnd.new-wal", "copy.jnd.jnd-draft-"})
    CHECK(bytes_of(folder / name) == "mine");
}

TEST_CASE("a link to the source is known as the source", "[data]") {
  const TemporaryFolder folder;
  const fs::path source = folder / "study.jnd";
  fill_study(*new_study(source));
  const std::string before = bytes_of(source);
  fs::create_hard_link(source, folder / "twin");
  CHECK_THROWS_WITH(back_up(*Study::open(source, Study::Access::read_only), folder / "twin", true),
                    Catch::Contains("is the study itself"));
  CHECK(bytes_of(source) == before);
}

TEST_CASE("a name that is taken is never given to another file", "[data]") {
  const TemporaryFolder folder;
  write_bytes(folder / "made", "new");
  write_bytes(folder / "taken", "old");
  CHECK(give_name(folder / "made", folder / "taken") == EEXIST);
  CHECK(bytes_of(folder / "taken") == "old");
  CHECK(give_name(folder / "made", folder / "free") == 0);
  CHECK(bytes_of(folder / "free") == "new");
  CHECK_FALSE(fs::exists(folder / "made"));
}

// Nobody goes on in a study's old file while its rescued copy has more.

TEST_CASE("the file of a study whose rescued copy holds more is refused, and the copy named", "[data]") {
  const TemporaryFolder folder;
  const fs::path path = folder / "study.jnd", away = folder / "away.jnd", second = folder / "study-rescued-2.jnd";
  CHECK(rescued_name(path, 1) == folder / "study-rescued.jnd");
  CHECK(rescued_name(path, 2) == second);
  CHECK_NOTHROW(refuse_rescued(path));
  write_bytes(second, "notes on a rescue");
  {
    const auto study = new_study(path);
    fs::rename(path, away);
    const auto note = [&] { study->add_study_event(event_kind::kNote, {{"text", "one"}}, kLater); };
    CHECK_THROWS_AS(note(), StorageTrouble);
    note();
    REQUIRE(study->path() == rescued_name(path, 1));
  }
  const auto refused = Catch::Contains("went on in " + rescued_name(path, 1).string());
  CHECK_THROWS_WITH(refuse_rescued(path), refused && Catch::Contains("are nowhere else"));
  fs::rename(away, path);
  CHECK_THROWS_WITH(refuse_rescued(path), refused && Catch::Contains("this file lacks"));
  write_bytes(path, "damaged");
  CHECK_THROWS_WITH(refuse_rescued(path), refused);
  write_bytes(path, bytes_of(rescued_name(path, 1)));
  CHECK_NOTHROW(refuse_rescued(path));  // it holds the same
  fs::remove(path);
  Study::create(path, "tutorial", tutorial().bytes, 7, kLater)->close();
  CHECK_NOTHROW(refuse_rescued(path));  // of another study
}

}  // namespace
}  // namespace jnd
