// What the tests of virtual objects share: a small random stream, random unions, the shipped objects, directions.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "devices/contact/god_object.h"
#include "devices/contact/object_json.h"
#include "devices/contact/virtual_object.h"

namespace jnd::testing {

// SplitMix64 (Steele, Lea and Flood 2014), to -1..1.
inline double random_share(std::uint64_t& state) {
  std::uint64_t z = state += 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-52 - 1;
}

// Each coordinate in -1..1.
inline Eigen::Vector3d random_vector(std::uint64_t& state) {
  const double x = random_share(state), y = random_share(state), z = random_share(state);
  return {x, y, z};
}

// One to three spheres and one to three capsules within 5 cm of the origin, mostly overlapping.
inline VirtualObject random_object(std::uint64_t& state) {
  VirtualObject object;
  const int spheres = 1 + static_cast<int>(1.4999 * (1 + random_share(state)));
  const int capsules = 1 + static_cast<int>(1.4999 * (1 + random_share(state)));
  for (int i = 0; i < spheres; ++i)
    object.spheres.push_back(
        {.centre_m = 0.03 * random_vector(state), .radius_m = 0.012 + 0.008 * random_share(state)});
  for (int i = 0; i < capsules; ++i)
    object.capsules.push_back({.a_m = 0.03 * random_vector(state),
                               .b_m = 0.03 * random_vector(state),
                               .radius_m = 0.010 + 0.007 * random_share(state)});
  return object;
}

inline VirtualObject shipped_object(const std::string& name) {
  return load_object(std::string(JND_SOURCE_DIR) + "/devices/objects/" + name + ".json").shape;
}

// A finger about to meet the object, coming from that side.
inline GodObject begun(const VirtualObject& object, const Eigen::Vector3d& from = Eigen::Vector3d::UnitX()) {
  GodObject god;
  god.begin(object, from);
  return god;
}

// Evenly spread unit vectors (a Fibonacci lattice).
inline std::vector<Eigen::Vector3d> directions(int count) {
  std::vector<Eigen::Vector3d> result;
  const double golden = M_PI * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z);
    result.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return result;
}

}  // namespace jnd::testing
