// Specifications of rigs for tests, with round numbers of their own.
#pragma once

#include <filesystem>
#include <string>

#include "protocols/rigs/rig_description.h"

namespace jnd::test {

// Texts of device files, and of a rig of two devices.
extern const char* const kRrs3Spec;
extern const char* const kMckibbenSpec;
extern const char* const kTwoDevicesSpec;

// A folder that is gone when the test is over.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  // Writes a file into it and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

DeviceSpec device_from(const std::string& text);
// What reading such a text complains of; empty: nothing.
std::string device_error(const std::string& text);
// "rrs3" (4.7 N, 2000 N/m, 15 mm), "mckibben" (20 N, 50 N/rad, 0.35..0.93 rad, 0.1 m) or "rrs3+mckibben" (both,
// 0.07 m).
RigSpec rig_named(const std::string& name);

}  // namespace jnd::test
