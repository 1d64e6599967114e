// d' of the yes-no model against numbers computed with R 4.2.2 (qnorm; checked with psyphy::dprime.SD and a second
// implementation), and what its statuses mean.
#include "analysis/detection/yes_no.h"

#include <array>
#include <cmath>
#include <vector>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// Equal, both infinite alike, both undefined, or within the tolerance for closed forms.
bool agrees(double ours, double reference) {
  if (std::isnan(reference)) return std::isnan(ours);
  return ours == reference || std::abs(ours - reference) <= 1e-10;
}

struct Expected {
  double hit_rate, false_alarm_rate, z_hit, z_false_alarm, dprime, criterion;
};
struct Case {
  Counts counts;
  std::array<Expected, 3> by_correction;  // none, loglinear, half
};

// n_diff, hits, n_same, false alarms -> H, F, zH, zF, d', c (R 4.2.2, 15 digits).
const std::vector<Case> kReference = {
    {{6, 5, 6, 1},
     {{{0.833333333333333, 0.166666666666667, 0.967421566101701, -0.967421566101701, 1.9348431322034, 0},
       {0.785714285714286, 0.214285714285714, 0.791638607743375, -0.791638607743375, 1.58327721548675, 0},
       {0.833333333333333, 0.166666666666667, 0.967421566101701, -0.967421566101701, 1.9348431322034, 0}}}},
    {{6, 6, 6, 2},
     {{{1, 0.333333333333333, kInf, -0.430727299295457, kInf, -kInf},
       {0.928571428571429, 0.357142857142857, 1.46523379268552, -0.36610635680057, 1.83134014948609,
        -0.549563717942476},
       {0.916666666666667, 0.333333333333333, 1.38299412710064, -0.430727299295457, 1.8137214263961,
        -0.47613341390259}}}},
    {{6, 3, 6, 3}, {{{0.5, 0.5, 0, 0, 0, 0}, {0.5, 0.5, 0, 0, 0, 0}, {0.5, 0.5, 0, 0, 0, 0}}}},
    {{6, 2, 6, 4},
     {{{0.333333333333333, 0.666666666666667, -0.430727299295457, 0.430727299295457, -0.861454598590915,
        5.55111512312578e-17},
       {0.357142857142857, 0.642857142857143, -0.36610635680057, 0.36610635680057, -0.732212713601139, 0},
       {0.333333333333333, 0.666666666666667, -0.430727299295457, 0.430727299295457, -0.861454598590915,
        5.55111512312578e-17}}}},
    {{6, 0, 6, 0},
     {{{0, 0, -kInf, -kInf, kNaN, kInf},
       {0.0714285714285714, 0.0714285714285714, -1.46523379268552, -1.46523379268552, 0, 1.46523379268552},
       {0.0833333333333333, 0.0833333333333333, -1.38299412710064, -1.38299412710064, 0, 1.38299412710064}}}},
    {{6, 6, 6, 6},
     {{{1, 1, kInf, kInf, kNaN, -kInf},
       {0.928571428571429, 0.928571428571429, 1.46523379268552, 1.46523379268552, 0, -1.46523379268552},
       {0.916666666666667, 0.916666666666667, 1.38299412710064, 1.38299412710064, 0, -1.38299412710064}}}},
    {{18, 15, 18, 4},
     {{{0.833333333333333, 0.222222222222222, 0.967421566101701, -0.764709673786387, 1.73213123988809,
        -0.101355946157657},
       {0.815789473684211, 0.236842105263158, 0.899434907667234, -0.716497500177991, 1.61593240784523,
        -0.0914687037446212},
       {0.833333333333333, 0.222222222222222, 0.967421566101701, -0.764709673786387, 1.73213123988809,
        -0.101355946157657}}}},
    {{200, 150, 200, 30},
     {{{0.75, 0.15, 0.674489750196082, -1.03643338949379, 1.71092313968987, 0.180971819648854},
       {0.748756218905473, 0.151741293532338, 0.670580886297182, -1.02899380267607, 1.69957468897326,
        0.179206458189446},
       {0.75, 0.15, 0.674489750196082, -1.03643338949379, 1.71092313968987, 0.180971819648854}}}},
    {{36, 36, 36, 5},
     {{{1, 0.138888888888889, kInf, -1.08532490807676, kInf, -kInf},
       {0.986486486486487, 0.148648648648649, 2.21112724108533, -1.04224674183241, 3.25337398291774, -0.58444024962646},
       {0.986111111111111, 0.138888888888889, 2.20041058121003, -1.08532490807676, 3.28573548928679,
        -0.557542836566637}}}},
    {{6, 5, 6, 0},
     {{{0.833333333333333, 0, 0.967421566101701, -kInf, kInf, kInf},
       {0.785714285714286, 0.0714285714285714, 0.791638607743375, -1.46523379268552, 2.2568724004289,
        0.336797592471074},
       {0.833333333333333, 0.0833333333333333, 0.967421566101701, -1.38299412710064, 2.35041569320234,
        0.207786280499469}}}},
};

TEST_CASE("yes-no rates, z scores, d' and criterion agree with R under every correction", "[analysis]") {
  for (const Case& one : kReference) {
    std::size_t place = 0;
    for (const Correction correction : {Correction::none, Correction::loglinear, Correction::half}) {
      CAPTURE(one.counts.n_diff, one.counts.hits, one.counts.n_same, one.counts.false_alarms, to_string(correction));
      const Expected& expected = one.by_correction[place++];
      const YesNo found = yes_no(one.counts, correction);
      CHECK(found.correction == correction);
      CHECK(agrees(found.hit_rate, expected.hit_rate));
      CHECK(agrees(found.false_alarm_rate, expected.false_alarm_rate));
      CHECK(agrees(found.z_hit, expected.z_hit));
      CHECK(agrees(found.z_false_alarm, expected.z_false_alarm));
      CHECK(agrees(found.dprime, expected.dprime));
      CHECK(agrees(found.criterion, expected.criterion));
      CHECK(found.raw_hit_rate == Approx(static_cast<double>(one.counts.hits) / one.counts.n_diff));
    }
  }
}

TEST_CASE("a row without one class is missing, and never a pseudo-value", "[analysis]") {
  for (const Counts& counts : {Counts{12, 7, 0, 0}, Counts{0, 0, 12, 3}, Counts{}}) {
    for (const Correction correction : {Correction::none, Correction::loglinear, Correction::half}) {
      const YesNo found = yes_no(counts, correction);
      CHECK(found.status == RateStatus::missing);
      for (const double value : {found.raw_hit_rate, found.raw_false_alarm_rate, found.hit_rate, found.false_alarm_rate,
                                 found.z_hit, found.z_false_alarm, found.dprime, found.criterion})
        CHECK(std::isnan(value));
    }
  }
}

TEST_CASE("one and the same answer throughout is no information, with the arithmetic of the corrected rates",
          "[analysis]") {
  for (const Counts& counts : {Counts{6, 0, 6, 0}, Counts{6, 6, 6, 6}}) {
    CHECK(yes_no(counts, Correction::loglinear).status == RateStatus::no_information);
    CHECK(yes_no(counts, Correction::loglinear).dprime == 0);
    CHECK(yes_no(counts, Correction::half).dprime == 0);
    CHECK(yes_no(counts, Correction::none).status == RateStatus::no_information);
    CHECK(std::isnan(yes_no(counts, Correction::none).dprime));
  }
  CHECK(yes_no({6, 6, 6, 0}, Correction::none).status == RateStatus::ok);
  CHECK(yes_no({6, 0, 6, 6}, Correction::none).dprime == -kInf);
}

TEST_CASE("corrections touch what they say and nothing else", "[analysis]") {
  CHECK(corrected_rate(3, 6, Correction::none) == 0.5);
  CHECK(corrected_rate(3, 6, Correction::half) == 0.5);
  CHECK(corrected_rate(0, 6, Correction::half) == Approx(1.0 / 12));
  CHECK(corrected_rate(6, 6, Correction::half) == Approx(11.0 / 12));
  CHECK(corrected_rate(2, 6, Correction::loglinear) == Approx(2.5 / 7));
  for (const Correction correction : {Correction::none, Correction::loglinear, Correction::half})
    CHECK(correction_from(to_string(correction)) == correction);
  CHECK_FALSE(correction_from("log-linear").has_value());
}

TEST_CASE("normal quantile and distribution are inverses, with their edges", "[analysis]") {
  // R 4.2.2: qnorm(0.975), qnorm(1e-10), pnorm(-8).
  CHECK(normal_quantile(0.975) == Approx(1.95996398454005).epsilon(1e-14));
  CHECK(normal_quantile(1e-10) == Approx(-6.36134090240406).epsilon(1e-14));
  CHECK(normal_cdf(-8) == Approx(6.22096057427178e-16).epsilon(1e-13));
  CHECK(normal_quantile(0) == -kInf);
  CHECK(normal_quantile(1) == kInf);
  CHECK(std::isnan(normal_quantile(-0.1)));
  CHECK(std::isnan(normal_quantile(kNaN)));
  for (double p = 0.001; p < 1; p += 0.001) CHECK(normal_cdf(normal_quantile(p)) == Approx(p).epsilon(1e-13));
}

}  // namespace
}  // namespace jnd
