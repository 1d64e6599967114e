// A session of the real engine over a study file, started as often as the disk makes it necessary.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "data/study/study.h"
#include "protocols/tasks/task.h"
#include "tests/runner/engine_fixture.h"

namespace jnd::test {

inline constexpr std::uint64_t kStudySeed = 20170601;

// The first session of P01, a person at a keyboard.
NewSession first_session(SessionKind kind, const Plan& plan);

// Two conditions, 4 main trials each, one practice round, ratings and a break: every kind of event that answers need.
Protocol short_protocol();

enum class Phase { create, open, session, close, done };
std::string_view to_string(Phase phase) noexcept;

// What the operator was told. An answer counts as acknowledged from saved() on.
class OperatorView final : public SessionView {
 public:
  void saved(const TrialOutline& outline, const Answer& answer) override;
  bool storage_trouble(const std::string& message) override;

  std::function<bool()> on_trouble = [] { return false; };  // whether to try again
  std::function<int()> asked_last;                          // index of the trial whose answer was asked last
  std::map<int, int> acknowledged;                          // by trial index
  std::vector<std::string> troubles;
};

// A trial of the final table: what was presented and what was answered.
struct TableRow {
  Trial trial;
  int answer = kClassSame;
  bool operator==(const TableRow&) const = default;
};

// One participant's session in one study.
class StudySession {
 public:
  StudySession(std::filesystem::path path, SessionKind kind);

  // What one start of the program does: makes or opens the study, begins the session or goes on with it, and closes
  // both. Throws what the program would report. Nothing happens where the session is closed already.
  void run(OperatorView& view);
  // Where run() is, or was when it threw.
  Phase phase() const noexcept { return phase_; }

  // Everything that must hold whenever the program is not running. Empty where it does, or what does not. A study that
  // is not there is whole as long as no answer was acknowledged. table: every answered trial, by index.
  std::string check(const std::map<int, int>& acknowledged, std::map<int, TableRow>* table = nullptr) const;
  // What the table must be at the end.
  std::map<int, TableRow> expected_table() const;

 private:
  std::filesystem::path path_;
  SessionKind kind_;
  Protocol protocol_;
  Phase phase_ = Phase::create;
};

}  // namespace jnd::test
