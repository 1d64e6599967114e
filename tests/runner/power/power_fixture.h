// Questions of power, and what enumeration says of them, for the tests of power.
#pragma once

#include "analysis/precision/cell_distribution.h"
#include "protocols/planning/planned_precision.h"
#include "runner/power/power_question.h"
#include "runner/power/power_shard.h"

namespace jnd::testing {

// The planned JNDs, the registered contrasts and tests of groups, and the criterion that most people have.
inline PowerQuestion registered_question(const Protocol& protocol) {
  PowerQuestion question;
  for (const Condition& condition : protocol.conditions)
    question.jnds.push_back(planned_jnd(protocol, condition.name).value);
  for (const Contrast& contrast : protocol.analysis.contrasts) question.contrasts.push_back({contrast.a, contrast.b});
  question.group_tests = registered_group_tests(protocol);
  question.people.criterion = usual_criterion(response_model_of(protocol).value());
  return question;
}

// The mean of the least-squares slope of somebody with that JND and a criterion in JNDs: it is linear in the d' of the
// series, so that it follows from theirs.
inline double enumerated_slope(const Protocol& protocol, double criterion, double jnd) {
  CountsDesign design = counts_design(protocol);
  design.criterion = {CriterionRule::Kind::common, criterion * jnd};
  double products = 0, squares = 0;
  for (const double difference : design.differences) {
    double mean = 0;
    for (const CellState& state : cell_distribution(cell_probabilities(design, difference, jnd)).states)
      mean += state.dprime * state.probability;
    products += difference * mean;
    squares += difference * difference;
  }
  return products / squares;
}

// A shard of the question in a file, by one thread.
inline ShardEnd make_power_shard(const Protocol& protocol, const PowerQuestion& question, int number, int of,
                                 const std::filesystem::path& file,
                                 const std::function<void(std::int64_t)>& progress = {}) {
  return make_shard(power_shard(protocol, question, number, of), file, power_work(protocol, question, 1), progress);
}

}  // namespace jnd::testing
