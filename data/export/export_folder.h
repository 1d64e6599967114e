// A folder of files that appears as a whole or not at all, and takes the place only of one that holds nothing but what
// was written into it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "data/fields/csv_writer.h"
#include "data/files/draft.h"
#include "protocols/input/sha256.h"

namespace jnd {

class ExportFolder {
 public:
  // Throws StorageError where `folder` exists and replace is false, or where it holds anything but unchanged files of
  // an earlier one (nothing of it is touched then), or cannot be written. An empty folder may be replaced.
  ExportFolder(const std::filesystem::path& folder, bool replace);

  // Throws StorageError, also where the name leads out of the folder or was written before, and Stopped.
  void write(const std::string& relative, const std::string& bytes);
  // The same for a file that comes piece by piece: the first piece makes it, and it is whole when the folder is
  // finished. So a long table needs no more memory than a short one.
  void append(const std::string& relative, const std::string& bytes);
  // What was written so far, relative, in alphabetical order.
  std::vector<std::string> names() const;
  // Adds SHA256SUMS, by which such a folder is known again, and which says how many rows each table has: after it
  // nothing more is written, and nothing of the disk is needed for its place. Throws StorageError.
  void finish();
  // Puts the folder, finished first where it is not, into its place. Returns the files but SHA256SUMS, relative, in
  // alphabetical order. Throws StorageError.
  std::vector<std::string> publish();

 private:
  std::filesystem::path folder_;
  bool replace_;
  std::unique_ptr<Draft> draft_;
  // A file that is not whole yet: what is not on the disk of it, and the sum of all of it.
  struct Growing {
    DraftPart part;
    Sha256Stream sum{};
    std::string waiting{};
    void flush();
  };
  // Throws StorageError where the name leads out of the folder.
  std::filesystem::path place_within(const std::string& relative) const;

  std::map<std::string, Growing> growing_;     // by file, relative
  std::map<std::string, std::int64_t> lines_;  // of these, and of those that are whole
  std::map<std::string, std::string> sums_;    // the same, of those that are whole
  bool finished_ = false;
};

// A table that grows row by row within a folder. Without a row there is no file.
template <typename Row>
class CsvFile {
 public:
  // files must outlive it.
  CsvFile(ExportFolder& files, std::string name, std::vector<CsvColumn<Row>> columns)
      : files_(&files), name_(std::move(name)), columns_(std::move(columns)) {}

  void add(const Row& row) {
    begin();
    files_->append(name_, csv_row(columns_, row));
  }
  // With its header alone where no row comes.
  void begin() {
    if (!begun_) files_->append(name_, csv_header(columns_));
    begun_ = true;
  }
  // Adds what its columns mean, where there is a file.
  void describe_in(std::vector<DictionaryRow>& dictionary) const {
    if (begun_) describe(name_, columns_, dictionary);
  }

 private:
  ExportFolder* files_;
  std::string name_;
  std::vector<CsvColumn<Row>> columns_;
  bool begun_ = false;
};

}  // namespace jnd
