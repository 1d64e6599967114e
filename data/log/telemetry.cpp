#include "data/log/telemetry.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "data/log/blob_bytes.h"
#include "data/log/body_numbers.h"
#include "data/log/storage_error.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

constexpr std::string_view kMagic = "jndticks";
constexpr std::size_t kHeaderSize = 8 + 4 + 4 + 4 + 4 + 8 + 8;  // magic .. dropped
constexpr std::size_t kChannelSize = 8;
constexpr std::size_t kTickSize = 2 * 8 + 2 * 4 + 9 * 8;     // the fields of a TickRecord
constexpr std::int64_t kLongest_ns = std::int64_t{1} << 62;  // 146 years: differences of times fit

// The control loop's clock never runs below 0, and no tick begins before its time.
std::int64_t time_at(std::string_view bytes, std::size_t at) {
  const auto value = static_cast<std::int64_t>(integer_at<std::uint64_t>(bytes, at));
  if (value < 0 || value > kLongest_ns) throw unreadable_blob("a record has a time that cannot be");
  return value;
}

// The doubles of a record, in the order of the format.
std::array<double, 9> doubles_of(const TickRecord& tick) {
  return {tick.penetration, tick.asked_n,     tick.given_n,     tick.measured_n, tick.vibration_g,
          tick.travel,      tick.finger_m[0], tick.finger_m[1], tick.finger_m[2]};
}

void set_double(TickRecord& tick, std::size_t place, double value) {
  const std::array<double*, 9> fields = {&tick.penetration,    &tick.asked_n,     &tick.given_n,
                                         &tick.measured_n,     &tick.vibration_g, &tick.travel,
                                         tick.finger_m.data(), &tick.finger_m[1], &tick.finger_m[2]};
  *fields[place] = value;
}

std::string raw_bytes(const Telemetry& telemetry, std::span<const TickRecord> ticks, std::int64_t dropped) {
  std::string bytes(kMagic);
  bytes.reserve(kHeaderSize + kChannelSize * telemetry.channels.size() + kTickSize * ticks.size());
  put_integer(bytes, kTelemetryVersion);
  put_integer(bytes, static_cast<std::uint32_t>(telemetry.unit == Unit::n_per_rad ? 1 : 0));
  put_integer(bytes, static_cast<std::uint32_t>(telemetry.channels.size()));
  put_integer(bytes, std::uint32_t{0});
  put_integer(bytes, static_cast<std::uint64_t>(ticks.size()));
  put_integer(bytes, static_cast<std::uint64_t>(dropped));
  for (const TelemetryChannel& channel : telemetry.channels) {
    put_integer(bytes, static_cast<std::uint32_t>(channel.finger));
    put_integer(bytes, static_cast<std::uint32_t>(channel.channel == Channel::kinaesthetic ? 1 : 0));
  }
  for (const TickRecord& tick : ticks) put_integer(bytes, static_cast<std::uint64_t>(tick.time_ns));
  for (const TickRecord& tick : ticks) put_integer(bytes, static_cast<std::uint64_t>(tick.lateness_ns));
  for (const TickRecord& tick : ticks) put_integer(bytes, static_cast<std::uint32_t>(tick.channel));
  for (const TickRecord& tick : ticks) put_integer(bytes, tick.limits);
  for (std::size_t place = 0; place < 9; ++place)
    for (const TickRecord& tick : ticks) put_integer(bytes, std::bit_cast<std::uint64_t>(doubles_of(tick)[place]));
  return bytes;
}

}  // namespace

std::vector<TelemetryChannel> telemetry_channels(const Presentation& presentation) {
  std::vector<TelemetryChannel> channels;
  for (const FingerPresentation& finger : presentation.fingers) channels.push_back({finger.finger, finger.channel});
  return channels;
}

TelemetryBlob encode_telemetry(int interval, const Telemetry& telemetry) {
  if (telemetry.channels.size() > kMaxTelemetryChannels)
    throw StorageError(fmt::format("telemetry of {} devices; at most {} can be kept", telemetry.channels.size(),
                                   kMaxTelemetryChannels));
  for (const TickRecord& tick : telemetry.ticks)
    if (tick.channel < 0 || static_cast<std::size_t>(tick.channel) >= telemetry.channels.size())
      throw StorageError(
          fmt::format("telemetry names device {}, and there are {}", tick.channel, telemetry.channels.size()));
  const std::size_t kept = std::min(telemetry.ticks.size(), static_cast<std::size_t>(kMaxTelemetryTicks));
  TelemetryBlob blob;
  blob.interval = interval;
  blob.ticks = static_cast<std::int64_t>(kept);
  blob.dropped = telemetry.dropped + static_cast<std::int64_t>(telemetry.ticks.size() - kept);
  const std::string raw = raw_bytes(telemetry, std::span(telemetry.ticks).first(kept), blob.dropped);
  blob.bytes = compressed_blob(raw);
  blob.sha256 = sha256_hex(blob.bytes);
  return blob;
}

Telemetry decode_telemetry(std::string_view bytes) {
  constexpr std::size_t kLargest =
      kHeaderSize + kChannelSize * kMaxTelemetryChannels + kTickSize * static_cast<std::size_t>(kMaxTelemetryTicks);
  const std::string raw = decompressed_blob(bytes, kLargest);
  const std::string_view view = raw;
  if (view.size() < kHeaderSize || view.substr(0, kMagic.size()) != kMagic)
    throw unreadable_blob("it is something else");
  const auto version = integer_at<std::uint32_t>(view, 8);
  if (version == 0 || version > kTelemetryVersion)
    throw unreadable_blob(fmt::format("it is of version {}; this program knows up to {}", version, kTelemetryVersion));
  const auto unit = integer_at<std::uint32_t>(view, 12), channels = integer_at<std::uint32_t>(view, 16);
  const auto count = integer_at<std::uint64_t>(view, 24), dropped = integer_at<std::uint64_t>(view, 32);
  if (unit > 1 || channels > kMaxTelemetryChannels || integer_at<std::uint32_t>(view, 20) != 0 ||
      count > static_cast<std::uint64_t>(kMaxTelemetryTicks) ||
      dropped > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
    throw unreadable_blob("its header holds values that cannot be");
  const auto ticks = static_cast<std::size_t>(count);
  if (view.size() != kHeaderSize + kChannelSize * channels + kTickSize * ticks)
    throw unreadable_blob("its size is not the one that its header gives");

  Telemetry telemetry;
  telemetry.unit = unit == 1 ? Unit::n_per_rad : Unit::n_per_m;
  telemetry.dropped = static_cast<std::int64_t>(dropped);
  std::size_t at = kHeaderSize;
  for (std::uint32_t i = 0; i < channels; ++i, at += kChannelSize) {
    const auto finger = integer_at<std::uint32_t>(view, at), channel = integer_at<std::uint32_t>(view, at + 4);
    if (finger > 0x7FFFFFFF || channel > 1) throw unreadable_blob("its header names a device that cannot be");
    telemetry.channels.push_back({static_cast<int>(finger), channel == 1 ? Channel::kinaesthetic : Channel::cutaneous});
  }
  telemetry.ticks.resize(ticks);
  for (TickRecord& tick : telemetry.ticks) {
    tick.time_ns = time_at(view, at);
    at += 8;
  }
  for (TickRecord& tick : telemetry.ticks) {
    tick.lateness_ns = time_at(view, at);
    at += 8;
  }
  for (TickRecord& tick : telemetry.ticks) {
    tick.channel = static_cast<std::int32_t>(integer_at<std::uint32_t>(view, at));
    if (tick.channel < 0 || tick.channel >= static_cast<std::int32_t>(channels))
      throw unreadable_blob("a record is of a device that there is not");
    at += 4;
  }
  for (TickRecord& tick : telemetry.ticks) {
    tick.limits = integer_at<std::uint32_t>(view, at);
    at += 4;
  }
  for (std::size_t place = 0; place < 9; ++place)
    for (TickRecord& tick : telemetry.ticks) {
      set_double(tick, place, std::bit_cast<double>(integer_at<std::uint64_t>(view, at)));
      at += 8;
    }
  return telemetry;
}

nlohmann::ordered_json telemetry_body(const std::vector<TelemetryBlob>& blobs) {
  nlohmann::ordered_json body = nlohmann::ordered_json::array();
  for (const TelemetryBlob& blob : blobs)
    body.push_back(
        {{"interval", blob.interval}, {"sha256", blob.sha256}, {"ticks", blob.ticks}, {"dropped", blob.dropped}});
  return body;
}

std::vector<TelemetryBlob> named_telemetry(const nlohmann::ordered_json& body) {
  if (!body.is_object() || !body.contains("telemetry")) return {};
  try {
    std::vector<TelemetryBlob> named;
    for (const nlohmann::ordered_json& one : body.at("telemetry"))
      named.push_back({whole_at(one, "interval"),
                       one.at("sha256").get<std::string>(),
                       whole_at<std::int64_t>(one, "ticks"),
                       whole_at<std::int64_t>(one, "dropped"),
                       {}});
    return named;
  } catch (const nlohmann::json::exception& error) {
    throw StorageError(fmt::format("\"telemetry\" of the event cannot be read: {}", error.what()));
  }
}

}  // namespace jnd
