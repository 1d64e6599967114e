#include "analysis/procedures/quest.h"

#include <array>
#include <cmath>

#include "protocols/planning/random_stream.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

QuestParameters reference_parameters() {
  QuestParameters parameters;
  parameters.t_guess = -1;
  parameters.t_guess_sd = 2;
  parameters.p_threshold = 0.82;
  parameters.beta = 3.5;
  parameters.delta = 0.01;
  parameters.gamma = 0.5;
  parameters.grain = 0.01;
  parameters.range = 4;
  return parameters;
}

struct ReferenceTrial {
  double x;
  bool correct;
  double mean, mode, median, sd;
};

// An independent implementation in numpy of Watson & Pelli (1983); 15 digits.
constexpr std::array<ReferenceTrial, 12> kReference = {{
    {-1, true, -1.29780870768666, -1.22, -1.41, 1.03178643169503},
    {-1.2, true, -1.55617420347526, -1.4, -1.68, 0.94163472740927},
    {-1.5, false, -0.639933331755656, -1.27, -0.87, 0.741781939185287},
    {-1.3, true, -0.78989653961547, -1.33, -1.07, 0.737955150529601},
    {-1.4, false, -0.567795836180984, -1.24, -0.79, 0.703003508374739},
    {-1.25, true, -0.699752945893864, -1.28, -1.01, 0.692710662699126},
    {-1.3, true, -0.824312263674283, -1.31, -1.14, 0.665815671864371},
    {-1.35, true, -0.933335933354017, -1.33, -1.22, 0.627811703096758},
    {-1.45, false, -0.821966877921406, -1.3, -1.14, 0.657162911524633},
    {-1.3, true, -0.940511396770216, -1.32, -1.22, 0.609197953613208},
    {-1.35, true, -1.03540643090119, -1.33, -1.26, 0.55623132875072},
    {-1.4, true, -1.10759250947965, -1.35, -1.29, 0.50609097455264},
}};

}  // namespace

TEST_CASE("the reference run is met to the last digits") {
  const QuestParameters parameters = reference_parameters();
  CHECK(quest_threshold_shift(parameters) == Approx(0.00483943710518652).epsilon(1e-13));
  CHECK(quest_grid_size(parameters) == 401);
  Quest run(parameters);
  for (const ReferenceTrial& trial : kReference) {
    run.answer(trial.x, trial.correct);
    const QuestEstimate estimate = run.estimate();
    CHECK(estimate.mean == Approx(trial.mean).margin(1e-13));
    CHECK(estimate.sd == Approx(trial.sd).margin(1e-13));
    CHECK(estimate.mode == Approx(trial.mode).margin(1e-13));
    CHECK(estimate.median == Approx(trial.median).margin(1e-13));
  }
  CHECK(run.answers() == static_cast<int>(kReference.size()));
}

TEST_CASE("before any answer the posterior is the prior") {
  QuestParameters parameters = reference_parameters();
  parameters.t_guess_sd = 0.3;
  const QuestEstimate estimate = Quest(parameters).estimate();
  CHECK(estimate.mean == Approx(-1).margin(1e-12));
  CHECK(estimate.mode == Approx(-1).margin(1e-12));
  CHECK(estimate.median == Approx(-1).margin(1e-12));
  CHECK(estimate.sd == Approx(0.3).margin(1e-4));  // the grid ends at 6.7 standard deviations
}

TEST_CASE("psi is p_threshold at threshold and between gamma and the lapses elsewhere") {
  for (const double gamma : {0.0, 0.1, 0.5}) {
    QuestParameters parameters = reference_parameters();
    parameters.gamma = gamma;
    const double shift = quest_threshold_shift(parameters);
    CHECK(quest_probability(parameters, shift, 2.5, 2.5) == Approx(0.82).margin(1e-13));
    CHECK(quest_probability(parameters, shift, -9, 2.5) == Approx(gamma).margin(1e-13));
    CHECK(quest_probability(parameters, shift, 9, 2.5) == Approx(1 - 0.01 * (1 - gamma)).margin(1e-13));
  }
}

TEST_CASE("a posterior moves against the answer, however many there are") {
  Quest up(reference_parameters()), down(reference_parameters());
  double before_up = up.estimate().mean, before_down = before_up;
  for (int i = 0; i < 50; ++i) {
    up.answer(up.estimate().mean, false);
    down.answer(down.estimate().mean, true);
    CHECK(up.estimate().mean > before_up);
    CHECK(down.estimate().mean < before_down);
    before_up = up.estimate().mean;
    before_down = down.estimate().mean;
  }
  // Thousands of answers do not underflow: the posterior is scaled after each.
  for (int i = 0; i < 3000; ++i) up.answer(-1, i % 5 != 0);
  CHECK(std::isfinite(up.estimate().mean));
  CHECK(up.estimate().sd > 0);
}

TEST_CASE("an answer that no threshold allows changes nothing") {
  QuestParameters parameters = reference_parameters();
  parameters.delta = 0;
  Quest run(parameters);
  const QuestEstimate before = run.estimate();
  run.answer(400, false);  // psi = 1 under every threshold
  CHECK(run.estimate().mean == before.mean);
  CHECK(run.answers() == 1);
}

// Thresholds drawn from the prior, and observers with the assumed psychometric function: then the mean squared error of
// the posterior mean is the mean posterior variance, and the error shrinks with the trials.
TEST_CASE("estimates converge on the threshold of known observers") {
  QuestParameters parameters = reference_parameters();
  parameters.t_guess_sd = 0.5;
  const double shift = quest_threshold_shift(parameters);
  constexpr int kRuns = 500;
  const auto errors = [&](int trials) {
    double bias = 0, squares = 0, claimed = 0;
    for (int i = 0; i < kRuns; ++i) {
      RandomStream stream(5, static_cast<std::uint64_t>(i + 1), "observer");
      const double truth = parameters.t_guess + parameters.t_guess_sd * stream.normal();
      Quest run(parameters);
      for (int trial = 0; trial < trials; ++trial) {
        const double x = run.estimate().mean;
        run.answer(x, stream.uniform() < quest_probability(parameters, shift, x, truth));
      }
      const QuestEstimate estimate = run.estimate();
      bias += (estimate.mean - truth) / kRuns;
      squares += (estimate.mean - truth) * (estimate.mean - truth) / kRuns;
      claimed += estimate.sd * estimate.sd / kRuns;
    }
    return std::array<double, 3>{bias, std::sqrt(squares), std::sqrt(claimed)};
  };
  const auto [bias, error, claimed] = errors(40);
  CAPTURE(bias, error, claimed);
  CHECK(std::abs(bias) < 4 * error / std::sqrt(kRuns));
  CHECK(error == Approx(claimed).epsilon(0.2));
  CHECK(error < 0.12);
  CHECK(errors(10)[1] > 1.5 * error);
}

TEST_CASE("a grid of whole steps is not made larger by rounding") {
  QuestParameters parameters = reference_parameters();
  parameters.range = 0.6;
  parameters.grain = 0.1;
  CHECK(quest_grid_size(parameters) == 7);
  parameters.grain = 0.25;
  CHECK(quest_grid_size(parameters) == 5);  // -0.5 .. 0.5: never less than the range
}

TEST_CASE("parameters that cannot be used say why") {
  CHECK(problem_of(reference_parameters()).empty());
  const auto broken = [](auto change) {
    QuestParameters parameters = reference_parameters();
    change(parameters);
    return !problem_of(parameters).empty();
  };
  CHECK(broken([](QuestParameters& p) { p.t_guess = NAN; }));
  CHECK(broken([](QuestParameters& p) { p.t_guess_sd = 0; }));
  CHECK(broken([](QuestParameters& p) { p.p_threshold = 0.5; }));  // gamma
  CHECK(broken([](QuestParameters& p) { p.p_threshold = 0.995; }));
  CHECK(broken([](QuestParameters& p) { p.beta = -1; }));
  CHECK(broken([](QuestParameters& p) { p.delta = 1; }));
  CHECK(broken([](QuestParameters& p) { p.gamma = -0.1; }));
  CHECK(broken([](QuestParameters& p) { p.grain = 0; }));
  CHECK(broken([](QuestParameters& p) { p.grain = 1e-9; }));
  CHECK(broken([](QuestParameters& p) { p.range = 0; }));
}
