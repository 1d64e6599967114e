#include "runner/results/result_format.h"

#include <fmt/format.h>

namespace jnd {

std::string stiffness_text(double value, const Protocol& protocol) {
  return number_text(value, stiffness_decimals(protocol));
}

std::string median_text(JndStatus status, double median, const Protocol& protocol) {
  if (status == JndStatus::ceiling || status == JndStatus::no_information) return std::string(to_string(status));
  return stiffness_text(median, protocol);
}

std::string_view unit_of(const Protocol& protocol) noexcept {
  return to_string(protocol.stimulus.unit);
}

const std::string& condition_text(const Protocol& protocol, int place) {
  return protocol.conditions[static_cast<std::size_t>(place)].name;
}

std::string condition_title(const Condition& condition) {
  return condition.label.empty() || condition.label == condition.name ? condition.name
                                                                      : condition.name + ": " + condition.label;
}

std::string tracks_words(const TrackCount& tracks) {
  if (tracks.used > 0 && tracks.used < tracks.all) return fmt::format("{} of {} tracks used", tracks.used, tracks.all);
  return tracks.unfinished > 0 ? fmt::format("{} of {} tracks unfinished", tracks.unfinished, tracks.all) : "";
}

std::string joined(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + ", " + b;
}

std::string source_caution(DifferenceSource source, const StudyAnalysis& analysis) {
  if (source == analysis.by) return {};
  return source == DifferenceSource::mixed ? "nominal differences in part" : "nominal difference";
}

ContrastScale contrast_scale(const ContrastRow& row, const OutcomeComparison& tested, const Protocol& protocol) {
  ContrastScale text;
  text.name = row.outcome;
  if (row.outcome == to_string(Outcome::slope)) {
    text.factor = slope_step(protocol);
    text.name = fmt::format("d' per {} {}", slope_step(protocol), unit_of(protocol));
  } else if (row.outcome == to_string(Outcome::log_jnd)) {
    text.name = "ln JND";
  } else if (row.outcome == kHierarchicalScale) {
    text.name = "ln JND (hierarchical model)";
  } else if (protocol.task.kind == TaskKind::same_different) {
    text.name = fmt::format("{} {}", row.outcome == to_string(Outcome::jnd) ? "JND" : row.outcome, unit_of(protocol));
    text.decimals = stiffness_decimals(protocol);
  } else {
    text.name = row.unit.empty() ? tested.title : fmt::format("{} {}", tested.title, row.unit);
  }
  return text;
}

}  // namespace jnd
