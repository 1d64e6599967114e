#include "protocols/tasks/which_task.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "analysis/numerics/normal.h"
#include "protocols/input/json_reader.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/posterior_model.h"
#include "protocols/tasks/task_estimates.h"

namespace jnd {
namespace {

constexpr int kFirst = 0, kSecond = 1;
constexpr double kPosteriorSds = 1.959963984540054;  // on either side of a posterior mean: 95 % of a Gaussian

// Which interval is to be chosen where the first is greater, or lesser, than the second.
int chosen(bool first_greater, const TaskSpec& spec) noexcept {
  return first_greater == spec.greater ? kFirst : kSecond;
}

}  // namespace

void WhichTask::read(JsonReader& section, TaskSpec& spec) const {
  spec.greater = section.one_of_or<bool>("chosen", {{"greater", true}, {"lesser", false}}, true);
  spec.standard_first = section.one_of_or<bool>("standard", {{"first", true}, {"either", false}}, false);
  const bool places = section.one_of_or<bool>("presentation", {{"sequential", false}, {"side-by-side", true}}, false);
  spec.sureness_levels = section.integer_or("sureness", 0, {.min = 0, .max = 4});
  spec.together = places;
  spec.classes = places ? std::vector<std::string>{"left", "right"} : std::vector<std::string>{"first", "second"};
}

std::vector<TaskProblem> WhichTask::problems(const Protocol& protocol) const {
  return problems_of_places(protocol);
}

std::vector<DrawnTrial> WhichTask::draw(const CellDraw& cell, RandomStream& stream) const {
  const TaskSpec& spec = cell.protocol.task;
  std::vector<DrawnTrial> trials;
  for (const double level : cell.series.levels) {
    std::vector<DrawnTrial> orders;
    for (const Intervals& stimuli : orders_of(cell.series.standard, level, spec.standard_first))
      orders.push_back({stimuli, target_of(stimuli, cell.series.standard, spec)});
    add_level(trials, std::move(orders), cell.trials, cell.sampling, stream);
  }
  stream.shuffle(trials);
  return trials;
}

// In blocks of every order on every side, so that the share of each holds everywhere in a session.
std::vector<DrawnTrial> WhichTask::draw_track(const CellDraw& track, RandomStream& stream) const {
  const TaskSpec& spec = track.protocol.task;
  const AdaptiveProcedure& procedure = *track.protocol.design.procedure;
  const double comparison = set_by_answers(track.series.standard);
  std::vector<DrawnTrial> block;
  for (const int side : procedure.sides) {
    for (const Intervals& stimuli : orders_of(track.series.standard, comparison, spec.standard_first)) {
      const bool comparison_first = stimuli[0] == comparison;
      block.push_back({stimuli, chosen(comparison_first == (side > 0), spec), side});
    }
  }
  std::vector<DrawnTrial> trials;
  while (static_cast<int>(trials.size()) < track.trials) {
    std::vector<DrawnTrial> part;
    for (int twice = 0; twice < 2; ++twice) part.insert(part.end(), block.begin(), block.end());
    stream.shuffle(part);
    trials.insert(trials.end(), part.begin(), part.end());
  }
  trials.resize(static_cast<std::size_t>(track.trials));
  return trials;
}

int WhichTask::target_of(const Intervals& stimuli, double, const TaskSpec& spec) const noexcept {
  return stimuli[0] == stimuli[1] ? -1 : chosen(stimuli[0] > stimuli[1], spec);
}

Answer WhichTask::answer(std::span<const Felt> felt, const Trial&, const Protocol& protocol, RandomStream&) const {
  const double difference = felt[0].value - felt[1].value;
  Answer answer;
  answer.said = chosen(difference > 0, protocol.task);
  answer.sureness = sureness_of(std::abs(difference), felt[0].sigma, protocol.task);
  return answer;
}

namespace {

// By level and order: 1 where the comparison came second, -1 where it came first.
std::vector<ChoiceRow> choice_rows(std::span<const AnsweredTrial> trials, const TaskSpec& spec) {
  std::map<std::pair<double, int>, ChoiceRow> rows;
  for (const AnsweredTrial& trial : trials) {
    const int order = trial.stimuli[0] == trial.standard ? 1 : -1;
    const double level = trial.stimuli[order > 0 ? 1 : 0];
    ChoiceRow& row = rows[{level, order}];
    row.level = level;
    row.order = order;
    ++row.n;
    // Asked for the lesser, who does not choose the comparison says that it has more.
    const bool comparison = trial.said == (order > 0 ? kSecond : kFirst);
    row.chosen += comparison == spec.greater ? 1 : 0;
  }
  std::vector<ChoiceRow> all;
  for (const auto& [key, row] : rows) all.push_back(row);
  return all;
}

TwoIntervalOptions options_of(const Protocol& protocol, std::span<const ChoiceRow> rows) {
  TwoIntervalOptions options;
  options.lapse = protocol.analysis.lapse_free ? std::nullopt : std::optional(protocol.analysis.lapse);
  const auto first = [](const ChoiceRow& row) { return row.order < 0; };
  options.order_term = std::any_of(rows.begin(), rows.end(), first) && !std::all_of(rows.begin(), rows.end(), first);
  return options;
}

double jnd_of(const ChoiceJnds& jnds, const std::string& convention) {
  return convention == "84 %" ? jnds.jnd_84 : convention == "d'=1" ? jnds.jnd_dprime1 : jnds.jnd_75;
}

// By the posterior of all answers: JND and PSE with the middle 95 % of it, of the PSE by 1.96 standard deviations.
void set_by_posterior(TaskEstimates& estimates, const Protocol& protocol, const Series& series,
                      std::span<const AnsweredTrial> trials) {
  const PosteriorOfAnswers of = posterior_of_trials(protocol, series, trials);
  const double factor = jnd_of(choice_jnds(TwoIntervalOptions().link, 1), protocol.analysis.jnd_convention);
  const double standard = series.standard, bias = of.estimate.mean_shift;
  const double half_width = kPosteriorSds * of.estimate.sd_shift;
  const bool ok = of.threshold.status == AdaptiveStatus::ok;
  const auto shift = [&](double from) {
    return ok ? TaskEstimate{from + bias, from + bias - half_width, from + bias + half_width} : TaskEstimate{};
  };
  estimates.status = to_string(of.threshold.status);
  estimates.values[0] = posterior_estimate(of.threshold, factor);
  estimates.values[1] = standard != 0 ? posterior_estimate(of.threshold, factor / standard) : TaskEstimate{};
  estimates.values[2] = shift(standard);
  estimates.values[3] = shift(0);
}

}  // namespace

std::vector<TaskOutcome> WhichTask::outcomes(const Protocol& protocol) const {
  const std::string_view unit = to_string(protocol.stimulus.unit);
  return {{"jnd", "JND", unit,
           fmt::format("just-noticeable difference, {}", protocol.analysis.jnd_convention == "d'=1"
                                                             ? std::string("d' = 1 of the two-interval task")
                                                             : protocol.analysis.jnd_convention + " chosen"),
           4, true},
          {"weber", "Weber fraction", "", "jnd / standard", 3, true},
          {"pse", "PSE", unit, "point of subjective equality: chosen half of the time", 4, false},
          {"bias", "bias", unit, "PSE less the standard", 4, false},
          {"order", "order effect", "", "b of the model: above 0 the second interval is favoured; in units of s", 3,
           false}};
}

TaskEstimates WhichTask::estimate(const Protocol& protocol, const Series& series,
                                  std::span<const AnsweredTrial> trials) const {
  const std::vector<ChoiceRow> rows = choice_rows(trials, protocol.task);
  const TwoIntervalOptions options = options_of(protocol, rows);
  const TwoIntervalFit fit = fit_two_interval(rows, options);
  const TwoIntervalIntervals intervals = two_interval_intervals(rows, options);
  const double factor = jnd_of(choice_jnds(options.link, 1), protocol.analysis.jnd_convention);
  const auto scaled = [](std::optional<ChoiceBounds> bounds, double by) {
    if (bounds) bounds = ChoiceBounds{bounds->low * by, bounds->high * by};
    return bounds;
  };
  const auto moved = [](std::optional<ChoiceBounds> bounds, double by) {
    if (bounds) bounds = ChoiceBounds{bounds->low + by, bounds->high + by};
    return bounds;
  };
  const double standard = series.standard;
  TaskEstimates estimates;
  estimates.status = word_of(kTwoIntervalStatusWords, fit.status);
  const std::optional<double> jnd = fit.s ? std::optional(*fit.s * factor) : std::nullopt;
  const std::optional<double> bias = fit.pse ? std::optional(*fit.pse - standard) : std::nullopt;
  estimates.values = {
      task_estimate(jnd, scaled(intervals.s, factor)),
      standard != 0 && jnd ? task_estimate(*jnd / standard, scaled(intervals.s, factor / standard)) : TaskEstimate{},
      task_estimate(fit.pse, intervals.pse), task_estimate(bias, moved(intervals.pse, -standard)),
      task_estimate(fit.order_b, intervals.order_b)};
  if (has_posterior_threshold(protocol)) set_by_posterior(estimates, protocol, series, trials);
  return estimates;
}

std::optional<TaskCurve> WhichTask::curve(const Protocol& protocol, const Series&,
                                          std::span<const AnsweredTrial> trials) const {
  const std::vector<ChoiceRow> rows = choice_rows(trials, protocol.task);
  std::map<double, TaskCurve::Point> points;
  for (const ChoiceRow& row : rows) {
    TaskCurve::Point& point = points[row.level];
    point.x = row.level;
    point.n += static_cast<int>(row.n);
    point.said += static_cast<int>(row.chosen);
  }
  TaskCurve curve;
  curve.said = "the comparison has more";
  for (const auto& [level, point] : points) curve.points.push_back(point);
  TwoIntervalOptions options = options_of(protocol, rows);
  options.order_term = false;  // both orders together
  const TwoIntervalFit fit = fit_two_interval(rows, options);
  if (fit.status != TwoIntervalStatus::ok || curve.points.size() < 2) return curve;
  const double lapse = fit.lapse.value_or(0);
  curve.x = evenly(curve.points.front().x, curve.points.back().x, 60);
  for (const double x : curve.x) curve.fitted.push_back(lapse / 2 + (1 - lapse) * normal_cdf((x - *fit.pse) / *fit.s));
  return curve;
}

std::string WhichTask::methods(const Protocol& protocol) const {
  const AnalysisPlan& plan = protocol.analysis;
  const std::string_view jnd =
      plan.jnd_convention == "84 %"   ? "s, the difference from the PSE at which 84 % choose the comparison"
      : plan.jnd_convention == "75 %" ? "0.6745 s, the difference from the PSE at which 75 % choose the comparison"
                                      : "s / sqrt 2, d' = 1 of the two-interval task";
  if (has_posterior_threshold(protocol))
    return fmt::format(
        "Of each participant, condition and standard JND and PSE are those of the posterior of the procedure's own response "
        "model given all answers: s is exp of the posterior mean of ln s, the PSE the standard plus the posterior mean of "
        "a. The JND is {}; the Weber fraction is JND / standard. The interval of the JND is the middle 95 % of the "
        "posterior, that of the PSE 1.96 of its standard deviations on either side; the order effect is b of "
        "P(comparison chosen) = Phi((x - PSE)/s + b o) by maximum likelihood. Status: too_few_answers, the answers say less "
        "than the prior; pinned_at_grid, no s is likelier than one at an end of the grid: then there is neither JND nor "
        "PSE.",
        jnd);
  return fmt::format(
      "Of each participant, condition and standard P(comparison chosen) = l/2 + (1 - l) Phi((x - PSE)/s{}) was fitted by "
      "maximum likelihood, with the lapse rate l {}. The JND is {}; the Weber fraction is JND / standard. Intervals are "
      "profile likelihood, 95 %. Status: separated, the levels are told apart without an error (JND 0); flat, the best "
      "slope is not positive (JND infinite); all_same, one answer throughout.",
      protocol.task.standard_first ? "" : " + b o), o = 1 where the comparison came second and -1 where it came first",
      plan.lapse_free ? "free from 0 to 0.1" : fmt::format("fixed at {:g}", plan.lapse), jnd);
}

}  // namespace jnd
