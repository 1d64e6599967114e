// A rig that is any program of the laboratory: it renders the stimulus at its own rate, and speaks the lines of
// devices/external/PROTOCOL.md with this one. What it presents is limited by itself, not by this program's governor.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "devices/clock.h"
#include "devices/emergency_stop.h"
#include "devices/external/external_settings.h"
#include "devices/external/rig_connection.h"
#include "devices/external/rig_exchange.h"

namespace jnd {

// How a presentation ended.
struct Rendered {
  std::optional<RigDone> done;    // complete; or else
  std::optional<RigVoid> voided;  // why it does not count
  std::vector<RigTelemetry> telemetry;
  std::vector<RigContact> contacts;
};

// What the rig was like since this was made; for the log.
struct ExternalReport {
  std::optional<RigHello> hello;  // of the newest connection that said one
  std::string source;             // the command or the address
  bool connected = false;
  std::string trouble;  // why it is not, or was not last; printable ASCII
  int starts = 0;       // of the program, or connections made
  RigTraffic traffic;
  std::vector<RigLineRefused> refused;  // the newest
};

// What the results have a place for. A rig that is lost is `device_lost`, one that was silent
// `stale_reading`, one that says a fault or whose words were refused `device_fault`.
Fault fault_of(RigFailure failure) noexcept;
// The part of a presentation that every rig has: first contact, duration, fault, who stopped it. An external rig has no
// fingers of ours: its numbers are RigDone's own.
Presentation presentation_of(const Rendered& rendered, StopSource stopped_by);

// The rig runs until this is destroyed: it is started at once, and after a fault ended with its whole session and started
// anew: at once, and where that does not last a second either, after one second, then two, up to five. Nothing is
// repeated by itself: a presentation that was under way ends as RigVoid. A thread of its own keeps up `alive`, so the
// caller may take its time. Thread rule: any thread, but one at a time drives presentations (prepare to wait, render).
class ExternalRig {
 public:
  // clock: the machine's monotonic one. Latched, `stop` lets nothing be presented, and stops what is presented or gets
  // ready: any thread may latch it, signal handlers too. Both must outlive the rig. Throws DeviceError only where the
  // machine has no thread or file left: a rig that cannot be started is missing().
  ExternalRig(ExternalSettings settings, const Clock& clock, const EmergencyStop& stop);
  // Says bye, gives it a second to end by itself, and ends it.
  ~ExternalRig();
  ExternalRig(const ExternalRig&) = delete;
  ExternalRig& operator=(const ExternalRig&) = delete;

  // Waits until it has said hello and is not lost, or has failed to start, or so long. Whether it is there.
  bool await_hello(double time_out_s) const;
  std::optional<RigHello> hello() const;
  // Why nothing can be presented, in the operator's words: not started, silent, ended and how, cannot be started again;
  // empty: nothing is missing.
  std::string missing() const;
  // The same without what the rig said itself, which may name what it presents.
  std::string missing_sealed() const;
  ExternalReport report() const;

  // One presentation from "prepare" to its end. hear: each event as it comes, on this thread. While `stop` is latched
  // nothing is presented; latched meanwhile, it is passed on within 5 ms. It always returns: at the latest after
  // prepare_s + silent_s + time_out_s + 0.3 s. enough: asked some times a second on this thread; true ends the presentation as it
  // should end, once.
  Rendered render(const RenderRequest& request, const std::function<void(const RigEvent&)>& hear = {},
                  const std::function<bool()>& enough = {});
  // The same of what prepare() has begun: void if it is not ready now.
  Rendered render_prepared(std::uint64_t id, const std::function<void(const RigEvent&)>& hear = {},
                           const std::function<bool()>& enough = {});
  // Nothing is presented any more, nor ready; waits for the rig's word.
  void let_go();

  // The same in steps, for a caller that does something in between. Each id ends with RigDone or RigVoid in wait().
  // 0 and `why`: the rig is missing, or has not said that it can do this.
  std::uint64_t prepare(const RenderRequest& request, std::string& why);
  bool prepares(std::uint64_t id) const;  // gets ready, or is
  bool present(std::uint64_t id);         // false: not ready
  std::uint64_t ask(const std::vector<std::string>& answers);
  void stop_with(RigStop reason);
  // What has come, as soon as there is anything, or nothing at `until_ns` of the clock.
  std::vector<RigEvent> wait(std::int64_t until_ns);

 private:
  Rendered follow(std::uint64_t id, bool presents, const std::function<void(const RigEvent&)>& hear,
                  const std::function<bool()>& enough);
  void await_rest();
  void serve() noexcept;
  void serve_once();
  void converse(RigConnection& connection);
  void part(RigConnection& connection);
  bool pause_until(std::int64_t until_ns) const;
  void hear_all(RigConnection& connection);
  void settle();
  void pass_on_stop();
  void say(const std::string& trouble, const std::string& sealed);
  bool leaving() const;

  const ExternalSettings settings_;
  const std::string source_;
  const Clock& clock_;
  const EmergencyStop& stop_;

  mutable std::mutex mutex_;
  mutable std::condition_variable news_;
  RigExchange exchange_;
  std::string trouble_;                 // empty while it is there
  std::string sealed_;                  // trouble_ without words of the rig
  int starts_ = 0, failed_starts_ = 0;  // failed: in a row
  bool is_trying_ = false;              // it is started, or runs
  bool leave_ = false;
  bool stop_passed_on_ = false;

  int wake_;  // an eventfd: something to write, or the thread is to end
  std::thread thread_;
};

}  // namespace jnd
