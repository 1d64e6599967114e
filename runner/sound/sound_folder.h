// A folder of this program's own, in which a player finds its sounds; it goes with its owner.
#pragma once

#include <filesystem>
#include <string>

#include "runner/sound/wave.h"

namespace jnd {

class SoundFolder {
 public:
  // Throws DeviceError where no temporary folder can be made.
  SoundFolder();
  ~SoundFolder();
  SoundFolder(const SoundFolder&) = delete;
  SoundFolder& operator=(const SoundFolder&) = delete;

  // As NAME.wav; returns its path. Throws DeviceError where there is no room.
  std::filesystem::path write(const std::string& name, const Wave& wave) const;

 private:
  std::filesystem::path path_;
};

}  // namespace jnd
