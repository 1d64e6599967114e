// jnd plan --precision: how well a planned design will measure JNDs.
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "data/fields/number_text.h"
#include "protocols/planning/planned_precision.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"
#include "runner/commands/precision_options.h"
#include "runner/opening/study_access.h"
#include "runner/precision/precision_json.h"
#include "runner/precision/precision_text.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/progress_bar.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

std::string four_digits(double value) {
  constexpr double kRounding = 1e-12;  // what is left of a 0
  if (!std::isfinite(value)) return "-";
  return fmt::format("{:.4g}", std::abs(value) < kRounding ? 0 : value);
}

const Series& series_of(const TaskPrecisionRow& row, const Protocol& protocol) {
  return protocol.series[static_cast<std::size_t>(row.series)];
}

std::string assumed_of(const Protocol& protocol) {
  return task_of(protocol.task.kind).unbiased_words(protocol) +
         ", without lapses, each answer independently of the others; everyone has the same noise";
}

// Lines ended by a newline.
std::string task_precision_text(const std::vector<TaskPrecisionRow>& rows, const TaskPrecisionQuestion& question,
                                const Protocol& protocol, TableStyle style) {
  const std::vector<TaskOutcome> outcomes = measured_outcomes(protocol);
  const std::string_view unit = to_string(protocol.stimulus.unit);
  PrecisionTable table({"standard", "noise " + std::string(unit), "trials", "outcome", "median", "95 % of participants",
                        "CV", "undefined"});
  for (const TaskPrecisionRow& row : rows) {
    const TaskOutcome& outcome = outcomes[row.outcome];
    const bool first = row.outcome == 0;
    std::string title(outcome.title);
    if (!outcome.unit.empty()) title += fmt::format(" {}", outcome.unit);
    if (outcome.key == protocol.analysis.outcome) title += " *";
    table.add({first ? series_of(row, protocol).name : "", first ? four_digits(row.noise) : "",
               first ? fmt::format("{:.4g}", row.trials) : "", title, four_digits(row.median),
               range_text(four_digits(row.low), four_digits(row.high)), outcome.positive ? percent_text(row.cv) : "",
               percent_text(row.undefined)});
  }
  return table.text(style) + fmt::format("assumed: {}\n", assumed_of(protocol)) +
         fmt::format(
             "{} participants who feel alike were simulated in one condition; to them two equal intervals differ "
             "with a standard deviation of the noise{}. CV: standard deviation over mean of what is measured of "
             "them. * the registered outcome.\n",
             question.participants,
             question.noise
                 ? ""
                 : fmt::format(
                       ", {:g} % of the standard or, where that is 0, of the middle of the levels (--jnd N or --noise N says otherwise)",
                       100 * kAssumedWeber));
}

nlohmann::ordered_json task_precision_json(const std::vector<TaskPrecisionRow>& rows,
                                           const TaskPrecisionQuestion& question, const Protocol& protocol) {
  const std::vector<TaskOutcome> outcomes = measured_outcomes(protocol);
  nlohmann::ordered_json out = {
      {"protocol_sha256", protocol.sha256}, {"registered", protocol.analysis.outcome},
      {"simulated", question.participants}, {"noise_from", question.noise ? "asked" : "assumed"},
      {"assumed", assumed_of(protocol)},    {"precision", nlohmann::ordered_json::array()}};
  for (const TaskPrecisionRow& row : rows)
    out["precision"].push_back({{"standard", series_of(row, protocol).name},
                                {"noise", row.noise},
                                {"trials", row.trials},
                                {"outcome", outcomes[row.outcome].key},
                                {"unit", outcomes[row.outcome].unit},
                                {"median", json_number(row.median)},
                                {"low", json_number(row.low)},
                                {"high", json_number(row.high)},
                                {"cv", json_number(row.cv)},
                                {"undefined", row.undefined}});
  return out;
}

constexpr int kMostTrials = 2000;  // of a cell, as in a protocol
constexpr double kLargestJnd = 1e6;

double jnd_from(const std::string& text, const std::string& argument) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value > 0 && value <= kLargestJnd))
    throw UsageError(fmt::format("--jnd {}: a JND is a number above 0, such as 208.5, or SV=208.5 for one condition",
                                 printable(argument)));
  return value;
}

// Says how far it is where that takes more than about a second.
Precision precision_with_progress(const PrecisionQuestion& question) {
  constexpr double kMostCellsWithoutWord = 1e6;
  const double cells = static_cast<double>(question.jnds.size() * question.design.differences.size()) *
                       question.participants * question.experiments;
  if (cells <= kMostCellsWithoutWord) return precision(question);
  ProgressBar bar("simulating studies", question.experiments);
  return precision(question, [&bar](int done) { bar.update(done); });
}

}  // namespace

std::vector<PlannedJnd> asked_jnds(const std::vector<std::string>& arguments, const Protocol& protocol) {
  std::vector<PlannedJnd> jnds;
  for (const Condition& condition : protocol.conditions) jnds.push_back(planned_jnd(protocol, condition.name));
  // The value for all first, so that it never overrides one of a condition.
  for (const std::string& argument : arguments) {
    if (argument.find('=') != std::string::npos) continue;
    jnds.assign(jnds.size(), {jnd_from(argument, argument), JndSource::asked});
  }
  for (const std::string& argument : arguments) {
    const std::string::size_type equals = argument.find('=');
    if (equals == std::string::npos) continue;
    std::string known;
    bool found = false;
    for (std::size_t i = 0; i < jnds.size(); ++i) {
      known += (known.empty() ? "" : ", ") + protocol.conditions[i].name;
      if (protocol.conditions[i].name != argument.substr(0, equals)) continue;
      jnds[i] = {jnd_from(argument.substr(equals + 1), argument), JndSource::asked};
      found = true;
    }
    if (!found)
      throw UsageError(
          fmt::format("--jnd {}: the protocol has no such condition; it has {}", printable(argument), known));
  }
  return jnds;
}

void add_precision_options(const Command& plan, PrecisionOptions& options) {
  const CommandOption precision =
      plan.add_flag("--precision", options.asked, "how well this design will measure JNDs, instead of the order");
  plan.add_option("--jnd", options.jnds,
                  "true JND to plan for: a number for all conditions, or NAME=NUMBER for one (default: the published "
                  "values, else the Weber fractions of the simulated participants)");
  plan.add_option("--trials", options.trials, "trials per cell (default: the protocol's); with --power several: 12,24")
      .range(1, kMostTrials)
      .delimiter(',');
  plan.add_option("--participants", options.participants,
                  "participants (default: the protocol's); with --power several: 12,18,24")
      .range(1, 1000)
      .delimiter(',');
  plan.add_option("--between-cv", options.between_cv,
                  "spread of the participants' true JNDs, as a coefficient of variation (default: 0; with --power 0.3)")
      .range(0.0, 2.0);
  plan.add_option("--cv", options.cv, "wanted coefficient of variation of one participant's JND (default: 0.1)")
      .needs(precision)
      .range(0.001, 10.0);
  plan.add_option(
          "--simulated", options.simulated,
          "how many participants are simulated, of tasks other than same-different and of procedures (default: 400)")
      .needs(precision)
      .range(20, 100000);
  plan.add_option(
          "--noise", options.noise,
          "the same of tasks by the standard deviation of a felt difference of two intervals, in the study's unit")
      .needs(precision)
      .range(1e-9, kLargestJnd);
  plan.add_flag("--markdown", options.markdown, "tables in Markdown").needs(precision);
}

namespace {

// Of a task: by simulation.
int plan_task_precision(const Protocol& protocol, const std::string& name, std::uint64_t seed, bool json,
                        const PrecisionOptions& options) {
  if (!options.participants.empty() || options.between_cv.value_or(0) > 0)
    throw UsageError(
        fmt::format("{}: --participants and --between-cv are for same-different with fixed series; --simulated "
                    "says how many participants are simulated here",
                    printable(name)));
  TaskPrecisionQuestion question;
  question.seed = seed;
  question.participants = options.simulated.value_or(question.participants);
  for (const std::string& text : options.jnds) {
    if (text.find('=') != std::string::npos)
      throw UsageError(fmt::format("--jnd {}: one number here, the same for every condition", printable(text)));
    const std::optional<double> of_one = task_of(protocol.task.kind).jnd_of_noise(protocol);
    if (!of_one)
      throw UsageError(
          fmt::format("--jnd {}: the task \"{}\" measures no JND; --noise N is the noise of a felt difference",
                      printable(text), to_string(protocol.task.kind)));
    question.noise = jnd_from(text, text) / *of_one;
  }
  if (options.noise && !options.jnds.empty())
    throw UsageError("--jnd and --noise say the same thing: give one of them");
  if (options.noise) question.noise = options.noise;
  const std::vector<TaskPrecisionRow> rows = [&] {
    ProgressBar bar("simulating participants", question.participants);
    return task_precision(protocol, question, [&bar](int done) { bar.update(done); });
  }();
  if (json) {
    fmt::print("{}\n", json_line(task_precision_json(rows, question, protocol)));
    return exit_code::kDone;
  }
  if (!options.markdown) fmt::print("{}\n", bold(printable(protocol.title)));
  fmt::print("{}", task_precision_text(rows, question, protocol,
                                       options.markdown ? TableStyle::markdown : TableStyle::terminal));
  return exit_code::kDone;
}

}  // namespace

int plan_precision(const std::string& name, std::uint64_t seed, bool json, const PrecisionOptions& options) {
  Protocol protocol = load_checked_protocol(name);
  if (!task_of(protocol.task.kind).has_trials())
    throw UsageError(fmt::format("{}: precision cannot be foretold of free interaction", printable(name)));
  for (const auto* const list : {&options.trials, &options.participants})
    if (list->size() > 1) throw UsageError("several designs at once are for --power: give one number with --precision");
  if (!options.trials.empty()) protocol.design.trials_per_cell = options.trials.front();
  if (!has_precision(protocol)) {
    const int balance = task_of(protocol.task.kind).balance_of(protocol.task);
    if (protocol.design.sampling == Sampling::balanced && protocol.design.trials_per_cell % balance != 0)
      throw UsageError(
          fmt::format("--trials {}: balanced cells need a multiple of {}", protocol.design.trials_per_cell, balance));
    if (!options.trials.empty() && !levels_given(protocol))
      throw UsageError("--trials: a procedure says itself when its tracks end");
    return plan_task_precision(protocol, name, seed, json, options);
  }
  if (options.noise) throw UsageError("--noise is for tasks other than same-different, and for procedures: give --jnd");
  if (options.simulated) throw UsageError("--simulated is for tasks other than same-different, and for procedures");
  if (protocol.design.sampling == Sampling::balanced && protocol.design.trials_per_cell % 4 != 0)
    throw UsageError(fmt::format("--trials {}: balanced cells need a multiple of 4", protocol.design.trials_per_cell));
  if (!options.participants.empty()) protocol.design.participants = options.participants.front();
  PrecisionQuestion question = precision_question(protocol);
  question.between_cv = options.between_cv.value_or(0);
  question.wanted_cv = options.cv;
  question.seed = seed;
  PlannedPrecision planned;
  question.jnds.clear();
  for (const PlannedJnd& jnd : asked_jnds(options.jnds, protocol)) {
    question.jnds.push_back(jnd.value);
    planned.sources.push_back(jnd.source);
  }
  planned.precision = precision_with_progress(question);
  if (json) {
    nlohmann::ordered_json out = {{"protocol_sha256", protocol.sha256}};
    out["precision"] = precision_json(planned, protocol);
    fmt::print("{}\n", json_line(out));
    return exit_code::kDone;
  }
  if (!options.markdown) fmt::print("{}\n", bold(printable(protocol.title)));
  fmt::print("{}", precision_text(planned, protocol, options.markdown ? TableStyle::markdown : TableStyle::terminal));
  return exit_code::kDone;
}

}  // namespace jnd
