#include "runner/precision/precision_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/numerics/words.h"
#include "protocols/course/duration.h"
#include "protocols/planning/allotment.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

std::string PrecisionTable::text(TableStyle style) const {
  if (style == TableStyle::markdown) return markdown();
  std::vector<TextTable::Align> align(rows_.front().size(), TextTable::Align::right);
  align.front() = TextTable::Align::left;
  TextTable table(rows_.front(), align);
  for (std::size_t i = 1; i < rows_.size(); ++i) table.add(rows_[i]);
  return table.text();
}

std::string PrecisionTable::markdown() const {
  std::string text;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    text += fmt::format("| {} |\n", fmt::join(rows_[i], " | "));
    if (i != 0) continue;
    text += "|---";
    for (std::size_t column = 1; column < rows_[i].size(); ++column) text += "|---:";
    text += "|\n";
  }
  return text;
}

namespace {

std::string percent(double share) {
  if (share < 1e-12) return "0.0 %";  // rounding leaves as much
  if (share < 0.0005) return "< 0.1 %";
  return fmt::format("{:.1f} %", 100 * share);
}

std::string of_cv(double cv) {
  return std::isfinite(cv) ? fmt::format("{:.0f} %", 100 * cv) : "none";
}

// Four digits at most; infinities and undefined numbers by name.
std::string amount(double value) {
  if (std::isnan(value)) return "none";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const double size = std::abs(value);
  if (size >= 1e6) return fmt::format("{:.1e}", value);
  return fmt::format("{:.{}f}", value, size >= 1000 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3);
}

std::string range(double low, double high) {
  return fmt::format("{} to {}", amount(low), amount(high));
}

std::string with_sign(double value) {
  return fmt::format("{}{}", value > 0 ? "+" : "", amount(value));
}

const std::string& name_of(const Protocol& protocol, std::size_t condition) {
  return protocol.conditions[condition].name;
}

std::string heading(const std::string& text, TableStyle style) {
  return style == TableStyle::markdown ? fmt::format("\n**{}**\n\n", text) : fmt::format("\n{}\n", bold(text));
}

std::string tested_range(const CountsDesign& design) {
  const auto [low, high] = std::minmax_element(design.differences.begin(), design.differences.end());
  return fmt::format("{:g} to {:g}", *low, *high);
}

// How the estimates' distribution was found; conditions can differ where some have too many outcomes.
std::string method_of(const Precision& precision, const Protocol& protocol) {
  std::string simulated;
  double median_se = 0, share_se = 0;
  int replicates = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < precision.participant.size(); ++i) {
    const ParticipantPrecision& one = precision.participant[i];
    if (one.method == PrecisionMethod::enumeration) continue;
    ++count;
    simulated += (simulated.empty() ? "" : ", ") + name_of(protocol, i);
    median_se = std::max(median_se, one.median_se);
    share_se = std::max(share_se, one.share_se);
    replicates = one.replicates;
  }
  std::string enumeration = "every outcome with its probability (enumeration)";
  if (count == 0) return enumeration;
  const std::string simulation =
      fmt::format("simulation of {} participants, standard error of a median {}, of a share at most {:.2f} %",
                  replicates, amount(median_se), 100 * share_se);
  return count == precision.participant.size() ? simulation
                                               : fmt::format("{}; {}: {}", enumeration, simulated, simulation);
}

std::string estimates(const PlannedPrecision& planned, const Protocol& protocol, TableStyle style) {
  const Precision& precision = planned.precision;
  PrecisionTable table({"condition", fmt::format("true JND {}", to_string(protocol.stimulus.unit)), "rate of 0 or 1",
                        "d' <= 0", "median", "5 to 95 %", "2.5 to 97.5 %", "bias of median", "mean of the defined",
                        "undefined", fmt::format("outside {}", tested_range(precision.question.design))});
  for (std::size_t i = 0; i < precision.participant.size(); ++i) {
    const ParticipantPrecision& one = precision.participant[i];
    table.add({name_of(protocol, i), amount(one.true_jnd), percent(one.risks.any_extreme),
               percent(one.risks.any_not_positive), amount(one.median), range(one.q05, one.q95),
               range(one.q025, one.q975), with_sign(one.bias_of_median), amount(one.mean), percent(1 - one.status.ok),
               percent(one.outside_tested)});
  }
  return table.text(style);
}

std::string proposals(const Precision& precision, const Protocol& protocol, TableStyle style) {
  PrecisionTable table({"condition", "CV", "spread of estimates", "width of a 95 % interval", "no upper bound",
                        fmt::format("trials per cell for a CV of {}", of_cv(precision.question.wanted_cv))});
  for (std::size_t i = 0; i < precision.participant.size(); ++i) {
    const ParticipantPrecision& one = precision.participant[i];
    table.add({name_of(protocol, i), of_cv(one.cv), of_cv(one.spread), amount(one.interval_width),
               percent(one.interval_unbounded),
               one.proposed_trials ? std::to_string(*one.proposed_trials) : "more than a million"});
  }
  return table.text(style);
}

// What the proposal means for a participant.
std::string session_of_proposal(const Precision& precision, const Protocol& protocol) {
  int trials = 0;
  for (const ParticipantPrecision& one : precision.participant) {
    if (!one.proposed_trials) return "";
    trials = std::max(trials, *one.proposed_trials);
  }
  Protocol proposed = protocol;
  proposed.design.trials_per_cell = trials;
  const std::size_t cells = conditions_of(protocol, largest_plan(protocol)).size() * protocol.series.size();
  return fmt::format("{} trials per cell in every condition are {} trials per participant, about {}.\n", trials,
                     static_cast<std::size_t>(trials) * cells, duration_text(expected_duration_s(proposed)));
}

std::string group_table(const Precision& precision, const Protocol& protocol, TableStyle style) {
  PrecisionTable table(
      {"condition", "mean JND, median", "5 to 95 %", "width of its 95 % interval", "someone undefined"});
  for (std::size_t i = 0; i < precision.group.size(); ++i) {
    const GroupPrecision& one = precision.group[i];
    table.add({name_of(protocol, i), amount(one.median), range(one.q05, one.q95), amount(one.ci_width),
               percent(one.with_undefined)});
  }
  return table.text(style);
}

std::string contrast_table(const Precision& precision, const Protocol& protocol, TableStyle style) {
  PrecisionTable table({"contrast", "true difference", "median", "width of its 95 % interval", "power",
                        "power of slopes", "someone without both"});
  for (const ContrastPrecision& one : precision.contrasts) {
    table.add({fmt::format("{} - {}", name_of(protocol, static_cast<std::size_t>(one.a)),
                           name_of(protocol, static_cast<std::size_t>(one.b))),
               amount(one.true_difference), amount(one.median), amount(one.ci_width), percent(one.power),
               percent(one.power_of_slopes), percent(one.with_undefined)});
  }
  return table.text(style);
}

std::string sources_of(const PlannedPrecision& planned, const Protocol& protocol) {
  std::string text;
  for (std::size_t i = 0; i < planned.sources.size(); ++i) {
    const double jnd = planned.precision.participant[i].true_jnd;
    const std::string source = planned.sources[i] == JndSource::published ? "published"
                               : planned.sources[i] == JndSource::asked
                                   ? "as asked"
                                   : fmt::format("assumed: {:.1f} % of the reference, as simulated participants",
                                                 100 * jnd / protocol.stimulus.reference);
    text += fmt::format("{}{} {:g} ({})", text.empty() ? "" : ", ", name_of(protocol, i), jnd, source);
  }
  return text;
}

std::string assumptions(const PlannedPrecision& planned, const Protocol& protocol) {
  const PrecisionQuestion& question = planned.precision.question;
  const CountsDesign& design = question.design;
  std::string text =
      fmt::format("{} trials per cell, {} classes; differences {:g} {}; {} participant{}\n", design.trials,
                  to_string(design.class_sizes), fmt::join(design.differences, ", "), to_string(protocol.stimulus.unit),
                  question.participants, question.participants == 1 ? "" : "s");
  text += fmt::format("true JND: {}\n", sources_of(planned, protocol));
  text += fmt::format("yes-no d' of {} rates, least-squares JND\n", to_string(design.correction));
  text += fmt::format("assumed: {}\n", assumed_of_participants(question));
  const std::string note = precision_note(protocol);
  if (!note.empty()) text += fmt::format("note: {}\n", note);
  return text;
}

}  // namespace

std::string_view to_string(ClassSizes sizes) noexcept {
  constexpr auto kWords = words<ClassSizes>({{"random", ClassSizes::random}, {"balanced", ClassSizes::balanced}});
  return word_of(kWords, sizes);
}

std::string assumed_of_participants(const PrecisionQuestion& question) {
  std::string text =
      "\"different\" is answered with probability Phi((difference - criterion) / JND), without bias (the criterion is half "
      "of the series' difference) and without lapses, each answer independently of the others; ";
  return text + (question.between_cv > 0
                     ? fmt::format("in the group true JNDs spread by {}", of_cv(question.between_cv))
                     : "everyone has the true JND");
}

std::string precision_text(const PlannedPrecision& planned, const Protocol& protocol, TableStyle style) {
  const Precision& precision = planned.precision;
  const PrecisionQuestion& question = precision.question;
  std::string text = assumptions(planned, protocol);
  text += heading(fmt::format("One participant: {}", method_of(precision, protocol)), style);
  text += estimates(planned, protocol, style);
  text +=
      heading(fmt::format("One participant: coefficient of variation (CV), and interval from {} simulated participants",
                          precision.participant.front().interval_draws),
              style);
  text += proposals(precision, protocol, style);
  if (style == TableStyle::markdown) text += '\n';
  text += session_of_proposal(precision, protocol);
  const std::string spread =
      question.between_cv > 0 ? fmt::format(", true JNDs spread by {}", of_cv(question.between_cv)) : "";
  text += heading(fmt::format("Group of {}: {} simulated studies, seed {}{}", question.participants,
                              question.experiments, question.seed, spread),
                  style);
  text += group_table(precision, protocol, style);
  if (precision.contrasts.empty()) return text;
  text += heading("Contrasts of the same studies: share of them whose 95 % interval excludes 0 (power)", style);
  return text + contrast_table(precision, protocol, style);
}

std::string precision_summary(const PlannedPrecision& planned, const Protocol& protocol, const std::string& name) {
  PrecisionTable table({"one participant", fmt::format("true JND {}", to_string(protocol.stimulus.unit)),
                        "estimates, 5 to 95 %", "undefined", "CV",
                        fmt::format("trials per cell for {}", of_cv(planned.precision.question.wanted_cv))});
  for (std::size_t i = 0; i < planned.precision.participant.size(); ++i) {
    const ParticipantPrecision& one = planned.precision.participant[i];
    table.add({name_of(protocol, i),
               amount(one.true_jnd) + (planned.sources[i] == JndSource::published ? " (published)" : " (assumed)"),
               range(one.q05, one.q95), percent(1 - one.status.ok), of_cv(one.cv),
               one.proposed_trials ? std::to_string(*one.proposed_trials) : "none"});
  }
  std::string text = table.text(TableStyle::terminal);
  text += fmt::format("  yes-no d' of {} rates, least-squares JND; \"jnd plan {} --precision\" says more\n",
                      to_string(planned.precision.question.design.correction), printable(name));
  const std::string note = precision_note(protocol);
  if (!note.empty()) text += fmt::format("  note: {}\n", note);
  return text;
}

}  // namespace jnd
