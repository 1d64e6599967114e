// Times as the log stores them: ISO 8601 in UTC with all nine decimals, so that nothing is lost and text order is time
// order.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace jnd {

// 0 -> "1970-01-01T00:00:00.000000000Z".
std::string to_iso8601(std::int64_t utc_ns);
// The inverse; throws StorageError where the text is not of exactly that form.
std::int64_t utc_ns_from(std::string_view iso8601);

}  // namespace jnd
