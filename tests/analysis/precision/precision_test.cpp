// The planner's figures, and simulated studies.
#include "analysis/precision/precision.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include "analysis/numerics/sample_quantile.h"
#include "analysis/numerics/special_values.h"
#include "analysis/precision/monte_carlo.h"
#include "analysis/precision/slope_distribution.h"
#include "analysis/thresholds/jnd.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// The planner's figures: the published design's, the laws that every design obeys, and the extremes.

PrecisionQuestion published() {
  PrecisionQuestion question;
  question.design.differences = {400, 300, 200};
  question.jnds = {208.5, 283.5, 351};  // SV, S, V
  question.contrasts = {{1, 0}, {2, 0}, {2, 1}};
  question.participants = 18;
  question.draws = 20'000;
  question.experiments = 2'000;
  return question;
}

TEST_CASE("figures of the published design", "[analysis]") {
  const Precision found = precision(published());
  const ParticipantPrecision &sv = found.participant[0], &s = found.participant[1], &v = found.participant[2];
  // Independent simulations of counts, 12 trials a series with random classes, log-linear rates: their figures, within
  // what 150,000 participants tell. Median and 5-95 % of SV; shares of rates of 0 or 1, of d' <= 0, and outside
  // 200..400.
  CHECK(sv.method == PrecisionMethod::enumeration);
  CHECK(sv.median == Approx(228).margin(1));
  CHECK(sv.q05 == Approx(154.7).margin(0.5));
  CHECK(sv.q95 == Approx(448).margin(3));
  CHECK(sv.risks.any_extreme == Approx(0.82).margin(0.004));
  CHECK(s.risks.any_extreme == Approx(0.654).margin(0.004));
  CHECK(v.risks.any_extreme == Approx(0.558).margin(0.004));
  CHECK(sv.risks.any_not_positive == Approx(0.153).margin(0.004));
  CHECK(s.risks.any_not_positive == Approx(0.301).margin(0.004));
  CHECK(v.risks.any_not_positive == Approx(0.411).margin(0.004));
  CHECK(sv.outside_tested == Approx(0.389).margin(0.005));
  CHECK(s.outside_tested == Approx(0.377).margin(0.005));
  CHECK(v.outside_tested == Approx(0.493).margin(0.005));
  CHECK(s.status.no_sensitivity == Approx(0.0064).margin(0.001));
  CHECK(v.status.no_sensitivity == Approx(0.0209).margin(0.002));
  CHECK(sv.bias_of_median == Approx(sv.median - 208.5));
  // A CV of 10 % takes about 122 / 200 / 293 trials a series: the delta method.
  CHECK(12 * std::pow(sv.cv / 0.1, 2) == Approx(122).margin(1));
  CHECK(12 * std::pow(s.cv / 0.1, 2) == Approx(200).margin(1));
  CHECK(12 * std::pow(v.cv / 0.1, 2) == Approx(293).margin(1));
  CHECK(sv.proposed_trials == 123);
  CHECK(s.proposed_trials == 201);
  CHECK(v.proposed_trials == 293);
}

TEST_CASE("a CV that is asked for comes out of the proposed trials", "[analysis]") {
  PrecisionQuestion question = published();
  for (const ClassSizes sizes : {ClassSizes::random, ClassSizes::balanced}) {
    question.design.class_sizes = sizes;
    question.design.trials = 12;
    const std::optional<int> trials = trials_for_cv(question.design, 283.5, 0.1);
    REQUIRE(trials);
    CHECK((sizes == ClassSizes::random || *trials % 4 == 0));
    question.design.trials = *trials;
    CHECK(asymptotic_cv(question.design, 283.5) <= 0.1);
    CHECK(asymptotic_cv(question.design, 283.5) > 0.098);
    const ParticipantPrecision found = participant_precision(question, 283.5);
    // The spread of the estimates themselves is close to it by then.
    CHECK(found.spread == Approx(0.1).margin(0.004));
    CHECK(found.median == Approx(283.5).margin(4));
    CHECK(found.proposed_trials == *trials);
  }
}

TEST_CASE("more trials mean less of everything that is bad", "[analysis]") {
  PrecisionQuestion question = published();
  question.draws = 2'000;
  for (const ClassSizes sizes : {ClassSizes::random, ClassSizes::balanced}) {
    question.design.class_sizes = sizes;
    ParticipantPrecision last;
    bool first = true;
    for (const int trials : {4, 8, 12, 16, 24}) {
      question.design.trials = trials;
      const ParticipantPrecision found = participant_precision(question, 351);
      if (!first) {
        CHECK(found.risks.any_extreme < last.risks.any_extreme);
        CHECK(found.risks.any_not_positive < last.risks.any_not_positive);
        CHECK(1 - found.status.ok < 1 - last.status.ok);
        CHECK(found.cv < last.cv);
        CHECK(found.outside_tested < last.outside_tested);
        CHECK(found.interval_unbounded <= last.interval_unbounded);
      }
      last = found;
      first = false;
    }
  }
}

TEST_CASE("balanced classes do better than random ones", "[analysis]") {
  PrecisionQuestion random = published(), balanced = published();
  balanced.design.class_sizes = ClassSizes::balanced;
  for (const double jnd : random.jnds) {
    const ParticipantPrecision one = participant_precision(random, jnd), other = participant_precision(balanced, jnd);
    CHECK(other.risks.any_missing == 0);
    CHECK(one.risks.any_missing > 0);
    CHECK(other.status.ok >= one.status.ok);
    CHECK(other.q95 < one.q95);
    CHECK(other.spread < one.spread);
    CHECK(other.cv == one.cv);  // the asymptotic one does not know of chance in the class sizes
  }
}

TEST_CASE("statuses and undefined outcomes add up, whatever the method", "[analysis]") {
  PrecisionQuestion question = published();
  question.draws = 2'000;
  for (const Correction correction : {Correction::none, Correction::loglinear, Correction::half}) {
    question.design.correction = correction;
    for (const int trials : {1, 4, 12, 100}) {
      question.design.trials = trials;
      for (const double jnd : {1e-6, 208.5, 1e9}) {
        const ParticipantPrecision found = participant_precision(question, jnd);
        CAPTURE(trials, jnd, to_string(correction));
        CHECK(found.status.ok + found.status.no_sensitivity + found.status.ceiling + found.status.no_information ==
              Approx(1).epsilon(1e-9));
        CHECK(found.outside_tested >= 1 - found.status.ok - 1e-9);
        CHECK(found.outside_tested <= 1);
        CHECK(found.risks.any_extreme >= found.risks.any_missing);
        CHECK(found.risks.any_extreme <= 1);
        CHECK(found.risks.any_not_positive >= 0);
        CHECK((found.method == PrecisionMethod::simulation) == (found.replicates > 0));
        if (correction == Correction::none && jnd == 1e-6 && trials > 1) CHECK(found.status.ceiling > 0.4);
        if (correction != Correction::none) CHECK(found.status.ceiling == 0);
      }
    }
  }
}

TEST_CASE("thresholds out of reach of the differences", "[analysis]") {
  PrecisionQuestion question = published();
  const ParticipantPrecision tiny = participant_precision(question, 1e-6);
  CHECK(std::isinf(tiny.cv));
  CHECK_FALSE(tiny.proposed_trials);
  CHECK(tiny.risks.any_extreme == Approx(1));
  CHECK(tiny.outside_tested == Approx(1));
  const ParticipantPrecision huge = participant_precision(question, 1e9);
  CHECK_FALSE(huge.proposed_trials);
  CHECK(std::isinf(huge.median));
  CHECK(std::isinf(huge.interval_width));
  CHECK(huge.interval_unbounded > 0.9);
  CHECK(huge.risks.any_not_positive > 0.8);
}

TEST_CASE("simulation stands in where combinations are too many, with its standard errors", "[analysis]") {
  PrecisionQuestion question = published();
  question.design.trials = 40;
  const ParticipantPrecision found = participant_precision(question, 208.5);
  CHECK(found.method == PrecisionMethod::simulation);
  CHECK(found.replicates == question.draws);
  CHECK(found.median_se > 0);
  CHECK(found.median_se < 1);
  CHECK(found.share_se == Approx(0.5 / std::sqrt(20'000)));
  question.seed = 2;
  const ParticipantPrecision again = participant_precision(question, 208.5);
  CHECK(again.median == Approx(found.median).margin(5 * std::sqrt(2) * found.median_se));
  CHECK(again.median != found.median);
  question.seed = 1;
  CHECK(participant_precision(question, 208.5).median == found.median);
}

TEST_CASE("the interval narrows with the root of the trials", "[analysis]") {
  PrecisionQuestion question = published();
  question.design.class_sizes = ClassSizes::balanced;
  question.design.trials = 400;
  const ParticipantPrecision fewer = participant_precision(question, 283.5);
  question.design.trials = 1600;
  const ParticipantPrecision more = participant_precision(question, 283.5);
  CHECK(fewer.interval_width / more.interval_width == Approx(2).epsilon(0.03));
  // 2 x 1.96 standard errors.
  CHECK(more.interval_width == Approx(2 * 1.96 * more.cv * 283.5).epsilon(0.02));
  CHECK(more.interval_unbounded == 0);
}

TEST_CASE("group figures: seeded, counted, and as large samples predict", "[analysis]") {
  PrecisionQuestion question = published();
  const Precision found = precision(question), again = precision(question);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(found.group[i].median == again.group[i].median);
    CHECK(found.contrasts[i].power == again.contrasts[i].power);
    CHECK(found.group[i].with_undefined ==
          Approx(1 - std::pow(found.participant[i].status.ok, 18)).margin(5 * std::sqrt(0.25 / question.experiments)));
    CHECK(found.group[i].without_interval == 0);
  }
  CHECK(found.contrasts[1].true_difference == 142.5);
  CHECK(found.contrasts[1].a == 2);
  CHECK(found.contrasts[1].power_of_slopes > found.contrasts[1].power);

  // Many balanced trials: the mean's interval is 2 t sd / sqrt(N) with sd = CV JND, but for the median of a sample sd.
  question.design.class_sizes = ClassSizes::balanced;
  question.design.trials = 400;
  question.experiments = 500;
  const Precision large = precision(question);
  const double t = 2.1098155778331806;  // 97.5 % of Student's t, 17 degrees of freedom
  for (std::size_t i = 0; i < 3; ++i) {
    const double sd = large.participant[i].spread * large.participant[i].median;
    CHECK(large.group[i].ci_width == Approx(2 * t * sd / std::sqrt(18)).epsilon(0.08));
    CHECK(large.group[i].with_undefined == 0);
  }
  CHECK(large.contrasts[1].power > 0.99);
}

TEST_CASE("without a true difference, power is the rate of false findings", "[analysis]") {
  PrecisionQuestion question = published();
  question.design.class_sizes = ClassSizes::balanced;
  question.design.trials = 100;
  question.jnds = {283.5, 283.5};
  question.contrasts = {{0, 1}};
  question.experiments = 4'000;
  for (const double between_cv : {0.0, 0.3}) {
    question.between_cv = between_cv;
    const ContrastPrecision contrast = precision(question).contrasts[0];
    CHECK(contrast.power_of_slopes == Approx(0.05).margin(5 * contrast.power_of_slopes_se + 0.005));
    CHECK(contrast.power == Approx(0.05).margin(0.025));
  }
}

TEST_CASE("a spread between participants widens the group's interval, not a contrast's alike", "[analysis]") {
  PrecisionQuestion question = published();
  question.design.class_sizes = ClassSizes::balanced;
  question.design.trials = 200;
  question.experiments = 1'000;
  const Precision narrow = precision(question);
  question.between_cv = 0.3;
  const Precision wide = precision(question);
  const double group = wide.group[1].ci_width / narrow.group[1].ci_width;
  const double contrast = wide.contrasts[0].ci_width / narrow.contrasts[0].ci_width;
  CHECK(group > 1.5);
  CHECK(contrast < group);
}

TEST_CASE("one participant has no interval of a mean, and none is made up", "[analysis]") {
  PrecisionQuestion question = published();
  question.participants = 1;
  const Precision found = precision(question);
  CHECK(found.group[0].without_interval == 1);
  CHECK(std::isnan(found.group[0].ci_width));
  CHECK(found.contrasts[0].without_interval == 1);
  CHECK(found.contrasts[0].power == 0);
  question.design.class_sizes = ClassSizes::balanced;
  question.design.trials = 1;  // no "same" trials at all
  const Precision nothing = precision(question);
  CHECK(nothing.participant[0].status.no_information == 1);
  CHECK(std::isnan(nothing.participant[0].median));
  CHECK(std::isnan(nothing.group[0].median));
  CHECK(nothing.group[0].with_undefined == 1);
}

TEST_CASE("questions without an answer are refused", "[analysis]") {
  const auto refused = [](auto change) {
    PrecisionQuestion question = published();
    change(question);
    CHECK_THROWS_AS(precision(question), std::invalid_argument);
  };
  refused([](PrecisionQuestion& question) { question.jnds = {}; });
  refused([](PrecisionQuestion& question) { question.jnds[0] = 0; });
  refused([](PrecisionQuestion& question) { question.jnds[1] = kNaN; });
  refused([](PrecisionQuestion& question) { question.design.differences = {}; });
  refused([](PrecisionQuestion& question) { question.design.differences[2] = -200; });
  refused([](PrecisionQuestion& question) { question.design.trials = 0; });
  refused([](PrecisionQuestion& question) { question.participants = 0; });
  refused([](PrecisionQuestion& question) { question.wanted_cv = 0; });
  refused([](PrecisionQuestion& question) { question.contrasts = {{0, 3}}; });
  refused([](PrecisionQuestion& question) { question.draws = 1; });
}

// Simulated studies: the same for a seed, and distributed as the exact enumeration says.

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
