#include "runner/sound/session_sound.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "protocols/course/prescription.h"
#include "protocols/input/input_error.h"
#include "protocols/tasks/task.h"
#include "runner/sound/wave.h"

namespace jnd {

namespace {

constexpr double kTone_hz = 880, kTone_s = 0.15;
constexpr double kLongestCue_s = 2;  // longer, and it would last into what is felt
// Beyond the longest trial that a protocol allows: taps, and a machine that is late.
constexpr double kMargin_s = 5;
constexpr double kLongestNoise_s = 600;

bool has_sound_cue(const Timeline& timeline) {
  return timeline.question_cue.kind == "sound" ||
         std::any_of(timeline.interval_cues.begin(), timeline.interval_cues.end(),
                     [](const CueSignal& cue) { return cue.kind == "sound"; });
}

// From the first cue to the question, or of a free interaction, at most.
double longest_noise_s(const Protocol& protocol) {
  const Timeline& timeline = protocol.timeline;
  const int intervals = felt_intervals(protocol.task);
  const double longest_s = protocol.explore ? protocol.explore->duration_s
                                            : intervals * (timeline.no_contact_time_out_s + timeline.explore_s) +
                                                  (intervals - 1) * timeline.gap_s;
  return std::min(longest_s + kMargin_s, kLongestNoise_s);
}

Wave cue_wave(const SoundSettings& settings) {
  if (settings.cue.empty()) return tone(kTone_hz, kTone_s, settings.cue_level_db);
  Wave wave = read_wav(settings.cue);
  if (wave.duration_s() > kLongestCue_s)
    throw InputError(
        fmt::format("{}: lasts {:.1f} s; a cue may last {:g} s, so that it is over before anything is felt",
                    settings.cue.string(), wave.duration_s(), kLongestCue_s));
  return wave;
}

Wave noise_wave(const MaskingNoise& masking, double duration_s) {
  if (masking.file.empty())
    return noise(masking.pink ? NoiseColour::pink : NoiseColour::white, duration_s, masking.level_db);
  return at_level(repeated(read_wav(masking.file), duration_s), masking.level_db, masking.file.string());
}

std::string noise_text(const MaskingNoise& masking) {
  const std::string what = masking.file.empty() ? std::string(masking.pink ? "pink noise" : "white noise")
                                                : masking.file.filename().string();
  return fmt::format("masking noise: {} at {:g} dB", what, masking.level_db);
}

}  // namespace

std::set<double> paces_of(const Protocol& protocol) {
  std::set<double> paces;
  for (const Condition& condition : protocol.conditions) {
    const Prescription* const prescription = prescription_of(protocol, condition);
    if (prescription != nullptr && prescription->pace_hz > 0) paces.insert(prescription->pace_hz);
  }
  return paces;
}

bool asks_for_sound(const Protocol& protocol, const SoundSettings& settings) {
  return settings.masking || !paces_of(protocol).empty() || (!protocol.explore && has_sound_cue(protocol.timeline));
}

SessionSound::SessionSound(const Protocol& protocol, const SoundSettings& settings) {
  const bool cues = has_sound_cue(protocol.timeline) && !protocol.explore;
  // First what is wrong whatever the machine can play.
  const Wave cue = cues ? cue_wave(settings) : Wave();
  const Wave masking = settings.masking ? noise_wave(*settings.masking, longest_noise_s(protocol)) : Wave();
  const PlayerTrial trial = try_players();
  check_.what = "sound";
  if (trial.player.command.empty()) {
    if (settings.masking)
      throw DeviceError(fmt::format("masking noise is asked for, and nothing can play it: {}", trial.trouble));
    check_.verdict = Verdict::warn;
    if (cues) check_.found = "cues are the terminal's bell; ";
    if (!paces_of(protocol).empty()) check_.found += "no metronome sets the prescribed pace; ";
    check_.found += trial.trouble;
    check_.what_to_do = "jnd doctor says whether sounds can be played";
    return;
  }
  player_ = trial.player;
  folder_.emplace();
  std::string text;
  if (cues) {
    cue_file_ = folder_->write("cue", cue);
    text = settings.cue.empty() ? fmt::format("a tone of {:g} Hz at {:g} dB", kTone_hz, settings.cue_level_db)
                                : settings.cue.filename().string();
    text = "cues: " + text;
  }
  for (const double pace_hz : paces_of(protocol)) {
    const Timeline& timeline = protocol.timeline;
    metronomes_[pace_hz] = folder_->write(
        fmt::format("metronome-{}", metronomes_.size()),
        metronome(pace_hz, timeline.no_contact_time_out_s + timeline.explore_s + kMargin_s, settings.cue_level_db));
    text += fmt::format("{}metronome: {:g} Hz", text.empty() ? "" : "; ", pace_hz);
  }
  if (settings.masking) {
    noise_file_ = folder_->write("noise", masking);
    text += (text.empty() ? "" : "; ") + noise_text(*settings.masking);
  }
  check_.found = fmt::format("{} ({})", text, player_.name());
}

bool SessionSound::cue(CuePlace place, const CueSignal& cue) {
  look_after();
  if (place == CuePlace::question)
    stop_noise();
  else
    start_noise();
  stop_metronome();
  if (const auto found = metronomes_.find(pace_hz_); place != CuePlace::question && found != metronomes_.end())
    metronome_.emplace(player_, found->second);
  if (cue.kind != "sound" || cue_file_.empty()) return false;
  playing_.emplace_back(player_, cue_file_);
  look_after();
  return !std::exchange(bell_, false);
}

void SessionSound::voided(const TrialOutline& /*outline*/, const std::string& /*reason*/) {
  stop_metronome();
  stop_noise();
}

void SessionSound::interval_over() {
  stop_metronome();
}

void SessionSound::happened(std::string_view moment) {
  if (moment == moment::kExplorationBegan)
    start_noise();
  else
    stop_noise();
  stop_metronome();
}

void SessionSound::start_noise() {
  if (noise_file_.empty() || noise_) return;
  noise_.emplace(player_, noise_file_);
}

void SessionSound::stop_noise() {
  end(noise_);
}

void SessionSound::stop_metronome() {
  end(metronome_);
}

void SessionSound::end(std::optional<PlayingSound>& sound) {
  if (sound) {
    sound->stop();
    playing_.push_back(std::move(*sound));
    sound.reset();
  }
  look_after();
}

// Ends what is to end, and counts what could not be played. The bell rings with the next cue after one that failed.
void SessionSound::look_after() {
  std::erase_if(playing_, [this](PlayingSound& sound) {
    if (!sound.is_over()) return false;
    if (sound.failed()) {
      ++failures_;
      bell_ = true;
    }
    return true;
  });
}

}  // namespace jnd
