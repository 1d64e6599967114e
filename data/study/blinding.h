// Whether a study's results of people may be seen. While it is blinded, outputs show coded or pooled values, and do not
// give the plan away: neither stimuli, nor which condition a letter stands for, nor the seed that both follow from. It
// guards against accidents and hints, not against the file being opened with other tools.
#pragma once

#include <string>
#include <string_view>

#include "data/study/study.h"
#include "protocols/protocol.h"

namespace jnd {

struct BlindingState {
  bool blinded = false;  // results of the kind asked for are shown in code
  int planned = 0;       // participants, by the protocol
  // Real participants with all their sessions closed; without excluded ones. A session that was ended early for good
  // is neither finished nor open.
  int finished = 0;
  int unfinished = 0;  // real sessions that are still open; without those of excluded participants
};

// Real data are blinded where the protocol says coded, the study was not unblinded, and a session is unfinished or fewer
// participants have finished than are planned. So are pilot and simulated data of a study with a real session, because
// participant n of every kind has the same plan.
BlindingState blinding_of(const Study& study, const Protocol& protocol, SessionKind kind);

// Whether stimuli, orders and seed are kept secret: the study is blinded for real data, and it has a real or
// pilot session, or none of any kind yet. Results of pilot sessions that stand alone name the conditions then, but no
// single trial. A study of simulations alone has no secrets.
bool plan_sealed(const Study& study, const Protocol& protocol);

// The study's seed in decimal, or `sealed` where it would give the plan away.
std::string seed_text(const Study& study, const Protocol& protocol, std::string_view sealed);

// The head of the session's chain. Empty while plans are sealed and the session is open: from one trial to the next it
// would be the hash of a single event.
std::string shown_head(const SessionInfo& session, bool sealed);

// Why results are in code, and what ends it, in one line. study: as a shell takes its name.
std::string blinding_line(const BlindingState& state, const std::string& study);

}  // namespace jnd
