// The characters of a file in which people keep a table.
#pragma once

#include <string>

namespace jnd {

// UTF-8 without its byte order mark, from UTF-8 or from UTF-16 with one (what spreadsheets call "Unicode text"). Bytes
// that are not UTF-8 stay as they are: the reader of the table names their place. Throws InputError for spreadsheets,
// archives, UTF-16 that is damaged or has no mark, and other files with zero bytes. file: its name in messages.
std::string table_text(std::string bytes, const std::string& file);

}  // namespace jnd
