// What a power study asks: designs, what is true of the people who will take part, and the analyses of their answers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/numerics/words.h"
#include "protocols/protocol.h"

namespace jnd {

// registered: the protocol's own: its JNDs, the mean of them, its tests of its contrasts. median: the median of the same JNDs, and
// Wilcoxon's test of their slopes. log_ml: a JND of each participant by maximum likelihood, the mean of the logarithms, paired t.
// hierarchical: one model of everybody's answers (analysis/hierarchical), likelihood-ratio tests.
enum class PowerAnalysis { registered, median, log_ml, hierarchical };
inline constexpr auto kPowerAnalysisWords = words<PowerAnalysis>({{"registered", PowerAnalysis::registered},
                                                                  {"median", PowerAnalysis::median},
                                                                  {"log-ml", PowerAnalysis::log_ml},
                                                                  {"hierarchical", PowerAnalysis::hierarchical}});

// The people that participants are drawn from: the model of analysis/hierarchical/hierarchical_likelihood.h.
struct Population {
  double between_cv = 0.3;       // coefficient of variation of the JND between people: of exp(u)
  double interaction_cv = 0.15;  // and of what a condition adds to that of a person: of exp(v)
  double criterion = 0;          // mean over people: kappa; of choices in JNDs (84 %)
  double criterion_sd = 0.3;
  double lapse = 0;     // share of trials answered by a guess, 0 to below 1
  double drop_out = 0;  // share of participants who leave nothing, 0 to below 1
};

// Groups of participants against each other, by the test that the protocol registers: two groups; or of an analysis of
// variance all groups at once, and whether they differ alike in every condition.
struct GroupTest {
  enum class Kind { pair, groups, interaction };
  Kind kind = Kind::pair;
  int a = 0, b = 0;  // of a pair: places in Protocol::groups, the first less the second
};

// One of the designs that are compared.
struct PowerDesign {
  int participants = 0;  // recruited; of all groups together, which are of one size
  int trials = 0;        // of a cell; 0: as many as a procedure asks
  // How far apart the true JNDs of the conditions are: each is G (JND / G)^effect with G their geometric mean, so that 0
  // is no difference and 1 the planned ones. Groups differ by the same power of their factors.
  double effect = 1;
};

struct PowerQuestion {
  std::vector<int> participants, trials;  // what designs are made of; trials empty for a procedure
  std::vector<double> effects;
  std::vector<double> jnds;                   // the planned one of each condition, > 0, in the study's unit
  std::vector<std::array<int, 2>> contrasts;  // pairs of conditions, the first less the second
  std::vector<GroupTest> group_tests{};       // of a protocol with groups that registers one
  // By group, then condition: how many times the planned JND that of its participants is, > 0. Empty without groups.
  std::vector<std::vector<double>> group_factors{};
  Population people;
  std::vector<PowerAnalysis> analyses;
  int studies = 1000;  // drawn of each design
  std::uint64_t seed = 1;
  double wanted = 0.8;                   // power
  std::optional<std::string> profile{};  // of participants simulated through the rig; none: drawn from the population
  std::string simulation_sha256{};       // of these (runner/session/simulate.h); else empty

  // By participants, then trials, then effect.
  std::vector<PowerDesign> designs() const;
  // Contrasts of conditions, then tests of groups: the order of whatever is counted for each.
  std::size_t tests() const noexcept { return contrasts.size() + group_tests.size(); }
};

// Those that the protocol registers, if any.
std::vector<GroupTest> registered_group_tests(const Protocol& protocol);
// How far the ln JND of a group's participants lies from that of truth_of() in a condition; 0 without groups.
double group_shift(const PowerQuestion& question, double effect, std::optional<int> group,
                   std::size_t condition) noexcept;

// The response model that answers are drawn from, and that the likelihoods assume. None where the protocol's task or model
// of d' has none here.
std::optional<ResponseModel> response_model_of(const Protocol& protocol);
// Of the criterion where none is given: "different" is said of about a fifth to a quarter of equal stimuli.
double usual_criterion(ResponseModel model) noexcept;

// The true values of a design. mu: ln s, with s the model's: the JND at d' = 1, of choices at 84 %.
HierarchicalPlace truth_of(const PowerQuestion& question, double effect, const Protocol& protocol);

nlohmann::ordered_json to_json(const PowerQuestion& question);
// Of what to_json made. Throws nlohmann::json::exception or std::invalid_argument where it is not that.
PowerQuestion power_question_from(const nlohmann::ordered_json& json);

}  // namespace jnd
