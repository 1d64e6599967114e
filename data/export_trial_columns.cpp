// Columns of trials.csv: the plan, the answer, and everything that was delivered, by interval and finger.
#include <algorithm>

#include <fmt/format.h>

#include "data/export_tables.h"

namespace jnd {

namespace {

using Column = CsvColumn<ExportTrial>;

std::string column_name(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return !((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')); }, '_');
  return text;
}

// A cell of one finger; empty where the presentation has no such finger.
template <typename Cell>
Column finger_column(std::size_t interval, std::size_t finger, const std::string& name, const std::string& quantity,
                     const std::string& meaning, const std::string& unit, Cell cell, const std::string& levels = "") {
  return {fmt::format("i{}_{}_{}", interval + 1, column_name(name), quantity),
          fmt::format("interval {}, {}: {}", interval + 1, name, meaning), unit, levels,
          [interval, finger, cell](const ExportTrial& row) -> std::string {
            const Presentation& presentation = row.record.presentations[interval];
            return finger < presentation.fingers.size() ? cell(presentation.fingers[finger]) : std::string();
          }};
}

template <typename Cell>
Column interval_column(std::size_t interval, const std::string& quantity, const std::string& meaning,
                       const std::string& unit, Cell cell, const std::string& levels = "") {
  return {fmt::format("i{}_{}", interval + 1, quantity), fmt::format("interval {}: {}", interval + 1, meaning), unit,
          levels, [interval, cell](const ExportTrial& row) { return cell(row.record.presentations[interval]); }};
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
  columns.push_back(interval_column(
      i, "fault", "why the presentation was not delivered as asked", "",
      [](const P& p) { return std::string(to_string(p.fault)); },
      "none no_contact stale_pose non_finite device_lost emergency_stop interrupted"));
}

void add_finger(std::vector<Column>& columns, std::size_t i, std::size_t f, const std::string& name) {
  using F = FingerPresentation;
  const auto add = [&](const char* quantity, const char* meaning, const char* unit, auto cell,
                       const char* levels = "") {
    columns.push_back(finger_column(i, f, name, quantity, meaning, unit, cell, levels));
  };
  add("stiffness_n_per_m",
      "delivered stiffness: slope of force on penetration over unsaturated contact; empty where none could be fitted",
      "N/m", [](const F& p) { return p.stiffness_n_per_m ? csv_number(*p.stiffness_n_per_m) : std::string(); });
  add("fit_samples", "samples in that fit", "", [](const F& p) { return csv_number(p.fit_samples); });
  add("peak_force_n", "largest delivered force", "N", [](const F& p) { return csv_number(p.peak_force_n); });
  add("deepest_penetration_m", "deepest penetration", "m",
      [](const F& p) { return csv_number(p.deepest_penetration_m); });
  add("work_j", "work done on the sphere while loading", "J", [](const F& p) { return csv_number(p.work_j); });
  add("mean_speed_m_per_s", "mean absolute penetration rate in contact", "m/s",
      [](const F& p) { return csv_number(p.mean_speed_m_per_s); });
  add("contacts", "number of contacts", "", [](const F& p) { return csv_number(p.contacts); });
  add("dwell_s", "time in contact", "s", [](const F& p) { return csv_number(p.dwell_s); });
  add("saturated_share", "share of contact time in which a limit reduced the force, 0..1", "",
      [](const F& p) { return csv_number(p.saturated_share); });
  add("vibration_g", "amplitude of the delivered bursts; 0 without one", "g",
      [](const F& p) { return csv_number(p.vibration_g); });
  add(
      "vibration_clamped", "whether the amplitude was limited by the device", "",
      [](const F& p) { return csv_flag(p.vibration_clamped); }, "0 1");
}

}  // namespace

std::vector<Column> trial_columns(const Protocol& protocol) {
  using R = ExportTrial;
  std::vector<Column> columns = {
      {"participant", "code of the participant", "", "", [](const R& r) { return csv_text(r.session.participant); }},
      {"session", "session of the trial", "", "", [](const R& r) { return csv_text(r.session.id); }},
      {"kind", "kind of the session", "", "real pilot simulated",
       [](const R& r) { return std::string(to_string(r.session.kind)); }},
      {"protocol_sha256", "SHA-256 of the protocol's bytes", "", "", [sha = protocol.sha256](const R&) { return sha; }},
      {"seq", "number of the trial's event in its session", "", "", [](const R& r) { return csv_number(r.seq); }},
      {"utc", "when the answer was saved, ISO 8601", "", "", [](const R& r) { return r.utc; }},
      {"trial", "place in the participant's plan, from 1; practice comes first", "", "",
       [](const R& r) { return csv_number(r.record.trial.index); }},
      {"attempt", "1, or more where the trial was voided and repeated", "", "",
       [](const R& r) { return csv_number(r.record.attempt); }},
      {"practice", "whether it was practice, which no analysis counts", "", "0 1",
       [](const R& r) { return csv_flag(r.record.trial.practice); }},
      {"round", "round of practice, from 1; 0 in the main part", "", "",
       [](const R& r) { return csv_number(r.record.trial.round); }},
      {"block", "block, from 1; 0 in practice", "", "", [](const R& r) { return csv_number(r.record.trial.block); }},
      {"series", "series of the trial", "", "", [](const R& r) { return csv_text(r.record.series_name); }},
      {"condition", "feedback condition", "", "", [](const R& r) { return csv_text(r.record.condition_name); }},
      {"stimulus_1_n_per_m", "stiffness asked in interval 1", "N/m", "",
       [](const R& r) { return csv_number(r.record.trial.stimuli_n_per_m[0]); }},
      {"stimulus_2_n_per_m", "stiffness asked in interval 2", "N/m", "",
       [](const R& r) { return csv_number(r.record.trial.stimuli_n_per_m[1]); }},
      {"same", "whether the two were equal", "", "0 1", [](const R& r) { return csv_flag(r.record.trial.same); }},
      {"answer", "what was answered", "", "same different",
       [](const R& r) { return std::string(to_string(r.record.answer.judgement)); }},
      {"correct", "whether the answer was right", "", "0 1",
       [](const R& r) { return csv_flag((r.record.answer.judgement == Judgement::same) == r.record.trial.same); }},
      {"entered_by", "who pressed the key", "", "participant operator",
       [](const R& r) { return std::string(to_string(r.record.answer.entered_by)); }},
      {"response_time_s", "from the question cue to the key", "s", "",
       [](const R& r) { return csv_number(r.record.answer.response_time_s); }},
      {"duration_s", "from the first cue to the answer", "s", "",
       [](const R& r) { return csv_number(r.record.duration_s); }},
      {"excluded", "whether a registered rule leaves the trial out of the analysis", "", "0 1",
       [](const R& r) { return csv_flag(!r.excluded_reason.empty()); }},
      {"excluded_reason", "the first rule that applies; empty where the trial counts", "",
       "response_time_below response_time_above saturated_share_above", [](const R& r) { return r.excluded_reason; }}};
  for (std::size_t interval = 0; interval < 2; ++interval) {
    add_interval(columns, interval);
    for (std::size_t finger = 0; finger < protocol.rig.fingers.size(); ++finger)
      add_finger(columns, interval, finger, protocol.rig.fingers[finger]);
  }
  return columns;
}

}  // namespace jnd
