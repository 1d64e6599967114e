#include "data/files/study_image.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

#include <arpa/inet.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/files/descriptor.h"
#include "data/log/storage_error.h"

namespace jnd {

namespace {

constexpr std::size_t kStatedPageSizeAt =
    16;  // in the study's header, https://sqlite.org/fileformat2.html, section 1.3
constexpr std::size_t kPiece = 1 << 20;

// `size` bytes from `place` on; fewer at the end of the file or after an error.
std::string bytes_at(int file, std::size_t place, std::size_t size) {
  std::string bytes(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count = ::pread(file, bytes.data() + done, size - done, static_cast<off_t>(place + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

std::uint32_t number_in(std::string_view bytes) {
  std::uint32_t number = 0;
  std::memcpy(&number, bytes.data(), sizeof number);
  return ntohl(number);
}

}  // namespace

StudyImage::StudyImage(int study) : study_(study) {
  for (std::string piece; !(piece = bytes_at(study, file_.size(), kPiece)).empty();) file_ += piece;
  if (file_.size() >= kStatedPageSizeAt + 2) {
    const auto high = static_cast<unsigned char>(file_[kStatedPageSizeAt]);
    const auto low = static_cast<unsigned char>(file_[kStatedPageSizeAt + 1]);
    page_size_ = high == 0 && low == 1 ? 65536 : (std::size_t{high} << 8U) + low;
  }
  if (page_size_ < 512 || file_.size() % page_size_ != 0)
    throw StorageError("the study is no whole file of SQLite's: it is damaged");
  pages_ = static_cast<std::uint32_t>(file_.size() / page_size_);
}

std::string StudyImage::frame(int log, std::uint32_t number) const {
  const std::size_t place = kLogHeader + std::size_t{number - 1} * (kFrameHeader + page_size_);
  std::string page = bytes_at(log, place + kFrameHeader, page_size_);
  return page.size() == page_size_ ? page : std::string();
}

bool StudyImage::add(int log, const LogIndex& index) {
  if (index.salt != salt_ || index.frames < known_) {
    // A log begins anew only when all of it is in the file.
    file_.resize(std::size_t{pages_} * page_size_);
    for (const auto& [number, page] : newest_) file_.replace((number - 1) * page_size_, page_size_, page);
    newest_.clear();
    frames_.clear();
    known_ = 0;
    salt_ = index.salt;
  }
  if (index.frames == known_) return true;
  if (index.page_size != page_size_) return false;
  std::map<std::uint32_t, std::string> newer;
  std::multimap<std::uint32_t, std::uint32_t> frames;
  for (std::uint32_t i = known_ + 1; i <= index.frames; ++i) {
    const std::size_t place = kLogHeader + std::size_t{i - 1} * (kFrameHeader + page_size_);
    const std::string header = bytes_at(log, place, kFrameHeader);
    std::string page = frame(log, i);
    if (header.size() < kFrameHeader || page.empty() || number_in(header) == 0) return false;
    frames.emplace(number_in(header), i);
    newer[number_in(header)] = std::move(page);
  }
  newer.merge(newest_);
  newest_ = std::move(newer);
  frames_.merge(frames);
  known_ = index.frames;
  pages_ = index.pages;
  return std::all_of(newest_.begin(), newest_.end(), [&](const auto& one) { return one.first <= pages_; });
}

bool StudyImage::explains(int log) const {
  struct stat status {};
  if (::fstat(study_, &status) != 0) return false;
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size % page_size_ != 0 || size < file_.size() || size > std::max(file_.size(), pages_ * page_size_)) return false;
  const auto committed = [&](std::uint32_t number, std::string_view page) {
    if (const auto found = newest_.find(number); found != newest_.end() && found->second == page) return true;
    const auto [first, last] = frames_.equal_range(number);
    return std::any_of(first, last, [&](const auto& one) { return frame(log, one.second) == page; });
  };
  const std::size_t piece = std::max(kPiece / page_size_, std::size_t{1}) * page_size_;
  for (std::size_t at = 0; at < size; at += piece) {
    const std::string now = bytes_at(study_, at, std::min(piece, size - at));
    if (now.size() < std::min(piece, size - at)) return false;
    if (at + now.size() <= file_.size() && std::memcmp(now.data(), file_.data() + at, now.size()) == 0) continue;
    for (std::size_t place = at; place < at + now.size(); place += page_size_) {
      const std::string_view page = std::string_view(now).substr(place - at, page_size_);
      const bool as_before = place < file_.size() && page == std::string_view(file_).substr(place, page_size_);
      if (!as_before && !committed(static_cast<std::uint32_t>(place / page_size_) + 1, page)) return false;
    }
  }
  return true;
}

int StudyImage::write_to(int descriptor) const {
  for (std::uint32_t number = 1; number <= pages_; ++number) {
    const auto found = newest_.find(number);
    const std::size_t place = std::size_t{number - 1} * page_size_;
    const std::string_view page =
        found != newest_.end() ? std::string_view(found->second) : std::string_view(file_).substr(place, page_size_);
    if (const int error = write_all(descriptor, page); error != 0) return error;
  }
  return 0;
}

}  // namespace jnd
