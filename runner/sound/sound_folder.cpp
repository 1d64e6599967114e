#include "runner/sound/sound_folder.h"

#include <cerrno>
#include <fstream>

#include <fmt/format.h>

#include "data/log/storage_error.h"
#include "protocols/input/file_trouble.h"

namespace jnd {

std::filesystem::path SoundFolder::write(const std::string& name, const Wave& wave) const {
  std::filesystem::path file = folder_.path() / (name + ".wav");
  const std::string bytes = wav_bytes(wave);
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out)
    throw StorageError(fmt::format("the sound {} cannot be written: {}; or set TMPDIR to another folder", file.string(),
                                   file_trouble(file, errno, FileUse::write).text()));
  return file;
}

}  // namespace jnd
