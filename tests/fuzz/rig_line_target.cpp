// Lines of an external rig: each is a message or is refused in words that can be printed, and whatever comes, a
// conversation counts only presentations that it began, each once.
#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "devices/external/rig_exchange.h"
#include "devices/external/rig_line.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace jnd;

constexpr std::string_view kFuzzedHello =
    R"({"type":"hello","protocol":1,"name":"R","version":"1","serial":"1","model":true,"answers":true,"quantities":)"
    R"([{"name":"q","unit":"","min":0,"max":1}],"parameters":[],"measures":[{"name":"force","unit":"N"}]})";

void check_line(std::string_view line) {
  const ReadRigLine read = read_rig_line(line);
  fuzz::require(read.message.has_value() != !read.refused.empty(), "a message, or a reason");
  for (const char letter : read.refused) fuzz::require(letter >= ' ' && letter <= '~', "a reason is printable ASCII");
  if (!read.message) return;
  if (const auto* done = std::get_if<RigDone>(&*read.message)) {
    fuzz::require(done->id >= 1 && done->contacts >= 0, "an id and a count");
    fuzz::require(std::isfinite(done->duration_s) && done->duration_s >= 0, "a duration is finite");
    fuzz::require(!done->delivered || std::isfinite(*done->delivered), "what is delivered is finite");
    for (const auto& [name, number] : done->peaks) fuzz::require(std::isfinite(number), "a peak is finite");
  }
}

RenderRequest fuzzed_request() {
  RenderRequest request;
  request.quantity = "q";
  request.value = 0.5;
  return request;
}

// The same lines as a rig says them, 10 ms apart.
void converse(std::string_view text) {
  RigExchange exchange("0", {});
  std::int64_t now_ns = 1;
  exchange.begin(now_ns);
  exchange.hear(kFuzzedHello, now_ns);
  std::string why;
  std::set<std::uint64_t> open, ended;
  while (!text.empty() && !exchange.lost()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::uint64_t id = exchange.prepare(fuzzed_request(), now_ns, why);
    if (id != 0) open.insert(id);
    exchange.hear(text.substr(0, end), now_ns);
    text.remove_prefix(std::min(end + 1, text.size()));
    now_ns += 10'000'000;
    exchange.tick(now_ns);
    for (const RigEvent& event : exchange.take_events()) {
      if (const auto* ready = std::get_if<RigReady>(&event.what)) (void)exchange.present(ready->id, now_ns);
      const auto* done = std::get_if<RigDone>(&event.what);
      const auto* voided = std::get_if<RigVoid>(&event.what);
      if (done == nullptr && voided == nullptr) continue;
      const std::uint64_t its = done != nullptr ? done->id : voided->id;
      fuzz::require(open.count(its) == 1 && ended.insert(its).second, "each presentation ends once");
    }
    (void)exchange.take_output();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    check_line(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  converse(text);
  return 0;
}
