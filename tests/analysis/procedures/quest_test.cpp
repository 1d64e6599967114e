#include "analysis/procedures/quest.h"

#include <cmath>

#include "analysis/selftest/reference_numbers.h"
#include "protocols/random_stream.h"
#include "tests/catch.h"

using namespace jnd;

TEST_CASE("the reference run is met to the last digits") {
  const nlohmann::json& reference = reference_numbers("adaptive").at("quest");
  const QuestParameters parameters = reference_quest();
  CHECK(quest_threshold_shift(parameters) == Approx(reference_number(reference.at("threshold_shift"))).epsilon(1e-13));
  CHECK(quest_grid_size(parameters) == 401);
  Quest run(parameters);
  for (const nlohmann::json& trial : reference.at("trials")) {
    run.answer(trial.at("x"), trial.at("correct"));
    const QuestEstimate estimate = run.estimate();
    CHECK(estimate.mean == Approx(reference_number(trial.at("mean"))).margin(1e-13));
    CHECK(estimate.sd == Approx(reference_number(trial.at("sd"))).margin(1e-13));
    CHECK(estimate.mode == Approx(reference_number(trial.at("mode"))).margin(1e-13));
    CHECK(estimate.median == Approx(reference_number(trial.at("median"))).margin(1e-13));
  }
  CHECK(run.answers() == 12);
}

TEST_CASE("before any answer the posterior is the prior") {
  QuestParameters parameters = reference_quest();
  parameters.t_guess_sd = 0.3;
  const QuestEstimate estimate = Quest(parameters).estimate();
  CHECK(estimate.mean == Approx(-1).margin(1e-12));
  CHECK(estimate.mode == Approx(-1).margin(1e-12));
  CHECK(estimate.median == Approx(-1).margin(1e-12));
  CHECK(estimate.sd == Approx(0.3).margin(1e-4));  // the grid ends at 6.7 standard deviations
}

TEST_CASE("psi is p_threshold at threshold and between gamma and the lapses elsewhere") {
  for (const double gamma : {0.0, 0.1, 0.5}) {
    QuestParameters parameters = reference_quest();
    parameters.gamma = gamma;
    const double shift = quest_threshold_shift(parameters);
    CHECK(quest_probability(parameters, shift, 2.5, 2.5) == Approx(0.82).margin(1e-13));
    CHECK(quest_probability(parameters, shift, -9, 2.5) == Approx(gamma).margin(1e-13));
    CHECK(quest_probability(parameters, shift, 9, 2.5) == Approx(1 - 0.01 * (1 - gamma)).margin(1e-13));
  }
}

TEST_CASE("a posterior moves against the answer, however many there are") {
  Quest up(reference_quest()), down(reference_quest());
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
  QuestParameters parameters = reference_quest();
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
  QuestParameters parameters = reference_quest();
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
  QuestParameters parameters = reference_quest();
  parameters.range = 0.6;
  parameters.grain = 0.1;
  CHECK(quest_grid_size(parameters) == 7);
  parameters.grain = 0.25;
  CHECK(quest_grid_size(parameters) == 5);  // -0.5 .. 0.5: never less than the range
}

TEST_CASE("parameters that cannot be used say why") {
  CHECK(problem_of(reference_quest()).empty());
  const auto broken = [](auto change) {
    QuestParameters parameters = reference_quest();
    change(parameters);
    return !problem_of(parameters).empty();
  };
  CHECK(broken([](QuestParameters& p) { p.t_guess = NAN; }));
  CHECK(broken([](QuestParameters& p) { p.t_guess_sd = 0; }));
  CHECK(broken([](QuestParameters& p) { p.grain = 10; }));  // one threshold only
  CHECK(broken([](QuestParameters& p) { p.t_guess_sd = p.grain / 10; }));
  CHECK(broken([](QuestParameters& p) { p.p_threshold = 0.5; }));  // gamma
  CHECK(broken([](QuestParameters& p) { p.p_threshold = 0.995; }));
  CHECK(broken([](QuestParameters& p) { p.beta = -1; }));
  CHECK(broken([](QuestParameters& p) { p.delta = 1; }));
  CHECK(broken([](QuestParameters& p) { p.gamma = -0.1; }));
  CHECK(broken([](QuestParameters& p) { p.grain = 0; }));
  CHECK(broken([](QuestParameters& p) { p.grain = 1e-9; }));
  CHECK(broken([](QuestParameters& p) { p.range = 0; }));
}
