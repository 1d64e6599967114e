#include "runner/session/simulate.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/experiment_stream.h"
#include "data/log/event_body.h"
#include "data/log/replay.h"
#include "data/study/trial_rows.h"
#include "devices/rigs/rig_factory.h"
#include "protocols/course/prescription.h"
#include "protocols/input/input_error.h"
#include "protocols/input/sha256.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/plan.h"
#include "protocols/tasks/task.h"
#include "runner/keys/interrupt.h"
#include "runner/session/ordered_work.h"
#include "runner/session/session_engine.h"
#include "runner/terminal/progress_bar.h"

namespace jnd {

namespace {

constexpr std::int64_t kDay_ns = 86'400'000'000'000;
constexpr std::int64_t kHour_ns = 3'600'000'000'000;
constexpr std::int64_t kFirstDay_ns = 946'713'600'000'000'000;  // 2000-01-01T08:00:00Z

// Counts trials, or explorations, for the progress bar; a simulated participant needs no words.
class CountingView final : public SessionView {
 public:
  explicit CountingView(std::atomic<std::int64_t>& trials) : trials_(trials) {}
  void saved(const TrialOutline& outline, const Answer&) override {
    if (outline.practice) return;
    ++trials_;
    ++saved_;
  }
  void explored() override { ++trials_; }
  std::int64_t saved_trials() const noexcept { return saved_; }

 private:
  std::int64_t saved_ = 0;
  std::atomic<std::int64_t>& trials_;
};

// What a session goes through: main trials, or explorations.
int steps_of(const Plan& plan) {
  return std::max(main_trial_count(plan), static_cast<int>(plan.explorations.size()));
}

std::int64_t main_trials(const SessionState& state) {
  return std::count_if(state.completed.begin(), state.completed.end(),
                       [](const TrialRecord& record) { return !record.trial.practice; });
}

// For the bar: of groups with different conditions as if everybody had as many trials as the group with the most.
std::int64_t trials_of_all(const Simulation& simulation) {
  const int someone = first_of(simulation.protocol, largest_plan(simulation.protocol), simulation.seed);
  return std::int64_t{simulation.participants} * simulation.protocol.design.sessions *
         main_trial_count(make_plan(simulation.protocol, someone, simulation.seed));
}

// Each session's noise is drawn anew.
std::uint64_t seed_of_session(std::uint64_t seed, int session) {
  return session == 1 ? seed : seed ^ (0x9e3779b97f4a7c15U * static_cast<std::uint64_t>(session));
}

SessionEnd run_participant(const Simulation& simulation, const RigFilter& rig_filter, const Plan& plan, SessionLog& log,
                           std::atomic<std::int64_t>& trials) {
  const std::uint64_t seed = seed_of_session(simulation.seed, plan.session);
  SimulatedClock clock(simulated_epoch_ns(plan.participant, plan.session));
  const SessionState state = replay(log.events());
  clock.sleep_until_ns(state.last_monotonic_ns);
  std::unique_ptr<Rig> rig =
      make_simulated_rig(simulation.protocol, simulation.rig, simulation.profile, plan.participant, seed, clock,
                         rig_options(simulation.record, simulation.protocol, simulation.rig));
  if (rig_filter) rig = rig_filter(std::move(rig));
  const std::unique_ptr<Responder> responder =
      make_simulated_participant(simulation.profile, simulation.protocol, plan.participant, seed, clock);
  CountingView view(trials);
  const SessionParts parts{simulation.protocol, plan, *rig, *responder, log, clock, view, interrupts(),
                           simulation.record,   false};
  const SessionEnd end = SessionEngine(parts).run(state);
  // Trials that nobody needed, such as those of tracks that ended before, count as done, for the bar.
  if (end == SessionEnd::completed) trials += main_trial_count(plan) - view.saved_trials() - main_trials(state);
  return end;
}

// A participant's sessions, one after the other.
struct Turn {
  int participant = 1, session = 1;
};
Turn turn_of(int place, const Protocol& protocol) {
  const int sessions = protocol.design.sessions;
  return {(place - 1) / sessions + 1, (place - 1) % sessions + 1};
}

// Each place in its turn, with a bar where one is asked for. done: by the calling thread, in order.
void for_each_place(const Simulation& simulation, int places, const std::atomic<std::int64_t>& trials,
                    std::int64_t trials_total, const std::function<Work(int)>& work,
                    const std::function<void(int)>& done) {
  std::optional<ProgressBar> bar;
  if (simulation.progress)
    bar.emplace(simulation.protocol.explore ? "simulating explorations" : "simulating trials", trials_total);
  work_in_order(places, simulation.threads, work, done, [&] {
    if (bar) bar->update(trials);
  });
}

}  // namespace

std::string simulation_sha256(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile) {
  return sha256_hex(profile.sha256 + simulated_rig_info(protocol, rig.spec).sha256);
}

std::uint64_t seed_of_study(std::uint64_t seed, std::int64_t study) {
  constexpr std::uint64_t kStudyPurpose = 0x6a6e6420'73747564;  // apart from other uses of the seed
  constexpr int kBeyondDouble = 11;                             // bits that a double has no room for
  return ExperimentStream(seed, kStudyPurpose, static_cast<std::uint64_t>(study)).next() >> kBeyondDouble;
}

std::string participant_code(int number) {
  return fmt::format("P{:02}", number);
}

std::int64_t simulated_epoch_ns(int participant, int session) {
  return kFirstDay_ns + (participant - 1) * kDay_ns + (session - 1) * kHour_ns;
}

std::string simulated_session_id(const StudyInfo& study, int participant, int session) {
  return sha256_hex(fmt::format("simulated/{}/{}/{}/{}", study.protocol_sha256, study.seed, participant, session))
      .substr(0, 32);
}

SimulationResult simulate_study(const Simulation& simulation, Study& study) {
  SimulationResult result;
  std::map<std::string, SessionInfo> known;
  std::map<std::pair<int, int>, std::string> ids;  // by number of participant and session: earlier programs had others
  for (const SessionInfo& session : study.sessions()) {
    known.emplace(session.id, session);
    if (session.kind == SessionKind::simulated) ids[{session.participant_number, session.number}] = session.id;
  }
  const std::string responder = "profile " + simulation.profile.name;
  std::atomic<std::int64_t> trials{0};
  std::int64_t total = 0;
  std::vector<int> already;
  const int places = simulation.participants * simulation.protocol.design.sessions;
  const auto id_of = [&](int place) {
    const Turn turn = turn_of(place, simulation.protocol);
    const auto found = ids.find({turn.participant, turn.session});
    return found != ids.end() ? found->second : simulated_session_id(study.info(), turn.participant, turn.session);
  };
  for (int place = 1; place <= places; ++place) {
    const Turn turn = turn_of(place, simulation.protocol);
    total += steps_of(make_plan(simulation.protocol, turn.participant, simulation.seed, turn.session));
    const auto found = known.find(id_of(place));
    if (found == known.end()) continue;
    if (found->second.responder != responder)
      throw InputError(fmt::format(
          "participant {} of this study was simulated with {}, not {}; use that profile or another study file",
          participant_code(turn.participant), found->second.responder, responder));
    trials += found->second.trials_done;
    if (found->second.state == "closed") already.push_back(place);
  }

  const auto is_done = [&](int place) { return std::binary_search(already.begin(), already.end(), place); };
  std::vector<Stamp> ends(static_cast<std::size_t>(places) + 1);
  const auto work = [&](int place) {
    if (is_done(place)) return Work::nothing_to_do;
    if (interrupt_requested()) return Work::interrupted;
    const Turn turn = turn_of(place, simulation.protocol);
    const Plan plan = make_plan(simulation.protocol, turn.participant, simulation.seed, turn.session);
    const std::string id = id_of(place);
    std::unique_ptr<SessionLog> log;
    if (known.contains(id)) {
      log = study.resume_session(id);
    } else {
      NewSession session;
      session.id = id;
      session.participant = participant_code(turn.participant);
      session.participant_number = turn.participant;
      session.number = turn.session;
      session.group = group_name(simulation.protocol, plan.group);
      session.kind = SessionKind::simulated;
      session.responder = responder;
      session.profile_sha256 = simulation.profile.sha256;
      const RigInfo rig = simulated_rig_info(simulation.protocol, simulation.rig.spec);
      session.rig = rig.name;
      session.rig_mode = rig.mode;
      session.tracker = rig.tracker;
      session.rig_sha256 = rig.sha256;
      session.trials_total = steps_of(plan);
      session.stamp = {simulated_epoch_ns(turn.participant, turn.session), 0};
      log = study.open_session(session);
    }
    if (run_participant(simulation, {}, plan, *log, trials) != SessionEnd::completed) return Work::interrupted;
    const SessionState state = replay(log->events());
    ends[static_cast<std::size_t>(place)] = {state.last_utc_ns, state.last_monotonic_ns};
    return Work::finished;
  };
  const auto close = [&](int place) {
    study.close_session(id_of(place), ends[static_cast<std::size_t>(place)]);
    ++result.completed;
  };
  for_each_place(simulation, places, trials, total, work, close);
  result.already_complete = static_cast<int>(already.size());
  result.interrupted = interrupt_requested();
  return result;
}

void for_counted(const SimulatedSessions& sessions, const Protocol& protocol,
                 const std::function<void(const TrialRecord&)>& take) {
  const auto excluded = [&](const TrialRecord& record) {
    return !exclusion_reason(protocol.analysis.exclude, record.answer.entered_by == EnteredBy::participant,
                             record.answer.response_time_s, largest_saturated_share(record),
                             breaks_limit(record.breach))
                .empty();
  };
  for (const std::vector<Event>& events : sessions.events)
    for (const TrialRecord& record : replay(events).completed)
      if (!record.trial.practice && (record.trial.track > 0 || !excluded(record))) take(record);
}

bool simulate_people(const Simulation& simulation, const std::function<void(const SimulatedSessions&)>& take,
                     const RigFilter& rig_filter) {
  const Protocol& protocol = simulation.protocol;
  std::atomic<std::int64_t> trials{0};
  const auto work = [&](int participant) {
    if (interrupt_requested()) return Work::interrupted;
    SimulatedSessions sessions{participant, group_of(protocol, participant, simulation.seed), {}};
    for (int session = 1; session <= protocol.design.sessions; ++session) {
      MemoryLog log;
      const Plan plan = make_plan(protocol, participant, simulation.seed, session);
      if (run_participant(simulation, rig_filter, plan, log, trials) != SessionEnd::completed) return Work::interrupted;
      sessions.events.push_back(log.events());
    }
    take(sessions);
    return Work::finished;
  };
  for_each_place(simulation, simulation.participants, trials, trials_of_all(simulation), work, [](int) {});
  return !interrupt_requested();
}

namespace {

// By condition, then series, as the protocol lists them.
std::vector<CellCounts> cells_of(const SimulatedSessions& sessions, const Protocol& protocol) {
  std::vector<CellCounts> cells;
  const auto all_series = static_cast<int>(protocol.series.size());
  std::map<std::pair<int, int>, std::size_t> places;
  for (const int condition : conditions_of(protocol, sessions.group))
    for (int series = 0; series < all_series; ++series) {
      places[{condition, series}] = cells.size();
      cells.push_back({participant_code(sessions.participant), condition, series, {}, sessions.group});
    }
  for_counted(sessions, protocol, [&](const TrialRecord& record) {
    const Trial& trial = record.trial;
    cells[places.at({trial.condition, trial.series})].counts.add(trial.target == kClassSame,
                                                                 record.answer.said == kClassDifferent);
  });
  return cells;
}

// What is made of each participant, in the order of their numbers; empty where interrupted.
template <typename Row, typename Make>
std::vector<Row> rows_of_all(const Simulation& simulation, const RigFilter& rig_filter, const Make& make) {
  std::vector<std::vector<Row>> rows(static_cast<std::size_t>(simulation.participants));
  std::vector<Row> all;
  if (!simulate_people(
          simulation,
          [&](const SimulatedSessions& sessions) {
            rows[static_cast<std::size_t>(sessions.participant - 1)] = make(sessions);
          },
          rig_filter))
    return all;
  for (const std::vector<Row>& one : rows) all.insert(all.end(), one.begin(), one.end());
  return all;
}

}  // namespace

std::vector<CellCounts> simulate_counts(const Simulation& simulation, const RigFilter& rig_filter) {
  return rows_of_all<CellCounts>(simulation, rig_filter, [&](const SimulatedSessions& sessions) {
    return cells_of(sessions, simulation.protocol);
  });
}

}  // namespace jnd
