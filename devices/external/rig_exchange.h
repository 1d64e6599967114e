// The conversation with an external rig, without its connection: lines and times in, lines and events out. It decides
// what counts. The times are those of one monotonic clock, ns.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "devices/external/external_settings.h"
#include "devices/external/rig_messages.h"

namespace jnd {

// How often the program says `alive`.
inline constexpr std::int64_t kRigAliveEvery_ns = 25'000'000;
// More refused lines within one second are a fault.
inline constexpr int kMostRefusedLines = 50;
// A rig's own clock may count a presentation longer by so much than the program did, s.
inline constexpr double kRigClockSlack_s = 0.1;
// What waits to be taken at most; telemetry beyond is dropped and counted.
inline constexpr std::size_t kMostRigEvents = 20'000;
// So many of the newest refused lines are kept for people.
inline constexpr std::size_t kRefusedLinesKept = 8;

// Why a presentation is void, or a connection over.
enum class RigFailure {
  rig_fault,     // the rig says so
  refused_done,  // its `done` could not be taken
  no_contact,
  stopped,      // by the program, or by the rig itself
  time_out,     // no `done` in time
  not_ready,    // no `ready` in time
  not_stopped,  // no `done` after `stop`
  silent,
  babbling,  // too many lines that are none
  no_hello,  // none in time, or another one than before
  ended      // the program or its connection
};

// -- events that are no message of the rig ----------------------------------------------------------------------------

// A presentation, or a question, ends without a result.
struct RigVoid {
  std::uint64_t id = 0;
  RigFailure failure = RigFailure::ended;
  std::string words;  // for the log and for people: printable ASCII
};
struct RigLineRefused {
  std::string line;  // its beginning, as printable ASCII
  std::string why;
};
// The connection is over: the rig has to be ended and started anew.
struct RigLost {
  RigFailure failure = RigFailure::ended;
  std::string words;
  std::string sealed{};  // the same without words of the rig, which may name what it presents
};

struct RigEvent {
  std::int64_t time_ns = 0;  // of its arrival
  std::variant<RigHello, RigReady, RigContact, RigDone, RigTelemetry, RigAnswer, RigFault, RigVoid, RigLineRefused,
               RigLost>
      what;
};

// Since the program began, over all connections.
struct RigTraffic {
  std::int64_t lines = 0;      // that came
  std::int64_t refused = 0;    // of these
  std::int64_t dropped = 0;    // events that nobody took in time
  std::int64_t presented = 0;  // presentations that are done: complete, and with the right id
  std::int64_t voided = 0;
  std::int64_t answered = 0;  // `alive`
  // The slowest answers to `alive` so far, with the age of one that has not come; presenting: from "present" to "done".
  double slowest_presenting_ms = 0, slowest_waiting_ms = 0;
};

// Thread rule: one thread.
class RigExchange {
 public:
  // token: what its hello has to carry; empty: nothing. No event and no message has it.
  RigExchange(std::string program_version, const RigTimeOuts& time_outs, std::string token = {});

  // -- the connection's side ------------------------------------------------------------------------------------------

  // A new connection: says hello. Ids go on, so that nothing that an earlier one says late can be taken for an answer.
  void begin(std::int64_t now_ns);
  void hear(std::string_view line, std::int64_t now_ns);  // without its end
  void hear_too_long(std::string_view beginning, std::int64_t now_ns);
  // Says `alive`, and judges time-outs: call it at least every 10 ms, after everything that has come was heard.
  void tick(std::int64_t now_ns);
  // The connection is over. sealed: as RigLost::sealed; empty: nothing in `words` is the rig's.
  void end(RigFailure failure, std::string_view words, std::int64_t now_ns, std::string_view sealed = {});
  // What is to be written, taken away.
  std::string take_output();
  // While this is set the connection has to be ended; only begin() clears it.
  const std::optional<RigLost>& lost() const noexcept { return lost_; }

  // -- the session's side -----------------------------------------------------------------------------------------------

  // The hello of the newest connection that said one.
  const std::optional<RigHello>& hello() const noexcept { return hello_; }
  // This connection said hello.
  bool greeted() const noexcept { return greeted_; }
  // Prepares or presents, or has to say that it stopped.
  bool engaged() const noexcept { return state_ != State::idle; }
  // Said hello, is alive, and neither prepares nor presents.
  bool idle() const noexcept { return greeted_ && !lost_ && !engaged(); }

  // Begins a presentation: the rig gets ready (RigReady, or RigVoid). Returns its id; 0 where the rig is not idle, or
  // the request is none that it said it can do (see rig_fit.h: `why` says what).
  std::uint64_t prepare(const RenderRequest& request, std::int64_t now_ns, std::string& why);
  // Presents what is ready: RigDone with outcome complete, or RigVoid, always. False if `id` is not ready. A rig that is
  // silent just now is told to present when it answers.
  bool present(std::uint64_t id, std::int64_t now_ns);
  // Gets ready for it, or is.
  bool prepares(std::uint64_t id) const noexcept {
    return id == id_ && !voided_ && (state_ == State::preparing || state_ == State::ready);
  }
  bool is_ready(std::uint64_t id) const noexcept { return id == id_ && state_ == State::ready; }
  // Its turn has come, and it is not ready: void.
  void give_up(std::uint64_t id, std::int64_t now_ns);
  // Asks for an answer by the rig's own buttons: RigAnswer once, or RigVoid where the rig is lost first. Returns the
  // question's id; 0 where it has no buttons or is not idle.
  std::uint64_t ask(const std::vector<std::string>& answers, std::int64_t now_ns);
  // Ends what goes on. With `enough` a presentation is done as soon as the rig says so; a question is withdrawn.
  void stop(RigStop reason, std::int64_t now_ns);
  void bye();

  bool has_events() const noexcept { return !events_.empty(); }
  std::vector<RigEvent> take_events();
  const RigTraffic& traffic() const noexcept { return traffic_; }
  const std::deque<RigLineRefused>& refused_lines() const noexcept { return refused_lines_; }

 private:
  enum class State { idle, preparing, ready, due, presenting, stopping };  // due: "present" waits for an answer

  void take(const RigHello& told, std::int64_t now_ns);
  void take(const RigReady& ready, std::int64_t now_ns);
  void take(const RigContact& contact, std::int64_t now_ns);
  void take(const RigDone& done, std::int64_t now_ns);
  void take(const RigTelemetry& telemetry, std::int64_t now_ns);
  void take(const RigAnswer& answer, std::int64_t now_ns);
  void take(const RigFault& fault, std::int64_t now_ns);
  void take(const RigAlive& alive, std::int64_t now_ns);

  // Each empty where all is well, or why the line is refused.
  std::string wrong_state(std::string_view what, std::uint64_t id, bool good_state) const;
  std::string wrong_names(const NamedNumbers& numbers) const;
  std::string wrong_done(const RigDone& done, std::int64_t now_ns) const;
  std::string unfinished(const RigDone& done) const;

  void finish(const RigDone& done, std::int64_t now_ns);
  void refuse(std::string why, std::int64_t now_ns);
  void void_presentation(RigFailure failure, std::string words, std::int64_t now_ns);
  void void_question(RigFailure failure, const std::string& words, std::int64_t now_ns);
  void stop_for(RigStop reason, std::int64_t now_ns);
  void emit(RigEvent event);
  void rest() noexcept {
    state_ = State::idle;
    presented_ns_ = 0;
  }
  void say_present(std::int64_t now_ns);
  void judge_silence(std::int64_t now_ns);
  std::int64_t unanswered_ns(std::int64_t now_ns) const;
  void keep_slowest(std::int64_t now_ns);

  const std::string program_version_;
  const RigTimeOuts time_outs_;
  const std::string token_;
  std::string output_;
  std::deque<RigEvent> events_;
  std::optional<RigLost> lost_;
  std::optional<RigHello> hello_;
  bool greeted_ = false;
  bool leaving_ = false;  // bye was said
  std::int64_t began_ns_ = 0;

  State state_ = State::idle;
  std::uint64_t last_id_ = 0;  // of presentations and questions, never used twice
  std::uint64_t id_ = 0;       // of the presentation that goes on
  RenderRequest request_;
  std::int64_t deadline_ns_ = 0;   // of the state
  std::int64_t presented_ns_ = 0;  // 0: not yet
  bool voided_ = false;            // it has its RigVoid already
  int contacts_ = 0;               // that it told
  std::uint64_t question_ = 0;
  std::vector<std::string> answers_;

  std::uint64_t alive_said_ = 0, alive_heard_ = 0;
  std::int64_t alive_said_ns_ = 0;             // the newest
  std::deque<std::int64_t> alive_unanswered_;  // when each was said, oldest first

  std::string_view line_;  // that is heard just now
  RigTraffic traffic_;
  std::deque<RigLineRefused> refused_lines_;
  std::int64_t refused_since_ns_ = 0;  // the second that counts
  int refused_lately_ = 0;
};

}  // namespace jnd
