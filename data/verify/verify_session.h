// One session under verify: its events against the plan made anew, and against each other.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "data/log/event_body.h"
#include "data/study/study.h"
#include "data/study/study_facts.h"
#include "data/verify/verify.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/plan.h"

namespace jnd {

class SessionCheck {
 public:
  // protocol: null where it cannot be read. All references must outlive it.
  SessionCheck(std::string session, const Protocol* protocol, const StudyFacts& facts, VerifyReport& report)
      : session_(std::move(session)), protocol_(protocol), facts_(facts), report_(report) {}

  // Of the next event. Throws StorageError and nlohmann::json::exception where the body is not its kind's.
  void check(const Event& event, const nlohmann::ordered_json& body);

  bool opened() const noexcept { return opened_; }
  bool closed() const noexcept { return closed_; }
  const std::string& kind() const noexcept { return kind_; }
  const std::string& participant() const noexcept { return participant_; }
  const std::string& seed() const noexcept { return seed_; }
  int participant_number() const noexcept { return participant_number_; }
  int number() const noexcept { return number_; }

 private:
  // An answer that holds so far.
  struct Given {
    Trial trial;    // as it was presented
    Trial planned;  // as the plan has it
    int attempt = 1;
    Answer answer;
  };

  template <typename... Arguments>
  void problem(const Event& event, fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    add(event, fmt::format(text, std::forward<Arguments>(arguments)...), Reveals::plan);
  }
  // The same of what gives nothing of the plan away.
  template <typename... Arguments>
  void open_problem(const Event& event, fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    add(event, fmt::format(text, std::forward<Arguments>(arguments)...), Reveals::nothing);
  }
  void add(const Event& event, const std::string& what, Reveals reveals);

  void open(const Event& event, const nlohmann::ordered_json& body);
  void make_the_plan();
  void check_group(const Event& event, const nlohmann::ordered_json& body);
  void check_began(const Event& event, const nlohmann::ordered_json& body);
  void check_completed(const Event& event, const nlohmann::ordered_json& body);
  void check_voided(const Event& event, const nlohmann::ordered_json& body);
  void check_block_ended(const Event& event, const nlohmann::ordered_json& body);
  void check_exploration(const Event& event, const nlohmann::ordered_json& body);
  void check_planned(const Event& event, Trial trial);
  void check_presented(const Event& event, const Trial& trial, const Trial& planned);
  void check_names(const Event& event, const TrialRecord& record);
  void check_settings(const Event& event, const TrialRecord& record);
  bool planned_index(const Event& event, int index);
  std::vector<Given>::iterator given(int index);
  void replay_answers();

  std::string session_;
  const Protocol* protocol_;
  const StudyFacts& facts_;
  VerifyReport& report_;
  bool opened_ = false, closed_ = false;
  std::string kind_, participant_, seed_;
  int participant_number_ = 0, number_ = 1;
  std::map<int, Trial> planned_;  // by index
  std::map<int, ExplorationSlot> explorations_;
  bool has_plan_ = false;
  std::optional<int> group_;             // as the plan has it
  std::optional<AdaptiveRun> adaptive_;  // over given_
  std::vector<Given> given_;             // in order
  std::set<int> given_up_;               // with their block
  std::set<int> explored_;
  std::optional<PendingTrial> pending_;
};

}  // namespace jnd
