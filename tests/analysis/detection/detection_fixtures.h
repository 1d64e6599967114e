// Counts with their reference numbers, and random counts, for the tests of signal detection.
//
// signal_detection_reference.json: R 4.2.2 and sensR 1.5-3 (differencing_ml_raw), cross-checked by a second
// implementation; 15 significant digits, infinities and NaN as strings.
#pragma once

#include <cmath>
#include <string>

#include <nlohmann/json.hpp>
#include <rapidcheck.h>

#include "analysis/detection/counts.h"
#include "analysis/numerics/special_values.h"
#include "analysis/selftest/reference_numbers.h"
#include "tests/catch.h"

namespace jnd::testing {

inline const nlohmann::json& detection_reference() {
  return reference_numbers("signal_detection");
}

inline Counts counts_of(const nlohmann::json& one) {
  return {one.at("n_diff"), one.at("hits"), one.at("n_same"), one.at("false_alarms")};
}

// Equal, both infinite alike, both undefined, or within an absolute tolerance.
inline bool agrees(double ours, double reference, double tolerance) {
  if (std::isnan(reference)) return std::isnan(ours);
  return ours == reference || std::abs(ours - reference) <= tolerance;
}
inline bool agrees(double ours, const nlohmann::json& reference, double tolerance) {
  return agrees(ours, reference_number(reference), tolerance);
}

// Runs check on every case of the reference that has trials of both classes.
template <typename Check>
void with_each_reference(Check&& check) {
  int cases = 0;
  for (const nlohmann::json& one : detection_reference()) {
    if (one.contains("status")) continue;  // "missing"
    CAPTURE(one.at("id").get<std::string>());
    check(counts_of(one), one);
    ++cases;
  }
  CHECK(cases == 10);
}

// Of 1 to 60 trials a class, with the extreme counts more often than their share.
inline Counts some_counts() {
  const auto of = [](int n) {
    switch (*rc::gen::inRange(0, 6)) {
      case 0:
        return 0;
      case 1:
        return n;
      default:
        return *rc::gen::inRange(0, n + 1);
    }
  };
  Counts counts;
  counts.n_diff = *rc::gen::inRange(1, 61);
  counts.hits = of(counts.n_diff);
  counts.n_same = *rc::gen::inRange(1, 61);
  counts.false_alarms = of(counts.n_same);
  return counts;
}

// The same observer with the two answers exchanged, and with the two classes exchanged.
inline Counts answers_exchanged(const Counts& counts) {
  return {counts.n_diff, counts.n_diff - counts.hits, counts.n_same, counts.n_same - counts.false_alarms};
}
inline Counts classes_exchanged(const Counts& counts) {
  return {counts.n_same, counts.false_alarms, counts.n_diff, counts.hits};
}

}  // namespace jnd::testing
