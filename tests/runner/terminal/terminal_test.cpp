// Text that is safe on a terminal, and its width there.
#include "runner/terminal/terminal.h"

#include <nlohmann/json.hpp>
#include <rapidcheck.h>

#include "tests/catch.h"

namespace jnd {

namespace {

// What a terminal would obey, by its bytes: C0 but line feed where that stays, DEL, C1 as UTF-8 and as single bytes.
bool has_controls(const std::string& text, bool line_feeds) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte < 0x20 && !(line_feeds && byte == '\n')) || byte == 0x7F) return true;
    if (byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0) return true;
    if (byte < 0xC2 && byte >= 0x80 && (i == 0 || static_cast<unsigned char>(text[i - 1]) < 0x80)) return true;
  }
  return false;
}

std::string any_bytes() {
  std::string text;
  for (const int byte : *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 256)))
    text += static_cast<char>(byte);
  return text;
}

}  // namespace

TEST_CASE("a name is one word for a shell, and no option", "[terminal]") {
  CHECK(shell_word("data/my-study_1.sqlite") == "data/my-study_1.sqlite");
  CHECK(shell_word("my study.sqlite") == "'my study.sqlite'");
  CHECK(shell_word("-x.sqlite") == "./-x.sqlite");
  CHECK(shell_word("") == "''");
  CHECK(shell_word("Anna's") == "'Anna'\\''s'");
  CHECK(shell_word("a\x1b[2J b") == "$'a\\x1b\\x5b2J\\x20b'");
}

TEST_CASE("what a terminal would obey, reorder or hide is made visible", "[terminal]") {
  CHECK(printable("plain, \xC3\xA9, \xE5\x89\x9B, \xF0\x9F\x99\x82") ==
        "plain, \xC3\xA9, \xE5\x89\x9B, \xF0\x9F\x99\x82");
  CHECK(printable("a\x1b[31m\x7f\n") == "a\\x1b[31m\\x7f\\x0a");
  CHECK(printable("\xC2\x9B"
                  "31m") == "\\u{9b}31m");
  CHECK(printable("\x9B"
                  "31m") == "\\x9b31m");
  CHECK(printable("\xE2\x80\xAE"
                  "abc\xE2\x81\xA6") == "\\u{202e}abc\\u{2066}");
  CHECK(printable("\xE2\x80\x8B\xE2\x80\xA8\xEF\xBB\xBF\xF3\xA0\x80\x81") == "\\u{200b}\\u{2028}\\u{feff}\\u{e0001}");
  // Overlong, a surrogate, beyond Unicode, cut off.
  CHECK(printable("\xC0\x9B") == "\\xc0\\x9b");
  CHECK(printable("\xED\xA0\x80") == "\\xed\\xa0\\x80");
  CHECK(printable("\xF4\x90\x80\x80") == "\\xf4\\x90\\x80\\x80");
  CHECK(printable("\xE2\x80") == "\\xe2\\x80");
  CHECK(printable_lines("a\n\x1b\tb\n") == "a\n\\x1b\\x09b\n");
}

TEST_CASE("no bytes whatever come out as a command, and safe text is not changed again", "[terminal]") {
  rc::check([] {
    const std::string text = any_bytes();
    RC_ASSERT(!has_controls(printable(text), false));
    RC_ASSERT(!has_controls(printable_lines(text), true));
    RC_ASSERT(printable(printable(text)) == printable(text));
  });
}

TEST_CASE("a JSON document for the terminal says the same to its reader", "[terminal]") {
  const nlohmann::json document = {{"a\x7f", "\xC2\x9B\xE2\x80\xAE\xF3\xA0\x80\x81 \xC3\xA9 \x1b\n"}};
  const std::string safe = printable_json(document.dump());
  CHECK_FALSE(has_controls(safe, false));
  CHECK(nlohmann::json::parse(safe) == document);
  CHECK(safe.find("\\u202e\\udb40\\udc01 \xC3\xA9") != std::string::npos);
}

TEST_CASE("wide characters take two columns, combining marks none", "[terminal]") {
  CHECK(display_width("abc") == 3);
  CHECK(display_width("\xC3\xA9") == 1);
  CHECK(display_width("e\xCC\x81") == 1);
  CHECK(display_width("\xE5\x89\x9B\xE6\x80\xA7") == 4);
  CHECK(display_width("\xEA\xB0\x95") == 2);
  CHECK(display_width("\xF0\x9F\x99\x82") == 2);
  CHECK(display_width("\xFF") == 1);
}

}  // namespace jnd
