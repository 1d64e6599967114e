// The shipped platform, for the tests of its mathematics.
#pragma once

#include "devices/rrs3/rrs3_kinematics.h"
#include "devices/rrs3/rrs3_platform.h"
#include "tests/devices/device_fixtures.h"

namespace jnd::testing {

inline Rrs3Kinematics default_device() {
  return Rrs3Kinematics(geometry_of(rrs3_spec()));
}

}  // namespace jnd::testing
