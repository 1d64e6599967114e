// jnd run: a session from this terminal. On simulated devices it is a rehearsal: kind pilot with a person at the keys,
// kind simulated where a profile answers. On specimens, which the operator hands over, it is real.
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "data/log/event_body.h"
#include "data/log/replay.h"
#include "data/log/storage_error.h"
#include "data/study/blinding.h"
#include "devices/hid/buttons/button_box.h"
#include "devices/hid/hidapi_bus.h"
#include "devices/rigs/rig_factory.h"
#include "devices/rigs/rig_file.h"
#include "protocols/input/resources.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/translation.h"
#include "runner/commands/commands.h"
#include "runner/console/console_lines.h"
#include "runner/console/session_console.h"
#include "runner/console/session_summary.h"
#include "runner/events/event_feed.h"
#include "runner/keys/interrupt.h"
#include "runner/keys/keyboard.h"
#include "runner/opening/participant_names.h"
#include "runner/opening/readiness.h"
#include "runner/opening/rig_source.h"
#include "runner/opening/session_opening.h"
#include "runner/opening/study_access.h"
#include "runner/screen/screen_display.h"
#include "runner/session/fast_clock.h"
#include "runner/session/rig_connections.h"
#include "runner/session/session_engine.h"
#include "runner/session/simulate.h"
#include "runner/sound/session_sound.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/study_variable.h"
#include "runner/terminal/terminal.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

struct ChosenRig {
  std::unique_ptr<const RigSource> own;  // null: the one that is set
  RigFile file;                          // empty where none was given
  const RigSource& source() const noexcept { return own ? *own : rig_source(); }
};

struct ChosenButtons {
  std::unique_ptr<HidBus> bus;
  std::unique_ptr<ButtonBox> box;  // null: the keyboard answers
};

// rig: "simulated", "hid", "specimens", or a rig file (--rig); fast: time is to be skipped. Throws UsageError, InputError, and
// DeviceError where the system's HID cannot be used.
ChosenRig choose_rig(const std::string& rig, bool fast) {
  ChosenRig chosen;
  if (rig == "simulated") return chosen;
  if (rig == "specimens") {
    chosen.own = make_specimen_rigs();
    return chosen;
  }
  if (fast)
    throw UsageError(
        "--fast skips time, and devices and other programs do not: leave it out, or rehearse with --rig simulated (the default)");
  if (rig != "hid") chosen.file = load_rig_file(rig);
  chosen.own = chosen.file.external ? make_laboratory_rigs(*chosen.file.external) : make_hid_rigs(chosen.file);
  return chosen;
}

// mapping: a file of `jnd device learn-buttons` (--buttons); empty: the rig file's. Waits until the box is there;
// throws InputError and DeviceError.
ChosenButtons choose_buttons(const std::filesystem::path& mapping, const RigFile& rig) {
  ChosenButtons chosen;
  const std::filesystem::path& file = mapping.empty() ? rig.buttons : mapping;
  if (file.empty()) return chosen;
  chosen.bus = std::make_unique<HidapiBus>();
  chosen.box = std::make_unique<ButtonBox>(*chosen.bus, load_button_mapping(file));
  chosen.box->wait_until_there();
  return chosen;
}

// Where certificates of calibration are looked for: beside the rig file, beside the study, here.
std::vector<std::filesystem::path> certificate_folders(const RigFile& rig, const std::filesystem::path& study) {
  std::vector<std::filesystem::path> folders = {study.has_parent_path() ? study.parent_path() : ".", "."};
  if (!rig.folder.empty()) folders.insert(folders.begin(), rig.folder);
  return folders;
}

// A screen, or lines. keyboard: null for a live demonstration, without key presses; then lines are printed. What is passed by
// reference or pointer must outlive the console. A terminal that cannot show a screen gets lines.
std::unique_ptr<Console> make_console(const ConsoleOptions& options, const Protocol& protocol, Keyboard* keyboard,
                                      Clock& clock, const Interrupts& interrupts) {
  std::unique_ptr<Display> display;
  const bool terminal = keyboard != nullptr && keyboard->is_terminal();
  if (terminal && is_terminal(STDOUT_FILENO) && !options.plain) display = make_screen_display();
  if (!display) display = std::make_unique<LineDisplay>(terminal);
  outlive_readers();  // after the keyboard, which takes such a signal for a crash
  return std::make_unique<SessionConsole>(options, protocol, keyboard, clock, interrupts, std::move(display));
}

struct RunOptions {
  std::string protocol;
  std::string study;
  std::string participant;               // asked for where empty
  std::optional<std::uint64_t> seed;     // of a new study; drawn where not given
  std::optional<std::string> responder;  // a profile that answers instead of a person
  std::string rig;                   // simulated, hid, specimens, or a rig file; empty: what the protocol's rig is for
  bool participant_presses = false;  // who presses the answer keys
  bool fast = false;
  bool plain = false;                             // a line at a time
  std::optional<std::string> events;              // where they are told to another program
  bool quiet = false;                             // no bell for the operator
  bool large_text = false;                        // of the participant's pages
  bool bell = false;                              // cues ring the terminal's bell, and no sound is played
  bool technician = false;                        // forces are shown, and the session is marked as unblinded
  std::optional<std::string> kind;                // real or pilot; what the rig is for where not given
  std::optional<std::string> language;            // of the participant's texts
  std::string group;                              // of the participant, where the operator says it
  bool beside = false;                            // another participant's session may stay unfinished
  std::string accept_gap;                         // why a too long interruption does not matter
  std::optional<std::string> override_readiness;  // why a bad finding does not matter
  std::string buttons;                            // a mapping of learn-buttons; empty: only keys answer
  std::string record = "full";                    // off, events, full
  std::string realtime = "prefer";                // off, prefer, require
};

// Specimens are there where the operator is; whatever else is real has to be named.
std::string rig_of_session(const RunOptions& options, const Protocol& protocol) {
  if (!options.rig.empty()) return options.rig;
  return !options.responder && protocol.rig.device == kSpecimenRig ? "specimens" : "simulated";
}

// What the user may choose, or what the rig is for.
SessionKind kind_of(const RunOptions& options, bool rig_simulated) {
  if (options.responder) {
    if (options.kind) throw UsageError("--responder answers for nobody: its data are simulated; leave --kind out");
    return SessionKind::simulated;
  }
  if (options.fast && !rig_simulated && options.kind != "pilot")
    throw UsageError(
        "--fast skips what the participant should feel: leave it out, or add --kind pilot for a rehearsal");
  if (!options.kind) return rig_simulated ? SessionKind::pilot : SessionKind::real;
  const std::optional<SessionKind> kind = session_kind_from(*options.kind);
  if (!kind || *kind == SessionKind::simulated)
    throw UsageError(fmt::format("'{}': --kind takes real or pilot", printable(*options.kind)));
  if (*kind == SessionKind::real && rig_simulated)
    throw UsageError(
        "this rig is simulated: nothing that is felt with it is real data. Leave --kind real out; the session is then "
        "a rehearsal, of kind pilot");
  return *kind;
}

void note_realtime(SessionLog& log, const RealtimeReport& report, const Clock& clock, Console& console) {
  nlohmann::ordered_json items = nlohmann::ordered_json::array();
  for (const RealtimeItem& item : report.items)
    items.push_back({{"what", item.what}, {"ok", item.ok}, {"detail", item.detail}, {"why_not", item.why_not}});
  log.append(event_kind::kRealtime, {{"policy", to_string(report.policy)}, {"items", std::move(items)}},
             {clock.utc_ns(), clock.now_ns()});
  const std::string problems = report.problems();
  if (!problems.empty()) console.announce(tr("The loop is not real-time:") + "\n" + problems, true);
}

// What was found, said to the operator. False: the session must not be begun.
bool is_ready(const Readiness& readiness, const RunOptions& options, Console& console) {
  const std::string text = readiness_text(readiness);
  const bool fine = std::all_of(readiness.items.begin(), readiness.items.end(),
                                [](const Check& item) { return item.verdict == Verdict::ok; });
  console.announce(text, !fine);
  if (!readiness.blocked) return true;
  return readiness.overridable && options.override_readiness && !options.override_readiness->empty();
}

// The forces of the rig, for a technician's eyes.
std::optional<LiveForces> forces_of(Rig& rig, const Protocol& protocol, const RigSpec& spec) {
  if (rig.live() == nullptr) return std::nullopt;
  LiveForces forces{.ticks = rig.live(), .devices = {}, .in_metres = protocol.stimulus.unit == Unit::n_per_m};
  for (const std::string& finger : protocol.rig.fingers)
    for (const DeviceSpec& device : spec.devices)
      forces.devices.push_back(
          spec.devices.size() == 1
              ? finger
              : fmt::format("{}, {}", finger, facts_of(device.model).acts_on_joint ? "joint" : "pulp"));
  return forces;
}

// Before anything is made. A session that counts is asked about: what has been seen cannot be unseen.
void check_technician(const RunOptions& options, const Protocol& protocol) {
  if (options.technician && !protocol.rig.built_in())
    throw UsageError(fmt::format(
        "--technician shows the forces of this program's own devices, and this protocol's rig is \"{}\": leave it out",
        printable(protocol.rig.device)));
}

bool may_unblind(const RunOptions& options, const BlindingState& state, Console& console) {
  if (!options.technician || !state.blinded) return true;
  return console.confirm(tr(
      "The technician's view shows the forces, and so the stimuli. This session of a blinded study will be marked as "
      "unblinded for ever. Go on?"));
}

// As every event of a session: where it cannot be written just now, it is tried again when the operator says so.
void close_session(Study& study, const std::string& id, Stamp stamp, Console& console) {
  for (;;) {
    try {
      study.close_session(id, stamp);
      return;
    } catch (const StorageTrouble& trouble) {
      if (!console.storage_trouble(trouble.what())) throw;
    }
  }
}

// What the participant hears; null where nothing is to be, in a quick rehearsal, and where the bell was chosen.
std::unique_ptr<SessionSound> sound_of(const RunOptions& options, const Protocol& protocol,
                                       const SoundSettings& settings) {
  if (options.bell && settings.masking)
    throw UsageError("--bell plays no sounds, and the rig file asks for masking noise: leave one of them out");
  if (options.bell && !paces_of(protocol).empty())
    throw UsageError(
        "--bell plays no sounds, and the protocol prescribes a pace, which a metronome sets: leave it out");
  if (options.fast || options.bell || !asks_for_sound(protocol, settings)) return nullptr;
  return std::make_unique<SessionSound>(protocol, settings);
}

void tell_failures(const SessionSound* sound, Console& console) {
  if (sound == nullptr || sound->failures() == 0) return;
  console.announce(sound->failures() == 1
                       ? tr("1 sound could not be played; the bell rang for the cue after it.")
                       : tr("{} sounds could not be played; the bell rang for the cue after each.", sound->failures()),
                   false);
}

void tell_dropped(EventFeed* events, Console& console) {
  if (events == nullptr) return;
  events->finish();
  if (const std::int64_t dropped = events->dropped(); dropped > 0)
    console.announce(dropped == 1
                         ? tr("1 event did not reach the reader of --events: it was too slow, or gone.")
                         : tr("{} events did not reach the reader of --events: it was too slow, or gone.", dropped),
                     false);
}

SessionCard card_of(const Protocol& protocol, const RunOptions& options, const SessionRequest& request,
                    const SessionTarget& target, const Plan& plan) {
  SessionCard card;
  card.title = protocol.title;
  card.participant = request.participant;
  // One that was drawn stays sealed in a blinded study.
  if (protocol.allotment == Allotment::given || !protocol.blinded) card.group = target.group;
  card.session = target.number;
  card.sessions = protocol.design.sessions;
  card.kind = request.kind;
  card.resumed = target.resumed.has_value();
  card.trials_done = target.resumed ? target.resumed->trials_done : 0;
  card.trials_total = std::max(main_trial_count(plan), static_cast<int>(plan.explorations.size()));
  card.fast = options.fast;
  card.unblinded = options.technician;
  return card;
}

SessionSummary summary_of(Study& study, const std::string& session, const RunOptions& options, const Plan& plan,
                          const Rig& rig, SessionEnd end, double run_s, const Deliveries& deliveries) {
  SessionSummary summary;
  summary.study = study.path().string();
  summary.moved = summary.study != options.study;
  summary.run_s = run_s;
  summary.deliveries = deliveries;
  summary.resumable = end == SessionEnd::interrupted;
  summary.free_interaction = !plan.explorations.empty();
  for (const SessionInfo& info : study.sessions()) {
    if (info.id != session) continue;
    summary.trials_done = info.trials_done;
    summary.trials_total = info.trials_total;
    summary.trials_voided = info.trials_voided;
  }
  for (const DeviceLinkReport& device : rig.connections().devices) {
    summary.slowest_presenting_ms = std::max(summary.slowest_presenting_ms, device.slowest_presenting_ms);
    summary.slowest_waiting_ms = std::max(summary.slowest_waiting_ms, device.slowest_waiting_ms);
  }
  return summary;
}

int command_run(const RunOptions& options) {
  const HoldInterrupts hold;
  const Protocol protocol = load_checked_protocol(options.protocol);
  const RigDescription description = rig_of(protocol);
  const bool person = !options.responder;
  const ParticipantProfile profile =
      load_profile(find_resource(Resource::profile, options.responder.value_or(default_profile(protocol))));
  const RecordPolicy record = record_policy_of(options.record);

  SessionRequest request;
  const ChosenRig chosen = choose_rig(rig_of_session(options, protocol), options.fast);
  request.kind = kind_of(options, chosen.source().info(protocol, description.spec).simulated);
  request.responder = person ? "keyboard" : "profile " + profile.name;
  request.profile_sha256 = person ? "" : profile.sha256;
  request.beside = options.beside;
  request.accept_gap = options.accept_gap;
  request.language = options.language;
  request.group = options.group;
  request.now = resume_moment(options.fast);
  request.participant = !options.participant.empty() || person ? options.participant : participant_code(1);
  // Refused before anything is made.
  if (options.language) in_language(protocol, *options.language);
  std::error_code no_study;
  check_technician(options, protocol);
  check_group(protocol, options.group, !std::filesystem::exists(options.study, no_study));

  if (!options.buttons.empty() && !person) throw UsageError("--responder answers for nobody: leave --buttons out");
  // They come before the study: where they are not there, nothing is made.
  const ChosenButtons chosen_buttons = person ? choose_buttons(options.buttons, chosen.file) : ChosenButtons{};
  ButtonBox* const buttons = chosen_buttons.box.get();
  const std::unique_ptr<EventFeed> events =
      options.events ? std::make_unique<EventFeed>(*options.events, options.study) : nullptr;
  const std::unique_ptr<SessionSound> sound = sound_of(options, protocol, chosen.file.sound);

  std::unique_ptr<Keyboard> keyboard;
  if (person) keyboard = std::make_unique<Keyboard>();
  std::unique_ptr<Clock> clock;
  if (options.fast)
    clock = std::make_unique<FastClock>();
  else
    clock = std::make_unique<SteadyClock>();
  const Interrupts& interrupted = interrupts();
  ConsoleOptions console_options;
  console_options.plain = options.plain;
  console_options.entered_by = options.participant_presses ? EnteredBy::participant : EnteredBy::operator_;
  console_options.buttons = buttons;
  console_options.alerts = !options.quiet;
  console_options.large_text = options.large_text;
  if (events) console_options.listeners.push_back(events.get());  // first: a sound takes a moment to start
  if (sound) console_options.listeners.push_back(sound.get());
  if (request.participant.empty()) {
    use_language(options.language.value_or(protocol.language));
    request.participant = make_console(console_options, protocol, keyboard.get(), *clock, interrupted)
                              ->ask_text(tr("Participant code (letters and digits)"));
    use_language("en");  // refusals are English, as those of every command
  }
  check_participant_code(request.participant);

  // Without them no study is made, and where one of them is a model nothing counts as real.
  if (chosen.source().look_for_devices(protocol, description, profile, *clock)) request.kind = kind_of(options, true);
  const auto now = [&] { return Stamp{clock->utc_ns(), clock->now_ns()}; };
  const std::unique_ptr<Study> study = open_or_create_study(options.study, protocol, options.seed, now());
  const std::uint64_t seed = study->info().seed;
  request.participant = participant_meant(request.participant, study->sessions());
  const SessionTarget target = choose_session(*study, protocol, request);
  const Protocol shown = target.language.empty() ? protocol : in_language(protocol, target.language);
  use_language(target.language.empty() ? protocol.language : target.language);
  const Plan plan = make_plan(protocol, target.participant_number, seed, target.number);

  SimulatedClock device_clock(clock->utc_ns());
  RigOptions how = rig_options(record, protocol, description);
  if (options.technician) how.live_ticks = telemetry_ticks(protocol, description.spec);
  // On the real clock the loop has a thread of its own; in a quick rehearsal it runs inside the session's.
  if (!options.fast) how.realtime = realtime_policy_of(options.realtime);
  std::unique_ptr<Rig> rig = chosen.source().make(protocol, description, profile, plan.participant, seed,
                                                  options.fast ? static_cast<Clock&>(device_clock) : *clock, how);
  if (options.fast) rig = std::make_unique<FastRig>(std::move(rig), device_clock, *clock);
  check_same_rig(target, rig->info());
  const StopOnInterrupt stop_rig(rig->stop);
  const StopOnKey stop_key(keyboard.get(), rig->stop);
  const StopOnButton stop_button(buttons, rig->stop);

  console_options.stop = &rig->stop;
  console_options.rig_buttons = rig->buttons();
  console_options.forces = forces_of(*rig, protocol, description.spec);
  const std::unique_ptr<Console> console = make_console(console_options, shown, keyboard.get(), *clock, interrupted);
  Readiness readiness;
  if (person) {
    readiness = check_readiness({protocol, description.spec, plan, *study, options.study, request.participant,
                                 request.kind, *rig, is_terminal(0), options.fast, buttons});
    if (sound) readiness.items.push_back(sound->check());
    if (!is_ready(readiness, options, *console)) {
      study->close();
      console->end(tr("Not begun: see to what is marked BAD and try again.") +
                   (readiness.overridable ? " " + tr("Where there is a good reason to go on all the same: "
                                                     "--override-readiness \"REASON\" (it is kept).")
                                          : ""));
      return exit_code::kProblemFound;
    }
  }

  if (!may_unblind(options, blinding_of(*study, protocol, request.kind), *console)) {
    study->close();
    console->end(tr("Not begun."));
    return exit_code::kProblemFound;
  }

  OpenedSession opened = open_session(*study, request, target, plan, rig->info(), now());
  if (person)
    opened.log->append(event_kind::kReadiness, readiness_body(readiness, options.override_readiness.value_or("")),
                       now());
  if (console_options.forces) opened.log->append(event_kind::kSessionUnblinded, {{"shown", "forces"}}, now());
  if (how.realtime) note_realtime(*opened.log, rig->realtime(), *clock, *console);
  if (const std::string missing = left_out_text(protocol, target.language); person && !missing.empty())
    console->announce(fmt::format("The translation \"{}\" {}. They are shown in {}.", printable(target.language),
                                  printable(missing), printable(protocol.language)),
                      true);
  if (target.resumed && person)
    console->announce(resume_text(target.check, protocol.resume), !target.check.warning.empty());
  console->begin(card_of(shown, options, request, target, plan));
  const SteadyClock machine_clock;
  const std::int64_t began_ns = machine_clock.now_ns();

  std::unique_ptr<Responder> simulated;
  if (!person) simulated = make_simulated_participant(profile, protocol, plan.participant, seed, *clock);
  std::optional<PauseOnInterrupt> pausing;
  if (person) pausing.emplace();
  const bool sealed = plan_sealed(*study, protocol) && !options.technician;
  const SessionParts parts{shown,       plan,   *rig,     person ? console->responder() : *simulated,
                           *opened.log, *clock, *console, interrupted,
                           record,      person, sealed};
  const SessionRecorder recorder(parts);
  note_connections(parts, recorder, "opened");
  note_calibrations(parts, recorder, certificate_folders(chosen.file, options.study));
  const auto last_words = [&](const std::string& words) {
    console->end(words);
    tell_dropped(events.get(), *console);
  };
  SessionEnd end = SessionEnd::interrupted;
  std::string missing;  // of the rig, where that ended it
  Deliveries deliveries;
  try {
    SessionEngine engine(parts);
    end = engine.run(replay(opened.log->events()),
                     {person && target.check.redo_block, person && target.check.practice_again});
    deliveries = deliveries_of(engine.course().state().completed, protocol);
    missing = person ? "" : missing_of(*rig, parts.sealed);
    note_connections(parts, recorder, "closed");
    tell_failures(sound.get(), *console);
    if (end != SessionEnd::interrupted) close_session(*study, opened.id, now(), *console);
  } catch (...) {
    last_words("");
    throw;
  }
  const std::string summary =
      "\n" + summary_text(summary_of(*study, opened.id, options, plan, *rig, end,
                                     static_cast<double>(machine_clock.now_ns() - began_ns) * 1e-9, deliveries));
  if (end == SessionEnd::interrupted) {
    study->close();
    last_words((missing.empty() ? "" : tr("Missing: {}.", printable(missing)) + "\n") +
               (study->path() == options.study
                    ? tr("Stopped. Every answer so far is saved in {}; the same command goes on at the next trial.",
                         printable(options.study))
                    : tr("Stopped. Every answer so far is saved in {}; the same command with this file goes on at the "
                         "next trial.",
                         printable(study->path().string()))) +
               summary);
    return exit_code::kInterrupted;
  }
  study->close();
  const std::string saved_in = printable(study->path().string());
  last_words((end == SessionEnd::completed
                  ? bold(tr("Done.")) + " " +
                        tr("The session of {} is complete and saved in {}.", request.participant, saved_in)
                  : tr("Ended. The session of {} is closed as it is; everything so far is saved in {}.",
                       request.participant, saved_in)) +
             summary);
  return exit_code::kDone;
}

}  // namespace

void add_run(CommandTree& tree) {
  const auto [command, options] = tree.add("run", "Run a session from this terminal, or go on with one",
                                           "jnd run tutorial --study pilot.sqlite --participant P01", command_run);
  command.add_option("PROTOCOL", options.protocol, "protocol file, or name of a shipped one").required();
  command.add_option("--study", options.study, "the study's file; made where it does not exist")
      .required()
      .variable(kStudyVariable);
  command.add_option("--participant", options.participant,
                     "participant code (letters and digits), or a number: 1 is P01; asked for if not given");
  command.add_option("--seed", options.seed, "seed of a new study (default: drawn, and kept in the study)");
  command.add_option("--responder", options.responder,
                     "a live demonstration: this profile answers instead of a person");
  command.add_flag("--participant-presses", options.participant_presses,
                   "the participant presses the answer keys (otherwise the operator enters what is said)");
  command.add_option("--buttons", options.buttons,
                     "the participant answers with buttons: a mapping of jnd device learn-buttons");
  command.add_option("--language", options.language,
                     "language of the participant's texts, of those in the protocol; the screen's own words too, where "
                     "there is a table of them (en, de)");
  command.add_option("--group", options.group,
                     "group of the participant, in a study whose protocol leaves it to you (allotment \"given\")");
  command.add_flag("--plain", options.plain,
                   "a line at a time instead of a full screen: for screen readers and scripts");
  command.add_option("--events", options.events,
                     "tell what happens, a JSON line each, to an open file descriptor (its number) or the program that "
                     "listens on a Unix socket (its path)");
  command.add_flag("--no-alerts", options.quiet,
                   "no bell for the operator at a question, a fault and the end of a break");
  command.add_flag("--large-text", options.large_text,
                   "the participant's texts and questions in large letters (on the screen: Ctrl-L)");
  command.add_flag("--technician", options.technician,
                   "a technician's view: force and depth of every device, live. They tell the stimuli, so the session "
                   "is marked as unblinded");
  command.add_flag("--bell", options.bell, "cues ring the terminal's bell instead of playing a sound");
  command.add_option("--kind", options.kind,
                     "real (default on a real rig, and on specimens) or pilot (default on a simulated one)");
  command.add_flag("--new", options.beside, "begin this participant while another one's session is unfinished");
  command.add_option("--accept-gap", options.accept_gap,
                     "go on after a longer interruption than the protocol allows, for this reason");
  command.add_option("--override-readiness", options.override_readiness,
                     "begin in spite of what the readiness check found, for this reason");
  command.add_option(
      "--rig", options.rig,
      "simulated (default), hid (the connected devices), specimens (the operator hands them over: the default where the "
      "protocol's rig is specimens), or a rig file");
  command.add_flag("--fast", options.fast, "rehearse without waiting: stimuli and pauses take no time");
  command.add_option("--record", options.record, "what is kept: off, events (faults), full (every tick; default)")
      .one_of({"off", "events", "full"});
  command.add_option("--realtime", options.realtime, "real-time scheduling: off, prefer (default), require")
      .one_of({"off", "prefer", "require"});
}

}  // namespace jnd
