// The rows of a study's tables out of the pages of its file, wherever they lie.
//
// SQLite reaches a row through the tree above it and gives up where the tree is damaged. Here every place of every page
// is tried as the beginning of a row (https://sqlite.org/fileformat2.html, sections 1.6 and 2): lost roots, pointers
// and page headers cost nothing. What is found may be damaged; the hashes that rows carry say so.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "data/copies/damaged_file.h"

namespace jnd {

enum class StoredTable { event, telemetry, protocol, study };

// A value as it is stored; text and blobs are bytes.
struct StoredValue {
  std::int64_t integer = 0;
  std::string bytes;
};

// Where a row begins; good for as long as the bytes are there.
struct RowPlace {
  Bytes rest;             // of its page, from its first byte
  int geometry = 0;       // place in the list of geometries
  bool with_log = false;  // its further pages are looked up in the log first
};

struct StoredRow {
  StoredTable table = StoredTable::event;
  std::vector<StoredValue> values;  // of the stored columns, in the order of the schema
  RowPlace place;
};

class StoredRows {
 public:
  StoredRows(Bytes file, Bytes log);

  // Calls `found` for everything that looks like a row: first of the file, then of the log in the order of writing. The
  // same row may come several times.
  void each(const std::function<void(StoredRow&&)>& found) const;
  // The row once more; none where its further pages cannot be read.
  std::optional<StoredRow> at(const RowPlace& place) const;

 private:
  void scan(Bytes page, int geometry, const std::function<void(StoredRow&&)>& found) const;
  std::optional<std::string> payload(const RowPlace& place, std::size_t begin, std::size_t size) const;
  Bytes page(std::uint32_t number, int geometry, bool with_log) const;

  Bytes file_;
  std::size_t bytes_;  // of the file and the log: no row is larger
  std::vector<PageGeometry> geometries_;
  std::vector<std::vector<LogPage>> log_;  // by geometry
  std::vector<std::unordered_map<std::uint32_t, Bytes>>
      latest_;  // by geometry: page number -> its last version in log_
};

}  // namespace jnd
