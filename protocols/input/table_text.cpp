#include "protocols/input/table_text.h"

#include <string_view>
#include <vector>

#include "protocols/input/input_error.h"
#include "protocols/input/utf8.h"

namespace jnd {

namespace {

constexpr const char* kSaveAs = "save it as CSV, UTF-8";

[[noreturn]] void fail(const std::string& file, const std::string& message) {
  throw InputError(std::vector<Diagnostic>{{file, 0, 0, "", message, kSaveAs}});
}

// Of bytes behind the mark.
std::string from_utf16(std::string_view bytes, bool high_byte_first, const std::string& file) {
  if (bytes.size() % 2 != 0) fail(file, "is UTF-16 text of which half a character is missing");
  std::u32string text;
  text.reserve(bytes.size() / 2);
  char32_t high = 0;  // the first half of a pair
  for (std::size_t at = 0; at < bytes.size(); at += 2) {
    const auto first = static_cast<unsigned char>(bytes[at]), second = static_cast<unsigned char>(bytes[at + 1]);
    const char32_t unit = high_byte_first ? first * 256U + second : second * 256U + first;
    const bool low_half = unit >= 0xDC00 && unit <= 0xDFFF, high_half = unit >= 0xD800 && unit <= 0xDBFF;
    if (low_half != (high != 0)) fail(file, "is UTF-16 text with half a character");
    if (low_half)
      text += static_cast<char32_t>(0x10000U + ((high - 0xD800U) << 10U) + (unit - 0xDC00U));
    else if (!high_half)
      text += unit;
    high = high_half ? unit : 0;
  }
  if (high != 0) fail(file, "is UTF-16 text with half a character");
  return to_utf8(text);
}

}  // namespace

std::string table_text(std::string bytes, const std::string& file) {
  const std::string_view begin = bytes;
  if (begin.starts_with("PK\x03\x04")) fail(file, "is a spreadsheet or an archive (xlsx, ods, zip), not a CSV text");
  if (begin.starts_with("\xD0\xCF\x11\xE0")) fail(file, "is a spreadsheet (xls), not a CSV text");
  if (begin.starts_with("\xFF\xFE") || begin.starts_with("\xFE\xFF"))
    bytes = from_utf16(begin.substr(2), begin.front() == '\xFE', file);
  else if (begin.starts_with("\xEF\xBB\xBF"))
    bytes.erase(0, 3);
  if (bytes.find('\0') != std::string::npos)
    fail(file, "holds zero bytes, so it is not a CSV text (or UTF-16 without its mark)");
  return bytes;
}

}  // namespace jnd
