// Shipped device and profiles, and what their readers say of mistakes.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <unistd.h>

#include "devices/participants/simulated_participant.h"
#include "protocols/input/input_error.h"
#include "protocols/planning/planned_precision.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() / ("jnd_profile_" + std::to_string(::getpid()) + ".json")) {
    std::ofstream(path_) << text;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string complaint(const std::string& text) {
  const TemporaryFile file(text);
  try {
    (void)load_profile(file.path());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("the shipped device has the paper's limits") {
  const DeviceSpec spec = rrs3_spec();
  CHECK(spec.name == "rrs3");
  CHECK(spec.max_force_n == 4.7);
  CHECK(spec.stroke_m == 0.015);
  CHECK(spec.max_roll_rad == Approx(std::numbers::pi / 5));
  CHECK(spec.max_pitch_rad == Approx(std::numbers::pi / 6));
  CHECK(spec.max_joint_speed_rad_per_s == Approx(std::numbers::pi / 3 / 0.1));
  CHECK(spec.min_vibration_g == 0.05);
  CHECK(spec.max_vibration_g == 1);
  CHECK(spec.min_vibration_hz == 50);
  CHECK(spec.max_vibration_hz == 240);
  CHECK(spec.max_stiffness >= 900);
  CHECK(spec.bd_m == Approx(2 * std::sqrt(3.0) * spec.bh_m));
}

TEST_CASE("shipped profiles hold the published calibration") {
  const ParticipantProfile magnitude = shipped_profile("chinello2017");
  CHECK(magnitude.strategy == ParticipantProfile::Strategy::magnitude);
  CHECK(magnitude.sigma_force_n_per_m == 283.5);
  CHECK(magnitude.sigma_vibration_n_per_m == 351);
  CHECK(magnitude.criterion_n_per_m == 150);
  CHECK(magnitude.criterion_sigmas == 0);
  CHECK(magnitude.lapse_rate == 0);
  CHECK(magnitude.drift_per_trial == 0);
  CHECK(magnitude.spread_cv == 0);
  CHECK(magnitude.sha256.size() == 64);
  const ParticipantProfile differencing = shipped_profile("chinello2017-differencing");
  CHECK(differencing.strategy == ParticipantProfile::Strategy::differencing);
  CHECK(differencing.sigma_force_n_per_m == 148.2);
  CHECK(differencing.sigma_vibration_n_per_m == 173.5);
  CHECK(differencing.criterion_sigmas == 2);
  const ParticipantProfile varied = shipped_profile("chinello2017-varied");
  CHECK(varied.spread_cv == 0.2);
  CHECK(varied.lapse_rate == 0.02);
  CHECK(varied.drift_per_trial > 0);
  CHECK(varied.sha256 != magnitude.sha256);
  for (const auto* profile : {&magnitude, &differencing, &varied}) {
    CHECK(profile->ratings.at("S").first == 6.7);
    CHECK(profile->ratings.at("V").first == 3.7);
    CHECK(profile->ratings.at("SV").first == 7.6);
  }
}

TEST_CASE("shipped profiles keep their Weber fractions at another reference") {
  StimulusSpec stimulus;
  stimulus.reference = 900;
  for (const char* name : {"chinello2017", "chinello2017-differencing", "chinello2017-varied", "kinaesthetic",
                           "chinello2017-experiment2"}) {
    CAPTURE(name);
    const ParticipantProfile profile = shipped_profile(name);
    stimulus.reference = 900;
    const ParticipantProfile published = at_reference(profile, stimulus);
    CHECK(published.sigma_force_n_per_m == profile.sigma_force_n_per_m);
    CHECK(published.sigma_vibration_n_per_m == profile.sigma_vibration_n_per_m);
    CHECK(published.criterion_n_per_m == profile.criterion_n_per_m);
    stimulus.reference = 450;
    const ParticipantProfile half = at_reference(profile, stimulus);
    CHECK(half.sigma_force_n_per_m == profile.sigma_force_n_per_m / 2);
    CHECK(half.sigma_vibration_n_per_m == profile.sigma_vibration_n_per_m / 2);
    CHECK(half.criterion_n_per_m == profile.criterion_n_per_m / 2);
    CHECK(half.criterion_sigmas == profile.criterion_sigmas);
  }
  ParticipantProfile absolute = shipped_profile("chinello2017");
  absolute.calibrated_at_n_per_m = 0;
  CHECK(at_reference(absolute, stimulus).sigma_force_n_per_m == 283.5);
}

TEST_CASE("planning assumes the JNDs of the simulated participants") {
  Protocol protocol;
  protocol.stimulus.reference = 450;
  for (const Cues cues : {Cues{true, false, false}, Cues{false, true, false}, Cues{true, true, false},
                          Cues{true, false, true}, Cues{false, false, true}}) {
    protocol.conditions = {{"c", "c", cues, true}};
    const ParticipantProfile profile =
        at_reference(shipped_profile(default_profile(protocol).c_str()), protocol.stimulus);
    double precision = 0;
    if (cues.force) precision += std::pow(profile.sigma_force_n_per_m, -2);
    if (cues.vibration) precision += std::pow(profile.sigma_vibration_n_per_m, -2);
    if (cues.kinaesthetic) precision += std::pow(profile.kinaesthetic_weber * 450, -2);
    CHECK(planned_jnd(protocol, "c").value == Approx(1 / std::sqrt(precision)).epsilon(1e-12));
  }
}

TEST_CASE("mistakes in a profile are named, all at once") {
  const std::string good = R"("format": 1, "name": "x", "title": "t", "strategy": "magnitude",
    "sigma_force_n_per_m": 100, "sigma_vibration_n_per_m": 100)";
  CHECK(complaint("{" + good + R"(, "criterion_n_per_m": 50})").empty());
  CHECK(complaint("{" + good + "}").find("criterion") != std::string::npos);
  CHECK(complaint("{" + good + R"(, "criterion_n_per_m": 50, "criterion_sigmas": 2})").find("both") !=
        std::string::npos);
  const std::string two = complaint("{" + good + R"(, "criterion_n_per_m": -1, "lapserate": 0.1})");
  CHECK(two.find("criterion_n_per_m") != std::string::npos);
  CHECK(two.find("lapse_rate") != std::string::npos);  // the nearest known name
  CHECK(complaint("{" + good + R"(, "criterion_n_per_m": 50, "ratings": {"S": {"mean": 5}}})").find("sd") !=
        std::string::npos);
  CHECK(complaint("{" + good + R"(, "criterion_n_per_m": 50, "hand": {"press_depth_m": 5}})").find("press_depth_m") !=
        std::string::npos);
  CHECK(complaint("{" + good).find(":") != std::string::npos);
  CHECK_THROWS_AS(load_profile("no/such/profile.json"), InputError);
}
