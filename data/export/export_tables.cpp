// Columns of trials.csv: the plan, the answer, and everything that was delivered, by interval and finger.
#include "data/export/export_tables.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/export/between_fields.h"
#include "protocols/course/prescription.h"
#include "protocols/tasks/same_different_task.h"
#include "protocols/tasks/task.h"
#include "protocols/version.h"

namespace jnd {

namespace {

using Column = CsvColumn<ExportTrial>;

std::string column_name(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return !((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')); }, '_');
  return text;
}

// A cell of one device; empty where the presentation has no such device.
template <typename Cell>
Column device_column(std::size_t interval, DevicePlace place, const std::string& name, const std::string& quantity,
                     const std::string& meaning, const std::string& unit, Cell cell, const std::string& levels = "") {
  return {fmt::format("i{}_{}_{}", interval + 1, column_name(name), quantity),
          fmt::format("interval {}, {}: {}", interval + 1, name, meaning), unit, levels,
          [interval, place, cell](const ExportTrial& row) -> std::string {
            for (const FingerPresentation& finger : row.record.presentations[interval].fingers)
              if (DevicePlace{finger.finger, finger.channel} == place) return cell(finger);
            return {};
          }};
}

std::string optional_number(const std::optional<double>& value) {
  return value ? csv_number(*value) : std::string();
}

template <typename Cell>
Column interval_column(std::size_t interval, const std::string& quantity, const std::string& meaning,
                       const std::string& unit, Cell cell, const std::string& levels = "") {
  return {fmt::format("i{}_{}", interval + 1, quantity), fmt::format("interval {}: {}", interval + 1, meaning), unit,
          levels, [interval, cell](const ExportTrial& row) { return cell(row.record.presentations[interval]); }};
}

std::string fault_names() {
  std::string names;
  for (const auto& [word, fault] : kFaultWords) names.append(names.empty() ? "" : " ").append(word);
  return names;
}

void add_interval(std::vector<Column>& columns, std::size_t i) {
  using P = Presentation;
  columns.push_back(interval_column(
      i, "first_contact_s", "first contact after the interval began; empty without contact", "s",
      [](const P& p) { return p.first_contact_s < 0 ? std::string() : csv_number(p.first_contact_s); }));
  columns.push_back(interval_column(i, "duration_s", "length of the interval", "s",
                                    [](const P& p) { return csv_number(p.duration_s); }));
  columns.push_back(
      interval_column(i, "ticks", "ticks of the control loop", "", [](const P& p) { return csv_number(p.ticks); }));
  columns.push_back(interval_column(i, "overruns", "whole periods that the control loop skipped", "",
                                    [](const P& p) { return csv_number(p.overruns); }));
  columns.push_back(interval_column(i, "lateness_p50_us", "median lateness of the ticks (0 on the simulated clock)",
                                    "us", [](const P& p) { return csv_number(p.lateness_p50_us); }));
  columns.push_back(interval_column(i, "lateness_p99_us", "99th percentile of the lateness", "us",
                                    [](const P& p) { return csv_number(p.lateness_p99_us); }));
  columns.push_back(interval_column(i, "lateness_max_us", "largest lateness", "us",
                                    [](const P& p) { return csv_number(p.lateness_max_us); }));
  std::string edges;
  for (const double edge : kLatenessEdges_us) edges.append(edges.empty() ? "" : " ").append(csv_number(edge));
  columns.push_back(interval_column(
      i, "lateness_histogram",
      "ticks by lateness, separated by blanks: up to " + edges + " us and later; empty on the simulated clock", "",
      [](const P& p) {
        std::string counts;
        if (p.lateness_max_us > 0)
          for (const std::int64_t count : p.lateness_histogram)
            counts.append(counts.empty() ? "" : " ").append(csv_number(count));
        return counts;
      }));
  columns.push_back(interval_column(
      i, "fault", "why the presentation was not delivered as asked", "",
      [](const P& p) { return std::string(to_string(p.fault)); }, fault_names()));
  columns.push_back(interval_column(i, "stopped_by", "who latched an emergency stop; empty without one", "",
                                    [](const P& p) { return csv_text(p.stopped_by); }));
}

void add_device(std::vector<Column>& columns, std::size_t i, DevicePlace place, const std::string& name, Unit unit) {
  using F = FingerPresentation;
  const auto add = [&](const std::string& quantity, const char* meaning, const std::string& of, auto cell,
                       const char* levels = "") {
    columns.push_back(device_column(i, place, name, quantity, meaning, of, cell, levels));
  };
  const std::string stiffness(name_suffix(unit)), length(length_suffix(unit)), symbol(to_string(unit));
  add("stiffness_" + stiffness,
      "delivered stiffness: slope of force on penetration over unsaturated contact; empty where none could be fitted",
      symbol, [](const F& p) { return optional_number(p.stiffness); });
  add("stiffness_se_" + stiffness, "standard error of that slope, as if the samples were independent", symbol,
      [](const F& p) { return optional_number(p.stiffness_se); });
  if (place.channel == Channel::kinaesthetic && unit == Unit::n_per_m)
    add("joint_stiffness_n_m_per_rad", "the same slope as a torque per angle of the joint", "N m/rad",
        [](const F& p) { return optional_number(p.joint_stiffness_n_m_per_rad); });
  add("fit_samples", "samples in that fit", "", [](const F& p) { return csv_number(p.fit_samples); });
  add("peak_force_n", "largest delivered force", "N", [](const F& p) { return csv_number(p.peak_force_n); });
  add("deepest_penetration_" + length, "deepest penetration", length,
      [](const F& p) { return csv_number(p.deepest_penetration); });
  add("work_j", "work done on the object while loading", "J", [](const F& p) { return csv_number(p.work_j); });
  add("mean_speed_" + length + "_per_s", "mean absolute penetration rate in contact", length + "/s",
      [](const F& p) { return csv_number(p.mean_speed); });
  add("contacts", "number of contacts", "", [](const F& p) { return csv_number(p.contacts); });
  add("dwell_s", "time in contact", "s", [](const F& p) { return csv_number(p.dwell_s); });
  add("saturated_share", "share of contact time in which a limit reduced the force, 0 to 1", "",
      [](const F& p) { return csv_number(p.saturated_share); });
  add("vibration_g", "amplitude of the delivered bursts; 0 without one", "g",
      [](const F& p) { return csv_number(p.vibration_g); });
  add(
      "vibration_clamped", "whether the amplitude was limited by the device", "",
      [](const F& p) { return csv_flag(p.vibration_clamped); }, "0 1");
  add("interventions", "limits that acted, each with its number of ticks (limit:ticks), separated by blanks", "",
      [](const F& p) {
        std::string text;
        for (const Intervention& one : p.interventions)
          text.append(text.empty() ? "" : " ").append(one.limit).append(":").append(csv_number(one.ticks));
        return csv_text(text);
      });
}

// What a rig that is none of ours says of an interval.
void add_measured(std::vector<Column>& columns, std::size_t i, const Protocol& protocol) {
  using P = Presentation;
  columns.push_back(interval_column(i, fmt::format("delivered_{}", name_suffix(protocol.stimulus.unit)),
                                    "what the rig says it delivered; empty where it does not say",
                                    std::string(to_string(protocol.stimulus.unit)),
                                    [](const P& p) { return optional_number(p.delivered); }));
  columns.push_back(
      interval_column(i, "measured", "what else the rig measured, name=value separated by blanks", "", [](const P& p) {
        std::string text;
        for (const auto& [name, value] : p.measured)
          text += fmt::format("{}{}={}", text.empty() ? "" : " ", name, csv_number(value));
        return csv_text(text);
      }));
}

// What was asked and answered, in the task's own words.
void add_task(std::vector<Column>& columns, const Protocol& protocol) {
  using R = ExportTrial;
  const Task& task = task_of(protocol.task.kind);
  const std::string suffix(name_suffix(protocol.stimulus.unit)), symbol(to_string(protocol.stimulus.unit));
  const std::string quantity = protocol.stimulus.quantity;
  const bool pairs = protocol.task.kind == TaskKind::same_different;
  if (!pairs && task.has_standard())
    columns.push_back({"standard_" + suffix, "the standard", symbol, "",
                       [](const R& r) { return csv_number(r.record.trial.standard); }});
  for (int i = 0; i < task.intervals(protocol.task); ++i)
    columns.push_back({fmt::format("stimulus_{}_{}", i + 1, suffix),
                       fmt::format("{} asked in interval {}", quantity, i + 1), symbol, "", [i](const R& r) {
                         const Intervals& stimuli = r.record.trial.stimuli;
                         const auto place = static_cast<std::size_t>(i);
                         return place < stimuli.size() ? csv_number(stimuli[place]) : std::string();
                       }});
  // Where a level may equal the standard, the values do not always tell which is which.
  if (task.level_may_be_standard())
    columns.push_back({"standard_interval", "the interval that held the standard", "", "1 2", [](const R& r) {
                         return csv_number(holds_standard(r.record.trial, r.record.trial.stimuli, 0) ? 1 : 2);
                       }});
  std::string words;
  if (!task.adjusts())  // its answers only move what is presented
    for (const std::string& word : protocol.task.classes) words.append(words.empty() ? "" : " ").append(word);
  if (pairs)
    columns.push_back({"same", "whether the two were equal", "", "0 1",
                       [](const R& r) { return csv_flag(r.record.trial.target == kClassSame); }});
  else if (!words.empty())
    columns.push_back(
        {"target", "the answer that is correct; empty where none is", "", words,
         [spec = protocol.task](const R& r) { return std::string(said_word(spec, r.record.trial.target)); }});
  columns.push_back({"answer", "what was answered", "", words, [](const R& r) {
                       const Answer& answer = r.record.answer;
                       return answer.number ? csv_number(*answer.number) : csv_text(r.record.answer_word);
                     }});
  if (task.adjusts())
    columns.push_back({"settings",
                       "what was presented in turn beside the standard, the start first, separated by blanks", symbol,
                       "", [](const R& r) {
                         std::string text;
                         for (const double setting : r.record.settings)
                           text.append(text.empty() ? "" : " ").append(csv_number(setting));
                         return csv_text(text);
                       }});
  if (protocol.task.sureness_levels > 0)
    columns.push_back({"sureness", "how sure of it, from 1", "", "",
                       [](const R& r) { return csv_number(r.record.answer.sureness); }});
  if (!words.empty())
    columns.push_back({"correct", "whether the answer was right", "", "0 1", [](const R& r) {
                         const std::optional<bool> correct = is_correct(r.record.trial, r.record.answer);
                         return correct ? csv_flag(*correct) : std::string();
                       }});
}

// Fingers by their names; where a finger has two devices, each with what it acts on.
std::string device_name(const Protocol& protocol, const std::vector<DevicePlace>& places, DevicePlace place) {
  const std::string& finger = protocol.rig.fingers.at(static_cast<std::size_t>(place.finger));
  const auto devices = std::count_if(places.begin(), places.end(),
                                     [&](const DevicePlace& other) { return other.finger == place.finger; });
  return devices > 1 ? fmt::format("{} {}", finger, to_string(place.channel)) : finger;
}

}  // namespace

std::vector<Column> trial_columns(const Protocol& protocol, const std::vector<DevicePlace>& places) {
  if (protocol.task.kind == TaskKind::explore) return {};  // it has no trials
  const Unit unit = protocol.stimulus.unit;
  using R = ExportTrial;
  std::vector<Column> columns = {
      {"participant", "code of the participant", "", "", [](const R& r) { return csv_text(r.session.participant); }},
      {"session", "session of the trial", "", "", [](const R& r) { return csv_text(r.session.id); }, Reveals::nothing},
      {"session_number", "which of the participant's sessions, from 1", "", "",
       [](const R& r) { return csv_number(r.session.number); }},
      {"kind", "kind of the session", "", "real pilot simulated",
       [](const R& r) { return std::string(to_string(r.session.kind)); }},
      {"protocol_sha256", "SHA-256 of the protocol's bytes", "", "", [sha = protocol.sha256](const R&) { return sha; }},
      {"seq", "number of the trial's event in its session", "", "", [](const R& r) { return csv_number(r.seq); }},
      {"utc", "when the answer was saved, ISO 8601", "", "", [](const R& r) { return r.utc; }, Reveals::nothing},
      {"trial", "place in the participant's plan, from 1; practice comes first", "", "",
       [](const R& r) { return csv_number(r.record.trial.index); }, Reveals::nothing},
      {"attempt", "1, or more where the trial was voided and repeated", "", "",
       [](const R& r) { return csv_number(r.record.attempt); }},
      {"practice", "whether it was practice, which no analysis counts", "", "0 1",
       [](const R& r) { return csv_flag(r.record.trial.practice); }, Reveals::nothing},
      {"round", "round of practice, from 1; 0 in the main part", "", "",
       [](const R& r) { return csv_number(r.record.trial.round); }},
      {"block", "block, from 1; 0 in practice", "", "", [](const R& r) { return csv_number(r.record.trial.block); },
       Reveals::nothing},
      {"series", "series of the trial", "", "", [](const R& r) { return csv_text(r.record.series_name); }},
      {"condition", "feedback condition", "", "", [](const R& r) { return csv_text(r.record.condition_name); }}};
  if (!protocol.groups.empty())
    columns.insert(columns.begin() + 1, {"group", "group of the participant", "", group_levels(protocol),
                                         [](const R& r) { return csv_text(r.session.group); }});
  add_task(columns, protocol);
  columns.insert(columns.end(),
                 {{"entered_by", "who pressed the key", "", "participant operator",
                   [](const R& r) { return std::string(to_string(r.record.answer.entered_by)); }, Reveals::nothing},
                  {"response_time_s", "from the question cue to the key", "s", "",
                   [](const R& r) { return csv_number(r.record.answer.response_time_s); }, Reveals::nothing},
                  {"duration_s", "from the first cue to the answer", "s", "",
                   [](const R& r) { return csv_number(r.record.duration_s); }, Reveals::nothing},
                  {"excluded", "whether a registered rule leaves the trial out of the analysis", "", "0 1",
                   [](const R& r) { return csv_flag(!r.excluded_reason.empty()); }},
                  {"excluded_reason", "the first rule that applies; empty where the trial counts", "",
                   "response_time_below response_time_above saturated_share_above off_prescription",
                   [](const R& r) { return r.excluded_reason; }}});
  if (judges_exploration(protocol))
    columns.push_back({"breach", "what of the prescription was broken or not measured; empty where all was kept", "",
                       "", [](const R& r) { return csv_text(r.record.breach); }});
  if (protocol.design.procedure)
    columns.push_back({"track", "track of the adaptive procedure in its condition, from 1; 0 in practice", "", "",
                       [](const R& r) { return csv_number(r.record.trial.track); }});
  const auto intervals = static_cast<std::size_t>(task_of(protocol.task.kind).intervals(protocol.task));
  for (std::size_t interval = 0; interval < intervals; ++interval) {
    add_interval(columns, interval);
    if (!protocol.rig.built_in()) add_measured(columns, interval, protocol);
    for (const DevicePlace& place : places)
      add_device(columns, interval, place, device_name(protocol, places, place), unit);
  }
  return columns;
}

// Columns of answers, sessions and the dictionary.

namespace {

constexpr const char* kKinds = "real pilot simulated";

}  // namespace

std::vector<CsvColumn<ExportAnswer>> answer_columns() {
  using R = ExportAnswer;
  return {
      {"participant", "code of the participant", "", "", [](const R& r) { return csv_text(r.session.participant); }},
      {"session", "session of the answer", "", "", [](const R& r) { return csv_text(r.session.id); }},
      {"session_number", "which of the participant's sessions, from 1", "", "",
       [](const R& r) { return csv_number(r.session.number); }},
      {"kind", "kind of the session", "", kKinds, [](const R& r) { return std::string(to_string(r.session.kind)); }},
      {"utc", "when the answer was saved, ISO 8601", "", "", [](const R& r) { return r.utc; }},
      {"question", "identifier of the question", "", "", [](const R& r) { return csv_text(r.question); }},
      {"asked", "when it is asked", "", "before_session after_condition after_series after_session",
       [](const R& r) { return csv_text(r.asked); }},
      {"condition", "the condition that it is about; empty where it is about none", "", "",
       [](const R& r) { return csv_text(r.condition); }},
      {"after_trial", "main trials planned before it; 0 before and after the session", "", "",
       [](const R& r) { return csv_number(r.after_trial); }},
      {"answered", "0 where a question that is not required was left out", "", "0 1",
       [](const R& r) { return csv_flag(r.answered); }},
      {"answer", "the answer as given", "", "", [](const R& r) { return csv_text(r.answer); }},
      {"text", "the question as asked", "", "", [](const R& r) { return csv_text(r.text); }}};
}

std::vector<CsvColumn<SessionInfo>> session_columns(const std::string& seed, const std::string& study_head,
                                                    const Protocol& protocol) {
  using R = SessionInfo;
  std::vector<CsvColumn<R>> columns = {
      {"participant", "code of the participant", "", "", [](const R& r) { return csv_text(r.participant); },
       Reveals::nothing},
      {"participant_number", "number of the plan", "", "", [](const R& r) { return csv_number(r.participant_number); },
       Reveals::nothing},
      {"session", "identifier of the session", "", "", [](const R& r) { return csv_text(r.id); }, Reveals::nothing},
      {"session_number", "which of the participant's sessions, from 1", "", "",
       [](const R& r) { return csv_number(r.number); }, Reveals::nothing},
      {"kind", "kind of the session", "", kKinds, [](const R& r) { return std::string(to_string(r.kind)); },
       Reveals::nothing},
      {"language", "language of the participant; empty where none was chosen", "", "",
       [](const R& r) { return csv_text(r.language); }, Reveals::nothing},
      {"excluded", "whether the participant was excluded: nothing of theirs is in the other files", "", "0 1",
       [](const R& r) { return csv_flag(r.excluded); }, Reveals::nothing},
      {"state", "whether it is finished", "", "open closed", [](const R& r) { return r.state; }, Reveals::nothing},
      {"responder", "who or what answered", "", "", [](const R& r) { return csv_text(r.responder); }, Reveals::nothing},
      {"started", "when it was opened, ISO 8601", "", "", [](const R& r) { return csv_text(r.started); },
       Reveals::nothing},
      {"ended", "when it was closed, ISO 8601; empty while open", "", "", [](const R& r) { return csv_text(r.ended); },
       Reveals::nothing},
      {"trials_done", "main trials answered", "", "", [](const R& r) { return csv_number(r.trials_done); },
       Reveals::nothing},
      {"trials_voided", "attempts voided, practice included", "", "",
       [](const R& r) { return csv_number(r.trials_voided); }, Reveals::nothing},
      {"trials_total", "main trials planned", "", "", [](const R& r) { return csv_number(r.trials_total); },
       Reveals::nothing},
      {"head", "hash of its last event: names everything before it", "", "", [](const R& r) { return r.head; },
       Reveals::nothing},
      {"study_head",
       "hash of the last event of the study's own chain: names every exclusion, unblinding and closing before it", "",
       "", [study_head](const R&) { return study_head; }, Reveals::nothing},
      {"seed", "seed of the study; empty while it is sealed", "", "", [seed](const R&) { return seed; }},
      {"protocol", "name of the protocol", "", "", [n = protocol.name](const R&) { return csv_text(n); },
       Reveals::nothing},
      {"protocol_sha256", "SHA-256 of the protocol's bytes", "", "", [sha = protocol.sha256](const R&) { return sha; },
       Reveals::nothing},
      {"exported_by", "version of the program that wrote these files", "", "",
       [](const R&) { return std::string("jnd ") + kVersion; }, Reveals::nothing}};
  // Who says a group knows it; one that was drawn stays sealed.
  if (!protocol.groups.empty())
    columns.insert(columns.begin() + 1, {"group", "group of the participant", "", group_levels(protocol),
                                         [](const R& r) { return csv_text(r.group); },
                                         protocol.allotment == Allotment::given ? Reveals::nothing : Reveals::plan});
  return columns;
}

std::vector<CsvColumn<DictionaryRow>> dictionary_columns() {
  using R = DictionaryRow;
  return {
      {"file", "file of the export; sub-* stands for every participant's folder", "", "",
       [](const R& r) { return r.file; }},
      {"column", "column of the file", "", "", [](const R& r) { return r.column; }},
      {"meaning", "what it holds", "", "", [](const R& r) { return csv_text(r.meaning); }},
      {"unit", "unit of numbers; empty for text, counts, shares and flags", "", "", [](const R& r) { return r.unit; }},
      {"levels", "values that text and flags can have, separated by blanks", "", "",
       [](const R& r) { return r.levels; }}};
}

}  // namespace jnd
