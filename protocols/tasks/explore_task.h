// Free interaction: objects are handled for a set time in each condition, then a questionnaire asks. A task without trials.
#pragma once

#include "protocols/tasks/task.h"

namespace jnd {

class ExploreTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::explore; }
  std::string_view summary() const noexcept override { return "free interaction, then a questionnaire"; }
  bool has_trials() const noexcept override { return false; }
  std::string_view values_path() const noexcept override { return "$.stimulus.reference"; }
  void read(JsonReader&, TaskSpec&) const override {}
  int intervals(const TaskSpec&) const noexcept override { return 0; }
  std::vector<TaskOutcome> outcomes(const Protocol&) const override { return {}; }
  TaskEstimates estimate(const Protocol&, const Series&, std::span<const AnsweredTrial>) const override {
    return {"no_trials", {}};
  }
};

}  // namespace jnd
