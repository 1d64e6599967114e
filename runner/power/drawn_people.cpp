#include "runner/power/drawn_people.h"

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "analysis/numerics/binomial.h"
#include "analysis/numerics/experiment_stream.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/stop_request.h"
#include "data/task_results/participant_tracks.h"
#include "protocols/input/resources.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/plan.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"
#include "runner/opening/rig_limits.h"
#include "runner/opening/study_access.h"
#include "runner/session/simulate.h"

namespace jnd {

namespace {

// An answer that counts.
struct PersonAnswer {
  int condition = 0, series = 0;  // places in the protocol
  AnsweredTrial trial;
};

// Of all sessions of a participant.
struct PersonAnswers {
  std::vector<PersonAnswer> given;    // in their order
  std::vector<AdaptiveTrack> tracks;  // of a procedure; all sessions
};

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

void add_threshold(DrawnPerson& person, int participant, std::size_t condition, const std::vector<SeriesCounts>& series,
                   const Protocol& protocol, const ThresholdMethod& method) {
  TaskEstimateRow& row = person.estimates.emplace_back();
  row.participant = name_of(participant);
  row.group = person.group;
  row.condition = static_cast<int>(condition);
  const double reference = protocol.stimulus.reference;
  row.estimates = estimates_of(estimate_jnd(series, reference, method.method, method.correction), reference);
}

// Same-different with given levels.
void add_thresholds(DrawnPerson& person, int participant, const std::vector<PersonAnswer>& given,
                    const Protocol& protocol) {
  const ThresholdMethod method = registered_method(protocol);
  for (const int condition : conditions_of(protocol, person.group)) {
    std::vector<SeriesCounts> series;
    for (const Series& one : protocol.series) series.push_back({std::abs(one.pair[1] - one.pair[0]), {}});
    for (const PersonAnswer& one : given) {
      if (one.condition != condition) continue;
      series[static_cast<std::size_t>(one.series)].counts.add(one.trial.target == kClassSame,
                                                              one.trial.said == kClassDifferent);
    }
    add_threshold(person, participant, static_cast<std::size_t>(condition), series, protocol, method);
  }
}

void add_estimates(DrawnPerson& person, int participant, const PersonAnswers& answers, const Protocol& protocol) {
  std::map<std::pair<int, int>, std::vector<AnsweredTrial>> by_cell;  // condition and series
  for (const PersonAnswer& one : answers.given) by_cell[{one.condition, one.series}].push_back(one.trial);
  for (const auto& [place, trials] : by_cell) {
    std::vector<AdaptiveTrack> own;
    for (const AdaptiveTrack& track : answers.tracks)
      if (track.condition == place.first && track.series == place.second) own.push_back(track);
    TaskEstimateRow& row = person.estimates.emplace_back();
    row.participant = name_of(participant);
    row.group = person.group;
    row.condition = place.first;
    row.standard = place.second;
    row.trials = static_cast<int>(trials.size());
    row.estimates = measured_estimates(protocol, protocol.series[static_cast<std::size_t>(place.second)], trials, own);
  }
}

// What the answers leave for the analyses. person: with its group. participant: from 1. protocol: of a task with a response model.
void add_measured(DrawnPerson& person, int participant, const PersonAnswers& answers, const Protocol& protocol) {
  const Task& task = task_of(protocol.task.kind);
  const AnswerModel observer = task.answer_model(protocol).value();
  const bool given_pairs = task.evidence(protocol) == Evidence::counts;
  for (const PersonAnswer& one : answers.given) {
    LevelAnswer answer = task.level_answer(one.trial, protocol.task);
    if (answer.level == 0 && given_pairs) {
      const std::array<double, 2>& pair = protocol.series[static_cast<std::size_t>(one.series)].pair;
      answer.level = observer.level_of_equal(std::abs(pair[1] - pair[0]));
    }
    add_answers(person.answers, static_cast<std::size_t>(one.condition), answer.level, answer.positive ? 1 : 0,
                answer.positive ? 0 : 1);
  }
  if (given_pairs)
    add_thresholds(person, participant, answers.given, protocol);
  else
    add_estimates(person, participant, answers, protocol);
}

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

PersonAnswer given_answer(const Trial& trial, const Answer& answer) {
  return {
      trial.condition,
      trial.series,
      {trial.stimuli, trial.standard, trial.target, answer.said, answer.sureness, answer.number, trial.standard_place}};
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
    person.ln_s.push_back(truth.mu[c] + u + truth.tv_of(c) * normal(stream));
    person.k.push_back(truth.kappa[c] + w);
  }
  return person;
}

// Everybody drawn from the population, one by one.
class ModelledPeople : public PeopleSource {
 public:
  ModelledPeople(const Protocol& protocol, const PowerQuestion& question, double effect)
      : protocol_(protocol),
        question_(question),
        effect_(effect),
        observer_(task_of(protocol.task.kind).answer_model(protocol).value()),
        truth_(truth_of(question, effect, protocol)) {}

  std::vector<DrawnPerson> people(std::uint64_t study, int count) const override {
    std::vector<DrawnPerson> all;
    for (int p = 1; p <= count; ++p) {
      ExperimentStream stream(question_.seed, kPersonPurpose, study, static_cast<std::uint64_t>(p));
      Person person = person_of(truth_, question_.people, stream);
      const std::optional<int> group = group_of(protocol_, p, seed_of_plans(study));
      for (std::size_t c = 0; c < person.ln_s.size(); ++c) person.ln_s[c] += group_shift(question_, effect_, group, c);
      DrawnPerson& drawn = all.emplace_back();
      drawn.group = group;
      drawn.dropped = person.dropped;
      if (!drawn.dropped) answer(person, study, p, stream, drawn);
    }
    return all;
  }

 protected:
  // stream: what is left of the person's own numbers.
  virtual void answer(const Person& person, std::uint64_t study, int participant, ExperimentStream& stream,
                      DrawnPerson& drawn) const = 0;

  // Who gets which trials, and belongs to which group.
  std::uint64_t seed_of_plans(std::uint64_t study) const noexcept { return question_.seed + study; }

  // Of a positive answer.
  double rate(const Person& person, double level, std::size_t condition) const {
    return std::exp(
        log_rates(observer_.response, level, person.ln_s[condition], person.k[condition], question_.people.lapse)
            .positive);
  }

  const Protocol& protocol_;
  const PowerQuestion& question_;
  double effect_;
  AnswerModel observer_;
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
    for (const int condition : conditions_of(protocol_, drawn.group)) {
      const auto c = static_cast<std::size_t>(condition);
      for (std::size_t s = 0; s < series.size(); ++s) {
        const std::array<double, 2>& pair = protocol_.series[s].pair;
        const double difference = std::abs(pair[1] - pair[0]), equal = observer_.level_of_equal(difference);
        const double sizes = uniform(stream), of_different = uniform(stream), of_same = uniform(stream);
        Counts counts;
        counts.n_diff = protocol_.design.sampling == Sampling::random ? binomial(trials, 0.5, sizes) : trials / 2;
        counts.n_same = trials - counts.n_diff;
        const double hit = rate(person, difference, c), false_alarm = rate(person, equal, c);
        counts.hits = binomial(counts.n_diff, hit, of_different);
        counts.false_alarms = binomial(counts.n_same, false_alarm, of_same);
        series[s] = {difference, counts};
        add_answers(drawn.answers, c, difference, counts.hits, counts.n_diff - counts.hits);
        add_answers(drawn.answers, c, equal, counts.false_alarms, counts.n_same - counts.false_alarms);
      }
      add_threshold(drawn, participant, c, series, protocol_, method_);
    }
  }

  ThresholdMethod method_;
};

// Every other design, trial by trial through the participant's plan.
class AnsweringPeople final : public ModelledPeople {
 public:
  using ModelledPeople::ModelledPeople;

 private:
  bool choice() const noexcept { return observer_.response == ResponseModel::choice; }

  void answer(const Person& person, std::uint64_t study, int participant, ExperimentStream& /*stream*/,
              DrawnPerson& drawn) const override {
    const auto number = static_cast<std::uint64_t>(participant);
    // Of each condition numbers of its own, so that what another one asks changes nothing.
    std::vector<ExperimentStream> streams;
    for (std::size_t c = 0; c < truth_.mu.size(); ++c)
      streams.emplace_back(question_.seed, kAnswerPurpose + c, study, number);
    PersonAnswers answers;
    for (int session = 1; session <= protocol_.design.sessions; ++session) {
      AdaptiveRun run(protocol_);
      const Plan plan = make_plan(protocol_, participant, seed_of_plans(study), session);
      for (const Trial& planned : plan.trials) {
        if (planned.practice || run.over(planned)) continue;
        const Trial trial = run.resolved(planned);
        const auto condition = static_cast<std::size_t>(trial.condition);
        const Answer answer = answer_to(trial, person, condition, uniform(streams[condition]));
        run.answered(planned, answer);
        answers.given.push_back(given_answer(trial, answer));
      }
      for (AdaptiveTrack& track : run.tracks()) answers.tracks.push_back(std::move(track));
    }
    add_measured(drawn, participant, answers, protocol_);
  }

  // The answer that u stands for.
  Answer answer_to(const Trial& trial, const Person& person, std::size_t condition, double u) const {
    const AnsweredTrial felt = given_answer(trial, {}).trial;
    const double level = task_of(protocol_.task.kind).level_answer(felt, protocol_.task).level;
    const bool positive = u < rate(person, level, condition);
    if (!choice()) return {.said = positive ? 1 : 0};  // "different" and "same", "yes" and "no"
    const int standard = trial.standard_place >= 0 ? trial.standard_place : trial.stimuli[0] == trial.standard ? 0 : 1;
    const int greater = positive ? 1 - standard : standard;
    return {.said = protocol_.task.greater ? greater : 1 - greater};
  }
};

// Whole sessions on the simulated rig, as jnd simulate has them, of the shipped participants or those of a file.
class RiggedPeople final : public PeopleSource {
 public:
  RiggedPeople(const Protocol& protocol, const PowerQuestion& question)
      : protocol_(protocol),
        question_(question),
        rig_(rig_of(protocol)),
        profile_(load_profile(find_resource(Resource::profile, question.profile.value()))) {}

  std::vector<DrawnPerson> people(std::uint64_t study, int count) const override {
    Simulation simulation{protocol_, rig_, profile_};
    simulation.record = RecordPolicy::off;
    simulation.participants = count;
    simulation.seed = seed_of_study(question_.seed, static_cast<std::int64_t>(study));
    std::vector<DrawnPerson> all(static_cast<std::size_t>(count));
    const bool whole = simulate_people(simulation, [&](const SimulatedSessions& simulated) {
      DrawnPerson& drawn = all[static_cast<std::size_t>(simulated.participant - 1)];
      drawn.group = simulated.group;
      add_measured(drawn, simulated.participant, answers_of(simulated), protocol_);
    });
    if (!whole) throw Stopped();  // what there is then is no study
    for (std::size_t p = 0; p < all.size(); ++p) {
      ExperimentStream stream(question_.seed, kPersonPurpose, study, p + 1);
      all[p].dropped = uniform(stream) < question_.people.drop_out;
    }
    return all;
  }

 private:
  PersonAnswers answers_of(const SimulatedSessions& simulated) const {
    PersonAnswers answers;
    for_counted(simulated, protocol_,
                [&](const TrialRecord& record) { answers.given.push_back(given_answer(record.trial, record.answer)); });
    if (!levels_given(protocol_))
      answers.tracks =
          participant_tracks(simulated.events, protocol_, participant_code(simulated.participant), simulated.group);
    return answers;
  }

  const Protocol& protocol_;
  const PowerQuestion& question_;
  RigDescription rig_;
  ParticipantProfile profile_;
};

}  // namespace

std::unique_ptr<PeopleSource> people_source(const Protocol& protocol, const PowerQuestion& question, double effect) {
  if (question.profile) return std::make_unique<RiggedPeople>(protocol, question);
  if (task_of(protocol.task.kind).evidence(protocol) == Evidence::counts)
    return std::make_unique<CountedPeople>(protocol, question, effect);
  return std::make_unique<AnsweringPeople>(protocol, question, effect);
}

}  // namespace jnd
