#include "data/copies/signs_of_loss.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>

namespace jnd {

namespace {

constexpr std::size_t kHeader = 100;
constexpr std::string_view kMagic("SQLite format 3\0", 16);

// What the first page says (https://sqlite.org/fileformat2.html, section 1.3).
struct FileHeader {
  PageGeometry geometry;
  std::uint32_t pages = 0;
  bool logged = false;  // in write-ahead mode, as a study is until it is closed
};

// None where it is damaged: sizes that cannot be, or a page count of another state of the file than the rest.
std::optional<FileHeader> header_of(Bytes page) {
  if (page.size() < kHeader || !std::equal(kMagic.begin(), kMagic.end(), page.begin(),
                                           [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; }))
    return std::nullopt;
  const auto number = [&](std::size_t at, std::size_t length) { return big_endian(page, at, length); };
  const std::size_t stated = number(16, 2), size = stated == 1 ? 65536 : stated, reserved = page[20];
  const bool possible = size >= 512 && (size & (size - 1)) == 0 && size - reserved >= 480;
  FileHeader header{{size, size - reserved}, number(28, 4), page[18] == 2 || page[19] == 2};
  if (!possible || header.pages == 0 || number(24, 4) != number(92, 4)) return std::nullopt;
  return header;
}

// The newest first page: of the log, else of the file.
std::optional<FileHeader> newest_header(Bytes file, Bytes log) {
  std::optional<FileHeader> header = header_of(file);
  for (const PageGeometry& geometry : geometries_of(file, log))
    for (const LogPage& page : pages_of_log(log, geometry))
      if (page.number == 1)
        if (std::optional<FileHeader> newer = header_of(page.bytes)) header = newer;
  return header;
}

// Without counting page by page: a damaged header may say any number.
std::size_t missing_pages(Bytes file, Bytes log, const FileHeader& header) {
  const std::size_t whole = file.size() / header.geometry.page_size;
  if (header.pages <= whole) return 0;
  std::set<std::uint32_t> behind;
  for (const LogPage& page : pages_of_log(log, header.geometry))
    if (page.number > whole && page.number <= header.pages) behind.insert(page.number);
  return header.pages - whole - behind.size();
}

// The number in the only row of the table `tally`: a leaf with one cell, which ends with the page and holds a NULL (the
// row's own number) and an integer.
std::optional<std::int64_t> tally_in(Bytes page, const PageGeometry& geometry) {
  constexpr std::size_t kCell = 12;  // where the page says at which byte its first cell begins, and behind it
  if (page.size() < geometry.page_size || page[0] != 0x0D || big_endian(page, 3, 2) != 1) return std::nullopt;
  const std::size_t at = big_endian(page, 8, 2);
  if (at < kCell || at + 5 > geometry.usable) return std::nullopt;
  const std::size_t payload = page[at], serial = page[at + 4];
  constexpr std::array<std::size_t, 7> kLength = {0, 1, 2, 3, 4, 6, 8};
  const bool constant = serial == 8 || serial == 9;
  const std::size_t length = constant ? 0 : serial < kLength.size() ? kLength[serial] : page.size();
  if (page[at + 1] != 1 || page[at + 2] != 3 || page[at + 3] != 0 || serial == 0 || payload != 3 + length ||
      at + 2 + payload != geometry.usable)
    return std::nullopt;
  if (constant) return static_cast<std::int64_t>(serial - 8);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < length; ++i) value = value << 8U | page[at + 5 + i];
  return static_cast<std::int64_t>(value);
}

// It only ever rises: of all versions of the page the highest number is the newest.
std::optional<std::int64_t> highest_tally(Bytes file, Bytes log, const PageGeometry& geometry) {
  std::optional<std::int64_t> highest;
  const auto look = [&](Bytes page) {
    if (const std::optional<std::int64_t> found = tally_in(page, geometry)) highest = std::max(highest, found);
  };
  for (std::size_t at = geometry.page_size; at + geometry.page_size <= file.size(); at += geometry.page_size)
    look(file.subspan(at, geometry.page_size));
  for (const LogPage& page : pages_of_log(log, geometry)) look(page.bytes);
  return highest;
}

}  // namespace

SignsOfLoss signs_of_loss(Bytes file, Bytes log, std::int64_t found) {
  SignsOfLoss signs;
  const std::optional<FileHeader> header = newest_header(file, log);
  if (!header) {
    signs.doubts.emplace_back(
        "the file's header is damaged: how long the file was, and how many events were in it, is not known");
    return signs;
  }
  signs.pages = header->pages;
  if (header->logged && log.empty())
    signs.doubts.emplace_back(
        "the study was not closed, and its log (-wal) is missing or empty: whether something was only in the log is "
        "not known");
  signs.pages_missing = static_cast<std::int64_t>(missing_pages(file, log, *header));
  if (signs.pages_missing > 0)
    signs.doubts.push_back(fmt::format("the file ends early: {} of its {} pages are missing, and what was on them",
                                       signs.pages_missing, header->pages));
  const std::optional<std::int64_t> added = signs.events_added = highest_tally(file, log, header->geometry);
  if (!added)
    signs.doubts.emplace_back("the count of the study's events is lost: whether all of them were found is not known");
  else if (*added < found)
    signs.doubts.push_back(fmt::format(
        "the newest count of the study's events is lost ({} are counted, {} were found): whether all of them were "
        "found is not known",
        *added, found));
  else if (*added != found)
    signs.doubts.push_back(fmt::format("{} events were added to the study, and {} of them were found", *added, found));
  return signs;
}

}  // namespace jnd
