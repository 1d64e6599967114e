#include "runner/sound/sound_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "devices/device_error.h"

namespace jnd {

SoundFolder::SoundFolder() {
  std::error_code error;
  std::string name = (std::filesystem::temp_directory_path(error) / "jnd-sound-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw DeviceError(
        fmt::format("sounds cannot be kept: no folder {}: {}; set TMPDIR to a folder that you may write to", name,
                    std::strerror(errno)));
  path_ = name;
}

SoundFolder::~SoundFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path SoundFolder::write(const std::string& name, const Wave& wave) const {
  std::filesystem::path file = path_ / (name + ".wav");
  const std::string bytes = wav_bytes(wave);
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out)
    throw DeviceError(
        fmt::format("the sound {} cannot be written; make room, or set TMPDIR to another folder", file.string()));
  return file;
}

}  // namespace jnd
