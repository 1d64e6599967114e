// What the tests of the McKibben finger share: its reference numbers and its angles.
#pragma once

#include <fstream>
#include <numbers>
#include <string>

#include <nlohmann/json.hpp>

#include "devices/mckibben/mckibben_model.h"
#include "tests/units.h"

namespace jnd::testing {

inline const MckibbenParameters kTable1;  // of the paper: the defaults

// Numbers of an independent numpy model; the file names its conventions.
inline const nlohmann::json& mckibben_reference() {
  static const nlohmann::json reference = [] {
    std::ifstream file(std::string(JND_SOURCE_DIR) + "/tests/devices/mckibben_reference.json");
    return nlohmann::json::parse(file);
  }();
  return reference;
}

inline MckibbenModel mckibben_model(const ForceGains& gains = {.kp = 0.28}, Tendon tendon = Tendon::bilateral) {
  return MckibbenModel(MckibbenParameters{}, tendon, gains);
}

inline double straight_rad() {
  static const double angle = MckibbenLinkage(MckibbenParameters{}).usable().min_rad;
  return angle;
}
inline double flexed_rad() {
  static const double angle = MckibbenLinkage(MckibbenParameters{}).usable().max_rad;
  return angle;
}

}  // namespace jnd::testing
