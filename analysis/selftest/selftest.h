// `jnd calc selftest`: published and independently computed numbers, recomputed on the user's own machine.
#pragma once

#include <cmath>
#include <string>
#include <vector>

namespace jnd {

// One quantity over all its reference cases.
struct SelftestQuantity {
  std::string name;  // such as "differencing d'"
  double tolerance = 0;
  int cases = 0;
  double largest_difference = 0;  // absolute, or relative where the name says so; inf where one was not to be had

  // ours and reference equal infinities count as no difference, and so do two NaN.
  void absolute(double ours, double reference) { add(ours, reference, 1); }
  void relative(double ours, double reference) { add(ours, reference, std::abs(reference)); }
  bool ok() const noexcept { return cases > 0 && largest_difference <= tolerance; }

 private:
  void add(double ours, double reference, double scale) {
    ++cases;
    if (ours == reference || (std::isnan(ours) && std::isnan(reference))) return;
    double difference = std::abs(ours - reference) / (scale > 0 ? scale : 1);
    if (!(difference >= 0)) difference = HUGE_VAL;
    if (difference > largest_difference) largest_difference = difference;
  }
};

// Every quantity that the program carries references of, recomputed: signal detection, tasks with a right answer, ratings,
// choices between two intervals, scaling, thresholds, group statistics, psychometric functions, adaptive procedures,
// the hierarchical model.
std::vector<SelftestQuantity> selftest();

}  // namespace jnd
