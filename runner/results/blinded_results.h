// What may be seen of a study while it is blinded: is the data sound, and how do the coded conditions stand as a group.
// Nothing here names a condition, a stimulus or the seed, and nothing says how well a single participant does.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/fields/block.h"
#include "data/study/blinding.h"
#include "data/task_results/task_results.h"
#include "data/verify/chain_check.h"
#include "protocols/protocol.h"

namespace jnd {

// One participant, everything pooled over conditions and stimuli. Shares are 0..1, NaN without a trial to judge by.
struct BlindedParticipant {
  std::string participant;
  std::string state;  // "finished", "not finished", "ended early", "excluded"
  int sessions = 0;
  int trials_done = 0, trials_total = 0, trials_voided = 0;
  int device_faults = 0;
  double said_different = 0;          // of the answers
  double median_response_time_s = 0;  // of answers that the participant entered; NaN without one
  double mean_trial_s = 0;            // NaN without one
};

// One condition, all participants together.
struct BlindedGroup {
  std::string code;
  // Participants with a threshold; nothing where they are fewer than kFewestTogether: their number tells of answers.
  std::optional<int> n;
  int of = 0;                      // participants with data
  double mean = 0;                 // JND or adaptive threshold, in the study's unit; NaN where there is no n
  double ci_low = 0, ci_high = 0;  // 95 %; NaN where there is none
};

// A mean of fewer would tell a participant's own result.
inline constexpr int kFewestTogether = 3;

struct BlindedResults {
  SessionKind kind = SessionKind::real;
  ChainReport chains;  // of the whole study, read before anything was computed
  BlindingState state;
  std::string line;  // blinding_line
  std::vector<BlindedParticipant> participants;
  std::vector<BlindedGroup> groups;  // by code
};

// Of the study's sessions of that kind. Only people who are measured have groups: who knows how simulated or pilot
// participants answer would know the letters by their means. Throws BrokenChain where the study is not what was
// recorded. study_name: how the command line names the study.
BlindedResults blinded_results(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by,
                               const std::string& study_name);

// "monitoring" and "coded", of which the latter may have no rows. They refer to the results.
std::vector<Block> blinded_blocks(const BlindedResults& results, const Protocol& protocol);
nlohmann::ordered_json to_json(const BlindedResults& results, const Protocol& protocol);
nlohmann::ordered_json to_json(const BlindingState& state);

}  // namespace jnd
