// The sounds of a session through a player that only notes what it is given.
#include "runner/sound/session_sound.h"

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <sys/wait.h>

#include "devices/device_error.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"
#include "tests/temporary_folder.h"
#include "tests/text_checks.h"
#include "tests/wait_until.h"

namespace jnd {
namespace {

// A folder of players that stands alone on PATH (with the shell's tools behind it) while it lives.
class Players {
 public:
  Players() : before_(std::getenv("PATH")) {  // NOLINT(concurrency-mt-unsafe): one thread
    std::filesystem::create_directory(folder_ / "bin");
    setenv("PATH", ((folder_ / "bin").string() + ":/usr/bin:/bin").c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  }
  ~Players() { setenv("PATH", before_.c_str(), 1); }  // NOLINT(concurrency-mt-unsafe)
  Players(const Players&) = delete;
  Players& operator=(const Players&) = delete;

  // A shell script; $file is what is to be played, $record where to note.
  void add(const std::string& name, const std::string& script) const {
    const std::filesystem::path file = folder_ / "bin" / name;
    std::ofstream(file) << "#!/bin/sh\nfor file in \"$@\"; do :; done\nrecord='" << (folder_ / "record").string()
                        << "'\n"
                        << script << "\n";
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  // Notes the file's name and sum, and plays for as long as it lasts. From that note on it notes its end, too.
  void add_good(const std::string& name) const {
    add(name,
        "case \"$file\" in *silence*) exit 0;; esac\n"
        "trap 'kill $!; echo \"end ${file##*/}\" >> \"$record\"; exit 0' TERM\n"
        "echo \"${file##*/} $(cksum < \"$file\")\" >> \"$record\"\n"
        "case \"$file\" in *noise*|*metronome*) tail -f /dev/null & wait;; esac");
  }
  std::vector<std::string> notes() const {
    std::ifstream in(folder_ / "record");
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }
  // How many begin so; waited for until there are as many as that.
  bool noted(const std::string& start, std::size_t count) const {
    std::size_t found = 0;
    return wait_until([&] {
             found = 0;
             for (const std::string& line : notes()) found += line.starts_with(start) ? 1U : 0U;
             return found >= count;
           }) &&
           found == count;
  }
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
  std::string before_;
};

Protocol with_sounds() {
  return test::small_protocol(
      {{"trial",
        {{"cues",
          {{"first", {{"kind", "sound"}}}, {"second", {{"kind", "sound"}}}, {"question", {{"kind", "sound"}}}}}}}});
}

SoundSettings with_noise(bool pink, double level_db) {
  SoundSettings settings;
  settings.masking = MaskingNoise{.file = {}, .pink = pink, .level_db = level_db};
  return settings;
}

const CueSignal kSound{.kind = "sound", .say = ""}, kNone{.kind = "none", .say = ""};

bool no_child_is_left() {
  return waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD;
}

template <typename Error, typename Act>
std::string said_by(const Act& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

}  // namespace

TEST_CASE("Every cue of the kind sound is the same file, and others are not heard", "[session_sound]") {
  const Players players;
  players.add_good("pw-play");
  {
    SessionSound sound(with_sounds(), {});
    CHECK(sound.check().verdict == Verdict::ok);
    CHECK(contains(sound.check().found, "cues: a tone of 880 Hz at -20 dB (pw-play)"));
    for (int trial = 0; trial < 3; ++trial) {
      CHECK(sound.cue(CuePlace::first, kSound));
      CHECK(sound.cue(CuePlace::second, kSound));
      CHECK_FALSE(sound.cue(CuePlace::question, kNone));
    }
    CHECK(players.noted("cue.wav", 6));
    CHECK(sound.failures() == 0);
  }
  CHECK(no_child_is_left());
  std::vector<std::string> notes = players.notes();
  std::erase_if(notes, [](const std::string& note) { return !note.starts_with("cue.wav"); });
  for (const std::string& note : notes) CHECK(note == notes.front());
}

TEST_CASE("Masking noise sounds from the first interval to the question, and ends with whatever ends a trial",
          "[session_sound]") {
  const Players players;
  players.add_good("aplay");
  {
    SessionSound sound(with_sounds(), with_noise(true, -30));
    CHECK(contains(sound.check().found, "masking noise: pink noise at -30 dB (aplay)"));
    CHECK(sound.cue(CuePlace::first, kSound));
    CHECK(players.noted("noise.wav", 1));
    CHECK(sound.cue(CuePlace::second, kSound));
    CHECK(sound.cue(CuePlace::question, kSound));
    CHECK(players.noted("end noise.wav", 1));
    std::size_t rounds = 1;
    for (const std::string_view ended : {moment::kPaused, moment::kStopped, moment::kMissing, moment::kEnded}) {
      (void)sound.cue(CuePlace::first, kNone);
      CHECK(players.noted("noise.wav", ++rounds));
      sound.happened(ended);
      CHECK(players.noted("end noise.wav", rounds));
    }
    (void)sound.cue(CuePlace::first, kNone);
    CHECK(players.noted("noise.wav", ++rounds));
    sound.voided({}, "stale_pose");
    CHECK(players.noted("end noise.wav", rounds));
    CHECK(sound.failures() == 0);
    (void)sound.cue(CuePlace::first, kNone);  // left to the end of the session
    CHECK(players.noted("noise.wav", ++rounds));
  }
  CHECK(no_child_is_left());
}

TEST_CASE("A metronome sounds in every interval alike, and ends with it", "[session_sound]") {
  const Players players;
  players.add_good("pw-play");
  Protocol protocol = with_sounds();
  protocol.conditions.resize(1);
  protocol.timeline.prescription = Prescription{.say = "", .pace_hz = 2, .limits = {}};
  SessionSound sound(protocol, {});
  TrialOutline outline;
  outline.pace_hz = 2;
  std::size_t intervals = 0;
  for (int trial = 1; trial <= 4; ++trial) {
    sound.trial(outline);
    for (const CuePlace place : {CuePlace::first, CuePlace::second}) {
      CHECK(sound.cue(place, kSound));
      CHECK(players.noted("metronome", ++intervals));
      sound.interval_over();
      CHECK(players.noted("end metronome", intervals));
    }
    CHECK(sound.cue(CuePlace::question, kSound));
  }
  CHECK(players.noted("cue.wav", 12));
  std::vector<std::string> notes = players.notes();
  std::erase_if(notes, [](const std::string& note) { return !note.starts_with("metronome"); });
  for (const std::string& note : notes) CHECK(note == notes.front());
  CHECK(sound.failures() == 0);
}

TEST_CASE("A player that hangs neither holds the session up nor outlives it", "[session_sound]") {
  const Players players;
  players.add(
      "pw-play",
      "case \"$file\" in *silence*) exit 0;; esac; trap '' TERM; echo started >> \"$record\"; exec tail -f /dev/null");
  {
    SessionSound sound(with_sounds(), with_noise(false, -40));
    CHECK(sound.cue(CuePlace::first, kSound));
    CHECK(players.noted("started", 2));
    CHECK(sound.cue(CuePlace::question, kSound));
  }
  CHECK(no_child_is_left());
}

TEST_CASE("The first player that can play is taken, and the bell rings where none can", "[session_sound]") {
  const Players players;
  players.add("pw-play", "echo 'no server' >&2; exit 1");
  players.add_good("aplay");
  CHECK(contains(SessionSound(with_sounds(), {}).check().found, "(aplay)"));
  CHECK(check_sound().verdict == Verdict::ok);
  players.add("aplay", "exit 2");
  SessionSound silent(with_sounds(), {});
  CHECK(silent.check().verdict == Verdict::warn);
  CHECK(contains(silent.check().found, "cues are the terminal's bell; pw-play cannot play (exit code 1: no server)"));
  CHECK_FALSE(silent.cue(CuePlace::first, kSound));
  Protocol paced = with_sounds();
  paced.conditions.resize(1);
  paced.timeline.prescription = Prescription{.say = "", .pace_hz = 2, .limits = {}};
  CHECK(contains(SessionSound(paced, {}).check().found,
                 "cues are the terminal's bell; no metronome sets the prescribed pace; pw-play"));
  CHECK(check_sound().verdict == Verdict::warn);
  CHECK_FALSE(check_sound().what_to_do.empty());
  CHECK(contains(said_by<DeviceError>([] { SessionSound(with_sounds(), with_noise(true, -30)); }),
                 "masking noise is asked for, and nothing can play it: pw-play cannot play"));
}

TEST_CASE("A player that fails in a session is counted, and the bell rings with the next cue", "[session_sound]") {
  const Players players;
  players.add("paplay", "case \"$file\" in *silence*) exit 0;; esac; echo tried >> \"$record\"; exit 1");
  SessionSound sound(with_sounds(), {});
  CHECK(wait_until([&] { return !sound.cue(CuePlace::first, kSound); }));
  CHECK(sound.failures() >= 1);
}

TEST_CASE("A sound of one's own is used as it is, and refused where it cannot be", "[session_sound]") {
  const Players players;
  players.add_good("pw-play");
  std::ofstream(players.path("beep.wav"), std::ios::binary) << wav_bytes(tone(500, 0.2, -30));
  std::ofstream(players.path("long.wav"), std::ios::binary) << wav_bytes(tone(500, 3, -30));
  std::ofstream(players.path("text.wav")) << "no sound";
  SoundSettings settings;
  settings.cue = players.path("beep.wav");
  settings.masking = MaskingNoise{.file = players.path("long.wav"), .pink = false, .level_db = -25};
  CHECK(contains(SessionSound(with_sounds(), settings).check().found,
                 "cues: beep.wav; masking noise: long.wav at -25 dB (pw-play)"));
  settings.masking.reset();
  settings.cue = players.path("long.wav");
  CHECK(contains(said_by<InputError>([&] { SessionSound(with_sounds(), settings); }),
                 "long.wav: lasts 3.0 s; a cue may last 2 s"));
  settings.cue = players.path("text.wav");
  CHECK(contains(said_by<InputError>([&] { SessionSound(with_sounds(), settings); }), "is no WAV file"));
  CHECK(contains(said_by<InputError>([&] { SessionSound(with_sounds(), with_noise(true, -7)); }), "would be clipped"));
}

TEST_CASE("Without a cue of the kind sound, and without noise, nothing is asked for", "[session_sound]") {
  CHECK(asks_for_sound(with_sounds(), {}));
  Protocol silent = with_sounds();
  for (CueSignal* cue :
       {&silent.timeline.interval_cues[0], &silent.timeline.interval_cues[1], &silent.timeline.question_cue})
    cue->kind = "none";
  CHECK_FALSE(asks_for_sound(silent, {}));
  CHECK(asks_for_sound(silent, with_noise(false, -30)));
}

}  // namespace jnd
