// Runs simulated participants through the session engine, several at a time.
//
// What a participant does depends on the seed, the protocol, the profile and its own number only, and sessions are
// closed in participant order: a study is the same whatever the number of threads, and whether or not it was
// interrupted and taken up again.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "data/log/session_log.h"
#include "data/results/study_results.h"
#include "data/study/study.h"
#include "devices/participants/simulated_participant.h"
#include "devices/rig.h"
#include "devices/rigs/rig_factory.h"
#include "protocols/protocol.h"
#include "runner/session/record_policy.h"

namespace jnd {

struct Simulation {
  const Protocol& protocol;
  const RigDescription& rig;
  const ParticipantProfile& profile;
  std::uint64_t seed = 0;
  int participants = 1;
  int threads = 1;
  bool progress = false;
  RecordPolicy record = RecordPolicy::events;
};

struct SimulationResult {
  int completed = 0;         // sessions finished in this run
  int already_complete = 0;  // sessions that were finished before
  bool interrupted = false;
};

// Of all that a simulation depends on but its protocol, seed and participants: the profile's file and the rig's.
std::string simulation_sha256(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile);

// Into a study; goes on with sessions that are open. Throws StorageError, and InputError where an open session belongs
// to another profile.
SimulationResult simulate_study(const Simulation& simulation, Study& study);

// What one simulated participant did.
struct SimulatedSessions {
  int participant = 1;
  std::optional<int> group;                // place in Protocol::groups
  std::vector<std::vector<Event>> events;  // of each session
};
// Their answers that an analysis takes, in their order, each to `take`: no practice, and what is not excluded as
// registered. An excluded answer of a procedure has moved the levels all the same, and counts.
void for_counted(const SimulatedSessions& sessions, const Protocol& protocol,
                 const std::function<void(const TrialRecord&)>& take);
// Nothing on disk. take: is given every participant by the thread that simulated them, several at a time. False where
// interrupted: then some are missing.
// rig_filter: for experiments on the rig itself, such as one that renders every stimulus alike; may be empty.
using RigFilter = std::function<std::unique_ptr<Rig>(std::unique_ptr<Rig>)>;
bool simulate_people(const Simulation& simulation, const std::function<void(const SimulatedSessions&)>& take,
                     const RigFilter& rig_filter = {});

// Of same-different: the counts alone. Empty where interrupted.
std::vector<CellCounts> simulate_counts(const Simulation& simulation, const RigFilter& rig_filter = {});

// The seed of the study with this number, from 0, among many that are simulated with one seed; below 2^53, so that every
// program reads it from a table as it is.
std::uint64_t seed_of_study(std::uint64_t seed, std::int64_t study);

// "P07"; at least two digits.
std::string participant_code(int number);
// The simulated time of a session: 2000-01-01T08:00:00Z, a day a participant, an hour a session.
std::int64_t simulated_epoch_ns(int participant, int session = 1);
// Another one for every protocol and seed, so that studies which have nothing in common can lie side by side.
std::string simulated_session_id(const StudyInfo& study, int participant, int session = 1);

}  // namespace jnd
