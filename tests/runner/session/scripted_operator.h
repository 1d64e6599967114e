// An operator who follows a script, and what the log says of it.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "runner/session/session_engine.h"
#include "tests/runner/engine_fixture.h"

namespace jnd::test {

using nlohmann::json;

// An operator who follows a script: what to ask for before the n-th asking of ready(), from 1.
class Scripted final : public SessionView {
 public:
  OperatorRequest ready(const TrialOutline& outline) override {
    outlines.push_back(outline);
    const auto found = before.find(static_cast<int>(outlines.size()));
    return found == before.end() ? OperatorRequest{} : found->second;
  }
  OperatorRequest meanwhile() override {
    const auto found = after_presentation.find(++presentations);
    return found == after_presentation.end() ? OperatorRequest{} : found->second;
  }
  OperatorRequest paused(const std::string& cause) override {
    pauses.push_back(cause);
    return in_pause;
  }
  bool storage_trouble(const std::string& message) override {
    troubles.push_back(message);
    return tries_again;
  }
  OperatorRequest recover(const std::string&) override { return {Request::go_on, "the strap had slipped"}; }
  void took_back(bool will_repeat) override { taken_back.push_back(will_repeat); }
  std::optional<bool> consent(const std::string&) override { return consents; }
  void progress(const std::vector<ConditionProgress>& conditions) override { last_progress = conditions; }

  std::map<int, OperatorRequest> before, after_presentation;
  OperatorRequest in_pause{Request::go_on, {}};
  bool tries_again = true, consents = true;
  std::vector<TrialOutline> outlines;
  int presentations = 0;
  std::vector<std::string> pauses, troubles;
  std::vector<bool> taken_back;
  std::vector<ConditionProgress> last_progress;
};

inline Bench& with_person(Bench& bench) {
  bench.person = true;
  return bench;
}

inline std::vector<json> bodies(const Bench& bench, std::string_view kind) {
  std::vector<json> found;
  for (const Event& event : bench.log.events())
    if (event.kind == kind) found.push_back(json::parse(event.body));
  return found;
}

inline std::vector<int> order_of(const Bench& bench) {
  std::vector<int> order;
  for (const TrialRecord& record : bench.completed()) order.push_back(record.trial.index);
  return order;
}

}  // namespace jnd::test
