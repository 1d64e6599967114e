#include "data/copies/stored_rows.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "analysis/numerics/stop_request.h"

namespace jnd {

namespace {

constexpr std::size_t kMostColumns = 16;
constexpr std::uint64_t kLargestRow = 0x7FFFFFFF;
constexpr std::uint64_t kSmallestRow = 64;   // every one holds a SHA-256 in hexadecimal
constexpr std::uint64_t kLongestName = 256;  // of a session, kind, version or seed

// What a column may hold, by SQLite's serial types.
enum class Kind { name, time, integer, json, digest, text, blob, null };

struct Layout {
  StoredTable table;
  std::array<Kind, 8> columns;
  std::size_t count;
};

// A later schema may add columns behind these.
constexpr std::array<Layout, 4> kLayouts = {
    {{StoredTable::event,
      {Kind::name, Kind::integer, Kind::name, Kind::time, Kind::integer, Kind::name, Kind::json, Kind::digest},
      8},
     {StoredTable::telemetry,
      {Kind::name, Kind::integer, Kind::integer, Kind::digest, Kind::integer, Kind::integer, Kind::blob},
      7},
     {StoredTable::protocol, {Kind::digest, Kind::text, Kind::blob}, 3},
     {StoredTable::study, {Kind::null, Kind::name, Kind::digest}, 3}}};

constexpr std::array<std::uint64_t, 10> kFixedLength = {0, 1, 2, 3, 4, 6, 8, 8, 0, 0};

std::uint64_t length_of(std::uint64_t serial) {
  return serial < kFixedLength.size() ? kFixedLength[serial] : (serial - 12) / 2;
}

bool fits(Kind kind, std::uint64_t serial) {
  const bool text = serial >= 13 && serial % 2 == 1;
  switch (kind) {
    case Kind::name:
      return text && serial > 13 && length_of(serial) <= kLongestName;
    case Kind::time:
      return text && length_of(serial) == std::string_view("2000-01-01T00:00:00.000000000Z").size();
    case Kind::integer:
      return serial >= 1 && serial <= 9 && serial != 7;
    case Kind::json:
    case Kind::text:
      return text;
    case Kind::digest:
      return text && length_of(serial) == 64;
    case Kind::blob:
      return serial >= 12 && serial % 2 == 0;
    case Kind::null:
      return serial == 0;
  }
  return false;
}

// Reads a variable-length integer (section 1.6) and moves `at` behind it; none where the bytes end first.
std::optional<std::uint64_t> varint(Bytes bytes, std::size_t& at) {
  std::uint64_t value = 0;
  for (int i = 0; i < 9; ++i) {
    if (at >= bytes.size()) return std::nullopt;
    const unsigned char byte = bytes[at++];
    if (i == 8) return value << 8U | byte;
    value = value << 7U | (byte & 0x7FU);
    if ((byte & 0x80U) == 0) return value;
  }
  return std::nullopt;
}

// The header of a row: where its payload begins, how long it is, and its columns.
struct Header {
  std::size_t begin = 0, size = 0, length = 0;  // length: of the record's header within the payload
  std::array<std::uint64_t, kMostColumns> serials{};
  std::size_t columns = 0;
  const Layout* layout = nullptr;
};

const Layout* layout_of(const Header& header) {
  for (const Layout& layout : kLayouts) {
    if (header.columns < layout.count || (layout.count == 3 && header.columns != 3)) continue;
    bool all = true;
    for (std::size_t i = 0; i < layout.count && all; ++i) all = fits(layout.columns[i], header.serials[i]);
    if (all) return &layout;
  }
  return nullptr;
}

// Called for every byte of the file: what is no row must be found out soon.
bool read_header(Bytes rest, Header& header) {
  std::size_t at = 0;
  const std::optional<std::uint64_t> size = varint(rest, at);
  if (!size || *size < kSmallestRow || *size > kLargestRow || !varint(rest, at)) return false;
  header.begin = at;
  header.size = static_cast<std::size_t>(*size);
  if (at >= rest.size() || rest[at] < 4 || rest[at] > 3 * kMostColumns) return false;
  header.length = rest[at++];
  const std::size_t end = header.begin + header.length;
  if (end > rest.size()) return false;
  std::uint64_t total = header.length;
  header.columns = 0;
  while (at < end) {
    const std::optional<std::uint64_t> serial = varint(rest, at);
    if (!serial || *serial == 10 || *serial == 11 || header.columns == kMostColumns) return false;
    header.serials[header.columns++] = *serial;
    total += length_of(*serial);
    if (total > header.size) return false;
  }
  if (at != end || total != header.size) return false;
  header.layout = layout_of(header);
  return header.layout != nullptr;
}

// How much of a payload lies in its own page (section 1.6).
std::size_t local_size(std::size_t size, std::size_t usable) {
  if (size <= usable - 35) return size;
  const std::size_t least = (usable - 12) * 32 / 255 - 23;
  const std::size_t local = least + (size - least) % (usable - 4);
  return local <= usable - 35 ? local : least;
}

StoredValue value_of(std::string_view bytes, std::uint64_t serial) {
  if (serial >= 12) return {0, std::string(bytes)};
  if (serial == 8 || serial == 9) return {serial == 9 ? 1 : 0, {}};
  std::uint64_t value = !bytes.empty() && (static_cast<unsigned char>(bytes[0]) & 0x80U) != 0 ? ~std::uint64_t{0} : 0;
  for (const char byte : bytes) value = value << 8U | static_cast<unsigned char>(byte);
  return {static_cast<std::int64_t>(value), {}};
}

}  // namespace

StoredRows::StoredRows(Bytes file, Bytes log)
    : file_(file), bytes_(file.size() + log.size()), geometries_(geometries_of(file, log)) {
  for (const PageGeometry& geometry : geometries_) {
    log_.push_back(pages_of_log(log, geometry));
    auto& latest = latest_.emplace_back();
    for (const LogPage& one : log_.back()) latest[one.number] = one.bytes;
  }
}

void StoredRows::each(const std::function<void(StoredRow&&)>& found) const {
  for (std::size_t i = 0; i < geometries_.size(); ++i) {
    const int geometry = static_cast<int>(i);
    const std::size_t page_size = geometries_[i].page_size;
    for (std::size_t at = 0; at < file_.size(); at += page_size)
      scan(file_.subspan(at, std::min(page_size, file_.size() - at)), geometry, found);
    for (const LogPage& one : log_[i]) scan(one.bytes, geometry, found);
  }
}

void StoredRows::scan(Bytes page, int geometry, const std::function<void(StoredRow&&)>& found) const {
  stop_if_requested();
  const std::size_t usable = geometries_[static_cast<std::size_t>(geometry)].usable;
  const Bytes used = page.first(std::min(usable, page.size()));
  const bool log = !log_[static_cast<std::size_t>(geometry)].empty();
  Header header;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const Bytes rest = used.subspan(i);
    if (!read_header(rest, header)) continue;
    if (std::optional<StoredRow> row = at({rest, geometry, false})) found(std::move(*row));
    if (log && local_size(header.size, usable) < header.size)
      if (std::optional<StoredRow> row = at({rest, geometry, true})) found(std::move(*row));
  }
}

std::optional<StoredRow> StoredRows::at(const RowPlace& place) const {
  Header header;
  if (!read_header(place.rest, header)) return std::nullopt;
  const std::optional<std::string> bytes = payload(place, header.begin, header.size);
  if (!bytes) return std::nullopt;
  StoredRow row;
  row.table = header.layout->table;
  row.place = place;
  std::size_t at = header.length;
  for (std::size_t i = 0; i < header.layout->count; ++i) {
    const auto length = static_cast<std::size_t>(length_of(header.serials[i]));
    row.values.push_back(value_of(std::string_view(*bytes).substr(at, length), header.serials[i]));
    at += length;
  }
  return row;
}

// `size` bytes from `begin` in the row's own page, and on from the pages behind it.
std::optional<std::string> StoredRows::payload(const RowPlace& place, std::size_t begin, std::size_t size) const {
  const std::size_t usable = geometries_[static_cast<std::size_t>(place.geometry)].usable;
  std::size_t local = local_size(size, usable);
  if (size > bytes_ || begin + local + (local < size ? 4 : 0) > place.rest.size()) return std::nullopt;
  const auto number_at = [](Bytes bytes, std::size_t at) {
    std::uint32_t number = 0;
    for (std::size_t i = 0; i < 4; ++i) number = number << 8U | bytes[at + i];
    return number;
  };
  const auto append = [](std::string& to, Bytes from) {
    to.append(reinterpret_cast<const char*>(from.data()), from.size());
  };
  std::string bytes;
  append(bytes, place.rest.subspan(begin, local));
  if (local == size) return bytes;
  std::uint32_t next = number_at(place.rest, begin + local);
  while (bytes.size() < size) {
    const Bytes further = page(next, place.geometry, place.with_log);
    const std::size_t piece = std::min(size - bytes.size(), usable - 4);
    if (further.size() < 4 + piece) return std::nullopt;
    append(bytes, further.subspan(4, piece));
    next = number_at(further, 0);
  }
  return bytes;
}

Bytes StoredRows::page(std::uint32_t number, int geometry, bool with_log) const {
  const auto place = static_cast<std::size_t>(geometry);
  if (with_log)
    if (const auto found = latest_[place].find(number); found != latest_[place].end()) return found->second;
  const std::size_t page_size = geometries_[place].page_size;
  if (number == 0 || (number - 1) * page_size >= file_.size()) return {};
  const std::size_t at = (number - 1) * page_size;
  return file_.subspan(at, std::min(page_size, file_.size() - at));
}

}  // namespace jnd
