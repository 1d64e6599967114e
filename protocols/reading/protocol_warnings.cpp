// What a reviewer would ask about a protocol: every finding is a warning with its numbers.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include "protocols/course/duration.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/cohort.h"
#include "protocols/planning/planned_precision.h"
#include "protocols/reading/protocol_reading.h"

namespace jnd {
namespace {

constexpr int kFewTrialsOfClass = 10;
constexpr double kMuchExtreme = 0.10;
constexpr double kMuchNotPositive = 0.05;
constexpr double kMuchVariation = 0.20;
constexpr double kLongSession_s = 90 * 60;

void warn_about_counts(ProtocolReading& reading) {
  const Design& design = reading.protocol.design;
  if (design.trials_per_cell < 2 * kFewTrialsOfClass) {
    reading.warn_at(
        "$.design.trials_per_cell",
        fmt::format("{} trials per cell give about {} \"same\" and {} \"different\" ones: rates in steps of {:.0f} %",
                    design.trials_per_cell, design.trials_per_cell / 2,
                    design.trials_per_cell - design.trials_per_cell / 2, 200.0 / design.trials_per_cell),
        fmt::format("plan at least {} of each class, {} trials", kFewTrialsOfClass, 2 * kFewTrialsOfClass));
  }
}

// "S 65 %, V 56 %"
std::string shares_of(const Protocol& protocol, const std::vector<double>& shares) {
  std::string text;
  for (std::size_t i = 0; i < shares.size(); ++i)
    text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ", protocol.conditions[i].name, 100 * shares[i]);
  return text;
}

bool any_above(const std::vector<double>& shares, double limit) {
  return std::any_of(shares.begin(), shares.end(), [&](double share) { return share > limit; });
}

void warn_about_precision(ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  const CountsDesign design = counts_design(protocol);
  std::vector<double> extreme, not_positive, variation;
  std::string trials;
  for (const Condition& condition : protocol.conditions) {
    const double jnd = planned_jnd(protocol, condition.name).value;
    const DesignRisks risks = design_risks(design, jnd);
    extreme.push_back(risks.any_extreme);
    not_positive.push_back(risks.any_not_positive);
    variation.push_back(asymptotic_cv(design, jnd));
    if (const std::optional<int> needed = trials_for_cv(design, jnd, kMuchVariation))
      trials += fmt::format("{}{} {}", trials.empty() ? "" : ", ", condition.name, *needed);
  }
  const std::string path = "$.design.trials_per_cell";
  if (any_above(extreme, kMuchExtreme)) {
    reading.warn_at(
        path,
        fmt::format("a hit or false-alarm rate of 0 or 1 in some series is expected for {} of the participants",
                    shares_of(protocol, extreme)),
        "where d' depends on the correction; more trials per cell make it rarer");
  }
  if (any_above(not_positive, kMuchNotPositive)) {
    reading.warn_at(path,
                    fmt::format("a d' of 0 or less in some series is expected for {} of the participants",
                                shares_of(protocol, not_positive)),
                    "such a series has no JND of its own; more trials per cell make it rarer");
  }
  if (any_above(variation, kMuchVariation)) {
    reading.warn_at(path,
                    fmt::format("the JND of one participant is expected with a coefficient of variation of {}",
                                shares_of(protocol, variation)),
                    trials.empty()
                        ? "the differences do not fit the JND"
                        : fmt::format("{:.0f} % takes this many trials per cell: {}; \"jnd plan --precision\" says "
                                      "more",
                                      100 * kMuchVariation, trials));
  }
}

void warn_about_draws(ProtocolReading& reading) {
  const Design& design = reading.protocol.design;
  if (design.sampling == Sampling::random) {
    reading.warn_at("$.design.sampling", "independent draws leave the number of \"same\" trials of a cell to chance",
                    "\"balanced\" blocks have the same P(same) and equal classes");
  }
  if (design.run_limit && *design.run_limit == 1) {
    reading.warn_at("$.design.run_limit",
                    "a run limit of 1 makes \"same\" and \"different\" alternate: answers can be guessed",
                    "3 or 4 keep long runs away");
  }
}

// The letters of a session's blocks follow the file then, whatever the seed.
void warn_about_letters(ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  const Design& design = protocol.design;
  if (protocol.blinded && conditions_of(protocol, largest_plan(protocol)).size() > 1 &&
      design.arrangement == Arrangement::blocked && design.condition_order == Order::fixed)
    reading.warn_at("$.design.order.conditions",
                    "everybody has the blocks in the order of \"conditions\": the letters of a coded study follow it "
                    "and hide nothing",
                    "write \"permuted\", \"williams\" or \"random\", or \"blinding\": \"open\"");
}

// Who says the group then knows which conditions come.
void warn_about_given_groups(ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  if (protocol.blinded && protocol.allotment == Allotment::given && !everyone_has_all(protocol))
    reading.warn_at("$.design.allotment",
                    "who says the group knows its conditions: the letters of a coded study hide less",
                    "give every group the same conditions, or let \"balanced\" allot them");
}

// A rig is told every parameter in every condition, and of one kind.
void warn_about_parameters(ProtocolReading& reading) {
  const std::vector<Condition>& conditions = reading.protocol.conditions;
  std::map<std::string, ParameterValue> first;
  for (const Condition& condition : conditions) first.insert(condition.parameters.begin(), condition.parameters.end());
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    const std::string path = fmt::format("$.conditions[{}].parameters", i);
    for (const auto& [name, value] : first) {
      const auto own = conditions[i].parameters.find(name);
      if (own == conditions[i].parameters.end())
        reading.warn_at(path,
                        fmt::format("{} is a parameter of other conditions, and not of this one", in_quotes(name)),
                        "give it here too: a rig is told every parameter in every condition");
      else if (own->second.index() != value.index())
        reading.warn_at(path, fmt::format("{} is of another kind here than in other conditions", in_quotes(name)),
                        "write a number everywhere, or a text");
    }
  }
}

// Orders; and where each number has its group in turn, groups of one size.
void warn_about_cohort(ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  const int groups = group_count(protocol);
  if (protocol.allotment == Allotment::balanced && protocol.design.participants % groups != 0)
    return reading.warn_at(
        "$.design.participants",
        fmt::format("{} participants do not fill {} groups equally", protocol.design.participants, groups),
        fmt::format("plan a multiple of {}", groups));
  const int group = std::max(balanced_at(protocol), groups);
  const int participants = reading.protocol.design.participants;
  if (participants % group != 0) {
    const int above = (participants / group + 1) * group;
    reading.warn_at(
        "$.design.participants",
        fmt::format("{} participants do not use the {} orders equally often", participants, group),
        above - group > 0 ? fmt::format("{} or {} would", above - group, above) : fmt::format("{} would", above));
  }
}

void warn_about_session(ProtocolReading& reading) {
  if (!reading.protocol.practice && !reading.explores()) {
    reading.warn_at("$.practice", "there is no practice: learning falls into the first blocks",
                    "add \"practice\" with a criterion");
  }
  if (reading.protocol.resume.practice_after_s && !reading.protocol.practice)
    reading.warn_at("$.resume.practice_after_min", "there is no practice that could come again",
                    "remove it, or add \"practice\"");
  const double duration = expected_duration_s(reading.protocol);
  if (duration > kLongSession_s) {
    reading.warn_at("$.design", fmt::format("a session takes about {:.0f} min", duration / 60),
                    "beyond 90 min fatigue counts: plan fewer trials, or series on several days");
  }
}

}  // namespace

void warn_about_protocol(ProtocolReading& reading) {
  if (const AdaptiveProcedure* procedure = reading.procedure()) warn_about_procedure(*procedure, reading);
  if (has_precision(reading.protocol)) {
    warn_about_counts(reading);
    warn_about_precision(reading);
    warn_about_draws(reading);
  }
  warn_about_parameters(reading);
  warn_about_letters(reading);
  warn_about_given_groups(reading);
  warn_about_cohort(reading);
  warn_about_session(reading);
  warn_about_translations(reading);
}

}  // namespace jnd
