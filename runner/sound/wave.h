// Sounds as samples, made or read, and as WAV files. Pure but for the files.
//
// Levels are the root mean square of the samples re full scale, in dB: a sine that fills the range has -3.01 dB.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace jnd {

struct Wave {
  int rate_hz = 48000;
  int channels = 1;              // 1 or 2
  std::vector<float> samples{};  // -1 to 1; of two channels in turn

  double duration_s() const noexcept {
    return static_cast<double>(samples.size()) / (static_cast<double>(rate_hz) * channels);
  }
};

// Root mean square re full scale, dB; -inf for silence and for no samples.
double level_db(const Wave& wave) noexcept;
// The largest magnitude of a sample.
double peak(const Wave& wave) noexcept;

// A sine with a rise and a fall of 10 ms (raised cosine), whose level between them is level_db. duration_s: at least
// 0.02.
Wave tone(double frequency_hz, double duration_s, double level_db);
Wave silence(double duration_s);
// Short tones of that level, the first at once, then one in every 1 / pace_hz s. pace_hz: 0.2 to 5.
Wave metronome(double pace_hz, double duration_s, double level_db);

enum class NoiseColour { white, pink };
// The same samples every time. Pink: power falls by 3 dB an octave from 20 Hz to 20 kHz, within 0.5 dB (P. Kellet's
// filter of white noise, musicdsp.org, "Pink noise filter"). Throws InputError where a level would clip, with the highest
// that does not.
Wave noise(NoiseColour colour, double duration_s, double level_db);

// Repeated to that length, each joint faded over 50 ms so that it is not heard; one that is long enough is cut.
Wave repeated(const Wave& wave, double duration_s);
// As loud as that. Throws InputError where it would clip, or is silent; what: the sound's name in the message.
Wave at_level(Wave wave, double wanted_db, const std::string& what);

// The bytes of a WAV file: RIFF, PCM of 16 bits.
std::string wav_bytes(const Wave& wave);
// From a file of that kind, of one or two channels and 8 to 192 kHz. Throws InputError with what it should be.
Wave read_wav(const std::filesystem::path& file);

}  // namespace jnd
