// Protocols held against what their rig can do.
#include "protocols/rigs/device_lint.h"

#include <cmath>
#include <numbers>

#include "protocols/random_stream.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"
#include "tests/protocols/rigs.h"

using namespace jnd;
using namespace jnd::test;

namespace {

Protocol shipped(const std::string& name = "chinello2017") {
  return load_protocol(protocols_folder() / (name + ".json"));
}

DeviceLint lint_of(const Protocol& protocol) {
  return lint_against_device(protocol, rig_named(protocol.rig.device), "p.json");
}

bool told(const std::vector<Diagnostic>& diagnostics, const std::string& path, const std::string& part) {
  for (const Diagnostic& diagnostic : diagnostics)
    if (diagnostic.path == path && diagnostic.message.find(part) != std::string::npos) return true;
  std::string all;
  for (const Diagnostic& diagnostic : diagnostics) all += to_text(diagnostic) + "\n";
  WARN("looked for " << path << ": " << part << " in\n" << all);
  return false;
}

}  // namespace

TEST_CASE("depths and shares of saturation of the published design") {
  const Protocol protocol = shipped();
  const DeviceSpec spec = device_from(kRrs3Spec);
  CHECK(depth_at_force_limit(500, spec) == Approx(0.00940).epsilon(1e-3));
  CHECK(depth_at_force_limit(600, spec) == Approx(0.00783).epsilon(1e-3));
  CHECK(depth_at_force_limit(700, spec) == Approx(0.00671).epsilon(1e-3));
  CHECK(depth_at_force_limit(900, spec) == Approx(0.00522).epsilon(1e-3));
  // Six presses of 5 +- 1 mm: 1 - Phi(0.222)^6, computed with an independent numpy model.
  CHECK(expected_saturated_intervals(900, protocol, spec) == Approx(0.959).margin(0.002));
  CHECK(expected_saturated_intervals(500, protocol, spec) < 1e-3);
  CHECK(burst_amplitude_g(900) == Approx(1.0));
}

TEST_CASE("the share of contact time that saturates is that of half-sine presses") {
  const Protocol protocol = shipped();
  const DeviceSpec spec = device_from(kRrs3Spec);
  RandomStream random(7, 0, "presses", 0);
  for (const double stiffness : {700.0, 900.0, 1500.0}) {
    int deeper = 0;
    constexpr int kSamples = 400000;
    for (int i = 0; i < kSamples; ++i) {
      const double deepest = 0.005 + 0.001 * random.normal();
      const double depth = deepest * std::sin(std::numbers::pi * random.uniform());
      if (stiffness * depth > spec.max_force_n) ++deeper;
    }
    CHECK(expected_saturated_share(stiffness, protocol, spec) == Approx(double(deeper) / kSamples).margin(0.003));
  }
}

TEST_CASE("a joint's presses: a fifth of the angle, one in two seconds, one finger") {
  const Protocol protocol = shipped("mckibben-stiffness");
  const DeviceSpec spec = device_from(kMckibbenSpec);
  CHECK(depth_at_force_limit(40, spec) == Approx(0.5));
  CHECK(expected_press_sd(protocol) == Approx(0.05));
  // 80 N/rad meets 20 N at 0.25 rad, the mean of both presses of four seconds: 1 - 0.5^2.
  CHECK(expected_saturated_intervals(80, protocol, spec) == Approx(0.75));
}

TEST_CASE("the published design: saturation is a warning, in its place and with numbers") {
  const DeviceLint lint = lint_of(shipped());
  CHECK(lint.errors.empty());
  REQUIRE(lint.warnings.size() == 1);
  CHECK(lint.warnings[0].path == "$.stimulus.expected_press_m");
  CHECK(lint.warnings[0].line > 1);
  CHECK(lint.warnings[0].message.find("presses of 5.00 mm ± 1.00 mm reach the rrs3's limit of 4.7 N") == 0);
  CHECK(lint.warnings[0].message.find("900 N/m at 5.22 mm, in 96 % of intervals and 11.8 % of contact time") !=
        std::string::npos);
}

TEST_CASE("repeating saturated trials is told to bias the study") {
  Protocol protocol = shipped();
  protocol.stimulus.on_saturation = OnSaturation::repeat;
  const DeviceLint lint = lint_of(protocol);
  REQUIRE(lint.warnings.size() == 1);
  CHECK(lint.warnings[0].suggestion.find("bias the study") != std::string::npos);
}

TEST_CASE("shallow presses and soft spheres raise nothing") {
  Protocol protocol = shipped();
  protocol.stimulus.expected_press = 0.002;
  const DeviceLint lint = lint_of(protocol);
  CHECK(lint.errors.empty());
  CHECK(lint.warnings.empty());
}

TEST_CASE("a pair whose vibrations clamp to one amplitude is an error where only vibration tells") {
  Protocol protocol = shipped();
  protocol.series[2].pair = {1200, 900};
  const DeviceLint lint = lint_of(protocol);
  REQUIRE(lint.errors.size() == 1);
  CHECK(told(lint.errors, "$.series[2].pair",
             "in condition V both spheres vibrate with 1 g (1.200 and 1.000 g asked): they would feel the same"));
  CHECK(told(lint.warnings, "$.series", "1200 N/m asks 1.200 g and gets 1 g"));

  protocol.conditions.erase(protocol.conditions.begin() + 1);  // without V, the force tells them apart
  CHECK(lint_of(protocol).errors.empty());
}

TEST_CASE("stiffnesses beyond the device are errors, as are pairs that only meet the force limit") {
  Protocol protocol = shipped();
  protocol.series[0].pair = {2500, 900};
  const DeviceLint lint = lint_of(protocol);
  CHECK(told(lint.errors, "$.series[0].pair[0]", "2500 N/m is more than the rrs3 renders stably, 2000 N/m"));

  RigSpec strong = rig_named("rrs3");
  strong.devices[0].max_stiffness = 20000;
  protocol.series[0].pair = {6000, 4000};
  const DeviceLint alike = lint_against_device(protocol, strong, "p.json");
  CHECK(told(alike.errors, "$.series[0].pair", "in condition S both spheres reach the force limit of 4.7 N"));
  // Both cues are limited, so that two of them tell no more than one.
  CHECK(told(alike.errors, "$.series[0].pair", "in condition SV both spheres reach the force limit"));
  CHECK(told(alike.errors, "$.series[0].pair", "press and vibrate with 1 g"));
  // 6000 N/m at 1 kHz relies on 6 N s/m; a finger is assumed to have 2.
  CHECK(told(alike.warnings, "$.series", "6000 N/m with a viscosity of 0 N s/m needs 6 N s/m"));
}

TEST_CASE("position control is told with what becomes of the differences") {
  Protocol protocol = shipped();
  for (const RenderingMode mode : {RenderingMode::pd, RenderingMode::pd_literal}) {
    protocol.rig.mode = mode;
    const DeviceLint lint = lint_of(protocol);
    CHECK(told(lint.warnings, "$.rig.mode", "500 and 900 N/m become 333 and 474"));
    CHECK(told(lint.warnings, "$.rig.mode", "differences of 200 to 400 N/m shrink to 62 to 140"));
  }
  protocol.series.resize(1);
  CHECK(told(lint_of(protocol).warnings, "$.rig.mode", "a difference of 400 N/m shrinks to 140"));
  protocol.conditions = {protocol.conditions[1]};  // vibration alone has no mode
  CHECK(lint_of(protocol).warnings.empty());
}

TEST_CASE("a platform that cannot follow the pulp is told") {
  Protocol protocol = shipped();
  RigSpec rig = rig_named("rrs3");
  // 4.5 N at 5 mm press the platform 4.5 mm into the pulp, 4.7 N and deeper presses 4.7 mm.
  rig.devices[0].highest_travel = rig.devices[0].rest_z_m + 0.0046;
  CHECK(told(lint_against_device(protocol, rig, "p.json").warnings, "$.stimulus.expected_press_m",
             "goes 4.70 mm into a finger pulp of 1000 N/m (assumed), but it can go 4.60 mm only"));
  rig.devices[0].highest_travel = rig.devices[0].rest_z_m + 0.004;
  CHECK(told(lint_against_device(protocol, rig, "p.json").errors, "$.stimulus.expected_press_m",
             "goes 4.50 mm into a finger pulp"));
  protocol.rig.mode = RenderingMode::pd;  // 474 N/m of 900: 2.4 mm, and 3.3 mm at the deepest
  CHECK(lint_against_device(protocol, rig, "p.json").errors.empty());

  protocol = shipped();
  protocol.stimulus.expected_press = 0.02;
  CHECK(told(lint_of(protocol).warnings, "$.stimulus.expected_press_m",
             "presses of 20.00 mm are deeper than the rrs3's stroke of 15.00 mm"));
}

TEST_CASE("viscosity beyond what the finger keeps passive at 1 kHz is an error with the numbers") {
  CHECK(needed_damping(2000, 0) == Approx(2));
  Protocol protocol = shipped();
  protocol.stimulus.damping_n_s_per_m = 1.1;  // 0.9 of the stiffness and 1.1: 2 N s/m, just passive
  CHECK(lint_of(protocol).errors.empty());
  protocol.stimulus.damping_n_s_per_m = 1.5;
  const DeviceLint lint = lint_of(protocol);
  CHECK(told(lint.errors, "$.stimulus.viscosity_n_s_per_m",
             "900 N/m with a viscosity of 1.5 N s/m needs 2.4 N s/m of the finger's own damping"));
  CHECK(lint.errors.at(0).suggestion == "at most 1.1 N s/m with this stiffness");
  CHECK(lint.errors.at(0).line > 1);
  protocol.conditions = {protocol.conditions[1]};  // vibration alone has no viscosity
  CHECK(lint_of(protocol).errors.empty());

  Protocol joint = shipped("mckibben-stiffness");
  joint.stimulus.damping_n_s_per_m = 0.16;  // 0.037 of 37 N/rad and 0.16: below 2 N s/m at 0.1 m, 0.2 N s/rad
  CHECK(lint_of(joint).errors.empty());
  joint.stimulus.damping_n_s_per_m = 0.17;
  CHECK(told(lint_of(joint).errors, "$.stimulus.viscosity_n_s_per_rad",
             "37 N/rad with a viscosity of 0.17 N s/rad needs 0.207 N s/rad"));
}

TEST_CASE("a joint's stiffness, force and range are held against the protocol") {
  const Protocol fine = shipped("mckibben-stiffness");
  CHECK(lint_of(fine).errors.empty());
  CHECK(lint_of(fine).warnings.empty());

  Protocol protocol = fine;
  protocol.series[1].pair = {60, 25};
  CHECK(told(lint_of(protocol).errors, "$.series[1].pair[0]", "60 N/rad is more than the mckibben renders, 50 N/rad"));

  RigSpec weak = rig_named("mckibben");
  weak.devices[0].max_force_n = 8;  // 37 N/rad at 0.216 rad, 25 N/rad at 0.320
  const DeviceLint saturated = lint_against_device(fine, weak, "p.json");
  CHECK(saturated.errors.empty());
  CHECK(told(saturated.warnings, "$.stimulus.expected_press_rad",
             "presses of 0.250 rad ± 0.050 rad reach the mckibben's limit of 8 N"));
  CHECK(told(saturated.warnings, "$.stimulus.expected_press_rad", "37 N/rad at 0.216 rad, in 94 % of intervals"));
  weak.devices[0].max_force_n = 1.5;  // 25 N/rad at 0.06 rad, within a quarter of 0.25
  CHECK(told(lint_against_device(fine, weak, "p.json").errors, "$.series[0].pair",
             "in condition K both objects reach the force limit of 1.5 N of the mckibben within 0.060 rad of a 0.250 "
             "rad press"));

  protocol = fine;
  protocol.stimulus.expected_press = 0.4;  // 0.1 + 0.4 + 2 * 0.08 is beyond 0.58
  const DeviceLint stops = lint_of(protocol);
  CHECK(stops.errors.empty());
  CHECK(told(stops.warnings, "$.stimulus.expected_press_rad", "15.9 % of presses of 0.400 rad"));
  protocol.stimulus.expected_press = 0.5;
  CHECK(told(lint_of(protocol).errors, "$.stimulus.expected_press_rad",
             "presses of 0.500 rad from a contact at 0.1 rad end at 0.600 rad: the mckibben flexes by 0.580 rad"));
  RigSpec short_range = rig_named("mckibben");
  short_range.devices[0].highest_travel = 0.44;
  CHECK(told(lint_against_device(fine, short_range, "p.json").errors, "$.rig.contact_flexion_rad",
             "an object 0.1 rad from straight is never met"));
}

TEST_CASE("two devices on a finger: a contact in N/m is named in N/rad at the joint too") {
  const Protocol fine = shipped("cutaneous-kinaesthetic");
  const DeviceLint lint = lint_of(fine);
  CHECK(lint.errors.empty());
  REQUIRE(lint.warnings.size() == 1);  // the pulp's limit; the joint's 20 N are far away
  CHECK(told(lint.warnings, "$.stimulus.expected_press_m", "reach the rrs3's limit of 4.7 N"));

  Protocol protocol = fine;
  protocol.series[0].pair = {1200, 900};
  CHECK(told(
      lint_of(protocol).errors, "$.series[0].pair[0]",
      "1200 N/m, 0.07 m from the joint, asks 58.8 N/rad at the device's own lever arm of 0.1 m, which is more than "
      "the mckibben renders, 50 N/rad"));
  Protocol cutaneous = protocol;
  cutaneous.conditions = {fine.conditions[0]};  // the joint renders nothing, so its limit is not asked
  CHECK(lint_of(cutaneous).errors.empty());

  protocol = fine;
  protocol.stimulus.expected_press = 0.035;  // 0.5 rad
  CHECK(told(lint_of(protocol).errors, "$.stimulus.expected_press_m",
             "presses of 35.00 mm (0.500 rad at a lever arm of 0.07 m) from a contact at 0.1 rad end at 0.600 rad"));
  protocol = fine;
  protocol.rig.mode = RenderingMode::pd;
  CHECK(told(lint_of(protocol).warnings, "$.rig.mode", "500 and 900 N/m become 333 and 474"));

  // The joint gives 0.07 / 0.1 of the contact's force: 900 N/m reach 2 N at 2 / 630 m.
  RigSpec weak_joint = rig_named("rrs3+mckibben");
  weak_joint.devices[1].max_force_n = 2;
  CHECK(told(lint_against_device(fine, weak_joint, "p.json").warnings, "$.stimulus.expected_press_m",
             "900 N/m at 3.17 mm"));

  // One cue that tells the pair apart is enough: the joint's force here, not the pulp's.
  RigSpec rig = rig_named("rrs3+mckibben");
  rig.devices[0].max_force_n = 0.4;
  const DeviceLint weak_pulp = lint_against_device(fine, rig, "p.json");
  CHECK(told(weak_pulp.errors, "$.series[0].pair", "in condition C both objects reach the force limit of 0.4 N"));
  for (const Diagnostic& error : weak_pulp.errors) CHECK(error.message.find("condition C both") != std::string::npos);
}

TEST_CASE("the shipped devices can do what the shipped protocols ask") {
  const std::filesystem::path specs = std::filesystem::path(JND_SOURCE_DIR) / "devices/specs";
  for (const auto& file : json_files(protocols_folder())) {
    CAPTURE(file.string());
    const Protocol protocol = load_protocol(file);
    if (!protocol.rig.built_in()) continue;
    const RigSpec rig = load_rig_spec(specs / (protocol.rig.device + ".json"));
    CHECK(rig.name == protocol.rig.device);
    const DeviceLint lint = lint_against_device(protocol, rig, file.string());
    for (const Diagnostic& error : lint.errors) CHECK(to_text(error) == "");
    // What remains to be told is the force limit of the 3RRS device.
    for (const Diagnostic& warning : lint.warnings) CHECK(warning.path == "$.stimulus.expected_press_m");
  }
}

TEST_CASE("taps need a device that vibrates") {
  Protocol protocol = shipped("mckibben-stiffness");
  CHECK(lint_of(protocol).errors.empty());
  protocol.timeline.interval_cues[1].kind = "tap";
  CHECK(told(lint_of(protocol).errors, "$.trial.cues.second.kind", "no device of this rig can tap"));
  protocol = shipped();
  protocol.timeline.interval_cues[1].kind = "tap";
  CHECK(lint_of(protocol).errors.empty());
}
