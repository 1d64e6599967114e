// Simulated studies: the same for a seed, and distributed as the exact enumeration says.
#include "analysis/precision/monte_carlo.h"

#include <cmath>
#include <vector>

#include "analysis/numerics/sample_quantile.h"
#include "analysis/numerics/special_values.h"
#include "analysis/precision/slope_distribution.h"
#include "analysis/thresholds/jnd.h"
#include "tests/catch.h"

namespace jnd {
namespace {

StudyModel published_study() {
  StudyModel model;
  model.design.differences = {400, 300, 200};
  model.jnds = {283.5, 351.0, 208.5};
  model.participants = 18;
  return model;
}

TEST_CASE("experiments are the same for a seed, in any order, and others for another seed", "[analysis]") {
  const StudySimulator simulator(published_study()), again(published_study());
  std::vector<double> first(54), second(54), other(54);
  simulator.slopes(7, 3, first);
  simulator.slopes(7, 4, other);
  CHECK(first != other);
  again.slopes(7, 3, second);
  CHECK(first == second);
  again.slopes(8, 3, other);
  CHECK(first != other);
  // More participants change no number of the others.
  StudyModel more = published_study();
  more.participants = 20;
  std::vector<double> of_more(60);
  StudySimulator(more).slopes(7, 3, of_more);
  for (std::size_t condition = 0; condition < 3; ++condition)
    for (std::size_t i = 0; i < 18; ++i) CHECK(of_more[condition * 20 + i] == first[condition * 18 + i]);
}

TEST_CASE("random numbers of an experiment do not depend on the machine", "[analysis]") {
  // Philox4x64-10 known answers: counter and key of zeros (Random123's kat_vectors).
  ExperimentStream stream(0, 0, 0);
  CHECK(stream.next() == 0x16554d9eca36314cULL);
  CHECK(stream.next() == 0xdb20fe9d672d0fdcULL);
  CHECK(stream.next() == 0xd7e772cee186176bULL);
  CHECK(stream.next() == 0x7e68b68aec7ba23bULL);
}

TEST_CASE("group means are those of the slopes, with every status counted", "[analysis]") {
  StudyModel model = published_study();
  model.design.trials = 2;  // where everything that can go wrong does
  for (const Correction correction : {Correction::none, Correction::loglinear}) {
    model.design.correction = correction;
    const StudySimulator simulator(model);
    std::vector<double> slopes(54);
    std::vector<MeanJnd> means(3);
    MeanJnd all;
    for (std::uint64_t experiment = 0; experiment < 200; ++experiment) {
      simulator.slopes(1, experiment, slopes);
      simulator.means(1, experiment, means);
      for (std::size_t condition = 0; condition < 3; ++condition) {
        double sum = 0;
        int n = 0;
        for (std::size_t i = 0; i < 18; ++i) {
          const double slope = slopes[condition * 18 + i];
          if (status_of_slope(slope) != JndStatus::ok) continue;
          sum += 1 / slope;
          ++n;
        }
        const MeanJnd& mean = means[condition];
        CHECK(mean.n == n);
        CHECK(mean.n + mean.no_sensitivity + mean.ceiling + mean.no_information == 18);
        if (n > 0)
          CHECK(mean.mean == Approx(sum / n).epsilon(1e-12));
        else
          CHECK(std::isnan(mean.mean));
        all.no_sensitivity += mean.no_sensitivity;
        all.ceiling += mean.ceiling;
        all.no_information += mean.no_information;
      }
    }
    CHECK(all.no_information > 0);
    CHECK(all.no_sensitivity > 0);
    CHECK((all.ceiling > 0) == (correction == Correction::none));
  }
}

// Share of simulated slopes by status, and quantiles, beside the enumeration's: within five standard errors.
void compare(const CountsDesign& design, double jnd, int draws) {
  StudyModel model;
  model.design = design;
  model.jnds = {jnd};
  const StudySimulator simulator(model);
  std::vector<CellDistribution> cells;
  for (const double difference : design.differences)
    cells.push_back(cell_distribution(cell_probabilities(design, difference, jnd)));
  const SlopeDistribution exact(cells, design.differences);
  int ok = 0, no_sensitivity = 0, no_information = 0;
  std::vector<double> jnds, slope(1);
  for (int i = 0; i < draws; ++i) {
    simulator.slopes(3, static_cast<std::uint64_t>(i), slope);
    const JndStatus status = status_of_slope(slope[0]);
    ok += status == JndStatus::ok ? 1 : 0;
    no_sensitivity += status == JndStatus::no_sensitivity ? 1 : 0;
    no_information += status == JndStatus::no_information ? 1 : 0;
    if (status == JndStatus::ok) jnds.push_back(1 / slope[0]);
    if (status == JndStatus::no_sensitivity) jnds.push_back(kInf);
    if (status == JndStatus::ceiling) jnds.push_back(0);
  }
  const auto near = [&](int count, double share) {
    const double se = std::sqrt(share * (1 - share) / draws) + 1.0 / draws;
    CHECK(count / static_cast<double>(draws) == Approx(share).margin(5 * se));
  };
  CAPTURE(jnd, design.trials);
  near(ok, exact.status().ok);
  near(no_sensitivity, exact.status().no_sensitivity);
  near(no_information, exact.status().no_information);
  const SampleQuantiles quantiles(std::move(jnds));
  for (const double share : {0.05, 0.5, 0.9}) {
    // The simulated quantile lies between exact ones a little below and above.
    const double step = 5 * std::sqrt(share * (1 - share) / draws);
    CHECK(quantiles.at(share) >= exact.jnd_quantile(share - step) * (1 - 1e-9));
    CHECK(quantiles.at(share) <= exact.jnd_quantile(share + step) * (1 + 1e-9));
  }
}

TEST_CASE("simulation agrees with enumeration", "[analysis]") {
  CountsDesign design;
  design.differences = {400, 300, 200};
  for (const ClassSizes sizes : {ClassSizes::random, ClassSizes::balanced}) {
    design.class_sizes = sizes;
    for (const int trials : {2, 3, 12}) {
      design.trials = trials;
      for (const double jnd : {208.5, 351.0}) compare(design, jnd, 40'000);
    }
  }
}

TEST_CASE("cells too large for a table are drawn from their counts, with the same distribution", "[analysis]") {
  CountsDesign design;
  design.differences = {200};
  design.trials = 70;  // random classes: 62,196 different counts
  REQUIRE(counts_of_cell(70, ClassSizes::random) > CellSampler::kMostTabulated);
  compare(design, 351, 20'000);
  design.class_sizes = ClassSizes::balanced;
  design.trials = 448;
  REQUIRE(counts_of_cell(448, ClassSizes::balanced) > CellSampler::kMostTabulated);
  compare(design, 351, 20'000);
}

TEST_CASE("a spread between participants is one factor for all their conditions", "[analysis]") {
  StudyModel model = published_study();
  model.design.trials = 2000;
  model.design.class_sizes = ClassSizes::balanced;
  model.jnds = {300, 300};
  model.participants = 400;
  model.between_cv = 0.3;
  const StudySimulator simulator(model);
  std::vector<double> slopes(800);
  simulator.slopes(1, 0, slopes);
  double sum = 0, squares = 0, products = 0, mean_other = 0;
  for (std::size_t i = 0; i < 400; ++i) {
    const double one = -std::log(slopes[i]), other = -std::log(slopes[400 + i]);
    sum += one / 400;
    mean_other += other / 400;
    squares += one * one / 400;
    products += one * other / 400;
  }
  const double sd = std::sqrt(squares - sum * sum);
  CHECK(sd == Approx(std::sqrt(std::log1p(0.09))).epsilon(0.1));
  CHECK(std::exp(sum) == Approx(300).epsilon(0.06));
  CHECK((products - sum * mean_other) / (sd * sd) > 0.9);  // the same people in both conditions
}

TEST_CASE("quantiles of samples and their standard errors", "[analysis]") {
  const SampleQuantiles values({5, 1, 4, 2, 3, kInf});
  CHECK(values.at(0.5) == 3);
  CHECK(values.at(0.01) == 1);
  CHECK(std::isinf(values.at(0.99)));
  CHECK(std::isnan(values.standard_error(0.99)));
  CHECK(std::isnan(SampleQuantiles({}).at(0.5)));
  // Uniform on 0..1: the median's standard error is 0.5 / sqrt(n).
  std::vector<double> uniform;
  for (int i = 0; i < 10'000; ++i) uniform.push_back((i + 0.5) / 10'000);
  CHECK(SampleQuantiles(uniform).standard_error(0.5) == Approx(0.005).epsilon(0.03));
}

}  // namespace
}  // namespace jnd
