// What a trial asks, as one thing: its words and keys, how its intervals are drawn, which answer is correct, how the
// answer follows from what was felt, and what the answers measure. Whoever plans, runs, logs, checks, exports or reports
// a study asks the task, and does not care which one it is.
//
// A trial belongs to one of the task's classes (Trial::target), and an answer says one of them (Answer::said): it is
// correct where the two are the same, and neither where the trial has none (-1).
//
// Free interaction is a task without trials. Who sets the levels is asked of level_source.h.
//
// A new task is a class here, its word in TaskKind, its place in task.cpp, a shipped protocol and its tests.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/hierarchical/response_model.h"
#include "protocols/protocol.h"
#include "protocols/random_stream.h"

namespace jnd {

class JsonReader;

// Classes of the task of two intervals, "are the two the same?".
inline constexpr int kClassSame = 0, kClassDifferent = 1;

// A contradiction in a protocol, at a JSON path.
struct TaskProblem {
  std::string path, message, suggestion;
};

// What an estimate of a participant in a condition rests on: the answers one by one (Task::estimate); where the tracks of
// a procedure come to; or how often each answer was given to each pair, of which d' follows.
enum class Evidence { answers, tracks, counts };

// What a small protocol of the task has, to start from. Levels are shares of the standard.
struct TaskStart {
  std::string_view asks{};                 // said after the intervals, of stiffness
  std::string_view asks_of_other{};        // of another quantity, whose name stands for {}; empty: the same
  std::string_view keys{};                 // JSON; empty: the answers have no words of their own
  std::vector<double> levels{};            // of identify the classes, of pairs the other value of each
  std::string_view levels_are = "Levels";  // asked for by these words
  int trials_per_cell = 0;
  std::string_view analysis{};  // JSON
};

// The stimuli of a trial before it has its place in a plan.
struct DrawnTrial {
  Intervals stimuli;
  int target = -1;
  int side = -1;            // of a stimulus that the answers set
  int standard_place = -1;  // Trial::standard_place
};

// What is drawn: `trials` of each level, or of the cell where the task has no levels, or of a track.
struct CellDraw {
  const Protocol& protocol;
  const Series& series;
  int trials = 0;
  Sampling sampling = Sampling::balanced;
};

// What the participant felt of one interval.
struct Felt {
  double value = 0;  // with its noise
  double sigma = 0;  // of that noise
};

// An answered trial, for the task's estimates.
struct AnsweredTrial {
  Intervals stimuli;
  double standard = 0;
  int target = -1;
  int said = 0;
  int sureness = 0;
  std::optional<double> number{};
  int standard_place = -1;  // Trial::standard_place
  bool correct() const noexcept { return said == target; }
};

// A number that a task measures.
struct TaskOutcome {
  std::string_view key;      // of files: "pse"
  std::string_view title;    // of tables: "PSE"
  std::string unit{};        // as people write it; empty: none
  std::string meaning{};     // one line, for the dictionary
  bool positive = false;     // its logarithm may be compared
  bool of_standard = false;  // a share of the standard, such as a Weber fraction
  // Tests may leave out who has none, which picks nobody: a slope is there for everyone who answered both ways.
  bool may_lack = false;
  bool share = false;       // between 0 and 1, and so are the ends of its intervals
  bool own_status = false;  // it may have no value where the others have
};

// Where there is no value: whether it is known to lie above, or below, every value. A median counts it there.
enum class Beyond { no, above, below };

// What became of one outcome. Where there is no value the status of all says why, or its own; an interval's end, and a slope, may be infinite.
struct TaskEstimate {
  std::optional<double> value{}, low{}, high{};  // low, high: 95 %
  double prior_weight = 0;                       // as of AdaptiveThreshold
  Beyond beyond = Beyond::no;
  std::string_view why{};  // of an outcome with an own_status: why it has no value; else empty
};
struct TaskEstimates {
  std::string status = "ok";            // of all of them
  std::vector<TaskEstimate> values;     // in the order of measured_outcomes()
  TrackCount tracks{};                  // behind the outcome that is of tracks, where one is
  std::vector<std::string> cautions{};  // remarks that exclude nothing: "extrapolated"
  int series_used = 0;                  // of estimates over all series of a condition: those in the fit
};

// How an answer depends on the level, in one model of everybody's answers (analysis/hierarchical).
struct AnswerModel {
  ResponseModel response = ResponseModel::yes_no;
  std::string_view jnd = "jnd";  // key of the outcome that is the JND
  double jnd_of_s = 1;           // that JND, as registered, of a spread s of 1
  double lapse = 0;              // fixed, as registered; 0 where it is free
  // Of choices: no comparison, of any standard, lies on the other side, and the PSE is taken as the standard.
  bool pse_at_standard = false;

  // Of equal stimuli in a series whose others differ by so much: none, but an observer who judges each interval by itself
  // says "same" the more, the further apart the others are (response_model.h).
  double level_of_equal(double difference) const noexcept {
    return response == ResponseModel::independent ? -difference : 0;
  }
};

// An answer as that model reads it.
struct LevelAnswer {
  double level = 0;       // the comparison less the standard; where that has no sign, their distance
  bool positive = false;  // "different", "yes", or the comparison
};

// How often it was given, in one half of a participant's trials.
struct LevelCount {
  double level = 0;
  int positive = 0, negative = 0;
  bool second_half = false;
  int sure_positive = 0, sure_negative = 0;  // of these, where sureness is asked
};

// The share of trials in which a class was said, and what the fit says of it, over the levels: for figures and tables.
struct TaskCurve {
  struct Point {
    double x = 0;  // level
    int n = 0, said = 0;
  };
  std::string said;               // what is counted, in words: "the comparison said to be stiffer"
  std::vector<Point> points;      // by level
  std::vector<double> x, fitted;  // the fitted curve, empty without one
};

class Task {
 public:
  virtual ~Task() = default;
  virtual TaskKind kind() const noexcept = 0;
  // One line: what it asks, for lists and help.
  virtual std::string_view summary() const noexcept = 0;

  // Whether it has trials: free interaction has none.
  virtual bool has_trials() const noexcept { return true; }
  // Whether a series is a pair of values, either of which a trial may present twice; otherwise it has a standard or levels.
  virtual bool has_pairs() const noexcept { return false; }
  // Key of files that says whether a trial belongs to the first class, in place of the class's word; empty: the word.
  virtual std::string_view first_class_key() const noexcept { return {}; }
  // Where a protocol's file has the values that are presented, if they are given.
  virtual std::string_view values_path() const noexcept { return "$.levels"; }
  virtual TaskStart start() const { return {}; }

  // Reading. The keys of the section "task" that are its own, and the words of its answers.
  virtual void read(JsonReader& section, TaskSpec& spec) const = 0;
  // What a loaded protocol contradicts itself in, as far as it is the task's.
  virtual std::vector<TaskProblem> problems(const Protocol&) const { return {}; }
  // Whether the levels are differences from a standard, so that a procedure can set them.
  virtual bool has_procedures() const noexcept { return false; }
  // The response model by which the Bayesian procedure chooses such levels, and by which all answers together have a
  // posterior; a yes-no signal is judged like a difference. None where it has none.
  virtual std::optional<PosteriorTask> posterior_task() const noexcept { return std::nullopt; }
  // None where the answers of the task have no such model, or not with what the protocol registers.
  virtual std::optional<AnswerModel> answer_model(const Protocol&) const { return std::nullopt; }
  // What of the protocol has none then, for messages: "the task "identify"".
  virtual std::string without_model(const Protocol& protocol) const;
  // Of a task with an answer_model().
  virtual LevelAnswer level_answer(const AnsweredTrial&, const TaskSpec&) const { return {}; }
  // Whether trials without a difference, or without a signal, are part of the task.
  virtual bool has_catch_trials() const noexcept { return false; }
  // Whether a level may equal the standard: otherwise a trial of it would have no correct answer.
  virtual bool level_may_be_standard() const noexcept { return false; }
  // Whether a series has a standard that the levels are compared with; otherwise they stand for themselves.
  virtual bool has_standard() const noexcept { return true; }
  // How many trials of a level hold every order equally often: with balanced sampling trials_per_cell is a multiple.
  virtual int balance_of(const TaskSpec&) const noexcept { return 1; }

  // Planning.
  // How many cells of `trials_per_cell` trials a condition has in a series: by default one for every level.
  virtual int cells_in(const Series& series) const noexcept { return static_cast<int>(series.levels.size()); }
  // Trials of a condition in a series whose levels are given: by default those of its cells.
  virtual int trials_of_levels(const Protocol& protocol, const Series& series) const;
  virtual Evidence evidence(const Protocol&) const noexcept { return Evidence::answers; }
  // Words for a condition's cells whose levels are given: "1 standard x 8 levels x 10 trials per cell".
  virtual std::string cells_text(const Protocol& protocol) const;
  virtual int intervals(const TaskSpec& spec) const noexcept = 0;
  // The arrangements of a comparison that lies on that side of the standard (-1 below, 1 above, 0 at or across it), which
  // come equally often, whoever sets the level.
  virtual std::vector<DrawnTrial> arrangements(const CellDraw&, double /*comparison*/, int /*side*/) const {
    return {};
  }
  // A cell, in any order: the plan shuffles nothing after it. By default the arrangements of all levels.
  virtual std::vector<DrawnTrial> draw(const CellDraw& cell, RandomStream& stream) const;
  // The slots of a track of the procedure, `trials` of them with a comparison that the answers set: by default its
  // arrangements.
  virtual std::vector<DrawnTrial> draw_track(const CellDraw& track, const AdaptiveProcedure& procedure,
                                             RandomStream& stream) const;
  // A round of practice with `trials` trials: of every level, as far as they go.
  virtual std::vector<DrawnTrial> draw_practice(const CellDraw& round, RandomStream& stream) const;
  // Which class a trial's stimuli belong to, once all are known.
  virtual int target_of(const Intervals&, double /*standard*/, const TaskSpec&) const noexcept { return -1; }
  // What a plan says of a trial in words: "same", "second", "signal".
  virtual std::string target_word(const Trial& trial, const TaskSpec& spec) const;

  // Whether answers may move the last stimulus, so that a trial goes on until one of them accepts it.
  virtual bool adjusts() const noexcept { return false; }
  // Then: the stimuli to present next after an answer; none: it ends the trial. now: what was presented, of a trial that
  // was planned as `trial`.
  virtual std::optional<Intervals> moved(const Intervals& /*now*/, const Answer&, const Trial& /*trial*/,
                                         const Protocol&) const {
    return std::nullopt;
  }
  // How often a trial's intervals are presented, on average, by somebody who accepts what equals the standard.
  virtual double expected_looks(const Protocol&) const { return 1; }
  // And what is logged of an answer that ended the trial.
  virtual Answer settled(Answer answer, const Intervals& /*presented*/) const noexcept { return answer; }

  // The response model: what is answered by somebody who felt that. One draw each from `stream` where a coin decides.
  virtual Answer answer(std::span<const Felt>, const Trial&, const Protocol&, RandomStream&) const { return {}; }

  // Whether a simulated participant compares two presentations cue by cue, by its profile's criterion, and not by answer().
  virtual bool compares_cues() const noexcept { return false; }
  // The same without bias, to which two equal intervals differ with a standard deviation of `noise`, in the study's unit.
  virtual Answer unbiased_answer(const Intervals& presented, const Trial& trial, const Protocol& protocol, double noise,
                                 RandomStream& stream) const;
  // How that observer answers, in words.
  virtual std::string unbiased_words(const Protocol&) const;

  // Results.
  virtual std::vector<TaskOutcome> outcomes(const Protocol& protocol) const = 0;
  // Of one participant, condition and series. Without trials: status "no_trials".
  virtual TaskEstimates estimate(const Protocol& protocol, const Series& series,
                                 std::span<const AnsweredTrial> trials) const = 0;
  // None where the task has nothing to draw over its levels.
  virtual std::optional<TaskCurve> curve(const Protocol&, const Series&, std::span<const AnsweredTrial>) const {
    return std::nullopt;
  }
  // How what is presented in a trial was arranged, in a sentence for a paper that ends with a blank; empty where there is
  // one way only.
  virtual std::string arrangement(const Protocol&) const { return {}; }
  // How large the JND that it measures is for somebody to whom two equal intervals differ with a standard deviation of 1;
  // none where it measures none.
  virtual std::optional<double> jnd_of_noise(const Protocol&) const { return std::nullopt; }
  // How the estimates come about, in sentences for a paper.
  virtual std::string methods(const Protocol&) const { return {}; }
};

const Task& task_of(TaskKind kind);
std::span<const Task* const> all_tasks() noexcept;

// What the estimates of one participant and condition are of, each with its standard: every series, or all of them
// together, whose standard is the reference.
struct JudgedStandard {
  std::string name;  // "all" of all series together
  double value = 0;
};
std::vector<JudgedStandard> judged_standards(const Protocol& protocol);
// Whether standards have values: stimuli that others are judged against, or that a number was given to.
inline bool has_valued_standards(const Protocol& protocol) {
  return task_of(protocol.task.kind).has_standard() || protocol.task.modulus;
}
std::size_t judged_standard_count(const Protocol& protocol);

// How often something is felt one after the other: in every interval, or once where all are felt together.
int felt_intervals(const TaskSpec& spec);
// Whether that interval holds the standard: the first that has its value, or of two that have it the planned one.
bool holds_standard(const Trial& trial, const Intervals& stimuli, std::size_t interval) noexcept;
// The word of what was said, such as "second"; empty where the answer is a number.
std::string_view said_word(const TaskSpec& spec, int said) noexcept;

// Trials of a condition in a series: of given levels Task::trials_of_levels, of a procedure those of its tracks at most.
int trials_of_cell(const Protocol& protocol, const Series& series);
int trials_of_cell(const Protocol& protocol, int series);  // place in Protocol::series

// A trial that moves no level: without a difference, or without a signal.
bool is_catch(const Trial& trial);

// "1 level", "2 levels".
std::string counted_words(std::size_t count, std::string_view word);

// How sure a simulated participant says it is, whose evidence lies so far from the criterion: a degree for every sigma.
int sureness_of(double distance, double sigma, const TaskSpec& spec) noexcept;

// Whether an answer is a sure one, of two kinds: above the middle of the scale of sureness.
bool is_sure(int sureness, const TaskSpec& spec) noexcept;

// trials: of one participant, condition and series, in the order in which they were answered. By level, from the least, and
// half; empty where the task has no answer_model().
std::vector<LevelCount> level_counts(std::span<const AnsweredTrial> trials, const Protocol& protocol);

// Whether it is the correct answer; none where there is none.
std::optional<bool> is_correct(const Trial& trial, const Answer& answer) noexcept;

}  // namespace jnd
