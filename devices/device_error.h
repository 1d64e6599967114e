// A device, or the machine that drives it, cannot do what was asked. The program exits with 4.
#pragma once

#include <stdexcept>

namespace jnd {

class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace jnd
