// A rig on the bench: a connection and a conversation driven by the caller, who may also say what a session never would
// and look at every line. For `jnd device test external`.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "devices/clock.h"
#include "devices/external/rig_connection.h"
#include "devices/external/rig_exchange.h"
#include "devices/external/rig_line.h"

namespace jnd {

// It was interrupted; the rig was ended.
class ProbeInterrupted : public std::runtime_error {
 public:
  ProbeInterrupted() : std::runtime_error("interrupted; the rig was told to stop and was ended") {}
};

// How a presentation went on the bench.
struct Probed {
  std::optional<RigDone> done;
  std::optional<RigVoid> voided;
  double ready_ms = 0;    // from "prepare" to "ready"
  double contacts = 0;    // messages
  double stopped_ms = 0;  // from "stop" to "done"; 0 where it was not stopped
};

// Thread rule: one thread, whose SIGPIPE is blocked while this lives.
class RigProbe {
 public:
  // Starts it and says hello. Throws DeviceError where it cannot be started. Everything below throws ProbeInterrupted
  // once `interrupted` is set.
  RigProbe(const ExternalSettings& settings, const std::atomic<bool>& interrupted);
  ~RigProbe();
  RigProbe(const RigProbe&) = delete;
  RigProbe& operator=(const RigProbe&) = delete;

  // Goes on until `over` holds, the rig is lost, or so long. Whether `over` holds.
  bool until(double seconds, const std::function<bool()>& over);

  // When a presentation is told to present, and to stop.
  struct Course {
    double hold_s = 0;                     // from "ready" to "present"
    std::optional<double> stop_after_s{};  // from "present"; of one that is enough, from the first contact
    RigStop reason = RigStop::interrupted;
  };
  Probed present(const RenderRequest& request, const Course& course);

  // What a session never says: a line as it is; and what the rig makes of it. Answers to "alive" go to the conversation
  // all the same.
  void say(std::string_view line);
  std::vector<ReadRigLine> overhear(double seconds, const std::function<bool(const RigMessage&)>& enough);
  // Says nothing for so long, not even "alive".
  std::vector<ReadRigLine> keep_silent(double seconds, const std::function<bool(const RigMessage&)>& enough);

  // Says bye, or only closes its input. Whether it ended by itself within so long.
  bool leave(double seconds, bool with_bye);
  std::string end(int grace_ms);

  const RigExchange& exchange() const noexcept { return exchange_; }
  const RigConnection& connection() const noexcept { return connection_; }
  double now_s() const noexcept { return 1e-9 * static_cast<double>(clock_.now_ns()); }

 private:
  void step();

  SteadyClock clock_;
  const std::atomic<bool>& interrupted_;
  std::unique_ptr<class BlockedSigpipe> sigpipe_;
  RigConnection connection_;
  RigExchange exchange_;
  bool aside_ = false;   // lines are overheard
  bool silent_ = false;  // nothing is said
  std::vector<ReadRigLine> overheard_;
};

}  // namespace jnd
