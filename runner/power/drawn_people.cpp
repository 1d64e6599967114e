#include "runner/power/drawn_people.h"

#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "analysis/numerics/binomial_sampler.h"
#include "analysis/numerics/experiment_stream.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/stop_request.h"
#include "protocols/input/resources.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/plan.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/same_different_task.h"
#include "protocols/tasks/task.h"
#include "runner/keys/interrupt.h"
#include "runner/opening/rig_limits.h"
#include "runner/opening/study_access.h"
#include "runner/session/simulate.h"

namespace jnd {

namespace {

// Keep the numbers of this use of a seed apart from others.
constexpr std::uint64_t kPersonPurpose = 0x6a6e6420'706f7772, kAnswerPurpose = 0x6a6e6420'616e7377;

double uniform(ExperimentStream& stream) {
  return open_uniform(stream.next());
}

double normal(ExperimentStream& stream) {
  return normal_quantile(uniform(stream));
}

// The count at which the distribution function of Binomial(n, p) passes u.
int binomial(int n, double p, double u) {
  constexpr int kFew = 60;  // more: the first terms may underflow
  if (p <= 0 || n == 0) return 0;
  if (p >= 1) return n;
  if (n > kFew) return BinomialSampler(n, p).at(u);
  const double odds = p / (1 - p);
  double term = std::exp(n * std::log1p(-p)), below = term;
  int k = 0;
  while (below < u && k < n) {
    term *= odds * (n - k) / (k + 1);
    ++k;
    below += term;
  }
  return k;
}

// Somebody of the population.
struct Person {
  bool dropped = false;
  std::vector<double> ln_s, k;  // by condition
};

Person person_of(const HierarchicalPlace& truth, const Population& people, ExperimentStream& stream) {
  Person person;
  person.dropped = uniform(stream) < people.drop_out;
  const double u = truth.tu * normal(stream), w = truth.tw * normal(stream);
  for (std::size_t c = 0; c < truth.mu.size(); ++c) {
    person.ln_s.push_back(truth.mu[c] + u + truth.tv * normal(stream));
    person.k.push_back(truth.kappa[c] + w);
  }
  return person;
}

// "1": its number; what results call a participant does not matter here.
std::string name_of(int participant) {
  return fmt::format("{}", participant);
}

// Cells of equal levels are added up.
void add_answers(std::vector<HierarchicalCell>& cells, std::size_t condition, double level, int positive,
                 int negative) {
  for (HierarchicalCell& cell : cells)
    if (cell.condition == static_cast<int>(condition) && cell.level == level) {
      cell.positive += positive;
      cell.negative += negative;
      return;
    }
  cells.push_back(
      {0, static_cast<int>(condition), level, static_cast<double>(positive), static_cast<double>(negative)});
}

ThresholdResult threshold_of(int participant, std::size_t condition, const std::vector<SeriesCounts>& series,
                             const Protocol& protocol, const ThresholdMethod& method) {
  ThresholdResult result;
  result.participant = name_of(participant);
  result.condition = static_cast<int>(condition);
  result.jnd = estimate_jnd(series, protocol.stimulus.reference, method.method, method.correction);
  return result;
}

// Everybody drawn from the population, one by one.
class ModelledPeople : public PeopleSource {
 public:
  ModelledPeople(const Protocol& protocol, const PowerQuestion& question, double effect)
      : protocol_(protocol),
        question_(question),
        model_(response_model_of(protocol).value()),
        truth_(truth_of(question, effect, protocol)) {}

  std::vector<DrawnPerson> people(std::uint64_t study, int count) const override {
    std::vector<DrawnPerson> all;
    for (int p = 1; p <= count; ++p) {
      ExperimentStream stream(question_.seed, kPersonPurpose, study, static_cast<std::uint64_t>(p));
      const Person person = person_of(truth_, question_.people, stream);
      DrawnPerson& drawn = all.emplace_back();
      drawn.dropped = person.dropped;
      if (!drawn.dropped) answer(person, study, p, stream, drawn);
    }
    return all;
  }

 protected:
  // stream: what is left of the person's own numbers.
  virtual void answer(const Person& person, std::uint64_t study, int participant, ExperimentStream& stream,
                      DrawnPerson& drawn) const = 0;

  // Of a positive answer.
  double rate(const Person& person, double level, std::size_t condition) const {
    return std::exp(
        log_rates(model_, level, person.ln_s[condition], person.k[condition], question_.people.lapse).positive);
  }

  const Protocol& protocol_;
  const PowerQuestion& question_;
  ResponseModel model_;
  HierarchicalPlace truth_;
};

// Same-different with given levels: counts of a cell by inversion, one number a class.
class CountedPeople final : public ModelledPeople {
 public:
  CountedPeople(const Protocol& protocol, const PowerQuestion& question, double effect)
      : ModelledPeople(protocol, question, effect), method_(registered_method(protocol)) {}

 private:
  void answer(const Person& person, std::uint64_t /*study*/, int participant, ExperimentStream& stream,
              DrawnPerson& drawn) const override {
    const int trials = protocol_.design.trials_per_cell * protocol_.design.sessions;
    std::vector<SeriesCounts> series(protocol_.series.size());
    for (std::size_t c = 0; c < person.ln_s.size(); ++c) {
      for (std::size_t s = 0; s < series.size(); ++s) {
        const std::array<double, 2>& pair = protocol_.series[s].pair;
        const double difference = std::abs(pair[1] - pair[0]);
        const double sizes = uniform(stream), of_different = uniform(stream), of_same = uniform(stream);
        Counts counts;
        counts.n_diff = protocol_.design.sampling == Sampling::random ? binomial(trials, 0.5, sizes) : trials / 2;
        counts.n_same = trials - counts.n_diff;
        const double hit = rate(person, difference, c), false_alarm = rate(person, 0, c);
        counts.hits = binomial(counts.n_diff, hit, of_different);
        counts.false_alarms = binomial(counts.n_same, false_alarm, of_same);
        series[s] = {difference, counts};
        add_answers(drawn.answers, c, difference, counts.hits, counts.n_diff - counts.hits);
        add_answers(drawn.answers, c, 0, counts.false_alarms, counts.n_same - counts.false_alarms);
      }
      drawn.thresholds.push_back(threshold_of(participant, c, series, protocol_, method_));
    }
  }

  ThresholdMethod method_;
};

// Every other design, trial by trial through the participant's plan.
class AnsweringPeople final : public ModelledPeople {
 public:
  using ModelledPeople::ModelledPeople;

 private:
  bool choice() const noexcept { return model_ == ResponseModel::choice; }

  void answer(const Person& person, std::uint64_t study, int participant, ExperimentStream& /*stream*/,
              DrawnPerson& drawn) const override {
    const auto number = static_cast<std::uint64_t>(participant);
    // Of each condition numbers of its own, so that what another one asks changes nothing.
    std::vector<ExperimentStream> streams;
    for (std::size_t c = 0; c < truth_.mu.size(); ++c)
      streams.emplace_back(question_.seed, kAnswerPurpose + c, study, number);
    std::map<std::pair<int, int>, std::vector<AnsweredTrial>> answered;  // by condition and series
    std::vector<AdaptiveTrack> tracks;
    for (int session = 1; session <= protocol_.design.sessions; ++session) {
      AdaptiveRun run(protocol_);
      const Plan plan = make_plan(protocol_, participant, question_.seed + study, session);
      for (const Trial& planned : plan.trials) {
        if (planned.practice || run.over(planned)) continue;
        const Trial trial = run.resolved(planned);
        const auto condition = static_cast<std::size_t>(trial.condition);
        const Answer answer = answer_to(trial, person, condition, uniform(streams[condition]), drawn.answers);
        run.answered(planned, answer);
        answered[{trial.condition, trial.series}].push_back({trial.stimuli, trial.standard, trial.target, answer.said,
                                                             answer.sureness, answer.number, trial.standard_place});
      }
      for (AdaptiveTrack& track : run.tracks()) tracks.push_back(std::move(track));
    }
    if (task_of(protocol_.task.kind).has_own_results())
      add_tracks(drawn, participant, tracks);
    else
      add_estimates(drawn, participant, answered, tracks);
  }

  // The answer that u stands for, which is also counted.
  Answer answer_to(const Trial& trial, const Person& person, std::size_t condition, double u,
                   std::vector<HierarchicalCell>& counted) const {
    const Task& task = task_of(protocol_.task.kind);
    const AnsweredTrial felt{.stimuli = trial.stimuli,
                             .standard = trial.standard,
                             .target = trial.target,
                             .standard_place = trial.standard_place};
    const double level = task.level_answer(felt, protocol_.task).level;
    const bool positive = u < rate(person, level, condition);
    add_answers(counted, condition, level, positive ? 1 : 0, positive ? 0 : 1);
    if (!choice()) return {.said = positive ? 1 : 0};  // "different" and "same", "yes" and "no"
    const int standard = trial.standard_place >= 0 ? trial.standard_place : trial.stimuli[0] == trial.standard ? 0 : 1;
    const int greater = positive ? 1 - standard : standard;
    return {.said = protocol_.task.greater ? greater : 1 - greater};
  }

  void add_estimates(DrawnPerson& drawn, int participant,
                     const std::map<std::pair<int, int>, std::vector<AnsweredTrial>>& answered,
                     const std::vector<AdaptiveTrack>& tracks) const {
    for (const auto& [place, trials] : answered) {
      std::vector<AdaptiveTrack> own;
      for (const AdaptiveTrack& track : tracks)
        if (track.condition == place.first && track.series == place.second) own.push_back(track);
      TaskEstimateRow& row = drawn.estimates.emplace_back();
      row.participant = name_of(participant);
      row.condition = place.first;
      row.series = place.second;
      row.trials = static_cast<int>(trials.size());
      row.estimates =
          measured_estimates(protocol_, protocol_.series[static_cast<std::size_t>(place.second)], trials, own);
    }
  }

  void add_tracks(DrawnPerson& drawn, int participant, const std::vector<AdaptiveTrack>& tracks) const {
    std::map<int, std::vector<AdaptiveTrack>> by_condition;
    for (const AdaptiveTrack& track : tracks) by_condition[track.condition].push_back(track);
    for (const auto& [condition, own] : by_condition) {
      AdaptiveRow& row = drawn.tracks.emplace_back();
      row.participant = name_of(participant);
      row.condition = condition;
      row.threshold = condition_threshold(own, protocol_);
    }
  }
};

// Through the model of the device, with the shipped participants, or those of a file.
class RiggedPeople final : public PeopleSource {
 public:
  RiggedPeople(const Protocol& protocol, const PowerQuestion& question)
      : protocol_(protocol),
        question_(question),
        rig_(rig_of(protocol)),
        profile_(load_profile(find_resource(Resource::profile, question.profile.value()))),
        method_(registered_method(protocol)) {}

  std::vector<DrawnPerson> people(std::uint64_t study, int count) const override {
    Simulation simulation{protocol_, rig_, profile_};
    simulation.record = RecordPolicy::off;
    simulation.participants = count;
    simulation.seed = ExperimentStream(question_.seed, kPersonPurpose, study).next();
    std::vector<DrawnPerson> all(static_cast<std::size_t>(count));
    std::vector<std::vector<std::vector<SeriesCounts>>> series(
        all.size(), std::vector<std::vector<SeriesCounts>>(protocol_.conditions.size()));
    const std::vector<CellCounts> cells = simulate_counts(simulation);
    if (interrupt_requested()) throw Stopped();  // what came back then is no study
    std::map<std::string, std::size_t> places;   // in the order of their numbers
    for (const CellCounts& cell : cells) {
      const std::size_t p = places.emplace(cell.participant, places.size()).first->second;
      const std::array<double, 2>& pair = protocol_.series[static_cast<std::size_t>(cell.series)].pair;
      const double difference = std::abs(pair[1] - pair[0]);
      const auto c = static_cast<std::size_t>(cell.condition);
      const Counts& counts = cell.counts;
      series[p][c].push_back({difference, counts});
      add_answers(all[p].answers, c, difference, counts.hits, counts.n_diff - counts.hits);
      add_answers(all[p].answers, c, 0, counts.false_alarms, counts.n_same - counts.false_alarms);
    }
    for (std::size_t p = 0; p < all.size(); ++p) {
      ExperimentStream stream(question_.seed, kPersonPurpose, study, p + 1);
      all[p].dropped = uniform(stream) < question_.people.drop_out;
      for (std::size_t c = 0; c < protocol_.conditions.size(); ++c)
        all[p].thresholds.push_back(threshold_of(static_cast<int>(p) + 1, c, series[p][c], protocol_, method_));
    }
    return all;
  }

 private:
  const Protocol& protocol_;
  const PowerQuestion& question_;
  RigDescription rig_;
  ParticipantProfile profile_;
  ThresholdMethod method_;
};

}  // namespace

std::unique_ptr<PeopleSource> people_source(const Protocol& protocol, const PowerQuestion& question, double effect) {
  if (question.profile) return std::make_unique<RiggedPeople>(protocol, question);
  if (protocol.task.kind == TaskKind::same_different && !protocol.design.procedure)
    return std::make_unique<CountedPeople>(protocol, question, effect);
  return std::make_unique<AnsweringPeople>(protocol, question, effect);
}

}  // namespace jnd
