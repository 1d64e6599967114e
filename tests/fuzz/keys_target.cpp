// Bytes of a terminal: whatever comes, keys are characters that can be shown, and a pause ends any sequence.
#include "runner/keys/key_parser.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

void check(const jnd::Key& key, std::int64_t now_ns) {
  using jnd::fuzz::require;
  require(key.time_ns <= now_ns, "a key is not from the future");
  require(key.character <= 0x10FFFF && !(key.character >= 0xD800 && key.character <= 0xDFFF), "a key is Unicode");
  require(key.name != jnd::KeyName::character ||
              (key.character >= 0x20 && !(key.character >= 0x7F && key.character < 0xA0)),
          "a character is not a control");
}

}  // namespace

// The highest bit of every fourth byte says whether the quiet gap passes before the next one.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  jnd::KeyParser parser;
  std::int64_t now_ns = 1;
  for (std::size_t i = 0; i < size; ++i) {
    now_ns += i % 4 == 3 && data[i] >= 0x80 ? jnd::KeyParser::kQuietGap_ns : 1000;
    if (const auto key = parser.quiet(now_ns)) check(*key, now_ns);
    if (const auto key = parser.feed(data[i], now_ns)) check(*key, now_ns);
  }
  now_ns += jnd::KeyParser::kQuietGap_ns;
  if (const auto key = parser.quiet(now_ns)) check(*key, now_ns);
  jnd::fuzz::require(!parser.waiting(), "nothing waits after a pause");
  const auto key = parser.feed('s', now_ns + 1);
  jnd::fuzz::require(key && key->is(U's'), "after a pause a letter is a letter");
  return 0;
}
