// Every method of a threshold against independent numbers (jnd_reference.json: numpy model with two optimisers, glm of
// R 4.2.2), and single series against sensR 1.5-3.
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/numerics/special_values.h"
#include "analysis/selftest/reference_numbers.h"
#include "analysis/thresholds/jnd.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using json = nlohmann::json;

const json& cases() {
  return reference_numbers("jnd").at("cases");
}

// Equal, both undefined, or within a relative tolerance.
bool agrees(double ours, double reference, double tolerance) {
  if (std::isnan(reference)) return std::isnan(ours);
  return ours == reference || std::abs(ours - reference) <= tolerance * std::abs(reference);
}

std::vector<SeriesCounts> series_of(const json& one) {
  std::vector<SeriesCounts> series;
  for (const json& row : one.at("series")) series.push_back({row[0], {row[1], row[2], row[3], row[4]}});
  return series;
}

JndEstimate estimate(const json& one, std::string_view method) {
  return estimate_jnd(series_of(one), one.at("reference"), *jnd_method_from(method), Correction::loglinear);
}

TEST_CASE("closed forms of the JND agree with an independent model to 1e-10", "[analysis][jnd]") {
  for (const json& one : cases()) {
    CAPTURE(one.at("id"));
    for (const char* method : {"least_squares", "weighted", "inverse_mean_slope", "mean_of_ratios"}) {
      CAPTURE(method);
      const JndEstimate found = estimate(one, method);
      const json& expected = one.at(method);
      // The reference prints a mean over a pole; the product refuses it.
      const double jnd = expected.value("defined", true) ? reference_number(expected.at("jnd")) : std::nan("");
      CHECK(to_string(found.method) == method);
      CHECK(agrees(found.jnd, jnd, 1e-10));
      CHECK(found.status == (std::isnan(jnd) ? JndStatus::no_sensitivity : JndStatus::ok));
      if (expected.contains("slope")) CHECK(agrees(found.slope, reference_number(expected.at("slope")), 1e-10));
      if (expected.contains("weber")) CHECK(agrees(found.weber, reference_number(expected.at("weber")), 1e-10));
      CHECK(std::isnan(found.ci_low));
      CHECK(std::isnan(found.ci_high));
      CHECK(std::isnan(found.log_likelihood));
    }
    std::size_t place = 0;
    for (const SeriesCounts& series : series_of(one))
      CHECK(
          agrees(std::sqrt(loglinear_variance(series.counts)), reference_number(one.at("se_dprime")[place++]), 1e-10));
  }
}

TEST_CASE("joint maximum likelihood agrees with an independent model, slope 1e-6, bounds 1e-5", "[analysis][jnd]") {
  for (const json& one : cases()) {
    CAPTURE(one.at("id"));
    for (const char* method :
         {"ml_yes_no_common", "ml_yes_no_series", "ml_differencing_common", "ml_differencing_series"}) {
      CAPTURE(method);
      const JndEstimate found = estimate(one, method);
      const json& expected = one.at(method);
      CHECK(to_string(found.status) == expected.at("status").get<std::string>());
      CHECK(agrees(found.slope, reference_number(expected.at("slope")), 1e-6));
      CHECK(agrees(found.jnd, reference_number(expected.at("jnd")), 1e-6));
      CHECK(agrees(found.slope_ci_low, reference_number(expected.at("slope_ci_low")), 1e-5));
      CHECK(agrees(found.slope_ci_high, reference_number(expected.at("slope_ci_high")), 1e-5));
      CHECK(agrees(found.ci_low, reference_number(expected.at("ci_low")), 1e-5));
      CHECK(agrees(found.ci_high, reference_number(expected.at("ci_high")), 1e-5));
      CHECK(std::abs(found.log_likelihood - reference_number(expected.at("log_likelihood"))) < 1e-10);
      // At the ceiling glm iterates towards infinity until it gives up; elsewhere it is another implementation.
      if (expected.contains("glm_slope") && found.status == JndStatus::ok)
        CHECK(agrees(found.slope, reference_number(expected.at("glm_slope")), 1e-6));
    }
  }
}

TEST_CASE("one series of difference 1 is the differencing d' of sensR, with its profile bounds", "[analysis][jnd]") {
  // sensR 1.5-3, samediff and its profile: counts, d', bounds.
  struct Single {
    Counts counts;
    double dprime, low, high;
  };
  const std::vector<Single> singles = {
      {{6, 5, 6, 1}, 3.32345442597307, 1.1596240043235, 5.74056421492212},
      {{6, 6, 6, 2}, kInf, 1.88757008011582, kInf},
      {{6, 3, 6, 3}, 0, 0, 2.68316652494473},
      {{6, 2, 6, 4}, 0, 0, 1.88306249335704},
      {{18, 15, 18, 4}, 3.09253182304492, 1.89905433470809, 4.37200056029212},
      {{200, 150, 200, 30}, 2.98883001526532, 2.62815352150113, 3.35905128692991},
      {{36, 36, 36, 5}, kInf, 4.27584980861053, kInf},
      {{6, 5, 6, 0}, kInf, 2.27112678695645, kInf},
  };
  for (const Single& one : singles) {
    CAPTURE(one.counts.hits, one.counts.n_diff, one.counts.false_alarms);
    for (const JndMethod method : {JndMethod::ml_differencing_series, JndMethod::ml_differencing_common}) {
      const std::vector<SeriesCounts> series = {{1, one.counts}};
      const JndEstimate found = estimate_jnd(series, 900, method, Correction::none);
      CHECK(agrees(found.slope, one.dprime, 1e-8));
      CHECK(agrees(found.slope_ci_low, one.low, 1e-6));
      CHECK(agrees(found.slope_ci_high, one.high, 1e-6));
    }
  }
}

}  // namespace
}  // namespace jnd
