// The stored trace of an external rig: bytes are a whole one, which is stored again as the same, or are refused in words.
// What is fuzzed is what stands within the compression, whose checksum would refuse nearly everything, and the bytes themselves.
#include <string>
#include <string_view>

#include "data/log/blob_bytes.h"
#include "data/log/trace_blob.h"
#include "runner/terminal/terminal.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace jnd;

void decode(std::string_view bytes) {
  try {
    const Trace trace = decode_trace(bytes);
    fuzz::require(is_trace(bytes), "what can be decoded is a trace");
    const TelemetryBlob again = encode_trace(0, trace);
    fuzz::require(static_cast<std::size_t>(again.ticks) == trace.samples.size(), "as many samples");
    // The bytes, since numbers that are none (NaN) differ from themselves.
    fuzz::require(decompressed_blob(again.bytes, 1 << 20) == decompressed_blob(bytes, 1 << 20),
                  "what was stored comes back");
  } catch (const StorageError& error) {
    fuzz::require_printable(printable_lines(error.what()), "a message");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  decode(text);
  decode(compressed_blob(text));
  return 0;
}
