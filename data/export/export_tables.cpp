// Columns of the files that hold what was recorded: the plan and the answer of every trial, what was presented in every
// interval, and who took part.
#include "data/export/export_tables.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "data/blocks/common_fields.h"
#include "data/fields/field.h"
#include "data/log/event_body.h"
#include "data/study/study_impl.h"
#include "protocols/course/prescription.h"
#include "protocols/input/json_text.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"
#include "protocols/version.h"

namespace jnd {

namespace {

constexpr const char* kNothing = "";

// What may be seen of a blinded study.
FieldTraits open_traits(std::string_view levels = kNothing) {
  return {.levels = levels, .reveals = Reveals::nothing};
}

FieldTraits time_traits(Reveals reveals = Reveals::nothing) {
  return {.type = CellType::time, .reveals = reveals};
}

template <typename Row>
void add_session_fields(Fields<Row>& fields) {
  using F = Field<Row>;
  fields.push_back(F(
      "participant", "code of the participant", [](const Row& r) { return r.session.participant; }, open_traits()));
  fields.push_back(F(
      "session", "identifier of the session", [](const Row& r) { return r.session.id; }, open_traits()));
  fields.push_back(F(
      "session_number", "which of the participant's sessions, from 1", [](const Row& r) { return r.session.number; },
      open_traits()));
  fields.push_back(
      F("kind", "kind of the session", [](const Row& r) { return r.session.kind; }, {.levels = kSessionKinds}));
}

// Behind the participant, where the protocol has groups. Who says a group knows it; one that was drawn stays sealed.
template <typename Row, typename Get>
void add_group(Fields<Row>& fields, const Protocol& protocol, Get get, Reveals reveals) {
  if (protocol.groups.empty()) return;
  fields.insert(fields.begin() + 1, Field<Row>("group", "group of the participant", get,
                                               {.levels = group_levels(protocol), .reveals = reveals}));
}

Reveals group_reveals(const Protocol& protocol) noexcept {
  return protocol.allotment == Allotment::given ? Reveals::nothing : Reveals::plan;
}

// The answers that have words, separated by blanks; empty where an answer is a number.
std::string answer_levels(const Protocol& protocol) {
  std::string words;
  if (task_of(protocol.task.kind).adjusts()) return words;  // its answers only move what is presented
  for (const std::string& word : protocol.task.classes) words.append(words.empty() ? "" : " ").append(word);
  return words;
}

// What was asked. trial: of a row.
template <typename Row, typename Get>
void add_stimuli(Fields<Row>& fields, const Protocol& protocol, Get trial) {
  const Task& task = task_of(protocol.task.kind);
  const std::string suffix(name_suffix(protocol.stimulus.unit)), symbol(to_string(protocol.stimulus.unit));
  if (!task.has_pairs() && task.has_standard())
    fields.push_back(Field<Row>("standard_" + suffix, "the standard",
                                [trial](const Row& r) { return trial(r).standard; }, {.unit = symbol}));
  for (int i = 0; i < task.intervals(protocol.task); ++i)
    fields.push_back(Field<Row>(fmt::format("stimulus_{}_{}", i + 1, suffix),
                                fmt::format("{} asked in interval {}", protocol.stimulus.quantity, i + 1),
                                [trial, place = static_cast<std::size_t>(i)](const Row& r) {
                                  const Intervals& stimuli = trial(r).stimuli;
                                  return place < stimuli.size() ? std::optional(stimuli[place]) : std::nullopt;
                                },
                                {.unit = symbol}));
}

using TrialFields = Fields<ExportTrial>;
using TrialField = Field<ExportTrial>;

void add_target(TrialFields& fields, const Protocol& protocol, const std::string& words) {
  using R = ExportTrial;
  // Where a level may equal the standard, the values do not always tell which is which.
  if (task_of(protocol.task.kind).level_may_be_standard())
    fields.push_back(TrialField("standard_interval", "the interval that held the standard", [](const R& r) {
      return holds_standard(r.record.trial, r.record.trial.stimuli, 0) ? 1 : 2;
    }));
  if (const std::string_view key = task_of(protocol.task.kind).first_class_key(); !key.empty())
    fields.push_back(TrialField(std::string(key), "whether the two were equal",
                                [](const R& r) { return r.record.trial.target == 0; }, {.levels = "0 1"}));
  else if (!words.empty())
    fields.push_back(
        TrialField("target", "the answer that is correct; empty where none is",
                   [spec = protocol.task](const R& r) { return std::string(said_word(spec, r.record.trial.target)); },
                   {.levels = words}));
}

void add_answer(TrialFields& fields, const Protocol& protocol, const std::string& words) {
  using R = ExportTrial;
  fields.push_back(TrialField(
      "answer", "what was answered",
      [](const R& r) {
        const std::optional<double>& number = r.record.answer.number;
        return number ? FieldValue(*number) : FieldValue(r.record.answer_word);
      },
      {.unit = words.empty() && task_of(protocol.task.kind).adjusts() ? std::string(to_string(protocol.stimulus.unit))
                                                                      : std::string(),
       .levels = words,
       .type = words.empty() ? CellType::number : CellType::text}));
  if (task_of(protocol.task.kind).adjusts())
    fields.push_back(TrialField("settings",
                                "what was presented in turn beside the standard, the start first, separated by blanks",
                                [](const R& r) {
                                  std::string text;
                                  for (const double setting : r.record.settings)
                                    text.append(text.empty() ? "" : " ").append(csv_number(setting));
                                  return text;
                                },
                                {.unit = to_string(protocol.stimulus.unit)}));
  if (protocol.task.sureness_levels > 0)
    fields.push_back(
        TrialField("sureness", "how sure of it, from 1", [](const R& r) { return r.record.answer.sureness; }));
  if (!words.empty())
    fields.push_back(TrialField("correct", "whether the answer was right",
                                [](const R& r) { return is_correct(r.record.trial, r.record.answer); },
                                {.levels = "0 1"}));
}

void add_course(TrialFields& fields, const Protocol& protocol) {
  using R = ExportTrial;
  const auto add = [&](TrialField field) { fields.push_back(std::move(field)); };
  add({"entered_by", "who pressed the key", [](const R& r) { return r.record.answer.entered_by; },
       open_traits("participant operator")});
  add({"response_time_s",
       "from the question cue to the key",
       [](const R& r) { return r.record.answer.response_time_s; },
       {.unit = "s", .reveals = Reveals::nothing}});
  add({"duration_s",
       "from the first cue to the answer",
       [](const R& r) { return r.record.duration_s; },
       {.unit = "s", .reveals = Reveals::nothing}});
  add({"excluded",
       "whether a registered rule leaves the trial out of the analysis",
       [](const R& r) { return !r.excluded_reason.empty(); },
       {.levels = "0 1"}});
  add({"excluded_reason",
       "the first rule that applies; empty where the trial counts",
       &R::excluded_reason,
       {.levels = "response_time_below response_time_above saturated_share_above off_prescription"}});
  if (judges_exploration(protocol))
    add({"breach", "what of the prescription was broken or not measured; empty where all was kept",
         [](const R& r) { return r.record.breach; }});
  if (!levels_given(protocol))
    add({"track", "track of the adaptive procedure in its condition, from 1; 0 in practice",
         [](const R& r) { return r.record.trial.track; }});
}

// Where in the plan. trial: of a row; round: of practice.
template <typename Row, typename Get>
void add_place(Fields<Row>& fields, Get trial) {
  using F = Field<Row>;
  fields.push_back(F(
      "practice", "whether it was practice, which no analysis counts",
      [trial](const Row& r) { return trial(r).practice; }, open_traits("0 1")));
  fields.push_back(
      F("round", "round of practice, from 1; 0 in the main part", [trial](const Row& r) { return trial(r).round; }));
  fields.push_back(F(
      "block", "block, from 1; 0 in practice", [trial](const Row& r) { return trial(r).block; }, open_traits()));
}

}  // namespace

std::vector<CsvColumn<ExportTrial>> trial_columns(const Protocol& protocol) {
  if (!task_of(protocol.task.kind).has_trials()) return {};
  using R = ExportTrial;
  using F = TrialField;
  const auto trial = [](const R& r) -> const Trial& { return r.record.trial; };
  TrialFields fields;
  add_session_fields(fields);
  add_group(
      fields, protocol, [](const R& r) { return r.session.group; }, Reveals::plan);
  fields.push_back(
      F("protocol_sha256", "SHA-256 of the protocol's bytes", [sha = protocol.sha256](const R&) { return sha; }));
  fields.push_back(F("seq", "number of the trial's event in its session", &R::seq));
  fields.push_back(F("utc", "when the answer was saved, ISO 8601", &R::utc, time_traits()));
  fields.push_back(F(
      "trial", "place in the participant's plan, from 1; practice comes first",
      [trial](const R& r) { return trial(r).index; }, open_traits()));
  fields.push_back(
      F("attempt", "1, or more where the trial was voided and repeated", [](const R& r) { return r.record.attempt; }));
  add_place(fields, trial);
  fields.push_back(F("series", "series of the trial", [](const R& r) { return r.record.series_name; }));
  fields.push_back(F("condition", "condition", [](const R& r) { return r.record.condition_name; }));
  const std::string words = answer_levels(protocol);
  add_stimuli(fields, protocol, trial);
  add_target(fields, protocol, words);
  add_answer(fields, protocol, words);
  add_course(fields, protocol);
  return csv_columns(fields);
}

std::vector<CsvColumn<ExportVoided>> voided_columns(const Protocol& protocol) {
  if (!task_of(protocol.task.kind).has_trials()) return {};
  using R = ExportVoided;
  using F = Field<R>;
  const auto trial = [](const R& r) -> const Trial& { return r.trial; };
  Fields<R> fields;
  add_session_fields(fields);
  add_group(
      fields, protocol, [](const R& r) { return r.session.group; }, Reveals::plan);
  fields.push_back(F("seq", "number of the voiding in its session's events", &R::seq));
  fields.push_back(F("utc", "when it was voided, ISO 8601", &R::utc, time_traits(Reveals::plan)));
  fields.push_back(F("trial", "place in the participant's plan, from 1; practice comes first",
                     [trial](const R& r) { return trial(r).index; }));
  fields.push_back(F("attempt", "which attempt at the trial, from 1", &R::attempt));
  add_place(fields, trial);
  fields.push_back(F("series", "series of the trial", &R::series));
  fields.push_back(F("condition", "condition", &R::condition));
  add_stimuli(fields, protocol, trial);
  fields.push_back(F("reason", "why it did not count; taken_back: an answer that was taken back", &R::reason));
  fields.push_back(F("words", "what the operator said of it; empty where nothing was said", &R::words));
  fields.push_back(F("answered", "whether it had been answered before it was voided", &R::answered, {.levels = "0 1"}));
  fields.push_back(F("uses_attempt", "whether it used up one of the trial's attempts; interruptions do not",
                     &R::uses_attempt, {.levels = "0 1"}));
  return csv_columns(fields);
}

// What was presented.

namespace {

using IntervalFields = Fields<ExportInterval>;
using IntervalField = Field<ExportInterval>;

std::string fault_names() {
  std::string names;
  for (const auto& [word, fault] : kFaultWords) names.append(names.empty() ? "" : " ").append(word);
  return names;
}

std::string lateness_edges() {
  std::string edges;
  for (const double edge : kLatenessEdges_us) edges.append(edges.empty() ? "" : " ").append(csv_number(edge));
  return edges;
}

std::string histogram_text(const Presentation& presentation) {
  std::string counts;
  if (presentation.lateness_max_us > 0)
    for (const std::int64_t count : presentation.lateness_histogram)
      counts.append(counts.empty() ? "" : " ").append(csv_number(count));
  return counts;
}

std::string measured_text(const Presentation& presentation) {
  std::string text;
  for (const auto& [name, value] : presentation.measured)
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", name, csv_number(value));
  return text;
}

std::string intervention_text(const FingerPresentation& finger) {
  std::string text;
  for (const Intervention& one : finger.interventions)
    text.append(text.empty() ? "" : " ").append(one.limit).append(":").append(csv_number(one.ticks));
  return text;
}

// Of the interval, the same in the rows of all its devices.
void add_interval(IntervalFields& fields) {
  const auto add = [&](const char* name, const std::string& meaning, auto of, FieldTraits traits = {}) {
    fields.push_back(IntervalField(
        name, meaning, [of](const ExportInterval& r) { return std::invoke(of, *r.presentation); }, traits));
  };
  using P = Presentation;
  add("first_contact_s", "first contact after the interval began; empty without contact",
      [](const P& p) { return p.first_contact_s < 0 ? kNaN : p.first_contact_s; }, {.unit = "s"});
  add("duration_s", "length of the interval", &P::duration_s, {.unit = "s"});
  add("ticks", "ticks of the control loop", &P::ticks);
  add("overruns", "whole periods that the control loop skipped", &P::overruns);
  add("lateness_p50_us", "median lateness of the ticks (0 on the simulated clock)", &P::lateness_p50_us,
      {.unit = "us"});
  add("lateness_p99_us", "99th percentile of the lateness", &P::lateness_p99_us, {.unit = "us"});
  add("lateness_max_us", "largest lateness", &P::lateness_max_us, {.unit = "us"});
  add("lateness_histogram",
      "ticks by lateness, separated by blanks: up to " + lateness_edges() +
          " us and later; empty on the simulated clock",
      histogram_text);
  add("fault", "why the presentation was not delivered as asked", [](const P& p) { return p.fault; },
      {.levels = fault_names()});
  add("stopped_by", "who latched an emergency stop; empty without one", &P::stopped_by);
}

// What a rig that is none of ours says of an interval.
void add_said_by_rig(IntervalFields& fields, const Protocol& protocol) {
  using R = ExportInterval;
  fields.push_back(IntervalField(fmt::format("delivered_{}", name_suffix(protocol.stimulus.unit)),
                                 "what the rig says it delivered; empty where it does not say",
                                 [](const R& r) { return r.presentation->delivered; },
                                 {.unit = to_string(protocol.stimulus.unit)}));
  fields.push_back(IntervalField("measured", "what else the rig measured, name=value separated by blanks",
                                 [](const R& r) { return measured_text(*r.presentation); }));
}

// Of one device: empty where the interval has none. joints: some device acts on a joint.
void add_device(IntervalFields& fields, const Protocol& protocol, bool joints) {
  const auto add = [&](const std::string& name, const char* meaning, auto of, FieldTraits traits = {}) {
    using Value = std::remove_cvref_t<std::invoke_result_t<decltype(of), const FingerPresentation&>>;
    traits.type = traits.type.value_or(cell_type<Value>());
    fields.push_back(IntervalField(
        name, meaning,
        [of](const ExportInterval& r) {
          return r.finger == nullptr ? FieldValue() : field_value(std::invoke(of, *r.finger));
        },
        traits));
  };
  using F = FingerPresentation;
  const Unit unit = protocol.stimulus.unit;
  const std::string stiffness(name_suffix(unit)), length(length_suffix(unit)), symbol(to_string(unit));
  add("finger", "finger that the device acts on",
      [&protocol](const F& f) { return protocol.rig.fingers.at(static_cast<std::size_t>(f.finger)); });
  add("channel", "what the device acts on: the pulp or the joint", &F::channel, {.levels = "cutaneous kinaesthetic"});
  add("stiffness_" + stiffness,
      "delivered stiffness: slope of force on penetration over unsaturated contact; empty where none could be fitted",
      &F::stiffness, {.unit = symbol});
  add("stiffness_se_" + stiffness, "standard error of that slope, as if the samples were independent", &F::stiffness_se,
      {.unit = symbol});
  if (joints && unit == Unit::n_per_m)
    add("joint_stiffness_n_m_per_rad", "the same slope as a torque per angle of the joint; empty of a pulp",
        &F::joint_stiffness_n_m_per_rad, {.unit = "N m/rad"});
  add("fit_samples", "samples in that fit", &F::fit_samples);
  add("peak_force_n", "largest delivered force", &F::peak_force_n, {.unit = "N"});
  add("deepest_penetration_" + length, "deepest penetration", &F::deepest_penetration, {.unit = length});
  add("work_j", "work done on the object while loading", &F::work_j, {.unit = "J"});
  add("mean_speed_" + length + "_per_s", "mean absolute penetration rate in contact", &F::mean_speed,
      {.unit = length + "/s"});
  add("contacts", "number of contacts", &F::contacts);
  add("dwell_s", "time in contact", &F::dwell_s, {.unit = "s"});
  add("saturated_share", "share of contact time in which a limit reduced the force, 0 to 1", &F::saturated_share);
  add("vibration_g", "amplitude of the delivered bursts; 0 without one", &F::vibration_g, {.unit = "g"});
  add("vibration_clamped", "whether the amplitude was limited by the device", &F::vibration_clamped, {.levels = "0 1"});
  add("interventions", "limits that acted, each with its number of ticks (limit:ticks), separated by blanks",
      intervention_text);
}

}  // namespace

std::vector<CsvColumn<ExportInterval>> interval_columns(const Protocol& protocol,
                                                        const std::vector<DevicePlace>& places) {
  if (!task_of(protocol.task.kind).has_trials()) return {};
  using R = ExportInterval;
  using F = IntervalField;
  IntervalFields fields = {
      F("participant", "code of the participant", [](const R& r) { return r.trial->session.participant; }),
      F("session", "identifier of the session", [](const R& r) { return r.trial->session.id; }),
      F("seq", "number of the trial's event in its session", [](const R& r) { return r.trial->seq; }),
      F("trial", "place in the participant's plan, from 1; practice comes first",
        [](const R& r) { return r.trial->record.trial.index; }),
      F("interval", "interval of the trial, from 1", [](const R& r) { return r.interval + 1; }),
      F(fmt::format("stimulus_{}", name_suffix(protocol.stimulus.unit)),
        fmt::format("{} asked in the interval", protocol.stimulus.quantity),
        [](const R& r) {
          const Intervals& stimuli = r.trial->record.trial.stimuli;
          const auto place = static_cast<std::size_t>(r.interval);
          return place < stimuli.size() ? std::optional(stimuli[place]) : std::nullopt;
        },
        {.unit = to_string(protocol.stimulus.unit)})};
  add_interval(fields);
  if (!protocol.rig.built_in()) add_said_by_rig(fields, protocol);
  if (!places.empty())
    add_device(fields, protocol, std::any_of(places.begin(), places.end(), [](const DevicePlace& place) {
                 return place.channel == Channel::kinaesthetic;
               }));
  return csv_columns(fields);
}

std::vector<ExportInterval> interval_rows(const ExportTrial& trial) {
  std::vector<ExportInterval> rows;
  for (std::size_t i = 0; i < trial.record.presentations.size(); ++i) {
    const Presentation& presentation = trial.record.presentations[i];
    const auto interval = static_cast<int>(i);
    for (const FingerPresentation& finger : presentation.fingers)
      rows.push_back({&trial, interval, &presentation, &finger});
    if (presentation.fingers.empty()) rows.push_back({&trial, interval, &presentation, nullptr});
  }
  return rows;
}

// Answers, sessions, participants and the dictionary.

std::vector<CsvColumn<ExportAnswer>> answer_columns() {
  using R = ExportAnswer;
  using F = Field<R>;
  Fields<R> fields;
  add_session_fields(fields);
  const auto add = [&](F field) { fields.push_back(std::move(field)); };
  add({"utc", "when the answer was saved, ISO 8601", &R::utc, time_traits(Reveals::plan)});
  add({"question", "identifier of the question", &R::question});
  add({"asked",
       "when it is asked",
       &R::asked,
       {.levels = "before_session after_condition after_series after_session"}});
  add({"condition", "the condition that it is about; empty where it is about none", &R::condition});
  add({"after_trial", "main trials planned before it; 0 before and after the session", &R::after_trial});
  add({"answered", "0 where a question that is not required was left out", &R::answered, {.levels = "0 1"}});
  add({"answer", "the answer as given", &R::answer});
  add({"text", "the question as asked", &R::text});
  return csv_columns(fields);
}

std::vector<ExportParticipant> participant_rows(const std::vector<SessionInfo>& sessions,
                                                const std::vector<ExcludedParticipant>& excluded) {
  std::vector<ExportParticipant> rows;
  for (const SessionInfo& session : sessions) {
    if (rows.empty() || rows.back().first.participant != session.participant) rows.push_back({session});
    ExportParticipant& row = rows.back();
    ++row.sessions;
    row.closed += session.state == "closed" ? 1 : 0;
    row.trials_done += session.trials_done;
    row.trials_voided += session.trials_voided;
    row.ended_early = row.ended_early || session.ended_early;
    for (const ExcludedParticipant& one : excluded)
      if (one.participant == session.participant && one.kind == session.kind) row.excluded_reason = one.reason;
  }
  return rows;
}

std::vector<CsvColumn<ExportParticipant>> participant_columns(const Protocol& protocol) {
  using R = ExportParticipant;
  using F = Field<R>;
  Fields<R> fields;
  const auto add = [&](F field) { fields.push_back(std::move(field)); };
  add({"participant", "code of the participant", [](const R& r) { return r.first.participant; }, open_traits()});
  add({"participant_number", "number of the plan", [](const R& r) { return r.first.participant_number; },
       open_traits()});
  add({"kind", "kind of the sessions", [](const R& r) { return r.first.kind; }, open_traits(kSessionKinds)});
  add({"sessions", "sessions that were opened", &R::sessions, open_traits()});
  add({"sessions_closed", "of them closed", &R::closed, open_traits()});
  add({"ended_early", "whether a session was closed for good before its end", &R::ended_early, open_traits("0 1")});
  add({"trials_done", "main trials answered, over all sessions", &R::trials_done, open_traits()});
  add({"trials_voided", "attempts voided, practice included", &R::trials_voided, open_traits()});
  add({"excluded", "whether the participant is left out: nothing of theirs is in the files of trials and results",
       [](const R& r) { return r.first.excluded; }, open_traits("0 1")});
  add({"excluded_reason", "why, as it was given; empty where the participant counts", &R::excluded_reason});
  add_group(
      fields, protocol, [](const R& r) { return r.first.group; }, group_reveals(protocol));
  return csv_columns(fields);
}

std::vector<CsvColumn<SessionInfo>> session_columns(const std::string& seed, const std::string& study_head,
                                                    const Protocol& protocol) {
  using R = SessionInfo;
  using F = Field<R>;
  Fields<R> fields;
  const auto add = [&](F field) { fields.push_back(std::move(field)); };
  add({"participant", "code of the participant", &R::participant, open_traits()});
  add({"participant_number", "number of the plan", &R::participant_number, open_traits()});
  add({"session", "identifier of the session", &R::id, open_traits()});
  add({"session_number", "which of the participant's sessions, from 1", &R::number, open_traits()});
  add({"kind", "kind of the session", &R::kind, open_traits(kSessionKinds)});
  add({"language", "language of the participant; empty where none was chosen", &R::language, open_traits()});
  add({"excluded", "whether the participant was excluded: nothing of theirs is in the files of trials and results",
       &R::excluded, open_traits("0 1")});
  add({"state", "whether it is finished", &R::state, open_traits("open closed")});
  add({"unblinded", "whether the operator saw forces, and so the stimuli, at least in a part of it", &R::unblinded,
       open_traits("0 1")});
  add({"responder", "who or what answered", &R::responder, open_traits()});
  add({"started", "when it was opened, ISO 8601", &R::started, time_traits()});
  add({"ended", "when it was closed, ISO 8601; empty while open", &R::ended, time_traits()});
  add({"trials_done", "main trials answered", &R::trials_done, open_traits()});
  add({"trials_voided", "attempts voided, practice included", &R::trials_voided, open_traits()});
  add({"trials_total", "main trials planned", &R::trials_total, open_traits()});
  add({"head", "hash of its last event: names everything before it", &R::head, open_traits()});
  add({"study_head",
       "hash of the last event of the study's own chain: names every exclusion, unblinding and closing before it",
       [study_head](const R&) { return study_head; }, open_traits()});
  add({"seed", "seed of the study; empty while it is sealed", [seed](const R&) { return seed; }});
  add({"protocol", "name of the protocol", [name = protocol.name](const R&) { return name; }, open_traits()});
  add({"protocol_sha256", "SHA-256 of the protocol's bytes", [sha = protocol.sha256](const R&) { return sha; },
       open_traits()});
  add({"exported_by", "version of the program that wrote these files",
       [](const R&) { return std::string("jnd ") + kVersion; }, open_traits()});
  add_group(fields, protocol, &R::group, group_reveals(protocol));
  return csv_columns(fields);
}

std::vector<CsvColumn<DictionaryRow>> dictionary_columns() {
  using R = DictionaryRow;
  const Fields<R> fields = {{"file", "file of the export; sub-* stands for every participant's folder", &R::file},
                            {"column", "column of the file", &R::column},
                            {"meaning", "what it holds", &R::meaning},
                            {"unit", "unit of numbers; empty for text, counts, shares and flags", &R::unit},
                            {"levels", "values that text and flags can have, separated by blanks", &R::levels},
                            {"type",
                             "type of the cells, in the words of datapackage.json",
                             &R::type,
                             {.levels = "string integer number boolean datetime"}}};
  return csv_columns(fields);
}

std::vector<DevicePlace> device_places(const Study& study, const Protocol& protocol,
                                       const std::vector<SessionInfo>& sessions) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  const int fingers = static_cast<int>(protocol.rig.fingers.size());
  std::set<DevicePlace> places;
  with_storage_errors(impl.path, [&] {
    SQLite::Statement query(
        impl.database(),
        "SELECT body FROM event WHERE kind = 'trial.completed' AND session = ? ORDER BY trial LIMIT "
        "1");
    for (const SessionInfo& session : sessions) {
      query.bind(1, session.id);
      if (query.executeStep()) {
        const auto body = json_if_valid(query.getColumn(0).getString());
        for (const Presentation& presentation : trial_record_from(body).presentations)
          for (const FingerPresentation& finger : presentation.fingers)
            if (finger.finger >= 0 && finger.finger < fingers) places.insert({finger.finger, finger.channel});
      }
      query.reset();
    }
  });
  if (places.empty() && protocol.rig.built_in())
    for (int finger = 0; finger < fingers; ++finger) places.insert({finger, Channel::cutaneous});
  return {places.begin(), places.end()};
}

}  // namespace jnd
