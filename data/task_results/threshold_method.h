// Which estimate a protocol registers, and the others to hold beside it.
#pragma once

#include <string>
#include <vector>

#include "analysis/detection/counts.h"
#include "analysis/thresholds/jnd.h"
#include "protocols/protocol.h"

namespace jnd {

struct ThresholdMethod {
  std::string model;  // of d': "yes-no", "differencing", "independent-observation"
  Correction correction = Correction::loglinear;
  JndMethod method = JndMethod::least_squares;
  bool operator==(const ThresholdMethod&) const = default;
};

// Throws StorageError where the plan's words are not known: a protocol of a newer program.
ThresholdMethod registered_method(const Protocol& protocol);

// Every way to a JND that the program has, the registered one first. Maximum likelihood works on the raw counts: its
// correction reads none.
std::vector<ThresholdMethod> all_methods(const ThresholdMethod& registered);

// "yes-no d' of loglinear rates, least_squares".
std::string describe(const ThresholdMethod& method);

}  // namespace jnd
