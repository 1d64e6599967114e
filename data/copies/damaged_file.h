// The bytes of a damaged study and of the write-ahead log beside it, as a private copy: the original is read once, from
// beginning to end, and never changed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace jnd {

using Bytes = std::span<const unsigned char>;

// A copy in memory that the kernel may put back on disk, in a file without a name: nothing stays, however the program
// ends. What the disk cannot read becomes zeros.
class PrivateCopy {
 public:
  // An absent file is empty. folder: where there is room for the copy. Throws StorageError, also where it is a folder,
  // a named pipe or a device.
  PrivateCopy(const std::filesystem::path& file, const std::filesystem::path& folder);
  ~PrivateCopy();
  PrivateCopy(const PrivateCopy&) = delete;
  PrivateCopy& operator=(const PrivateCopy&) = delete;

  Bytes bytes() const noexcept { return {static_cast<const unsigned char*>(data_), size_}; }
  std::int64_t unreadable() const noexcept { return unreadable_; }  // bytes that the disk did not give

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
  std::int64_t unreadable_ = 0;
};

// The number of `length` bytes, at most 4, that begins at `at`: SQLite's integers are big-endian.
std::uint32_t big_endian(Bytes bytes, std::size_t at, std::size_t length);

// How the file is cut into pages (https://sqlite.org/fileformat2.html, section 1.3).
struct PageGeometry {
  std::size_t page_size = 4096;  // a power of two from 512 to 65536
  std::size_t usable = 4096;     // of a page: without the reserved end
  bool operator==(const PageGeometry&) const = default;
};

// A page as the write-ahead log holds it.
struct LogPage {
  std::uint32_t number = 0;  // from 1
  Bytes bytes;
};

// The geometries to try: what the headers say where that can be, and what every study is made with.
std::vector<PageGeometry> geometries_of(Bytes file, Bytes log);

// The pages of every committed transaction of the log's present generation, in the order in which they were written
// (section 4). Checksums are not looked at: the hash chain decides later what is whole.
std::vector<LogPage> pages_of_log(Bytes log, const PageGeometry& geometry);

}  // namespace jnd
