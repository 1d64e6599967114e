#include "data/copies/damaged_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "analysis/numerics/stop_request.h"
#include "data/files/descriptor.h"
#include "data/files/draft.h"
#include "data/files/study_image.h"
#include "data/log/storage_error.h"
#include "protocols/input/file_trouble.h"

namespace jnd {

namespace {

constexpr std::size_t kPiece = 4096;  // what a disk gives or does not give

bool possible(std::size_t page_size) {
  return page_size >= 512 && page_size <= 65536 && (page_size & (page_size - 1)) == 0;
}

struct Descriptor {
  int value = -1;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

StorageError cannot_copy(const std::filesystem::path& folder, int error) {
  return StorageError(fmt::format("{}: a copy of the damaged file cannot be written: {}", folder.string(),
                                  file_trouble(folder / ".jnd-recover", error, FileUse::write).text()));
}

}  // namespace

std::uint32_t big_endian(Bytes bytes, std::size_t at, std::size_t length) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < length; ++i) value = value << 8U | bytes[at + i];
  return value;
}

PrivateCopy::PrivateCopy(const std::filesystem::path& file, const std::filesystem::path& folder) {
  // Without waiting: the opening of a named pipe would wait for a writer.
  const Descriptor from{::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
  if (from.value < 0) {
    if (errno == ENOENT) return;
    throw cannot_read(file, errno);
  }
  struct stat status {};
  if (::fstat(from.value, &status) != 0) throw cannot_read(file, errno);
  if (!S_ISREG(status.st_mode))
    throw StorageError(fmt::format("{}: is not a file; remove it and try again", file.string()));
  std::string name = (folder / ".jnd-recover-XXXXXX").string();
  const Descriptor to{::mkostemp(name.data(), O_CLOEXEC)};
  if (to.value < 0) throw cannot_copy(folder, errno);
  ::unlink(name.c_str());
  std::array<char, kPiece> piece{};
  for (off_t at = 0;;) {
    stop_if_requested();
    ssize_t got = ::pread(from.value, piece.data(), piece.size(), at);
    if (got == 0) break;
    if (got < 0) {
      if (errno != EIO) throw cannot_read(file, errno);
      const off_t end = ::lseek(from.value, 0, SEEK_END);
      if (end <= at) break;
      got = static_cast<ssize_t>(std::min<off_t>(end - at, static_cast<off_t>(piece.size())));
      piece.fill(0);
      unreadable_ += got;
    }
    if (const int error = write_all(to.value, {piece.data(), static_cast<std::size_t>(got)}); error != 0)
      throw cannot_copy(folder, error);
    at += got;
    size_ += static_cast<std::size_t>(got);
  }
  if (size_ == 0) return;
  void* mapped = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, to.value, 0);
  if (mapped == MAP_FAILED) throw cannot_read(file, errno);
  data_ = mapped;
}

PrivateCopy::~PrivateCopy() {
  if (data_ != nullptr) ::munmap(data_, size_);
}

std::vector<PageGeometry> geometries_of(Bytes file, Bytes log) {
  std::vector<PageGeometry> geometries;
  const auto add = [&](std::size_t page_size, std::size_t reserved) {
    if (!possible(page_size) || page_size - reserved < 480) return;
    const PageGeometry geometry{page_size, page_size - reserved};
    if (std::find(geometries.begin(), geometries.end(), geometry) == geometries.end()) geometries.push_back(geometry);
  };
  if (file.size() >= 100) {
    const std::size_t stated = big_endian(file, 16, 2);
    add(stated == 1 ? 65536 : stated, file[20]);
  }
  if (log.size() >= kLogHeader) add(big_endian(log, 8, 4), 0);
  add(PageGeometry{}.page_size, 0);
  return geometries;
}

std::vector<LogPage> pages_of_log(Bytes log, const PageGeometry& geometry) {
  const std::size_t frame = kFrameHeader + geometry.page_size;
  if (log.size() < kLogHeader + frame) return {};
  const auto salts_at = [&](std::size_t at) { return std::array{big_endian(log, at, 4), big_endian(log, at + 4, 4)}; };
  const std::size_t frames = (log.size() - kLogHeader) / frame;
  const auto frame_at = [&](std::size_t i) { return kLogHeader + i * frame; };
  // Frames of an earlier generation lie behind the present one's. Where the header is damaged, the first frame knows.
  auto salts = salts_at(16);
  bool known = false;
  for (std::size_t i = 0; i < frames && !known; ++i) known = salts_at(frame_at(i) + 8) == salts;
  if (!known) salts = salts_at(frame_at(0) + 8);
  std::vector<LogPage> pages;
  std::size_t committed = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    if (salts_at(frame_at(i) + 8) != salts) continue;
    pages.push_back({big_endian(log, frame_at(i), 4), log.subspan(frame_at(i) + kFrameHeader, geometry.page_size)});
    if (big_endian(log, frame_at(i) + 4, 4) != 0) committed = pages.size();
  }
  pages.resize(committed);
  return pages;
}

}  // namespace jnd
