// The parts of the lint against a rig; used by device_lint*.cpp only.
#pragma once

#include <set>
#include <string>

#include "protocols/reading/protocol_reading.h"
#include "protocols/rigs/device_lint.h"

namespace jnd {

struct DeviceLinting {
  const Protocol& protocol;
  const RigSpec& rig;
  const std::string& file;
  JsonNode root;
  DeviceLint lint = {};

  void error(const std::string& path, std::string message, std::string suggestion);
  void warn(const std::string& path, std::string message, std::string suggestion);

  bool any(bool Cues::*cue) const;       // does any condition have it?
  std::set<double> stiffnesses() const;  // of all series
  bool in_metres() const { return protocol.stimulus.unit == StiffnessUnit::n_per_m; }
  std::string_view unit() const { return to_string(protocol.stimulus.unit); }
  std::string depth(double value) const;  // "5.22 mm" or "0.240 rad"
  std::string press_path() const;         // of the expected press
  // Where the stiffnesses of a series are written; beside an adaptive procedure, which makes its own series: its clamp.
  std::string series_path() const;
  std::string pair_path(std::size_t series) const;
  std::string stiffness_path(std::size_t series, std::size_t of_pair) const;
  std::string objects(bool plural) const;  // "spheres" where they are spheres

  // Force asked of a device per force of the contact. A McKibben finger gives the torque of a contact, k L x, out of
  // its own lever arm l: L / l.
  double force_gain(const DeviceSpec& spec) const {
    return in_metres() && spec.model == DeviceModel::mckibben ? rig.lever_arm_m / spec.lever_arm_m : 1;
  }
  // In the McKibben finger's own N/rad: a contact of k N/m is k L^2 / l.
  double at_joint(double stiffness, const DeviceSpec& joint) const {
    return in_metres() ? stiffness * rig.lever_arm_m * force_gain(joint) : stiffness;
  }
  // A depth as an angle of the joint.
  double angle_of(double depth) const { return in_metres() ? depth / rig.lever_arm_m : depth; }
};

// device_lint_range.cpp: presses, objects and contacts that leave the devices' ranges or the loop's abilities.
void lint_travel(DeviceLinting& linting);
void lint_mode(DeviceLinting& linting);
void lint_sampled_contact(DeviceLinting& linting);

}  // namespace jnd
