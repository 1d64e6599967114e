// One target of the fuzzers: what arbitrary bytes may do to one of the program's readers. A property that does not hold
// ends the process, which is what a fuzzer and the replay of its corpora look for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

// As libFuzzer names it; the replay gives each target a name of its own.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace jnd::fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "property violated: %s\n", what);
  std::abort();
}

// Nothing that a terminal would obey: C0 but line feeds, DEL, C1 in UTF-8.
inline void require_printable(std::string_view text, const char* what) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    require((byte >= 0x20 || byte == '\n') && byte != 0x7F, what);
    if (byte == 0xC2 && i + 1 < text.size()) require(static_cast<unsigned char>(text[i + 1]) >= 0xA0, what);
  }
}

}  // namespace jnd::fuzz
