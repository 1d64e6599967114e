// A folder of this program's own, in which a player finds its sounds.
#pragma once

#include <filesystem>
#include <string>

#include "data/files/scratch_folder.h"
#include "runner/sound/wave.h"

namespace jnd {

class SoundFolder {
 public:
  // As NAME.wav; returns its path. Throws StorageError where there is no room.
  std::filesystem::path write(const std::string& name, const Wave& wave) const;

 private:
  ScratchFolder folder_{"sound"};  // throws StorageError where none can be made
};

}  // namespace jnd
