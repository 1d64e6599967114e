// No description of a device raises a limit above its model's hard one.
#include <cmath>

#include <fmt/format.h>

#include "protocols/input/input_error.h"
#include "protocols/rigs/device_models.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"
#include "tests/protocols/rigs.h"

using namespace jnd;
using namespace jnd::test;

TEST_CASE("a description that asks for more than the model's hard limit is refused, and says what is allowed") {
  const auto refused = [](const char* spec, const char* key, const char* before, const char* asked, const char* hard) {
    const std::string error =
        device_error(replaced(spec, fmt::format("\"{}\": {}", key, before), fmt::format("\"{}\": {}", key, asked)));
    CAPTURE(key, error);
    CHECK(error.find(fmt::format("$.limits.{}: {}", key, asked)) != std::string::npos);
    CHECK(error.find(fmt::format("ever given, {}", hard)) != std::string::npos);
    CHECK(error.find("never raise it") != std::string::npos);
  };
  refused(kRrs3Spec, "max_force_n", "4.7", "12", "4.7 N");
  refused(kRrs3Spec, "stroke_m", "0.015", "0.03", "0.015 m");
  refused(kRrs3Spec, "max_roll_rad", "0.628", "0.7", "0.628319 rad");
  refused(kRrs3Spec, "max_vibration_g", "1", "1.5", "1 g");
  refused(kMckibbenSpec, "max_force_n", "20", "31", "30 N");
  refused(kMckibbenSpec, "max_stiffness_n_per_rad", "50", "500", "50 N/rad");
}

TEST_CASE("a lower limit is anybody's to set; what is no limit is 0") {
  CHECK(device_error(replaced(kRrs3Spec, "\"max_force_n\": 4.7", "\"max_force_n\": 2")).empty());
  CHECK(limit_in_force(2, 4.7) == 2);
  CHECK(limit_in_force(12, 4.7) == 4.7);
  CHECK(limit_in_force(-1, 4.7) == 0);
  CHECK(limit_in_force(std::nan(""), 4.7) == 0);
  CHECK(limit_in_force(INFINITY, 4.7) == 4.7);
}
