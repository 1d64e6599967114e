#include "data/log/trace_blob.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "data/log/blob_bytes.h"
#include "data/log/telemetry.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

constexpr std::string_view kTraceMagic = "jndtrace";
constexpr std::size_t kTraceHeaderSize = 8 + 4 + 4 + 8 + 8;  // magic, version, channels, samples, dropped
constexpr std::size_t kLongestName = 40, kLongestUnit = 40;
constexpr std::size_t kSampleSize = 8 + 8 + 4 + 8;
constexpr std::size_t kLargestTrace = kTraceHeaderSize + kMaxTraceChannels * (2 + kLongestName + kLongestUnit) +
                                      kSampleSize * static_cast<std::size_t>(kMaxTraceSamples);

void put_text(std::string& bytes, const std::string& text, std::size_t longest) {
  if (text.size() > longest)
    throw StorageError(
        fmt::format("a channel of a trace has a name or unit of {} bytes; {} can be kept", text.size(), longest));
  put_integer(bytes, static_cast<std::uint8_t>(text.size()));
  bytes += text;
}

void put_double(std::string& bytes, double value) {
  put_integer(bytes, std::bit_cast<std::uint64_t>(value));
}

// Takes what it reads away from the front. Throws StorageError where there is not so much.
class Front {
 public:
  explicit Front(std::string_view bytes) : bytes_(bytes) {}
  template <typename Integer>
  Integer integer() {
    return integer_at<Integer>(take(sizeof(Integer)), 0);
  }
  double number() { return std::bit_cast<double>(integer<std::uint64_t>()); }
  std::string text(std::size_t longest) {
    const std::size_t size = integer<std::uint8_t>();
    if (size > longest) throw unreadable_blob("a channel has a name that cannot be");
    return std::string(take(size));
  }
  std::string_view take(std::size_t size) {
    if (size > bytes_.size()) throw unreadable_blob("its size is not the one that its header gives");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }
  std::size_t left() const noexcept { return bytes_.size(); }

 private:
  std::string_view bytes_;
};

}  // namespace

TelemetryBlob encode_trace(int interval, const Trace& trace) {
  if (trace.channels.size() > kMaxTraceChannels)
    throw StorageError(
        fmt::format("a trace of {} channels; at most {} can be kept", trace.channels.size(), kMaxTraceChannels));
  const std::size_t kept = std::min(trace.samples.size(), static_cast<std::size_t>(kMaxTraceSamples));
  const auto samples = std::span(trace.samples).first(kept);
  TelemetryBlob blob;
  blob.interval = interval;
  blob.ticks = static_cast<std::int64_t>(kept);
  blob.dropped = trace.dropped + static_cast<std::int64_t>(trace.samples.size() - kept);
  std::string raw(kTraceMagic);
  put_integer(raw, kTraceVersion);
  put_integer(raw, static_cast<std::uint32_t>(trace.channels.size()));
  put_integer(raw, static_cast<std::uint64_t>(kept));
  put_integer(raw, static_cast<std::uint64_t>(blob.dropped));
  for (const Trace::Channel& channel : trace.channels) {
    put_text(raw, channel.name, kLongestName);
    put_text(raw, channel.unit, kLongestUnit);
  }
  for (const Trace::Sample& sample : samples) put_double(raw, sample.heard_s);
  for (const Trace::Sample& sample : samples) put_double(raw, sample.rig_s);
  for (const Trace::Sample& sample : samples) {
    if (sample.channel < 0 || static_cast<std::size_t>(sample.channel) >= trace.channels.size())
      throw StorageError(
          fmt::format("a trace names channel {}, and there are {}", sample.channel, trace.channels.size()));
    put_integer(raw, static_cast<std::uint32_t>(sample.channel));
  }
  for (const Trace::Sample& sample : samples) put_double(raw, sample.value);
  blob.bytes = compressed_blob(raw);
  blob.sha256 = sha256_hex(blob.bytes);
  return blob;
}

bool is_trace(std::string_view bytes) {
  return blob_beginning(bytes, kTraceMagic.size()) == kTraceMagic;
}

Trace decode_trace(std::string_view bytes) {
  const std::string raw = decompressed_blob(bytes, kLargestTrace);
  Front front(raw);
  if (raw.size() < kTraceHeaderSize || front.take(kTraceMagic.size()) != kTraceMagic)
    throw unreadable_blob("it is something else");
  const auto version = front.integer<std::uint32_t>(), channels = front.integer<std::uint32_t>();
  if (version == 0 || version > kTraceVersion)
    throw unreadable_blob(fmt::format("it is of version {}; this program knows up to {}", version, kTraceVersion));
  const auto count = front.integer<std::uint64_t>(), dropped = front.integer<std::uint64_t>();
  if (channels > kMaxTraceChannels || count > static_cast<std::uint64_t>(kMaxTraceSamples) ||
      dropped > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
    throw unreadable_blob("its header holds values that cannot be");
  Trace trace;
  trace.dropped = static_cast<std::int64_t>(dropped);
  for (std::uint32_t i = 0; i < channels; ++i) {
    Trace::Channel channel;
    channel.name = front.text(kLongestName);
    channel.unit = front.text(kLongestUnit);
    trace.channels.push_back(std::move(channel));
  }
  if (front.left() != kSampleSize * static_cast<std::size_t>(count))
    throw unreadable_blob("its size is not the one that its header gives");
  trace.samples.resize(static_cast<std::size_t>(count));
  for (Trace::Sample& sample : trace.samples) sample.heard_s = front.number();
  for (Trace::Sample& sample : trace.samples) sample.rig_s = front.number();
  for (Trace::Sample& sample : trace.samples) {
    const auto channel = front.integer<std::uint32_t>();
    if (channel >= channels) throw unreadable_blob("a sample is of a channel that there is not");
    sample.channel = static_cast<int>(channel);
  }
  for (Trace::Sample& sample : trace.samples) sample.value = front.number();
  return trace;
}

}  // namespace jnd
