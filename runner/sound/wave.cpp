#include "runner/sound/wave.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <string_view>

#include <fmt/format.h>

#include "protocols/input/input_error.h"
#include "protocols/input/read_file.h"

namespace jnd {

namespace {

constexpr double kRamp_s = 0.010, kJoint_s = 0.050;
constexpr double kFullScale = 32767;
constexpr std::uint64_t kNoiseSeed = 20171107;  // any: the same noise for everybody
// Until the slowest pole of the pink filter (0.99886) has forgotten its start.
constexpr int kPinkSettles = 20000;

double amplitude_of(double level_db) noexcept {
  return std::pow(10, level_db / 20);
}

std::size_t frames_of(double duration_s, int rate_hz) {
  return static_cast<std::size_t>(std::llround(duration_s * rate_hz));
}

// White, uniform from -1 to 1: its largest sample is only 4.8 dB above its level.
class UniformNoise {
 public:
  double next() noexcept { return static_cast<double>(engine_() >> 11U) * 0x1p-52 - 1; }

 private:
  std::mt19937_64 engine_{kNoiseSeed};
};

class PinkNoise {
 public:
  PinkNoise() noexcept {
    for (int i = 0; i < kPinkSettles; ++i) (void)next();
  }
  double next() noexcept {
    const double white = white_.next();
    double sum = last_ + white * 0.5362;
    for (std::size_t i = 0; i < kPoles.size(); ++i) {
      state_[i] = kPoles[i] * state_[i] + kGains[i] * white;
      sum += state_[i];
    }
    last_ = white * 0.115926;
    return sum;
  }

 private:
  static constexpr std::array<double, 6> kPoles = {0.99886, 0.99332, 0.96900, 0.86650, 0.55000, -0.7616};
  static constexpr std::array<double, 6> kGains = {0.0555179, 0.0750759, 0.1538520, 0.3104856, 0.5329522, -0.0168980};
  UniformNoise white_;
  std::array<double, 6> state_{};
  double last_ = 0;
};

template <typename Source>
Wave filled(Source source, double duration_s) {
  Wave wave;
  wave.samples.resize(frames_of(duration_s, wave.rate_hz));
  for (float& sample : wave.samples) sample = static_cast<float>(source.next());
  return wave;
}

void put(std::string& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes += static_cast<char>((value >> (8U * static_cast<unsigned>(i))) & 0xFFU);
}

std::uint32_t take(std::string_view bytes, std::size_t at, int count) noexcept {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i)
    value |= std::uint32_t{static_cast<std::uint8_t>(bytes[at + static_cast<std::size_t>(i)])}
             << (8U * static_cast<unsigned>(i));
  return value;
}

InputError no_wav(const std::filesystem::path& file, const std::string& why) {
  return InputError(fmt::format(
      "{}: {}; give a WAV file of 16-bit PCM with one or two channels at 8 to 192 kHz (sox IN.mp3 -b 16 OUT.wav)",
      file.string(), why));
}

// The parts of a RIFF file that matter, by their places.
struct WavParts {
  std::string_view format, data;
};

WavParts parts_of(std::string_view bytes, const std::filesystem::path& file) {
  constexpr std::size_t kHead = 12, kChunkHead = 8;
  if (bytes.size() < kHead || bytes.substr(0, 4) != "RIFF" || bytes.substr(8, 4) != "WAVE")
    throw no_wav(file, "is no WAV file");
  WavParts parts;
  for (std::size_t at = kHead; at + kChunkHead <= bytes.size();) {
    const std::string_view name = bytes.substr(at, 4);
    const std::size_t size = take(bytes, at + 4, 4);
    const std::string_view body = bytes.substr(at + kChunkHead, size);
    if (body.size() < size) throw no_wav(file, fmt::format("is cut short: {} of {} bytes", body.size(), size));
    if (name == "fmt ") parts.format = body;
    if (name == "data") parts.data = body;
    at += kChunkHead + size + size % 2;
  }
  return parts;
}

}  // namespace

double level_db(const Wave& wave) noexcept {
  double sum = 0;
  for (const float sample : wave.samples) sum += double{sample} * double{sample};
  if (!(sum > 0)) return -std::numeric_limits<double>::infinity();
  return 10 * std::log10(sum / static_cast<double>(wave.samples.size()));
}

double peak(const Wave& wave) noexcept {
  double largest = 0;
  for (const float sample : wave.samples) largest = std::max(largest, std::abs(double{sample}));
  return largest;
}

Wave tone(double frequency_hz, double duration_s, double level_db) {
  Wave wave;
  wave.samples.resize(frames_of(duration_s, wave.rate_hz));
  const double amplitude = amplitude_of(level_db) * std::numbers::sqrt2;
  const auto ramp = static_cast<double>(frames_of(kRamp_s, wave.rate_hz));
  const std::size_t count = wave.samples.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double from_end = static_cast<double>(std::min(i, count - 1 - i));
    const double gain = from_end < ramp ? 0.5 - 0.5 * std::cos(std::numbers::pi * from_end / ramp) : 1;
    const double phase = 2 * std::numbers::pi * frequency_hz * static_cast<double>(i) / wave.rate_hz;
    wave.samples[i] = static_cast<float>(amplitude * gain * std::sin(phase));
  }
  return wave;
}

Wave silence(double duration_s) {
  Wave wave;
  wave.samples.resize(frames_of(duration_s, wave.rate_hz));
  return wave;
}

Wave metronome(double pace_hz, double duration_s, double level_db) {
  constexpr double kClick_hz = 1320, kClick_s = 0.03;
  const Wave click = tone(kClick_hz, kClick_s, level_db);
  Wave wave = silence(duration_s);
  for (int n = 0;; ++n) {
    const std::size_t at = frames_of(n / pace_hz, wave.rate_hz);
    if (at + click.samples.size() > wave.samples.size()) return wave;
    std::copy(click.samples.begin(), click.samples.end(), wave.samples.begin() + static_cast<std::ptrdiff_t>(at));
  }
}

Wave noise(NoiseColour colour, double duration_s, double level_db) {
  Wave wave = colour == NoiseColour::white ? filled(UniformNoise(), duration_s) : filled(PinkNoise(), duration_s);
  return at_level(std::move(wave), level_db, colour == NoiseColour::white ? "white noise" : "pink noise");
}

Wave repeated(const Wave& wave, double duration_s) {
  Wave out = wave;
  const auto channels = static_cast<std::size_t>(wave.channels);
  const std::size_t wanted = frames_of(duration_s, wave.rate_hz) * channels;
  const std::size_t joint = std::min(frames_of(kJoint_s, wave.rate_hz), wave.samples.size() / channels / 2) * channels;
  while (out.samples.size() < wanted && wave.samples.size() > joint) {
    const std::size_t from = out.samples.size() - joint;
    for (std::size_t i = 0; i < joint; ++i) {  // powers add to one, as of sounds that are not alike
      const std::size_t frame = i / channels;
      const double place = (static_cast<double>(frame) + 0.5) * static_cast<double>(channels) /
                           static_cast<double>(joint) * std::numbers::pi / 2;
      out.samples[from + i] =
          static_cast<float>(std::cos(place) * out.samples[from + i] + std::sin(place) * wave.samples[i]);
    }
    out.samples.insert(out.samples.end(), wave.samples.begin() + static_cast<std::ptrdiff_t>(joint),
                       wave.samples.end());
  }
  out.samples.resize(std::min(out.samples.size(), wanted));
  return out;
}

Wave at_level(Wave wave, double wanted_db, const std::string& what) {
  const double now_db = level_db(wave);
  if (!std::isfinite(now_db)) throw InputError(fmt::format("{}: is silent; choose another sound", what));
  const double gain = amplitude_of(wanted_db - now_db);
  if (const double largest = peak(wave) * gain; largest > 1)
    throw InputError(fmt::format("{}: would be clipped at {:g} dB; its highest level is {:.1f} dB", what, wanted_db,
                                 std::floor(10 * (wanted_db - 20 * std::log10(largest))) / 10));
  for (float& sample : wave.samples) sample = static_cast<float>(gain * sample);
  return wave;
}

std::string wav_bytes(const Wave& wave) {
  constexpr std::uint32_t kBytes = 2, kFormatSize = 16, kHeadAfterSize = 36;
  const auto channels = static_cast<std::uint32_t>(wave.channels);
  const auto rate = static_cast<std::uint32_t>(wave.rate_hz);
  const auto data = static_cast<std::uint32_t>(kBytes * wave.samples.size());
  std::string bytes = "RIFF";
  bytes.reserve(data + kHeadAfterSize + 8);
  put(bytes, kHeadAfterSize + data, 4);
  bytes += "WAVEfmt ";
  put(bytes, kFormatSize, 4);
  put(bytes, 1, 2);  // PCM
  put(bytes, channels, 2);
  put(bytes, rate, 4);
  put(bytes, rate * channels * kBytes, 4);
  put(bytes, channels * kBytes, 2);
  put(bytes, 8 * kBytes, 2);
  bytes += "data";
  put(bytes, data, 4);
  for (const float sample : wave.samples) {
    const auto value = static_cast<std::int16_t>(std::lround(kFullScale * std::clamp(double{sample}, -1.0, 1.0)));
    put(bytes, static_cast<std::uint16_t>(value), 2);
  }
  return bytes;
}

Wave read_wav(const std::filesystem::path& file) {
  constexpr std::size_t kFormatSize = 16;
  constexpr std::uint32_t kPcm = 1, kExtensible = 0xFFFE;
  constexpr std::size_t kMostBytes = std::size_t{64} << 20U;
  const std::string bytes = read_input_file(file, kMostBytes);
  const WavParts parts = parts_of(bytes, file);
  if (parts.format.size() < kFormatSize) throw no_wav(file, "does not say its format");
  const std::uint32_t kind = take(parts.format, 0, 2);
  const std::uint32_t bits = take(parts.format, 14, 2);
  // An extensible format names PCM in the first two bytes of its own.
  const bool pcm =
      kind == kPcm || (kind == kExtensible && parts.format.size() >= 26 && take(parts.format, 24, 2) == kPcm);
  if (!pcm || bits != 16) throw no_wav(file, fmt::format("has {} bits of format {}", bits, kind));
  Wave wave;
  wave.channels = static_cast<int>(take(parts.format, 2, 2));
  wave.rate_hz = static_cast<int>(std::min<std::uint32_t>(take(parts.format, 4, 4), 1'000'000));
  if (wave.channels < 1 || wave.channels > 2) throw no_wav(file, fmt::format("has {} channels", wave.channels));
  if (wave.rate_hz < 8000 || wave.rate_hz > 192000) throw no_wav(file, fmt::format("has {} Hz", wave.rate_hz));
  const std::size_t frame = 2U * static_cast<std::size_t>(wave.channels);
  const std::size_t count = parts.data.size() / frame * static_cast<std::size_t>(wave.channels);
  if (count == 0) throw no_wav(file, "holds no sound");
  wave.samples.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
    wave.samples.push_back(static_cast<float>(static_cast<std::int16_t>(take(parts.data, 2 * i, 2)) / kFullScale));
  return wave;
}

}  // namespace jnd
