// When a study is blinded, by every fact that decides it.
#include "data/study/blinding.h"

#include <array>

#include "data/study/study_admin.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace jnd {

namespace {

constexpr Stamp kLater = {1'700'001'000'000'000'000, 1000};

// The tutorial plans two participants.
Protocol of_two() {
  Protocol protocol = tutorial();
  protocol.blinded = true;
  return protocol;
}

bool blinded(const Study& study, SessionKind kind = SessionKind::real) {
  return blinding_of(study, of_two(), kind).blinded;
}

}  // namespace

TEST_CASE("a study is blinded from its first real session to the planned number of finished ones", "[blinding]") {
  const TemporaryFolder folder;
  const std::unique_ptr<Study> study = new_study(folder / "s.sqlite");
  CHECK(blinded(*study));
  run_whole_session(*study, of_two(), 1, SessionKind::real);
  CHECK(blinded(*study));
  CHECK(blinding_of(*study, of_two(), SessionKind::real).finished == 1);
  const NewSession second = new_session(2, SessionKind::real);
  answer_all(*study->open_session(second), of_two(), 2, 3);
  CHECK(blinding_of(*study, of_two(), SessionKind::real).unfinished == 1);
  CHECK(blinded(*study));
  study->close_session(second.id, kLater);
  CHECK_FALSE(blinded(*study));
  // A session more that is not finished blinds it again.
  study->open_session(new_session(3, SessionKind::real));
  CHECK(blinded(*study));
}

TEST_CASE("an open protocol, an unblinded study, rehearsals without a real session are not blinded", "[blinding]") {
  const TemporaryFolder folder;
  const std::unique_ptr<Study> study = new_study(folder / "s.sqlite");
  constexpr std::array kRehearsals = {SessionKind::pilot, SessionKind::simulated};
  for (const SessionKind kind : kRehearsals) run_whole_session(*study, of_two(), 1, kind);
  for (const SessionKind kind : kRehearsals) CHECK_FALSE(blinded(*study, kind));
  run_whole_session(*study, of_two(), 1, SessionKind::real);
  for (const SessionKind kind : kRehearsals) CHECK(blinded(*study, kind));
  Protocol open = of_two();
  open.blinded = false;
  CHECK_FALSE(blinding_of(*study, open, SessionKind::real).blinded);
  CHECK_FALSE(plan_sealed(*study, open));
  CHECK(plan_sealed(*study, of_two()));
  unblind(*study, "the interim look that was registered", kLater);
  CHECK_FALSE(blinded(*study));
  CHECK_FALSE(blinded(*study, SessionKind::pilot));
  CHECK_FALSE(plan_sealed(*study, of_two()));
}

TEST_CASE("excluded participants neither finish a study nor hold it up", "[blinding]") {
  const TemporaryFolder folder;
  const std::unique_ptr<Study> study = new_study(folder / "s.sqlite");
  for (const int number : {1, 2}) run_whole_session(*study, of_two(), number, SessionKind::real);
  CHECK_FALSE(blinded(*study));
  exclude_participant(*study, "P02", SessionKind::real, "did not wear the blindfold", false, kLater);
  CHECK(blinded(*study));
  CHECK(blinding_of(*study, of_two(), SessionKind::real).finished == 1);
}

TEST_CASE("a session that was ended early for good neither finishes a study nor holds it up", "[blinding]") {
  const TemporaryFolder folder;
  const std::unique_ptr<Study> study = new_study(folder / "s.sqlite");
  run_whole_session(*study, of_two(), 1, SessionKind::real);
  const NewSession refused = new_session(2, SessionKind::real), left = new_session(3, SessionKind::real);
  study->open_session(refused)->append(event_kind::kLeft, {{"cause", "no consent"}, {"reason", ""}, {"for_good", true}},
                                       kLater);
  study->close_session(refused.id, kLater);
  CHECK(study->sessions()[1].ended_early);
  CHECK(blinding_of(*study, of_two(), SessionKind::real).finished == 1);
  CHECK(blinding_of(*study, of_two(), SessionKind::real).unfinished == 0);
  CHECK(blinded(*study));
  // Left for now and resumed, or stopped before the end for good was closed and then taken up again: finished.
  {
    const std::unique_ptr<SessionLog> log = study->open_session(left);
    log->append(event_kind::kLeft, {{"cause", "operator"}, {"reason", ""}, {"for_good", true}}, kLater);
    CHECK_FALSE(study->sessions()[2].ended_early);  // not closed
    log->append(event_kind::kSessionResumed, {{"reason", ""}}, kLater);
    answer_all(*log, of_two(), 3);
  }
  study->close_session(left.id, kLater);
  CHECK_FALSE(study->sessions()[2].ended_early);
  CHECK_FALSE(blinded(*study));
}

TEST_CASE("a plan is sealed but in a study of simulated sessions alone", "[blinding]") {
  const TemporaryFolder folder;
  const std::unique_ptr<Study> study = new_study(folder / "s.sqlite");
  CHECK(plan_sealed(*study, of_two()));
  CHECK(seed_text(*study, of_two(), "sealed") == "sealed");
  run_whole_session(*study, of_two(), 1);
  CHECK_FALSE(plan_sealed(*study, of_two()));
  CHECK(seed_text(*study, of_two(), "sealed") == std::to_string(kSeed));
  run_whole_session(*study, of_two(), 1, SessionKind::pilot);
  CHECK(plan_sealed(*study, of_two()));
}

TEST_CASE("the line of a blinded study says why, and what ends it", "[blinding]") {
  BlindingState state{.blinded = true, .planned = 18, .finished = 2, .unfinished = 1};
  CHECK(
      blinding_line(state, "s.sqlite") ==
      "BLINDED: 2 of 18 planned participants finished, 1 real session open. Conditions are in code or pooled, stimuli and "
      "seed are sealed. This ends with 16 more finished participants and the end of 1 open session, or with: jnd "
      "unblind s.sqlite --reason \"...\"");
  state = {.blinded = true, .planned = 18, .finished = 18, .unfinished = 2};
  CHECK(blinding_line(state, "s").find("This ends with the end of 2 open sessions, or") != std::string::npos);
}

}  // namespace jnd
