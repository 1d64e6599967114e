// "Which is stiffer?", two-interval forced choice: a standard and a comparison, in either order or the standard first.
//
// Its response model: P(comparison chosen) = lapse / 2 + (1 - lapse) F((x - PSE) / s + b o), with o = +1 where the
// comparison came second and -1 where it came first (analysis/choice/two_interval.h).
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "analysis/numerics/normal.h"
#include "protocols/input/json_reader.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/posterior_model.h"
#include "protocols/tasks/task.h"
#include "protocols/tasks/task_estimates.h"

namespace jnd {
namespace {

constexpr int kFirst = 0, kSecond = 1;

// Which interval is to be chosen where the first is greater, or lesser, than the second.
int chosen(bool first_greater, const TaskSpec& spec) noexcept {
  return first_greater == spec.greater ? kFirst : kSecond;
}

// Where the comparison was.
int comparison_place(const AnsweredTrial& trial) noexcept {
  const bool standard_first = trial.standard_place < 0 ? trial.stimuli[0] == trial.standard : trial.standard_place == 0;
  return standard_first ? kSecond : kFirst;
}

// Asked for the lesser, who does not choose the comparison says that it has more.
bool comparison_has_more(const AnsweredTrial& trial, const TaskSpec& spec) noexcept {
  return (trial.said == comparison_place(trial)) == spec.greater;
}

// By level and order: 1 where the comparison came second, -1 where it came first.
std::vector<ChoiceRow> choice_rows(std::span<const AnsweredTrial> trials, const TaskSpec& spec) {
  std::map<std::pair<double, int>, ChoiceRow> rows;
  for (const AnsweredTrial& trial : trials) {
    const int place = comparison_place(trial), order = place == kSecond ? 1 : -1;
    const double level = trial.stimuli[static_cast<std::size_t>(place)];
    ChoiceRow& row = rows[{level, order}];
    row.level = level;
    row.order = order;
    ++row.n;
    row.chosen += comparison_has_more(trial, spec) ? 1 : 0;
  }
  std::vector<ChoiceRow> all;
  for (const auto& [key, row] : rows) all.push_back(row);
  return all;
}

// Whether comparisons lie on both sides of the standard, or at it: on one side alone they do not tell the PSE from s.
bool on_both_sides(const Protocol& protocol, const Series& series) {
  const std::vector<int> sides = sides_of_comparisons(protocol, series);
  return sides.size() != 1 || sides.front() == 0;
}

bool measures_pse(const Protocol& protocol, const Series& series) {
  return on_both_sides(protocol, series) || has_posterior_threshold(protocol);  // whose prior does
}

bool measures_any_pse(const Protocol& protocol) {
  const auto measures = [&](const Series& series) { return measures_pse(protocol, series); };
  return protocol.series.empty() || std::any_of(protocol.series.begin(), protocol.series.end(), measures);
}

TwoIntervalOptions options_of(const Protocol& protocol, const Series& series, std::span<const ChoiceRow> rows) {
  TwoIntervalOptions options;
  if (!measures_pse(protocol, series)) options.pse = series.standard;
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
  const double half_width = kNormal975 * of.estimate.sd_shift;
  const double weight = std::pow(of.estimate.sd_shift / of.prior.sd_shift, 2);
  const bool ok = of.threshold.status == AdaptiveStatus::ok;
  const auto shift = [&](double from) {
    return ok ? TaskEstimate{from + bias, from + bias - half_width, from + bias + half_width, weight} : TaskEstimate{};
  };
  estimates.status = to_string(of.threshold.status);
  estimates.values[0] = posterior_estimate(of.threshold, factor);
  estimates.values[1] = standard != 0 ? posterior_estimate(of.threshold, factor / standard) : TaskEstimate{};
  estimates.values[2] = shift(standard);
  estimates.values[3] = shift(0);
}

class WhichTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::which; }
  std::string_view summary() const noexcept override { return "two intervals: which has more of the quantity?"; }
  TaskStart start() const override {
    return {.asks = "Which was stiffer, the first or the second?",
            .asks_of_other = "Which had more {}, the first or the second?",
            .keys = R"({"first": "1", "second": "2"})",
            .levels = {0.5, 0.7, 0.85, 1.15, 1.3, 1.5},
            .trials_per_cell = 12,
            .analysis = R"({"outcome": "jnd"})"};
  }
  void read(JsonReader& section, TaskSpec& spec) const override {
    spec.greater = section.one_of_or<bool>("chosen", {{"greater", true}, {"lesser", false}}, true);
    spec.standard_first = section.one_of_or<bool>("standard", {{"first", true}, {"either", false}}, false);
    const bool places = section.one_of_or<bool>("presentation", {{"sequential", false}, {"side-by-side", true}}, false);
    spec.sureness_levels = section.integer_or("sureness", 0, {.min = 0, .max = 4});
    spec.together = places;
    spec.classes = places ? std::vector<std::string>{"left", "right"} : std::vector<std::string>{"first", "second"};
  }
  std::vector<TaskProblem> problems(const Protocol& protocol) const override { return problems_of_places(protocol); }
  bool level_may_be_standard() const noexcept override { return true; }
  bool has_procedures() const noexcept override { return true; }
  std::optional<PosteriorTask> posterior_task() const noexcept override { return PosteriorTask::which; }
  std::optional<AnswerModel> answer_model(const Protocol& protocol) const override {
    AnswerModel model{.response = ResponseModel::choice, .jnd_of_s = jnd_of_noise(protocol).value()};
    if (!protocol.analysis.lapse_free) model.lapse = protocol.analysis.lapse;
    model.pse_at_standard = std::none_of(protocol.series.begin(), protocol.series.end(),
                                         [&](const Series& series) { return on_both_sides(protocol, series); });
    return model;
  }
  LevelAnswer level_answer(const AnsweredTrial& trial, const TaskSpec& spec) const override {
    return {plain_sum(trial.stimuli[static_cast<std::size_t>(comparison_place(trial))], -trial.standard),
            comparison_has_more(trial, spec)};
  }
  int balance_of(const TaskSpec& spec) const noexcept override { return spec.standard_first ? 1 : 2; }
  int intervals(const TaskSpec&) const noexcept override { return 2; }
  std::vector<DrawnTrial> arrangements(const CellDraw& cell, double comparison, int side) const override {
    const TaskSpec& spec = cell.protocol.task;
    std::vector<DrawnTrial> orders;
    for (const Intervals& stimuli : orders_of(cell.series.standard, comparison, spec.standard_first)) {
      const bool comparison_first = !orders.empty();
      if (side == 0)  // what is correct is known once the comparison is
        orders.push_back({.stimuli = stimuli, .standard_place = comparison_first ? 1 : 0});
      else
        orders.push_back({.stimuli = stimuli, .target = chosen(comparison_first == (side > 0), spec)});
    }
    return orders;
  }
  int target_of(const Intervals& stimuli, double, const TaskSpec& spec) const noexcept override {
    return stimuli[0] == stimuli[1] ? -1 : chosen(stimuli[0] > stimuli[1], spec);
  }
  Answer answer(std::span<const Felt> felt, const Trial&, const Protocol& protocol, RandomStream&) const override {
    const double difference = felt[0].value - felt[1].value;
    Answer answer;
    answer.said = chosen(difference > 0, protocol.task);
    answer.sureness = sureness_of(std::abs(difference), felt[0].sigma, protocol.task);
    return answer;
  }
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override {
    const std::string unit(to_string(protocol.stimulus.unit));
    const std::string& convention = protocol.analysis.jnd_convention;
    const std::string_view title = convention == "75 %"   ? "JND (75 %)"
                                   : convention == "84 %" ? "JND (84 %)"
                                                          : "JND (d' = 1)";
    std::vector<TaskOutcome> outcomes = {
        {"jnd", title, unit,
         fmt::format("just-noticeable difference, {}", protocol.analysis.jnd_convention == "d'=1"
                                                           ? std::string("d' = 1 of the two-interval task")
                                                           : protocol.analysis.jnd_convention + " chosen"),
         true},
        {"weber", "Weber fraction", "", "jnd / standard", true, true}};
    if (measures_any_pse(protocol))
      outcomes.insert(outcomes.end(),
                      {{"pse", "PSE", unit, "point of subjective equality: chosen half of the time", false},
                       {"bias", "bias", unit, "PSE less the standard", false}});
    if (!protocol.task.standard_first)
      outcomes.push_back({"order", "order effect", "",
                          "b of the model: above 0 the second interval is favoured; in units of s", false});
    outcomes.push_back(share_of_correct());
    return outcomes;
  }
  TaskEstimates estimate(const Protocol& protocol, const Series& series,
                         std::span<const AnsweredTrial> trials) const override {
    const std::vector<ChoiceRow> rows = choice_rows(trials, protocol.task);
    const TwoIntervalOptions options = options_of(protocol, series, rows);
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
    // Levels told apart without an error, or not at all, bound the JND on one side only.
    const std::optional<double> jnd =
        fit.status == TwoIntervalStatus::ok ? std::optional(*fit.s * factor) : std::nullopt;
    estimates.values = {task_estimate(jnd, scaled(intervals.s, factor)),
                        standard != 0 ? task_estimate(jnd ? std::optional(*jnd / standard) : std::nullopt,
                                                      scaled(intervals.s, factor / standard))
                                      : TaskEstimate{}};
    if (measures_any_pse(protocol)) {
      const std::optional<double> pse = options.pse ? std::nullopt : fit.pse;
      const std::optional<ChoiceBounds> bounds = options.pse ? std::nullopt : intervals.pse;
      estimates.values.push_back(task_estimate(pse, bounds));
      estimates.values.push_back(
          task_estimate(pse ? std::optional(*pse - standard) : std::nullopt, moved(bounds, -standard)));
    }
    if (!protocol.task.standard_first) estimates.values.push_back(task_estimate(fit.order_b, intervals.order_b));
    estimates.values.push_back(share_correct(trials));
    if (has_posterior_threshold(protocol)) set_by_posterior(estimates, protocol, series, trials);
    return estimates;
  }
  std::optional<TaskCurve> curve(const Protocol& protocol, const Series& series,
                                 std::span<const AnsweredTrial> trials) const override {
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
    TwoIntervalOptions options = options_of(protocol, series, rows);
    options.order_term = false;  // both orders together
    const TwoIntervalFit fit = fit_two_interval(rows, options);
    if (fit.status != TwoIntervalStatus::ok || curve.points.size() < 2) return curve;
    const double lapse = fit.lapse.value_or(0);
    curve.x = evenly(curve.points.front().x, curve.points.back().x, 60);
    for (const double x : curve.x)
      curve.fitted.push_back(lapse / 2 + (1 - lapse) * normal_cdf((x - *fit.pse) / *fit.s));
    return curve;
  }
  std::string arrangement(const Protocol& protocol) const override {
    const TaskSpec& spec = protocol.task;
    if (spec.standard_first)
      return spec.together ? "The standard was always on the left. " : "The standard always came first. ";
    return spec.together ? fmt::format("The two were felt side by side, the standard on the left and on the right {}. ",
                                       how_often(protocol))
                         : fmt::format("The standard came first and second {}. ", how_often(protocol));
  }
  std::optional<double> jnd_of_noise(const Protocol& protocol) const override {
    return jnd_of(choice_jnds(ChoiceLink::probit, 1), protocol.analysis.jnd_convention);
  }
  std::string methods(const Protocol& protocol) const override {
    const AnalysisPlan& plan = protocol.analysis;
    const std::string_view jnd =
        plan.jnd_convention == "84 %"   ? "s, the difference from the PSE at which 84 % choose the comparison"
        : plan.jnd_convention == "75 %" ? "0.6745 s, the difference from the PSE at which 75 % choose the comparison"
                                        : "s / sqrt 2, d' = 1 of the two-interval task";
    const auto one_sided = std::count_if(protocol.series.begin(), protocol.series.end(),
                                         [&](const Series& series) { return !measures_pse(protocol, series); });
    const std::string_view pse = one_sided == 0 ? ""
                                 : static_cast<std::size_t>(one_sided) == protocol.series.size()
                                     ? " and the PSE fixed at the standard, on one side of which all comparisons lay"
                                     : " and the PSE fixed at the standard where all comparisons lay on one side of it";
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
        "Of each participant, condition and standard P(comparison chosen) = l/2 + (1 - l) Phi((x - PSE)/s{} was fitted by "
        "maximum likelihood, with the lapse rate l {}{}. The JND is {}; the Weber fraction is JND / standard. Intervals are "
        "profile likelihood, 95 %. There is no JND, and an interval that is open on one side, where the status is separated "
        "(the levels are told apart without an error) or flat (the best slope is not positive), and none of either where it "
        "is not_identified (one level) or all_same (one answer throughout).",
        protocol.task.standard_first ? ")"
                                     : " + b o), o = 1 where the comparison came second and -1 where it came first,",
        plan.lapse_free ? "free from 0 to 0.1" : fmt::format("fixed at {:g}", plan.lapse), pse, jnd);
  }
};

}  // namespace

const Task& which_task() noexcept {
  static const WhichTask task;
  return task;
}

}  // namespace jnd
