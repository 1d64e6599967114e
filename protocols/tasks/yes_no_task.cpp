// "Was it there?", one interval: a signal, which is one of the levels, or noise, which is the standard. Answered with yes or
// no, or on a scale of sureness. Trials of noise are its catch trials.
//
// Its response model is that of signal detection: "yes" where what was felt exceeds a criterion; d' is the distance of
// signal and noise in units of the noise's standard deviation (analysis/detection, analysis/ratings).
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "analysis/detection/yes_no.h"
#include "analysis/numerics/decimal_order.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/ratings/rating_roc.h"
#include "protocols/input/json_reader.h"
#include "protocols/tasks/arrangements.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/posterior_model.h"
#include "protocols/tasks/task.h"
#include "protocols/tasks/task_estimates.h"

namespace jnd {
namespace {

constexpr int kNo = 0, kYes = 1;

int noises_of(int signals, const TaskSpec& spec) {
  return static_cast<int>(std::lround(signals * (1 - spec.signal_share) / spec.signal_share));
}

LevelAnswer read_yes(const AnsweredTrial& trial) noexcept {
  return {plain_distance(trial.stimuli[0], trial.standard), trial.said == kYes};
}

// "Yes" by the distance from the noise; 0 is the noise itself.
std::vector<ChoiceRow> yes_rows(std::span<const AnsweredTrial> trials) {
  std::map<double, ChoiceRow> rows;
  for (const AnsweredTrial& trial : trials) {
    const auto [distance, yes] = read_yes(trial);
    ChoiceRow& row = rows[distance];
    row.level = distance;
    ++row.n;
    row.chosen += yes ? 1 : 0;
  }
  std::vector<ChoiceRow> all;
  for (const auto& [distance, row] : rows) all.push_back(row);
  return all;
}

Counts counts_of(std::span<const AnsweredTrial> trials) {
  Counts counts;
  for (const AnsweredTrial& trial : trials) {
    const bool yes = trial.said == kYes;
    ++(trial.target == kYes ? counts.n_diff : counts.n_same);
    if (yes) ++(trial.target == kYes ? counts.hits : counts.false_alarms);
  }
  return counts;
}

// Ratings from the surest "no" to the surest "yes".
RatingRoc roc_of(std::span<const AnsweredTrial> trials, int levels) {
  std::vector<int> noise(static_cast<std::size_t>(2 * levels)), signal = noise;
  for (const AnsweredTrial& trial : trials) {
    const int sureness = std::clamp(trial.sureness, 1, levels);
    const int category = trial.said == kYes ? levels + sureness - 1 : levels - sureness;
    ++(trial.target == kYes ? signal : noise)[static_cast<std::size_t>(category)];
  }
  return rating_roc(noise, signal);
}

// Whether the noise has a size of its own, of which a threshold may be a share.
bool has_weber_fraction(const Protocol& protocol) {
  return protocol.series.empty() || std::any_of(protocol.series.begin(), protocol.series.end(),
                                                [](const Series& series) { return series.standard > 0; });
}

class YesNoTask final : public Task {
 public:
  TaskKind kind() const noexcept override { return TaskKind::yes_no; }
  std::string_view summary() const noexcept override { return "one interval: was the signal there?"; }
  TaskStart start() const override {
    return {.asks = "Was it the stiffer one?",
            .asks_of_other = "Was it the one with more {}?",
            .keys = R"({"no": "n", "yes": "y"})",
            .levels = {1.3},
            .trials_per_cell = 60,
            .analysis = R"({"outcome": "threshold"})"};
  }
  void read(JsonReader& section, TaskSpec& spec) const override {
    spec.signal_share = section.number_or("signal_share", 0.5, {.min = 0.05, .max = 0.95});
    spec.sureness_levels = section.integer_or("sureness", 0, {.min = 0, .max = 4});
    spec.classes = {"no", "yes"};
  }
  bool has_procedures() const noexcept override { return true; }
  std::optional<PosteriorTask> posterior_task() const noexcept override { return PosteriorTask::same_different; }
  std::optional<AnswerModel> answer_model(const Protocol&) const override { return AnswerModel{.jnd = "threshold"}; }
  LevelAnswer level_answer(const AnsweredTrial& trial, const TaskSpec&) const override { return read_yes(trial); }
  bool has_catch_trials() const noexcept override { return true; }
  std::vector<TaskProblem> problems(const Protocol& protocol) const override {
    for (const Series& series : protocol.series) {
      const auto above = std::count_if(series.levels.begin(), series.levels.end(),
                                       [&](double level) { return level > series.standard; });
      if (above != 0 && static_cast<std::size_t>(above) != series.levels.size())
        return {
            {"$.levels", fmt::format("signals lie on both sides of the noise, {:g}", series.standard),
             "a signal is more, or less, than the noise: give levels on one side, and the others a protocol of their own"}};
    }
    return {};
  }
  int trials_of_levels(const Protocol& protocol, const Series& series) const override {
    const int signals = protocol.design.trials_per_cell * static_cast<int>(series.levels.size());
    return signals + noises_of(signals, protocol.task);
  }
  int intervals(const TaskSpec&) const noexcept override { return 1; }
  std::vector<DrawnTrial> draw(const CellDraw& cell, RandomStream& stream) const override {
    const int signals = cell.trials * static_cast<int>(cell.series.levels.size());
    const int noises = noises_of(signals, cell.protocol.task);
    std::vector<DrawnTrial> trials(static_cast<std::size_t>(noises), {{cell.series.standard}, kNo});
    for (const double level : cell.series.levels)
      trials.insert(trials.end(), static_cast<std::size_t>(cell.trials), {{level}, kYes});
    stream.shuffle(trials);
    return trials;
  }
  std::vector<DrawnTrial> draw_track(const CellDraw& track, const AdaptiveProcedure& procedure,
                                     RandomStream& stream) const override {
    const CatchBlock block = catch_block_of(procedure).value();
    const int side = procedure.sides.front();
    const double comparison = set_by_answers(track.series.standard);
    std::vector<DrawnTrial> trials;
    for (int signals = 0; signals < track.trials;) {
      const int now = std::min(block.trials - block.catches, track.trials - signals);
      std::vector<DrawnTrial> part(static_cast<std::size_t>(now), {{comparison}, kYes, side});
      part.insert(part.end(), static_cast<std::size_t>(slots_of_track(block, now) - now),
                  {{track.series.standard}, kNo});
      stream.shuffle(part);
      trials.insert(trials.end(), part.begin(), part.end());
      signals += now;
    }
    return trials;
  }
  int target_of(const Intervals& stimuli, double standard, const TaskSpec&) const noexcept override {
    return stimuli[0] == standard ? kNo : kYes;
  }
  // The criterion is half way between noise and the signal that the participant expects: the middle of the levels. Where a
  // procedure sets them, that signal is 20 % away from the noise, or two sigma away from a noise of 0.
  Answer answer(std::span<const Felt> felt, const Trial& trial, const Protocol& protocol,
                RandomStream&) const override {
    double away = trial.standard != 0 ? 0.2 * std::abs(trial.standard) : 2 * felt[0].sigma;
    const Series& series = protocol.series[static_cast<std::size_t>(trial.series)];
    int side = sides_of_comparisons(protocol, series).front();  // of the noise, on which signals lie
    if (const std::vector<double>& levels = series.levels; !levels.empty()) {
      const double mean = std::accumulate(levels.begin(), levels.end(), 0.0) / static_cast<double>(levels.size());
      side = mean > trial.standard ? 1 : -1;
      away = std::abs(mean - trial.standard);
    }
    const double beyond = side * (felt[0].value - trial.standard) - 0.5 * away;
    Answer answer;
    answer.said = beyond > 0 ? kYes : kNo;
    answer.sureness = sureness_of(std::abs(beyond), felt[0].sigma, protocol.task);
    return answer;
  }
  std::vector<TaskOutcome> outcomes(const Protocol& protocol) const override {
    const std::string unit(to_string(protocol.stimulus.unit));
    std::vector<TaskOutcome> outcomes = {
        {"dprime", "d'", "", "z(H) - z(F) on log-linear rates, all signals together", false},
        {"criterion", "criterion c", "", "c = -(z(H) + z(F)) / 2; above 0: tends to say no", false},
        {"threshold", "threshold", unit, "distance of the signal from the noise at d' = 1, maximum likelihood", true},
        share_of_correct()};
    if (has_weber_fraction(protocol))
      outcomes.push_back({"weber", "Weber fraction", "", "threshold / standard", true, true});
    if (protocol.task.sureness_levels > 0) {
      outcomes.push_back({"d_a", "d_a", "", "d_a of the ratings, unequal variances", false});
      outcomes.push_back(
          {"area", "A_z", "", "area under the ROC of the ratings, unequal variances", true, false, false, true});
    }
    return outcomes;
  }
  TaskEstimates estimate(const Protocol& protocol, const Series& series,
                         std::span<const AnsweredTrial> trials) const override {
    const YesNo rates = yes_no(counts_of(trials), Correction::loglinear);
    const std::vector<ChoiceRow> rows = yes_rows(trials);
    const TwoIntervalFit fit = fit_two_interval(rows);
    const TwoIntervalIntervals intervals = two_interval_intervals(rows);
    TaskEstimates estimates;
    const bool ok = fit.status == TwoIntervalStatus::ok;
    std::string_view status = word_of(kTwoIntervalStatusWords, fit.status);
    TaskEstimate threshold = task_estimate(ok ? fit.s : std::nullopt, intervals.s);
    if (has_posterior_threshold(protocol)) {
      const AdaptiveThreshold of_posterior = posterior_of_trials(protocol, series, trials).threshold;
      status = to_string(of_posterior.status);
      threshold = posterior_estimate(of_posterior);
    }
    estimates.status = rates.status == RateStatus::ok ? status : to_string(rates.status);
    estimates.values = {task_estimate(rates.dprime, ChoiceBounds{rates.ci_low, rates.ci_high}),
                        task_estimate(rates.criterion), threshold, share_correct(trials)};
    if (has_weber_fraction(protocol))
      estimates.values.push_back(series.standard > 0 ? scaled(threshold, 1 / series.standard) : TaskEstimate{});
    if (protocol.task.sureness_levels > 0) {
      const RatingRoc roc = roc_of(trials, protocol.task.sureness_levels);
      const auto with_error = [](const RatingEstimate& one, double least, double most) {
        const double half_width = kNormal975 * one.se;
        return task_estimate(
            one.value, ChoiceBounds{std::max(one.value - half_width, least), std::min(one.value + half_width, most)});
      };
      const bool fitted = roc.unequal.status == RatingStatus::ok;
      if (!fitted && rates.status == RateStatus::ok) estimates.status = to_string(roc.unequal.status);
      estimates.values.push_back(fitted ? with_error(roc.unequal.d_a, -kInf, kInf) : TaskEstimate{});
      estimates.values.push_back(fitted ? with_error(roc.unequal.area, 0, 1) : TaskEstimate{});
    }
    return estimates;
  }
  std::optional<TaskCurve> curve(const Protocol&, const Series&, std::span<const AnsweredTrial> trials) const override {
    const std::vector<ChoiceRow> rows = yes_rows(trials);
    TaskCurve curve;
    curve.said = "yes";
    for (const ChoiceRow& row : rows)
      curve.points.push_back({row.level, static_cast<int>(row.n), static_cast<int>(row.chosen)});
    const TwoIntervalFit fit = fit_two_interval(rows);
    if (fit.status != TwoIntervalStatus::ok || rows.size() < 2) return curve;
    curve.x = evenly(0, rows.back().level, 60);
    for (const double x : curve.x) curve.fitted.push_back(normal_cdf((x - *fit.pse) / *fit.s));
    return curve;
  }
  // At d' = 1, which is of one interval's noise.
  std::optional<double> jnd_of_noise(const Protocol&) const override { return 1 / std::sqrt(2.0); }
  std::string methods(const Protocol& protocol) const override {
    std::string text =
        "d' = z(H) - z(F) and the criterion c are of all signals together, on rates corrected log-linearly, "
        "(k + 0.5) / (n + 1) (Hautus 1995), with the interval of Gourevitch and Galanter 1967. ";
    text +=
        has_posterior_threshold(protocol)
            ? "The threshold is s of the procedure's own response model, the distance at d' = 1: exp of the posterior "
              "mean of ln s given all answers, with the middle 95 % of the posterior; there is none while the answers "
              "say less than the prior, nor where the posterior is highest at an end of the grid. "
            : "The threshold is sigma of P(yes) = Phi(distance / sigma - k), fitted by maximum likelihood to noise and "
              "signals together: the distance at d' = 1; its interval is profile likelihood, 95 %. There is no threshold, and "
              "an interval that is open on one side, where the status is separated (noise and signals are told apart without "
              "an error) or flat (they are not told apart). ";
    text += "Status: no_information, one answer throughout; missing, no noise or no signal.";
    if (protocol.task.sureness_levels > 0)
      text +=
          " The ratings were fitted with normal distributions of unequal variances; d_a and the area A_z have intervals "
          "of 1.96 standard errors, and there is neither where the ratings of noise and signals share one category at most "
          "(separated, not_applicable) or bound no variance (unbounded).";
    return text;
  }
};

}  // namespace

const Task& yes_no_task() noexcept {
  static const YesNoTask task;
  return task;
}

}  // namespace jnd
