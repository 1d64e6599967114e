// What an experiment is. A Protocol is immutable once loaded; its identity is the SHA-256 of the file's bytes.
// The JSON form is read by protocols/reading/protocol_json.h and described for users in protocols/README.md.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "analysis/procedures/posterior.h"
#include "analysis/procedures/quest.h"
#include "analysis/procedures/staircase.h"
#include "analysis/thresholds/adaptive_threshold.h"
#include "protocols/vocabulary.h"

namespace jnd {

enum class Sampling { random, balanced };
enum class Order { fixed, random, permuted, williams };
enum class Arrangement { blocked, mixed };
enum class Feedback { none, correctness };
enum class OnSaturation { flag, repeat };

struct Source {
  std::string citation;
  std::string doi;
};

// A published number to print beside ours.
struct PublishedValue {
  std::string condition;  // a condition's name
  std::string quantity;   // "jnd" (in the study's unit), "weber" (fraction) or "rating"
  double value = 0;
  std::optional<double> ci95_half_width;  // same unit as value
  std::string note;
  std::string question{};      // of a rating: the id of the question; empty: the condition as a whole
  std::optional<double> sd{};  // of the participants' values, same unit
  int standard = -1;           // place in Protocol::series; -1: of all of them
};

// A value that the source does not print and that the author of the protocol chose.
struct Assumption {
  std::string path;  // JSON path into the protocol, which must exist
  std::string why;
};

// One physical object that the operator hands over.
struct Specimen {
  double value = 0;                // of the study's quantity
  std::vector<std::string> codes;  // what is written on it; more than one where there are several of that value
};

inline constexpr std::string_view kExternalRig = "external";   // a program of the laboratory renders
inline constexpr std::string_view kSpecimenRig = "specimens";  // the operator's hands do

struct RigRequest {
  std::string device;                // name of a rig: "rrs3", "mckibben", "rrs3+mckibben", "external", "specimens"
  std::vector<std::string> fingers;  // such as thumb, index; 1 or 2, one where a joint is driven
  std::string tracker;               // "hid", "process", "replay", "hand" (simulated), or "encoder": the joint's own
  RenderingMode mode = RenderingMode::wrench;  // of a 3RRS device
  // Fingertip devices around a virtual object.
  double separation_m = 0.130;     // between the devices' rest positions
  double sphere_radius_m = 0.040;  // of the virtual sphere between them
  std::string object{};            // name of another virtual object; empty: the sphere
  // A joint: the flexion from straight at which the finger meets the object.
  double contact_flexion_rad = 0;
  std::vector<Specimen> specimens{};  // of the rig "specimens"

  // Our own models and devices render; otherwise something that we know by its word alone.
  bool built_in() const noexcept { return device != kExternalRig && device != kSpecimenRig; }
};

// A signal to the participant; identical for all stimuli.
struct CueSignal {
  std::string kind;  // "sound", "tap" or "none"
  std::string say;   // what the console tells the operator to say; may be empty
};

// What ends an interval after its first contact: the time explore_s; so many contacts; or a key. The last two end with
// explore_s at the latest.
enum class IntervalEnd { time, contacts, key };

// What participants are told to do in every interval, and between which limits it counts as done.
struct Prescription {
  // A limit on what was measured of the finger that pressed hardest: "contacts", "peak_force", "depth", "mean_speed".
  struct Limit {
    std::string measure;
    double low = 0, high = 0;  // inclusive; in N, m (rad of a joint) or m/s
  };
  std::string say;                              // what the operator says before a block
  double pace_hz = 0;                           // of a metronome during the intervals; 0: none
  std::vector<Limit> limits;                    // empty: said, and not judged
  OnSaturation on_breach = OnSaturation::flag;  // what becomes of a trial that broke it
};

struct Timeline {
  std::array<CueSignal, kMostIntervals> interval_cues;  // of the first, second and third interval
  CueSignal question_cue;
  double explore_s = 3;  // from first contact
  IntervalEnd interval_end = IntervalEnd::time;
  int contacts = 0;  // that end an interval, where contacts do
  std::optional<Prescription> prescription;
  double no_contact_time_out_s = 10;
  double gap_s = 1;  // platform neutral between the intervals
  double between_trials_s = 1;
  double answer_time_out_s = 30;  // then the trial is voided and repeated
  int max_attempts = 3;
};

// An answer that a key gives.
struct AnswerChoice {
  std::string word;  // as files have it: "same", "second", "same-unsure"
  char key = 0;
  int said = 0;      // Answer::said
  int sureness = 0;  // Answer::sureness
};

// What each trial asks, and what of that is this study's own. What a task is says protocols/tasks/task.h.
struct TaskSpec {
  TaskKind kind{};
  std::vector<std::string> classes = {"same", "different"};  // the words of Answer::said
  // In the order in which keys are shown; empty: a number is answered.
  std::vector<AnswerChoice> answers = {{"same", 's', 0, 0}, {"different", 'd', 1, 0}};
  int sureness_levels = 0;      // how many degrees of sureness each class has; 0: it is not asked
  bool greater = true;          // of which and directed: the greater value is asked for ("stiffer"), else the lesser
  bool directed = false;        // of oddity: the odd one is always the greater, or the lesser
  bool standard_first = false;  // of which: else either comes first
  double signal_share = 0.5;    // of yes-no: share of trials with a signal
  bool together = false;        // of which: both at once, side by side, instead of one after the other
  std::vector<double> class_values{};       // of identify: the value of each class
  std::optional<double> modulus{};          // of magnitude: the number that the standard is said to have; none: free
  double number_min = 0, number_max = 1e6;  // of an answer with a number
  double start = 0;                         // of adjust: how far from the standard it starts, as a fraction of it
};

struct StimulusSpec {
  std::string quantity = "stiffness";
  Unit unit = Unit::n_per_m;
  double reference = 0;           // base of the Weber fraction, in that unit
  double damping_n_s_per_m = 0;   // viscosity of every contact, N s/m or N s/rad; the source papers have none
  double expected_press = 0.005;  // typical depth, m or rad: for lint against the force limit and for simulated hands
  OnSaturation on_saturation = OnSaturation::flag;
};

using ParameterValue = std::variant<double, bool, std::string>;

struct Condition {
  std::string name;   // short: S, V, SV
  std::string label;  // for people
  Cues cues;
  bool devices = true;  // false, with the paradigm explore only: bare hands, nothing is rendered
  // What a rig that is none of ours is told of it, and what it means to whoever sets it up: "delay_ms": 30.
  std::map<std::string, ParameterValue> parameters{};
  std::map<std::string, ParameterValue> standard_parameters{};  // what of them is otherwise where the standard is felt
  std::optional<Prescription> prescription{};  // in place of the timeline's: modes of exploration that are compared
};

// Free interaction for a set time in each condition (Chinello et al. 2017, experiment 2).
struct Exploration {
  double duration_s = 0;             // of a condition, divided equally among the objects
  std::vector<std::string> objects;  // names of virtual objects; each participant meets them in an assigned order
};

// What is compared with what, in the unit of StimulusSpec: of same-different a pair of values, of the other tasks a
// standard and its comparisons.
struct Series {
  std::string name;
  std::array<double, 2> pair{};  // two different values; of the other tasks the least and the greatest presented
  double standard = 0;           // 0 where the task has none
  std::vector<double> levels{};  // what is compared, named or judged; of a procedure empty
};

// How levels are set where the answers set them. A level is a difference: the comparison is the reference less the
// level, in the unit of StimulusSpec; never stiffer than the reference, as in the source paper's pairs.
struct AdaptiveProcedure {
  enum class Kind { staircase, quest, posterior } kind = Kind::staircase;
  std::vector<double> starts;         // one track of each condition for each: its first level
  std::array<double, 2> clamp{};      // lowest and highest level
  StaircaseRule staircase;            // without start
  QuestParameters quest;              // of log10 of the level; without t_guess
  PosteriorConfiguration posterior;   // levels: distances from the standard. Empty lists, SDs of 0: by default
  std::optional<double> precision{};  // of posterior: the standard deviation of ln JND that ends a track before
  bool joint_likelihood = false;      // a staircase's threshold is that of the posterior of all its answers
  int trials = 0;                     // most trials of a track that have a difference
  int reversals = 0;                  // that end a track before; 0: its trials only
  double catch_share = 0.5;           // of a track's trials, those with equal stimuli
  // Of the standard, on which comparisons lie: below (-1), above (1), or both; {0}: across it, the level is the comparison.
  std::vector<int> sides = {-1};
  int averaged_reversals = 6;  // the last ones, of which a staircase's threshold is the mean
};

// Participants who get some of the conditions: a factor between them.
struct Group {
  std::string name;             // short: "patients"
  std::string label;            // for people
  std::vector<int> conditions;  // places in Protocol::conditions, ascending
};
// Who belongs to which group: by participant number, in balanced random blocks; or the operator says it.
enum class Allotment { balanced, given };

struct Design {
  int participants = 1;  // planned
  // Constant stimuli where none. With a procedure Protocol::series is one entry, made from reference and clamp.
  std::optional<AdaptiveProcedure> procedure;
  int trials_per_cell = 4;  // a condition in a series; with a procedure, of a condition at most
  Sampling sampling = Sampling::balanced;
  Arrangement arrangement = Arrangement::blocked;
  Order series_order = Order::fixed;
  Order condition_order = Order::fixed;
  bool per_series = false;       // a new condition order in every series
  std::optional<int> run_limit;  // most trials in a row of one class (same or different) within a block
  int sessions = 1;              // of each participant: the whole plan again, in another order
};

struct Practice {
  int trials = 0;                // a round
  int series = 0;                // whose pair is used, place in Protocol::series
  std::vector<int> conditions;   // places in Protocol::conditions, in turn
  double criterion_correct = 0;  // share correct that ends practice, 0..1
  int max_rounds = 1;
  Feedback feedback = Feedback::correctness;
  std::optional<double> difference{};  // with an adaptive procedure: the pair is reference - difference, and reference
};

struct Break {
  enum class After { block, series, trials } after = After::block;
  int trials = 0;         // for After::trials: every so many main trials
  double duration_s = 0;  // the least; the operator may prolong it
  std::string say;
};

struct Question {
  enum class When { before_session, after_condition, after_series, after_session } when = When::after_session;
  // confirm: of the checklist only, "yes" or nothing.
  enum class Kind { rating, number, choice, text, confirm } kind = Kind::rating;
  std::string id;
  std::string text;
  double min = 0, max = 0;            // rating and number, inclusive
  std::string low_label, high_label;  // rating
  std::vector<std::string> options;   // choice: what the log keeps
  std::vector<std::string> shown;     // choice: the same in the participant's language; empty: options
  bool per_condition = false;         // after_session: asked once for each condition
  bool required = true;
  std::string group{};  // the part of a questionnaire that it belongs to, such as QA; empty: none
};

// A page that the operator reads out, or that the participant reads.
struct Instruction {
  enum class When { before_session, before_practice, before_main } when = When::before_session;
  std::string id;
  std::string text;
};

// How a session that was interrupted goes on.
struct ResumePolicy {
  std::optional<double> longest_gap_s;     // a longer interruption needs the operator's reason; none: any length
  std::optional<double> practice_after_s;  // after a longer one the last practice round comes again; none: never
  bool redo_block = false;                 // the interrupted block's answers are voided and it begins anew
};

// Texts in another language, by the place of the text in the protocol file: "$.consent".
using Translation = std::map<std::string, std::string>;

struct Exclusions {  // of single trials, before anything is counted
  std::optional<double> response_time_below_s;
  std::optional<double> response_time_above_s;
  std::optional<double> saturated_share_above;  // of any finger in either interval
  bool off_prescription = false;                // those that broke a limit of the prescription
};

struct Contrast {
  int a = 0, b = 0;  // places in Protocol::conditions; the difference is a - b
};

// Tests of the conditions against each other.
enum class Outcome { slope, jnd, log_jnd };
enum class Omnibus { none, anova, friedman };
enum class PostHoc { holm_t, games_howell, tukey, wilcoxon };

// Tests of groups of participants against each other: of their means over conditions, or groups and conditions at once.
enum class BetweenTest { none, welch, mann_whitney, mixed_anova };

struct GroupTestPlan {
  // The slope exists for nearly everyone; the JND and its logarithm only for those whose slope is positive, and tests
  // on them are refused where a participant has none.
  Outcome outcome = Outcome::slope;
  Omnibus omnibus = Omnibus::anova;
  PostHoc post_hoc = PostHoc::holm_t;
  BetweenTest between = BetweenTest::none;
  double alpha = 0.05;
};

struct AnalysisPlan {
  std::string model = "yes-no";              // of d': yes-no, differencing, independent-observation
  std::string correction = "loglinear";      // none, loglinear, half
  std::string jnd_method = "least_squares";  // ml, weighted, inverse_mean_slope, mean_of_ratios
  bool common_criterion = false;             // of ml: one criterion for all series of a condition
  // Of the tasks other than same-different: which of the task's outcomes is compared, and how its JND is meant.
  std::string outcome{};
  int standard = -1;                    // at which it is, a place in Protocol::series; -1: the mean over all of them
  std::string jnd_convention = "75 %";  // "75 %", "84 %", "d'=1"
  double lapse = 0;                     // fixed rate; lapse_free: estimated
  bool lapse_free = false;
  UnfinishedTracks unfinished_tracks = UnfinishedTracks::leave_out;  // of staircases, see adaptive_threshold.h
  bool by_delivered = false;                                         // slopes over the delivered stiffness differences
  bool hierarchical =
      false;                 // contrasts are ratios of JNDs by one model of everybody's answers, not of separate values
  bool own_spreads = false;  // of that model: people differ by other spreads in every condition
  Exclusions exclude;
  std::vector<Contrast> contrasts;
  GroupTestPlan tests;
};

struct Protocol {
  std::string bytes;   // the file, verbatim
  std::string sha256;  // of bytes, 64 lower-case hexadecimal digits
  std::string name;    // file name without folder and .json
  std::string title;
  Source source;
  std::vector<PublishedValue> published;
  std::vector<Assumption> assumed;
  RigRequest rig;
  TaskSpec task;
  Timeline timeline;
  StimulusSpec stimulus;
  std::vector<Condition> conditions;
  std::vector<Group> groups;  // empty: everyone gets every condition
  Allotment allotment = Allotment::balanced;
  std::vector<Series> series;
  Design design;
  std::optional<Practice> practice;
  std::vector<Break> breaks;
  std::vector<Question> questions;
  std::optional<Exploration> explore;  // with the paradigm explore
  std::vector<Question> checklist;  // what the operator confirms or fills in before a session: masking noise, blindfold
  std::vector<Instruction> instructions;  // in order
  std::string consent;                    // the text that the participant agrees to; empty: consent is taken elsewhere
  std::string language = "en";            // of the texts, as BCP 47 names it
  std::map<std::string, Translation> translations;  // by language
  ResumePolicy resume;
  bool blinded = true;  // results of people stay coded or pooled until the study is complete, or unblinded
  Feedback feedback = Feedback::none;
  AnalysisPlan analysis;
  std::vector<std::string> notes;  // for people: why the design is as it is
};

// The names of what results and plans number. 0 <= place < how many there are.
inline const std::string& condition_name(const Protocol& protocol, int place) {
  return protocol.conditions[static_cast<std::size_t>(place)].name;
}
inline const Question& question_of(int place, const Protocol& protocol) {
  return protocol.questions[static_cast<std::size_t>(place)];
}

}  // namespace jnd
