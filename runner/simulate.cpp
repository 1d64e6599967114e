#include "runner/simulate.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "data/event_body.h"
#include "devices/rig_factory.h"
#include "protocols/input_error.h"
#include "protocols/plan.h"
#include "protocols/sha256.h"
#include "runner/counts_log.h"
#include "runner/interrupt.h"
#include "runner/progress_bar.h"
#include "runner/session_engine.h"

namespace jnd {

namespace {

constexpr std::int64_t kDay_ns = 86'400'000'000'000;
constexpr std::int64_t kFirstDay_ns = 946'713'600'000'000'000;  // 2000-01-01T08:00:00Z

// Counts trials for the progress bar; a simulated participant needs no words.
class CountingView final : public SessionView {
 public:
  explicit CountingView(std::atomic<std::int64_t>& trials) : trials_(trials) {}
  void saved(const TrialOutline& outline, const Answer&) override {
    if (outline.practice) return;
    ++trials_;
    ++saved_;
  }
  std::int64_t saved_trials() const noexcept { return saved_; }

 private:
  std::int64_t saved_ = 0;
  std::atomic<std::int64_t>& trials_;
};

std::int64_t main_trials(const SessionState& state) {
  return std::count_if(state.completed.begin(), state.completed.end(),
                       [](const TrialRecord& record) { return !record.trial.practice; });
}

SessionEnd run_participant(const Simulation& simulation, const RigFilter& rig_filter, const Plan& plan, SessionLog& log,
                           std::atomic<std::int64_t>& trials) {
  SimulatedClock clock(simulated_epoch_ns(plan.participant));
  const SessionState state = replay(log.events());
  clock.sleep_until_ns(state.last_monotonic_ns);
  std::unique_ptr<Rig> rig =
      make_simulated_rig(simulation.protocol, simulation.rig, simulation.profile, plan.participant, simulation.seed,
                         clock, rig_options(simulation.record, simulation.protocol, simulation.rig));
  if (rig_filter) rig = rig_filter(std::move(rig));
  const std::unique_ptr<Responder> responder =
      make_simulated_participant(simulation.profile, simulation.protocol, plan.participant, simulation.seed, clock);
  CountingView view(trials);
  SessionEngine engine(simulation.protocol, plan, *rig, *responder, log, clock, view, interrupt_requested(),
                       simulation.record);
  const SessionEnd end = engine.run(state);
  // Trials that ended tracks did not need count as done, for the bar.
  if (simulation.protocol.design.procedure && end == SessionEnd::completed)
    trials += main_trial_count(plan) - view.saved_trials() - main_trials(state);
  return end;
}

enum class Work { finished, nothing_to_do, interrupted };

// Calls work(participant) for 1..n on several threads, and done(participant) on the calling thread for those whose work
// finished: in participant order, up to the first that was interrupted. The first exception stops the rest and is
// thrown here.
void for_each_participant(const Simulation& simulation, const std::atomic<std::int64_t>& trials,
                          std::int64_t trials_total, const std::function<Work(int)>& work,
                          const std::function<void(int)>& done) {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::optional<Work>> results(static_cast<std::size_t>(simulation.participants) + 1);
  std::exception_ptr failure;
  std::atomic<int> next{1};

  const auto worker = [&] {
    for (int participant = next++; participant <= simulation.participants; participant = next++) {
      Work result = Work::interrupted;
      std::exception_ptr problem;
      try {
        result = work(participant);
      } catch (...) {
        problem = std::current_exception();
        next = simulation.participants + 1;
      }
      const std::lock_guard lock(mutex);
      results[static_cast<std::size_t>(participant)] = result;
      if (problem && !failure) failure = problem;
      changed.notify_all();
    }
  };
  std::vector<std::jthread> threads;
  for (int i = 0; i < std::clamp(simulation.threads, 1, simulation.participants); ++i) threads.emplace_back(worker);

  std::unique_ptr<ProgressBar> bar;
  if (simulation.progress) bar = std::make_unique<ProgressBar>("simulating trials", trials_total);
  for (int participant = 1; participant <= simulation.participants; ++participant) {
    std::unique_lock lock(mutex);
    const std::optional<Work>& result = results[static_cast<std::size_t>(participant)];
    while (!result && !failure) {
      changed.wait_for(lock, std::chrono::milliseconds(100));
      if (bar) bar->update(trials);
    }
    if (failure || result == Work::interrupted) break;
    const bool finished = result == Work::finished;
    lock.unlock();
    if (finished) done(participant);
  }
  threads.clear();
  if (bar) bar->update(trials);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

std::string participant_code(int number) {
  return fmt::format("P{:02}", number);
}

std::int64_t simulated_epoch_ns(int participant) {
  return kFirstDay_ns + (participant - 1) * kDay_ns;
}

std::string simulated_session_id(std::uint64_t seed, int participant) {
  return sha256_hex(fmt::format("simulated/{}/{}", seed, participant)).substr(0, 32);
}

SimulationResult simulate_study(const Simulation& simulation, Study& study) {
  SimulationResult result;
  std::map<std::string, SessionInfo> known;
  for (const SessionInfo& session : study.sessions()) known.emplace(session.id, session);
  const std::string responder = "profile " + simulation.profile.name;
  std::atomic<std::int64_t> trials{0};
  std::int64_t total = 0;
  std::vector<int> already;
  for (int participant = 1; participant <= simulation.participants; ++participant) {
    total += main_trial_count(make_plan(simulation.protocol, participant, simulation.seed));
    const auto found = known.find(simulated_session_id(simulation.seed, participant));
    if (found == known.end()) continue;
    if (found->second.responder != responder)
      throw InputError(fmt::format(
          "participant {} of this study was simulated with {}, not {}; use that profile or another study file",
          participant_code(participant), found->second.responder, responder));
    trials += found->second.trials_done;
    if (found->second.state == "closed") already.push_back(participant);
  }

  const auto is_done = [&](int participant) { return std::binary_search(already.begin(), already.end(), participant); };
  std::vector<Stamp> ends(static_cast<std::size_t>(simulation.participants) + 1);
  const auto work = [&](int participant) {
    if (is_done(participant)) return Work::nothing_to_do;
    if (interrupt_requested()) return Work::interrupted;
    const Plan plan = make_plan(simulation.protocol, participant, simulation.seed);
    const std::string id = simulated_session_id(simulation.seed, participant);
    std::unique_ptr<SessionLog> log;
    if (known.contains(id)) {
      log = study.resume_session(id);
    } else {
      NewSession session;
      session.id = id;
      session.participant = participant_code(participant);
      session.participant_number = participant;
      session.kind = SessionKind::simulated;
      session.responder = responder;
      session.profile_sha256 = simulation.profile.sha256;
      const RigInfo rig = simulated_rig_info(simulation.protocol, simulation.rig.spec);
      session.rig = rig.name;
      session.rig_mode = rig.mode;
      session.tracker = rig.tracker;
      session.rig_sha256 = rig.sha256;
      session.trials_total = main_trial_count(plan);
      session.stamp = {simulated_epoch_ns(participant), 0};
      log = study.open_session(session);
    }
    if (run_participant(simulation, {}, plan, *log, trials) != SessionEnd::completed) return Work::interrupted;
    const SessionState state = replay(log->events());
    ends[static_cast<std::size_t>(participant)] = {state.last_utc_ns, state.last_monotonic_ns};
    return Work::finished;
  };
  const auto close = [&](int participant) {
    study.close_session(simulated_session_id(simulation.seed, participant),
                        ends[static_cast<std::size_t>(participant)]);
    ++result.completed;
  };
  for_each_participant(simulation, trials, total, work, close);
  result.already_complete = static_cast<int>(already.size());
  result.interrupted = interrupt_requested();
  return result;
}

std::vector<CellCounts> simulate_counts(const Simulation& simulation, const RigFilter& rig_filter) {
  std::vector<std::vector<CellCounts>> cells(static_cast<std::size_t>(simulation.participants) + 1);
  std::atomic<std::int64_t> trials{0};
  const std::int64_t total =
      std::int64_t{simulation.participants} * main_trial_count(make_plan(simulation.protocol, 1, simulation.seed));
  const auto work = [&](int participant) {
    if (interrupt_requested()) return Work::interrupted;
    CountsLog log;
    const Plan plan = make_plan(simulation.protocol, participant, simulation.seed);
    if (run_participant(simulation, rig_filter, plan, log, trials) != SessionEnd::completed) return Work::interrupted;
    cells[static_cast<std::size_t>(participant)] = log.cells(simulation.protocol, participant_code(participant));
    return Work::finished;
  };
  for_each_participant(simulation, trials, total, work, [](int) {});
  std::vector<CellCounts> all;
  if (interrupt_requested()) return all;
  for (const auto& one : cells) all.insert(all.end(), one.begin(), one.end());
  return all;
}

AdaptiveResults simulate_thresholds(const Simulation& simulation) {
  std::vector<std::vector<AdaptiveRow>> rows(static_cast<std::size_t>(simulation.participants) + 1);
  std::atomic<std::int64_t> trials{0};
  const std::int64_t total =
      std::int64_t{simulation.participants} * main_trial_count(make_plan(simulation.protocol, 1, simulation.seed));
  const auto work = [&](int participant) {
    if (interrupt_requested()) return Work::interrupted;
    MemoryLog log;
    const Plan plan = make_plan(simulation.protocol, participant, simulation.seed);
    if (run_participant(simulation, {}, plan, log, trials) != SessionEnd::completed) return Work::interrupted;
    rows[static_cast<std::size_t>(participant)] =
        adaptive_rows(log.events(), simulation.protocol, participant_code(participant), SessionKind::simulated);
    return Work::finished;
  };
  for_each_participant(simulation, trials, total, work, [](int) {});
  AdaptiveResults results;
  results.kind = SessionKind::simulated;
  if (interrupt_requested()) return results;
  for (const auto& one : rows) results.rows.insert(results.rows.end(), one.begin(), one.end());
  results.group = adaptive_group(results.rows, simulation.protocol);
  return results;
}

}  // namespace jnd
