// A page and its folder of figures, which appear when both are complete.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace jnd {

struct ReportFiles {
  std::filesystem::path page;
  std::filesystem::path folder;  // of the figures
  std::string page_bytes;
  std::vector<std::pair<std::string, std::string>> figures;  // name and bytes; the folder is not made where empty
};

// Throws StorageError where the page or the folder exists and replace is false, where either is anything but what an
// earlier report wrote, unchanged (then nothing is changed), or where they cannot be written.
void check_report_place(const std::filesystem::path& page, const std::filesystem::path& folder, bool replace);

// Writes both beside their places, for their owner only, and puts them there: what stood there before stays whole until
// then, and each is whole at any instant. Checks the place first. Throws StorageError.
void write_report(const ReportFiles& files, bool replace);

}  // namespace jnd
