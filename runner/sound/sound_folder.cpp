#include "runner/sound/sound_folder.h"

#include <fstream>

#include <fmt/format.h>

#include "data/log/storage_error.h"

namespace jnd {

std::filesystem::path SoundFolder::write(const std::string& name, const Wave& wave) const {
  std::filesystem::path file = folder_.path() / (name + ".wav");
  const std::string bytes = wav_bytes(wave);
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out)
    throw StorageError(
        fmt::format("the sound {} cannot be written; make room, or set TMPDIR to another folder", file.string()));
  return file;
}

}  // namespace jnd
