// How many trials a JND costs: the Bayesian adaptive procedure beside a weighted staircase with accelerated steps towards
// 90 % and constant levels, on simulated observers whose JND is known.
//
//   posterior_recovery_bench [RUNS [TRIALS]]      300 runs of up to 480 trials
//
// same-different: blocks of 2 same and 4 different trials, shuffled; P(different) = lapse/2 + (1 - lapse) Phi(d/JND - k)
// with k = 0.75 and lapse = 0.02. which: blocks of 6, P(comparison) = lapse/2 + (1 - lapse) Phi((x - 900 - a)/s) with
// a = 20 N/m. All three are analysed alike: by the mean of the posterior of ln s over all answers, and its 2.5 to 97.5 %
// interval; beside it the joint maximum likelihood of the yes-no model, which may have none.
//
// Printed for each procedure and true JND:
//   trials to 20 %   the first block from which on, to the end, the scatter (SD/mean) of the estimates is at most 20 %; the
//                    root mean squared error / true JND is; the mean posterior SD of ln s is at most 0.2
//   at 72 trials     root mean squared error of ln JND (aim: 0.21 for 150 to 351 N/m), bias of ln JND, coverage of the
//                    95 % interval (aim: 92 to 99 %), estimates that are undefined (aim: none), and the same of the
//                    maximum likelihood: undefined of the runs, error of the others
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/normal.h"
#include "analysis/procedures/staircase.h"
#include "analysis/selftest/model_quantities.h"
#include "analysis/thresholds/jnd_ml_yes_no.h"
#include "protocols/random_stream.h"

namespace {

using namespace jnd;

constexpr int kBlock = 6, kSameOfBlock = 2, kLookedAt = 72;
constexpr double kLapse = 0.02, kCriterion = 0.75, kOffset = 20;
constexpr std::array kTrue = {150.0, 208.5, 283.5, 351.0, 500.0};

enum class Way { posterior, staircase, constant };
constexpr std::array kWays = {Way::posterior, Way::staircase, Way::constant};

const char* name_of(Way way) {
  return way == Way::posterior ? "posterior" : way == Way::staircase ? "weighted staircase" : "constant levels";
}

struct Answer {
  double level;
  bool positive;
};

// One run: the estimates after each block.
struct Course {
  std::vector<double> ln_jnd, sd, low, high;
  double ml_ln_jnd = NAN;  // after kLookedAt trials; NaN where the likelihood has no maximum with a JND
};

double probability_of(PosteriorTask task, double jnd, double level) {
  const double z = task == PosteriorTask::which ? (level - 900 - kOffset) / jnd : level / jnd - kCriterion;
  return kLapse / 2 + (1 - kLapse) * normal_cdf(z);
}

// 90 % correct: nine times as far up as down, shrinking. Levels: distance from the standard.
Staircase weighted_staircase(PosteriorTask task) {
  StaircaseRule rule;
  rule.start = task == PosteriorTask::which ? 300 : 400;
  rule.up = rule.down = 1;
  rule.step_up = 360;
  rule.step_down = 40;
  rule.accelerated = true;
  rule.clamp = task == PosteriorTask::which ? std::array{25.0, 500.0} : std::array{25.0, 600.0};
  return Staircase(rule);
}

// The slope of the joint yes-no likelihood over all answers, as ln JND.
double maximum_likelihood(const std::vector<Answer>& answers, double standard) {
  MlGroup group;
  std::vector<Answer> sorted = answers;
  std::sort(sorted.begin(), sorted.end(), [](const Answer& a, const Answer& b) { return a.level < b.level; });
  double said = 0;
  for (const Answer& one : sorted) {
    const double x = one.level - standard;
    if (group.cells.empty() || group.cells.back().x != x) group.cells.push_back({x, 0, 0});
    group.cells.back().n += 1;
    group.cells.back().said += one.positive ? 1 : 0;
    said += one.positive ? 1 : 0;
  }
  if (said == 0 || said == static_cast<double>(sorted.size())) return NAN;
  // Separated: every "no" at or below every "yes".
  double largest_no = -HUGE_VAL, smallest_yes = HUGE_VAL;
  for (const Answer& one : sorted) {
    if (one.positive) smallest_yes = std::min(smallest_yes, one.level);
    if (!one.positive) largest_no = std::max(largest_no, one.level);
  }
  if (largest_no <= smallest_yes || group.cells.size() < 2) return NAN;
  const std::array groups = {group};
  const double slope = YesNoProfile(groups).maximum();
  return slope > 1e-9 ? -std::log(slope) : NAN;
}

class Simulation {
 public:
  Simulation(PosteriorTask task, Way way, double jnd, std::uint64_t run)
      : task_(task),
        way_(way),
        jnd_(jnd),
        stream_(2026, run, "posterior_recovery", static_cast<std::uint64_t>(way)),
        posterior_(reference_posterior(task, PosteriorUtility::variance)),
        staircase_(weighted_staircase(task)) {}

  Course run(int trials) {
    Course course;
    for (int block = 0; block * kBlock < trials; ++block) {
      std::array<int, kBlock> places{0, 1, 2, 3, 4, 5};
      stream_.shuffle(places);
      for (const int place : places) trial(place);
      const PosteriorProcedure posterior = way_ == Way::posterior ? posterior_ : posterior_of_answers();
      const PosteriorEstimate of = posterior.estimate();
      course.ln_jnd.push_back(of.mean_ln_s);
      course.sd.push_back(of.sd_ln_s);
      course.low.push_back(posterior.ln_s_quantile(0.025));
      course.high.push_back(posterior.ln_s_quantile(0.975));
      if ((block + 1) * kBlock == kLookedAt)
        course.ml_ln_jnd = maximum_likelihood(answers_, task_ == PosteriorTask::which ? 900 : 0);
    }
    return course;
  }

 private:
  bool which() const { return task_ == PosteriorTask::which; }

  // With the levels of these answers for its levels.
  PosteriorProcedure posterior_of_answers() const {
    PosteriorConfiguration configuration = reference_posterior(task_, PosteriorUtility::variance);
    std::vector<double>& levels = configuration.levels;
    levels.clear();
    if (!which()) levels.push_back(0);
    for (const Answer& answer : answers_)
      if (std::find(levels.begin(), levels.end(), answer.level) == levels.end()) levels.push_back(answer.level);
    PosteriorProcedure posterior(configuration);
    for (const Answer& answer : answers_) {
      const auto place = std::find(levels.begin(), levels.end(), answer.level) - levels.begin();
      posterior.update(static_cast<std::size_t>(place), answer.positive);
    }
    return posterior;
  }

  // place: which of the six trials of a block this is.
  void trial(int place) {
    const bool same = !which() && place < kSameOfBlock;
    const double side = place % 2 == 0 ? -1 : 1;
    double level = 0;
    std::size_t choice = 0;  // of the posterior's levels, of which the first is that of the same trial
    if (same) {
      level = 0;
    } else if (way_ == Way::posterior) {
      choice = posterior_.choose(which() ? PosteriorSlot::balanced : PosteriorSlot::different).level;
      level = posterior_.level(choice);
    } else if (way_ == Way::staircase) {
      level = which() ? 900 + side * staircase_.level() : staircase_.level();
    } else {
      level = which() ? 900 + side * 100 * (1 + place / 2) : 200 + 100 * static_cast<double>(stream_.below(3));
    }
    const bool positive = stream_.uniform() < probability_of(task_, jnd_, level);
    if (way_ == Way::posterior) posterior_.update(choice, positive);
    answers_.push_back({level, positive});
    if (!same && way_ == Way::staircase) staircase_.answer(which() ? positive == (side > 0) : positive);
  }

  PosteriorTask task_;
  Way way_;
  double jnd_;
  RandomStream stream_;
  PosteriorProcedure posterior_;
  Staircase staircase_;
  std::vector<Answer> answers_;
};

double root_mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return values.empty() ? NAN : std::sqrt(sum / static_cast<double>(values.size()));
}

// The first block from which on every value is at most `most`, in trials; "> N" where there is none.
std::string trials_to(const std::vector<double>& values, double most) {
  std::size_t from = values.size();
  while (from > 0 && values[from - 1] <= most) --from;
  if (from == values.size()) return fmt::format("> {}", values.size() * kBlock);
  return fmt::format("{}", (from + 1) * kBlock);
}

void summarise(PosteriorTask task, Way way, double jnd, int runs, int trials) {
  std::vector<Course> courses;
  for (int run = 0; run < runs; ++run)
    courses.push_back(Simulation(task, way, jnd, static_cast<std::uint64_t>(run) + 1).run(trials));
  std::vector<double> scatter, error, sd;
  for (std::size_t block = 0; block < courses[0].ln_jnd.size(); ++block) {
    std::vector<double> estimates, off, sds;
    for (const Course& course : courses) {
      estimates.push_back(std::exp(course.ln_jnd[block]));
      off.push_back(estimates.back() / jnd - 1);
      sds.push_back(course.sd[block]);
    }
    const Moments of = moments(estimates);
    scatter.push_back(of.sd / of.mean);
    error.push_back(root_mean_square(off));
    sd.push_back(moments(sds).mean);
  }
  std::vector<double> off, ml_off;
  int covered = 0, undefined = 0, ml_undefined = 0;
  const std::size_t at = kLookedAt / kBlock - 1;
  for (const Course& course : courses) {
    if (!std::isfinite(course.ln_jnd[at])) ++undefined;
    off.push_back(course.ln_jnd[at] - std::log(jnd));
    if (course.low[at] <= std::log(jnd) && std::log(jnd) <= course.high[at]) ++covered;
    if (std::isnan(course.ml_ln_jnd))
      ++ml_undefined;
    else
      ml_off.push_back(course.ml_ln_jnd - std::log(jnd));
  }
  fmt::print("{:<19} {:6.1f} {:>8} {:>8} {:>8}   {:8.3f} {:+8.3f} {:7.1f} % {:6} {:9} {:9.3f}\n", name_of(way), jnd,
             trials_to(scatter, 0.2), trials_to(error, 0.2), trials_to(sd, 0.2), root_mean_square(off),
             moments(off).mean, 100.0 * covered / runs, undefined, ml_undefined, root_mean_square(ml_off));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 300;
  const int trials = std::max(argc > 2 ? std::atoi(argv[2]) : 480, kLookedAt);
  for (const PosteriorTask task : {PosteriorTask::same_different, PosteriorTask::which}) {
    fmt::print("{}, {} runs of {} trials\n", task == PosteriorTask::which ? "which" : "same-different", runs, trials);
    fmt::print("{:<19} {:>6} {:>26}   {}\n", "", "", "trials to 20 % by", "at 72 trials");
    fmt::print("{:<19} {:>6} {:>8} {:>8} {:>8}   {:>8} {:>8} {:>9} {:>6} {:>9} {:>9}\n", "procedure", "JND", "scatter",
               "error", "SD", "RMSE ln", "bias ln", "coverage", "undef.", "ML undef.", "ML RMSE");
    for (const Way way : kWays)
      for (const double jnd : kTrue) summarise(task, way, jnd, runs, trials);
  }
  return 0;
}
