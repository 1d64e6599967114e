// The words that every room shares, as plain records: what is presented, what was delivered, what was answered.
// SI units inside; a unit is part of the name of every field that crosses a boundary.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/numerics/words.h"
#include "protocols/tick_record.h"

namespace jnd {

// What kind of session the data come from. The three are never pooled unless a user asks for it.
enum class SessionKind { real, pilot, simulated };

// The unit of what a study varies, as people write it: "N/m" of a contact, "N/rad" of a joint (force at the fingertip
// per angle), or that of any other quantity, such as "N s/m". Its text is kept once per program: a Unit is as cheap to
// copy and to compare as a number.
class Unit {
 public:
  // NOLINTNEXTLINE(readability-identifier-naming)
  static const Unit n_per_m, n_per_rad;
  // text: 1 to 16 characters.
  static Unit named(std::string_view text);
  constexpr std::string_view text() const noexcept { return names_->text; }
  // As a part of a field's name: "n_per_m", "n_s_per_m".
  constexpr std::string_view suffix() const noexcept { return names_->suffix; }
  constexpr bool operator==(const Unit&) const = default;

 private:
  struct Names {
    std::string_view text, suffix;
  };
  static constexpr Names kContact{"N/m", "n_per_m"}, kJoint{"N/rad", "n_per_rad"};
  explicit constexpr Unit(const Names* names) noexcept : names_(names) {}
  const Names* names_;
};
inline constexpr Unit Unit::n_per_m{&Unit::kContact};
inline constexpr Unit Unit::n_per_rad{&Unit::kJoint};

// What carries the stimulus: force on the pulp and a vibration burst (3RRS device), resistance of the joint (McKibben
// finger).
struct Cues {
  bool force = false;
  bool vibration = false;
  bool kinaesthetic = false;
  bool operator==(const Cues&) const = default;
};

// One interval's sphere.
struct Stimulus {
  double stiffness = 0;          // > 0, in the study's unit
  double damping_n_s_per_m = 0;  // >= 0: viscosity of the contact
  Cues cues;
  bool operator==(const Stimulus&) const = default;
};

// How a 3RRS platform turns a contact into torques (Chinello et al. 2017): wrench = force control, (26); pd = position
// control in the platform's coordinates; pd_literal = position control in the joints as printed, (36).
enum class RenderingMode { wrench, pd, pd_literal };

// Who pressed the key: response times are analysed only where the participant did.
enum class EnteredBy { participant, operator_ };

// What was said, in the terms of the trial's task (protocols/tasks/task.h).
struct Answer {
  int said = 0;                    // which of the task's classes: "same" or "different", "first" or "second", ...
  int sureness = 0;                // how sure of it, from 1; 0 where the task does not ask
  std::optional<double> number{};  // the answer of a task that is answered with a number
  EnteredBy entered_by = EnteredBy::participant;
  double response_time_s = 0;  // from the question cue to the key
};

// Why a presentation was not delivered as asked. `none` and `no_contact` need no operator; the others stop the device.
enum class Fault {
  none,
  no_contact,
  stale_pose,     // no new pose of the finger from the tracker
  stale_reading,  // no new reading from the device
  command_gap,    // the loop itself came too late
  non_finite,
  sensor_stuck,  // the measured force does not follow what is given
  device_lost,
  device_fault,  // the device stopped itself
  emergency_stop,
  interrupted
};

// What a device acts on: the pulp of the finger, or its joint.
enum class Channel { cutaneous, kinaesthetic };

// What one limit of the governor did in one interval: in how many ticks, and asked and given where it took most.
struct Intervention {
  std::string limit;  // "force_cap", "force_rise", ...: devices/loop/governor.h
  std::int64_t ticks = 0;
  double asked = 0, given = 0;  // N; g or Hz for vibrations; rad or m for the workspace
  bool operator==(const Intervention&) const = default;
};

// What one device of a rig did to its finger in one interval. Shares are of contact time, 0..1. Penetration and speed
// are in m and m/s where the study's stiffness is in N/m, in rad and rad/s where it is in N/rad.
struct FingerPresentation {
  int finger = 0;  // place in RigRequest::fingers
  Channel channel = Channel::cutaneous;
  // Least-squares slope through the origin of delivered force on penetration, over the unsaturated samples in contact
  // outside the soft start, in the study's unit; none where there is no such sample or no force was commanded.
  std::optional<double> stiffness;
  // Standard error of that slope from its residuals, as if the samples were independent; none with fewer than two.
  std::optional<double> stiffness_se;
  // The same slope as a torque per angle, of a joint whose contact is described in N/m.
  std::optional<double> joint_stiffness_n_m_per_rad;
  std::int64_t fit_samples = 0;
  double peak_force_n = 0;
  double deepest_penetration = 0;
  double work_j = 0;      // done by the finger on the object while loading: integral of force d(path), rising part
  double mean_speed = 0;  // mean absolute penetration rate in contact
  int contacts = 0;
  double dwell_s = 0;          // time in contact
  double saturated_share = 0;  // of contact time, the part in which a limit reduced the asked force
  double vibration_g = 0;      // amplitude of the bursts delivered; 0 without one
  bool vibration_clamped = false;
  std::vector<Intervention> interventions;
};

// Upper edges of a presentation's lateness histogram, us; what is later than the last falls into one bucket more.
inline constexpr std::array<double, 12> kLatenessEdges_us = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000};

// What was really delivered in one interval.
struct Presentation {
  std::vector<FingerPresentation> fingers;  // an entry for each device, in the protocol's order of fingers
  double first_contact_s = -1;              // after the interval began; -1 without contact
  double duration_s = 0;
  std::int64_t ticks = 0;
  std::int64_t overruns = 0;   // whole periods skipped
  double lateness_p50_us = 0;  // of the ticks' wake-ups; 0 on the simulated clock
  double lateness_p99_us = 0;
  double lateness_max_us = 0;
  std::array<std::int64_t, kLatenessEdges_us.size() + 1> lateness_histogram{};  // ticks by kLatenessEdges_us
  // What a rig that is none of our devices says that it delivered, in the study's unit; and what else it measured.
  std::optional<double> delivered{};
  std::optional<double> delivered_beside{};  // the same of what was felt beside it, until it is the second interval's
  std::map<std::string, double> measured{};
  Fault fault = Fault::none;
  std::string stopped_by;              // who latched an emergency stop: "key", "signal", "button", "program"
  std::vector<TickRecord> last_ticks;  // before a fault other than no_contact: the last kTicksBeforeStop of each device
};

inline constexpr std::size_t kTicksBeforeStop = 100;

// What each trial asks: protocols/tasks. explore is free interaction, which has no trials.
enum class TaskKind { same_different, which, yes_no, identify, oddity, abx, magnitude, adjust, explore };
inline constexpr auto kTaskWords = words<TaskKind>({{"same-different", TaskKind::same_different},
                                                    {"which", TaskKind::which},
                                                    {"yes-no", TaskKind::yes_no},
                                                    {"identify", TaskKind::identify},
                                                    {"oddity", TaskKind::oddity},
                                                    {"abx", TaskKind::abx},
                                                    {"magnitude", TaskKind::magnitude},
                                                    {"adjust", TaskKind::adjust},
                                                    {"explore", TaskKind::explore}});
std::string_view to_string(TaskKind task) noexcept;
std::optional<TaskKind> task_kind_from(std::string_view text) noexcept;

inline constexpr std::size_t kMostIntervals = 3;

// What the intervals of a trial present, in order: one to three values in the study's unit.
class Intervals {
 public:
  Intervals() = default;  // two, of 0
  Intervals(std::initializer_list<double> values) noexcept;
  Intervals(const std::array<double, 2>& pair) noexcept : Intervals({pair[0], pair[1]}) {}
  std::size_t size() const noexcept { return size_; }
  void push_back(double value) noexcept;  // beyond kMostIntervals: not kept
  double operator[](std::size_t interval) const noexcept { return values_[interval]; }
  double& operator[](std::size_t interval) noexcept { return values_[interval]; }
  const double* begin() const noexcept { return values_.data(); }
  const double* end() const noexcept { return values_.data() + size_; }
  double* begin() noexcept { return values_.data(); }
  double* end() noexcept { return values_.data() + size_; }
  auto operator<=>(const Intervals&) const = default;

 private:
  std::array<double, kMostIntervals> values_{};
  std::size_t size_ = 2;
};

// One planned trial.
struct Trial {
  int index = 0;  // place in the plan, from 1; practice comes first
  int block = 0;  // from 1; 0 for practice
  bool practice = false;
  int round = 0;      // practice round from 1; 0 in the main part
  int series = 0;     // place in Protocol::series, from 0
  int condition = 0;  // place in Protocol::conditions, from 0
  Intervals stimuli{};
  Unit unit = Unit::n_per_m;  // of the stimuli
  TaskKind task{};
  // Which of the task's classes the stimuli belong to: the one that is correct to say; -1 where none is.
  int target = 0;
  double standard = 0;  // that the others are judged against; 0: there is none
  // Of an adaptive procedure: which of its condition's tracks, from 1; 0 with constant stimuli and in practice. In the
  // plan a stimulus that the answers set is set_by_answers(standard); protocols/planning/adaptive_run.h knows it when
  // its turn comes.
  int track = 0;
  // Of such a stimulus: below (-1) or above (1) its standard; 0: on either, as the answers move it across.
  int side = -1;
  // The interval, from 0, whose stimulus is the standard, where two are or may become equal; -1: values tell.
  int standard_place = -1;
  bool operator==(const Trial&) const = default;
};

// In the place of a stimulus that is not known yet: never the standard, which is the other value that a track plans.
constexpr double set_by_answers(double standard) noexcept {
  return standard == 0 ? -1 : 0;
}

// One trial that was carried out and answered: what the log keeps of it.
struct TrialRecord {
  Trial trial;
  int attempt = 1;
  std::string condition_name;
  std::string series_name;
  Answer answer;
  std::string answer_word{};       // the word of what was said; empty where it is a number
  std::vector<double> settings{};  // of adjust: what was presented in turn beside the standard, the start first
  std::string breach{};            // what of the prescription was broken, in one line; empty: nothing
  std::vector<Presentation> presentations = std::vector<Presentation>(2);  // one of each interval
  double duration_s = 0;                                                   // from the first cue to the answer
};

std::string_view to_string(SessionKind kind) noexcept;
std::string_view to_string(Unit unit) noexcept;      // Unit::text
std::string_view name_suffix(Unit unit) noexcept;    // Unit::suffix
std::string_view length_suffix(Unit unit) noexcept;  // of a penetration's name: "m", "rad"
std::string_view to_string(Channel channel) noexcept;
inline constexpr auto kRenderingModeWords = words<RenderingMode>(
    {{"wrench", RenderingMode::wrench}, {"pd", RenderingMode::pd}, {"pd-literal", RenderingMode::pd_literal}});
std::string_view to_string(RenderingMode mode) noexcept;
std::string_view to_string(EnteredBy who) noexcept;  // "participant", "operator"
inline constexpr auto kFaultWords = words<Fault>({{"none", Fault::none},
                                                  {"no_contact", Fault::no_contact},
                                                  {"stale_pose", Fault::stale_pose},
                                                  {"stale_reading", Fault::stale_reading},
                                                  {"command_gap", Fault::command_gap},
                                                  {"non_finite", Fault::non_finite},
                                                  {"sensor_stuck", Fault::sensor_stuck},
                                                  {"device_lost", Fault::device_lost},
                                                  {"device_fault", Fault::device_fault},
                                                  {"emergency_stop", Fault::emergency_stop},
                                                  {"interrupted", Fault::interrupted}});
std::string_view to_string(Fault fault) noexcept;
std::optional<SessionKind> session_kind_from(std::string_view text) noexcept;
std::optional<Channel> channel_from(std::string_view text) noexcept;
std::optional<EnteredBy> entered_by_from(std::string_view text) noexcept;
std::optional<Fault> fault_from(std::string_view text) noexcept;

}  // namespace jnd
