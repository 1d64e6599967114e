// The 3RRS model's questions and answers as JSON, for one pose and for many.
#pragma once

#include <optional>
#include <string>

#include "devices/rrs3/rrs3_model.h"
#include "runner/device_commands/device_output.h"
#include "runner/terminal/json_output.h"

namespace jnd {

// {yaw, p, b, d, q, j_chi, j_xi, h, tau, kq, cond, det_ux}, legs by rows.
nlohmann::ordered_json rrs3_answer_json(const Rrs3ModelAnswer& answer);

// Throws InputError where a stiffness is negative or a wrench so large that it is a slip of units.
void check_rrs3_query(const Rrs3ModelQuery& query);

struct Rrs3ModelOptions {
  std::string pose;      // "PZ,ROLL,PITCH"
  std::string geometry;  // a file; empty: the shipped device
  std::string wrench;    // "FX,FY,FZ,MX,MY,MZ"; empty: none
  double stiffness_n_per_m = 0;
  std::optional<double> rotational_n_m_per_rad;  // where not given, the stiffness in N mm/rad
  std::string batch;                             // a file of JSON lines, "-": standard input
  bool map = false;
  std::optional<double> height_m;  // of the map; the rest height where not given
  DeviceOutput output;
};
// The answers to options.batch, a file of JSON lines. Returns the exit code.
int answer_rrs3_batch(const Rrs3ModelOptions& options);

}  // namespace jnd
