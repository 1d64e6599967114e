// All that the 3RRS model says of one pose, in one answer; and the platform's geometry from JSON.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "devices/rrs3/rrs3_kinematics.h"
#include "devices/rrs3/rrs3_statics.h"
#include "devices/rrs3/rrs3_workspace.h"
#include "protocols/input/json_document.h"

namespace jnd {

struct Rrs3ModelQuery {
  Rrs3Geometry geometry;
  Rrs3Coordinates coordinates;
  Wrench wrench = Wrench::Zero();     // platform -> finger at O1, N and N m
  double translational_n_per_m = 0;   // kS of (35)
  double rotational_n_m_per_rad = 0;  // kphi
};

// SI, frame S0; symbols as in rrs3_kinematics.h.
struct Rrs3ModelAnswer {
  double yaw = 0;
  Eigen::Vector3d p;
  Eigen::Matrix3d b, d;  // platform joints and elbows; a row a leg
  Eigen::Vector3d q;
  Eigen::Matrix3d j_chi;          // (22): q' = J chi
  Eigen::Matrix3d j_xi;           // dq / d(pz, roll, pitch)
  Eigen::Matrix<double, 6, 3> h;  // (17)
  Eigen::Vector3d tau;            // (26)
  Eigen::Matrix3d kq;             // (35)
  double cond = 0;                // of J, translation column times b
  double det_ux = 0;              // of (14)'s dependent block, columns vx, vy, wz, in m
  Rrs3SingularityDistances singularities;
};

// Empty where the pose is out of the legs' reach, beyond a quarter turn of tilt, or singular. Throws InputError where
// the geometry has a length that is not positive.
std::optional<Rrs3ModelAnswer> ask_rrs3_model(const Rrs3ModelQuery& query);

// A geometry as a JSON object, metres: {a, b, bh, bd, l1, l2, pz0} (pz0 may be missing: a pose does not need it), or
// {a_m, b_m, bh_m, bd_m, l1_m, l2_m, rest_z_m} as in specs/rrs3.json, or such a file's object, whose "geometry" is
// read. Throws InputError with every mistake and its JSON path; file is for messages.
Rrs3Geometry rrs3_geometry_from_json(const JsonNode& node, const std::string& file);

// The same from a file. Throws InputError where it cannot be read, too.
Rrs3Geometry load_rrs3_geometry(const std::filesystem::path& path);

}  // namespace jnd
