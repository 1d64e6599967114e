#include "runner/analysis_text.h"

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "runner/terminal.h"
#include "runner/text_table.h"

namespace jnd {

namespace {

using Align = TextTable::Align;

std::string number(double value, int decimals) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return fmt::format("{:.{}f}", value, decimals);
}

std::string percent(double fraction) {
  return std::isfinite(fraction) ? fmt::format("{:.1f} %", 100 * fraction) : "-";
}

// Stiffnesses of a contact are hundreds of N/m, those of a joint tens of N/rad.
int decimals_of(const Protocol& protocol) {
  return protocol.stimulus.unit == StiffnessUnit::n_per_m ? 1 : 2;
}

std::string stiffness(double value, const Protocol& protocol) {
  return number(value, decimals_of(protocol));
}

std::string_view unit_of(const Protocol& protocol) {
  return to_string(protocol.stimulus.unit);
}

// Of slopes, so that they have digits to read: d' per 100 N/m, d' per 10 N/rad.
int slope_step(const Protocol& protocol) {
  return protocol.stimulus.unit == StiffnessUnit::n_per_m ? 100 : 10;
}

std::string interval(const MeanEstimate& estimate, int decimals) {
  if (std::isnan(estimate.ci_low)) return "-";
  return number(estimate.ci_low, decimals) + " .. " + number(estimate.ci_high, decimals);
}

const PublishedValue* published(const Protocol& protocol, const std::string& condition, const std::string& quantity) {
  for (const PublishedValue& value : protocol.published)
    if (value.condition == condition && value.quantity == quantity) return &value;
  return nullptr;
}

std::string published_jnd(const Protocol& protocol, const std::string& condition) {
  const PublishedValue* value = published(protocol, condition, "jnd");
  if (value == nullptr) return "";
  if (value->ci95_half_width)
    return stiffness(value->value, protocol) + " ± " + stiffness(*value->ci95_half_width, protocol);
  return stiffness(value->value, protocol);
}

std::string remarks(const JndEstimate& estimate) {
  std::string text;
  if (estimate.status != JndStatus::ok) text = to_string(estimate.status);
  for (const Caution caution : estimate.cautions) {
    // Every participant of a short design has too few trials; the heading says it once.
    if (caution == Caution::few_trials) continue;
    text += (text.empty() ? "" : ", ") + std::string(to_string(caution));
  }
  return text;
}

const Condition& condition_at(const Protocol& protocol, int place) {
  return protocol.conditions[static_cast<std::size_t>(place)];
}

std::string method(const StudyAnalysis& analysis, const Protocol& protocol) {
  return fmt::format(
      "JND: {} through the origin of {} d' ({} rates) on the {} stiffness differences; Weber fraction = JND / {:g} {}",
      protocol.analysis.jnd_method, protocol.analysis.model, protocol.analysis.correction, to_string(analysis.by),
      protocol.stimulus.reference, unit_of(protocol));
}

// Whoever changes the axis after the fact must say so wherever the number goes.
void print_unregistered(const StudyAnalysis& analysis, const Protocol& protocol) {
  if (analysis.by != registered_source(protocol))
    fmt::print("{}\n", warn(fmt::format("The protocol registers {} stiffness differences: this is another analysis.",
                                        to_string(registered_source(protocol)))));
}

// Where the fit rests on another difference than the one asked for.
std::string source_remark(DifferenceSource source, const StudyAnalysis& analysis) {
  if (source == analysis.by) return {};
  return source == DifferenceSource::mixed ? "nominal differences in part" : "nominal difference";
}

std::string joined(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + ", " + b;
}

}  // namespace

void print_participants(const StudyAnalysis& analysis, const Protocol& protocol) {
  fmt::print("{}\n{}\n", bold("Participants"), dim(method(analysis, protocol)));
  print_unregistered(analysis, protocol);
  for (const ThresholdResult& row : analysis.thresholds) {
    if (std::find(row.jnd.cautions.begin(), row.jnd.cautions.end(), Caution::few_trials) == row.jnd.cautions.end())
      continue;
    fmt::print("{}\n",
               warn("caution: few_trials (fewer than 10 trials a class and series); single JNDs scatter widely"));
    break;
  }
  TextTable table({"participant", "condition", fmt::format("d' per {} {}", slope_step(protocol), unit_of(protocol)),
                   fmt::format("JND {}", unit_of(protocol)), "Weber", "s a trial", "remarks"},
                  {Align::left, Align::left, Align::right, Align::right, Align::right, Align::right, Align::left});
  std::string last;
  for (const ThresholdResult& row : analysis.thresholds) {
    table.add({row.participant == last ? "" : row.participant, condition_at(protocol, row.condition).name,
               number(slope_step(protocol) * row.jnd.slope, 3), stiffness(row.jnd.jnd, protocol),
               percent(row.jnd.weber), row.mean_trial_s > 0 ? number(row.mean_trial_s, 1) : "-",
               joined(remarks(row.jnd), source_remark(row.difference_source, analysis))});
    last = row.participant;
  }
  fmt::print("{}\n", table.text());
}

void print_cells(const StudyAnalysis& analysis, const Protocol& protocol) {
  fmt::print("{}\n{}\n", bold("Cells"),
             dim(fmt::format("{} d' = z(H) - z(F) on {} rates; c > 0 leans to \"same\"; stiffness differences as asked "
                             "and as delivered",
                             protocol.analysis.model, protocol.analysis.correction)));
  TextTable table({"participant", "condition", "series", fmt::format("asked {}", unit_of(protocol)), "delivered",
                   "hits", "false alarms", "H", "F", "z(H)", "z(F)", "d'", "c", "remarks"},
                  {Align::left, Align::left, Align::left, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right, Align::right, Align::right, Align::right, Align::right, Align::left});
  for (const CellResult& cell : analysis.cells) {
    std::string note = cell.yes_no.status == RateStatus::ok ? "" : std::string(to_string(cell.yes_no.status));
    if (cell.excluded > 0) note += fmt::format("{}{} excluded", note.empty() ? "" : ", ", cell.excluded);
    if (cell.missing > 0) note += fmt::format("{}{} not done", note.empty() ? "" : ", ", cell.missing);
    if (cell.without_fit > 0 && cell.delivered_difference.n > 0)
      note = joined(note, fmt::format("{} without a delivered difference", cell.without_fit));
    note = joined(note, source_remark(cell.difference_source, analysis));
    const Series& series = protocol.series[static_cast<std::size_t>(cell.series)];
    table.add({cell.participant, condition_at(protocol, cell.condition).name, series.name,
               stiffness(std::abs(series.pair[1] - series.pair[0]), protocol),
               stiffness(cell.delivered_difference.mean, protocol),
               fmt::format("{}/{}", cell.counts.hits, cell.counts.n_diff),
               fmt::format("{}/{}", cell.counts.false_alarms, cell.counts.n_same), number(cell.yes_no.hit_rate, 3),
               number(cell.yes_no.false_alarm_rate, 3), number(cell.yes_no.z_hit, 3),
               number(cell.yes_no.z_false_alarm, 3), number(cell.yes_no.dprime, 3), number(cell.yes_no.criterion, 3),
               note});
  }
  fmt::print("{}\n", table.text());
}

namespace {

void print_group_notes(const StudyAnalysis& analysis, const Protocol& protocol) {
  for (const GroupResult& row : analysis.group) {
    const JndGroup& jnd = row.jnd;
    const int left_out = jnd.no_sensitivity + jnd.ceiling + jnd.no_information;
    if (left_out == 0) continue;
    fmt::print(
        "  {}: the mean leaves out {} of {} ({} no_sensitivity, {} ceiling, {} no_information); the median keeps {} of "
        "them\n",
        condition_at(protocol, row.condition).name, left_out, jnd.n, jnd.no_sensitivity, jnd.ceiling,
        jnd.no_information, jnd.no_sensitivity + jnd.ceiling);
  }
  for (const GroupResult& row : analysis.group)
    if (const std::string remark = source_remark(row.difference_source, analysis); !remark.empty() && row.jnd.n > 0)
      fmt::print("  {}: {}: nothing was delivered that has a stiffness to fit\n",
                 condition_at(protocol, row.condition).name, remark);
}

void print_contrasts(const StudyAnalysis& analysis, const Protocol& protocol) {
  if (analysis.contrasts.empty()) return;
  TextTable table({"contrast", "n", fmt::format("mean difference {}", unit_of(protocol)), "95 % CI"},
                  {Align::left, Align::right, Align::right, Align::right});
  for (const ContrastResult& row : analysis.contrasts) {
    const std::string remark = source_remark(row.difference_source, analysis);
    table.add({condition_at(protocol, row.a).name + " - " + condition_at(protocol, row.b).name +
                   (remark.empty() ? "" : " (" + remark + ")"),
               std::to_string(row.difference.n), stiffness(row.difference.mean, protocol),
               interval(row.difference, decimals_of(protocol))});
  }
  fmt::print("\n{}\n{}\n{}", bold("Registered contrasts"), dim("paired differences of the JND, participants with both"),
             table.text());
}

}  // namespace

void print_group(const StudyAnalysis& analysis, const Protocol& protocol) {
  fmt::print("{}\n{}\n",
             bold(fmt::format("Group ({}, {} participants)", to_string(analysis.kind), analysis.participants)),
             dim(method(analysis, protocol)));
  print_unregistered(analysis, protocol);
  TextTable table(
      {"condition", "n used", "mean JND", "95 % CI", "median", "1/mean slope", "mean Weber", "published JND", "Weber"},
      {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
       Align::right});
  for (const GroupResult& row : analysis.group) {
    const Condition& condition = condition_at(protocol, row.condition);
    const JndGroup& jnd = row.jnd;
    const PublishedValue* weber = published(protocol, condition.name, "weber");
    table.add({condition.name, fmt::format("{} of {}", jnd.mean_jnd.n, jnd.n), stiffness(jnd.mean_jnd.mean, protocol),
               interval(jnd.mean_jnd, decimals_of(protocol)), stiffness(jnd.median_jnd, protocol),
               stiffness(jnd.inverse_mean_slope, protocol), percent(jnd.mean_weber.mean),
               published_jnd(protocol, condition.name), weber == nullptr ? "" : percent(weber->value)});
  }
  fmt::print("{}", table.text());
  print_group_notes(analysis, protocol);
  for (const auto& [reason, trials] : analysis.exclusions)
    fmt::print("  excluded by the registered rule {}: {} trials\n", reason, trials);
  print_contrasts(analysis, protocol);
}

}  // namespace jnd
