// Sounds as samples and as files: lengths, levels, clipping, headers.
#include "runner/sound/wave.h"

#include <array>
#include <cmath>
#include <fstream>
#include <numbers>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/temporary_folder.h"
#include "tests/text_checks.h"

namespace jnd {
namespace {

std::uint32_t number_at(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = value << 8U | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

std::filesystem::path saved(const TemporaryFolder& folder, const std::string& bytes) {
  const std::filesystem::path file = folder / "sound.wav";
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

template <typename Act>
std::string input_error_of(const Act& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

// Power of a band of one octave about a frequency, by Goertzel's sums at some of its frequencies; up to a factor.
double octave_power(const Wave& wave, double centre_hz) {
  double power = 0;
  constexpr int kLines = 60;
  for (int i = 0; i < kLines; ++i) {
    const double hz = centre_hz / std::numbers::sqrt2 * std::exp2((i + 0.5) / kLines);
    const double step = 2 * std::numbers::pi * hz / wave.rate_hz;
    double re = 0, im = 0;
    for (std::size_t k = 0; k < wave.samples.size(); ++k) {
      const double phase = step * static_cast<double>(k);
      re += wave.samples[k] * std::cos(phase);
      im += wave.samples[k] * std::sin(phase);
    }
    power += (re * re + im * im) * hz;  // lines stand for bands as wide as their frequency
  }
  return power;
}

}  // namespace

TEST_CASE("A tone has its length, its level between the ramps, and ends as softly as it begins", "[wave]") {
  const Wave wave = tone(880, 0.15, -20);
  CHECK(wave.rate_hz == 48000);
  CHECK(wave.channels == 1);
  CHECK(wave.samples.size() == 7200);
  CHECK(wave.duration_s() == Approx(0.15));
  Wave middle = wave;
  middle.samples.assign(wave.samples.begin() + 600, wave.samples.end() - 600);
  CHECK(level_db(middle) == Approx(-20).margin(0.05));
  CHECK(peak(wave) == Approx(0.1 * std::numbers::sqrt2).epsilon(0.01));
  CHECK(wave.samples.front() == 0);
  CHECK(std::abs(wave.samples.back()) < 1e-4);
  CHECK(std::abs(wave.samples[24]) < 0.002);
}

TEST_CASE("Noise has its length and its level, and is the same every time", "[wave]") {
  for (const NoiseColour colour : {NoiseColour::white, NoiseColour::pink})
    for (const double wanted_db : {-60.0, -30.0, -20.0}) {
      CAPTURE(wanted_db);
      const Wave wave = noise(colour, 2, wanted_db);
      CHECK(wave.samples.size() == 96000);
      CHECK(level_db(wave) == Approx(wanted_db).margin(1e-3));
      CHECK(peak(wave) <= 1);
      CHECK(wave.samples == noise(colour, 2, wanted_db).samples);
    }
  // A longer one begins with the shorter one, up to the level.
  const Wave longer = noise(NoiseColour::white, 3, -30), shorter = noise(NoiseColour::white, 2, -30);
  CHECK(longer.samples[1000] / longer.samples[10] == Approx(shorter.samples[1000] / shorter.samples[10]).epsilon(1e-4));
}

TEST_CASE("White noise rises by 3 dB an octave in bands, pink noise does not", "[wave]") {
  const Wave white = noise(NoiseColour::white, 2, -20), pink = noise(NoiseColour::pink, 2, -20);
  const double white_at_1k = octave_power(white, 1000), pink_at_1k = octave_power(pink, 1000);
  for (const double hz : {125.0, 500.0, 4000.0, 8000.0}) {
    CAPTURE(hz);
    CHECK(10 * std::log10(octave_power(white, hz) / white_at_1k) == Approx(10 * std::log10(hz / 1000)).margin(2.5));
    CHECK(10 * std::log10(octave_power(pink, hz) / pink_at_1k) == Approx(0).margin(2.5));
  }
}

TEST_CASE("A level that would clip is refused, with the highest that does not", "[wave]") {
  const std::string said = input_error_of([] { (void)noise(NoiseColour::pink, 5, -6); });
  CHECK(contains(said, "pink noise: would be clipped at -6 dB; its highest level is -1"));
  Wave square;
  square.samples = {0.5F, -0.5F};
  CHECK(level_db(square) == Approx(-6.0206));
  CHECK(peak(at_level(square, 0, "x")) == Approx(1));
  CHECK(contains(input_error_of([&] { (void)at_level(square, 1, "x"); }), "its highest level is 0.0 dB"));
  CHECK(contains(input_error_of([] { (void)at_level(silence(0.1), -20, "quiet.wav"); }), "quiet.wav: is silent"));
  CHECK(std::isinf(level_db(Wave{})));
}

TEST_CASE("A short sound is repeated to a length, without a jump at the joints", "[wave]") {
  const Wave wave = tone(100, 0.5, -20);
  const Wave longer = repeated(wave, 3);
  CHECK(longer.duration_s() == Approx(3));
  float largest = 0;
  for (std::size_t i = 1; i < longer.samples.size(); ++i)
    largest = std::max(largest, std::abs(longer.samples[i] - longer.samples[i - 1]));
  CHECK(largest < 0.005F);
  CHECK(repeated(wave, 0.1).duration_s() == Approx(0.1));
  Wave stereo = noise(NoiseColour::pink, 0.4, -20);
  stereo.channels = 2;
  CHECK(repeated(stereo, 1).duration_s() == Approx(1));
  Wave one;
  one.samples = {0.25F};
  CHECK(repeated(one, 0.001).samples.size() == 48);
}

TEST_CASE("A WAV file has the header of its samples, and is read back", "[wave]") {
  const TemporaryFolder folder;
  Wave wave;
  wave.rate_hz = 44100;
  wave.channels = 2;
  wave.samples = {0, 1, -1, 0.5F, 2, -2};  // beyond full scale is cut
  const std::string bytes = wav_bytes(wave);
  CHECK(bytes.size() == 44 + 12);
  CHECK(bytes.substr(0, 4) == "RIFF");
  CHECK(number_at(bytes, 4, 4) == bytes.size() - 8);
  CHECK(bytes.substr(8, 8) == "WAVEfmt ");
  CHECK(number_at(bytes, 16, 4) == 16);
  CHECK(number_at(bytes, 20, 2) == 1);
  CHECK(number_at(bytes, 22, 2) == 2);
  CHECK(number_at(bytes, 24, 4) == 44100);
  CHECK(number_at(bytes, 28, 4) == 44100 * 4);
  CHECK(number_at(bytes, 32, 2) == 4);
  CHECK(number_at(bytes, 34, 2) == 16);
  CHECK(bytes.substr(36, 4) == "data");
  CHECK(number_at(bytes, 40, 4) == 12);
  const Wave back = read_wav(saved(folder, bytes));
  CHECK(back.rate_hz == 44100);
  CHECK(back.channels == 2);
  CHECK(back.samples == std::vector<float>{0, 1, -1, std::lround(0.5 * 32767) / 32767.0F, 1, -1});
}

TEST_CASE("What is no WAV file of that kind is refused with what it should be", "[wave]") {
  const TemporaryFolder folder;
  const std::string good = wav_bytes(tone(880, 0.05, -20));
  const auto said = [&](std::string bytes) {
    const std::string message = input_error_of([&] { (void)read_wav(saved(folder, bytes)); });
    CHECK(contains(message, "16-bit PCM"));
    return message;
  };
  const auto changed = [&good](std::size_t at, char value) {
    std::string bytes = good;
    bytes[at] = value;
    return bytes;
  };
  CHECK(contains(said("ID3 something else entirely"), "is no WAV file"));
  CHECK(contains(said(""), "is no WAV file"));
  CHECK(contains(said(good.substr(0, good.size() - 2)), "is cut short"));
  CHECK(contains(said(good.substr(0, 36)), "holds no sound"));
  CHECK(contains(said(good.substr(0, 12)), "does not say its format"));
  CHECK(contains(said(changed(20, 3)), "16 bits of format 3"));
  CHECK(contains(said(changed(34, 24)), "24 bits"));
  CHECK(contains(said(changed(22, 6)), "6 channels"));
  CHECK(contains(said(changed(22, 0)), "0 channels"));
  std::string slow = good;
  slow[24] = slow[25] = slow[26] = slow[27] = 1;
  CHECK(contains(said(slow), "Hz"));
  // Every beginning of a good file, and every one of its head's bytes changed: a message, or sound.
  for (std::size_t size = 0; size < 60; ++size)
    (void)input_error_of([&] { (void)read_wav(saved(folder, good.substr(0, size))); });
  for (std::size_t at = 0; at < 44; ++at)
    for (const char value : {'\0', '\1', '\x7f', '\xff'})
      (void)input_error_of([&] { (void)read_wav(saved(folder, changed(at, value))); });
}

TEST_CASE("a metronome is the same tone at every beat and nothing between") {
  const Wave wave = metronome(2, 3.2, -20), beat = tone(1320, 0.03, -20);
  CHECK(wave.duration_s() == Approx(3.2));
  const auto rate = static_cast<std::size_t>(wave.rate_hz);
  const std::size_t length = beat.samples.size();
  std::size_t sounding = 0;
  for (const float sample : wave.samples) sounding += sample != 0 ? 1 : 0;
  for (std::size_t n = 0; n < 7; ++n) {
    const auto from = wave.samples.begin() + static_cast<std::ptrdiff_t>(n * rate / 2);
    CHECK(std::equal(beat.samples.begin(), beat.samples.end(), from));
  }
  CHECK(sounding <= 7 * length);
  CHECK(sounding > 6 * length);
}

}  // namespace jnd
