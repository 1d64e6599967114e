#include "devices/external/rig_probe.h"

#include <algorithm>
#include <csignal>
#include <ctime>
#include <utility>

#include "analysis/numerics/special_values.h"
#include "protocols/version.h"

namespace jnd {

namespace {

constexpr int kProbeLook_ms = 2;

}  // namespace

// A write to a rig that is gone would end this program otherwise.
class BlockedSigpipe {
 public:
  BlockedSigpipe() noexcept {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~BlockedSigpipe() {
    const timespec at_once{};
    while (sigtimedwait(&pipe_, nullptr, &at_once) > 0) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  BlockedSigpipe(const BlockedSigpipe&) = delete;
  BlockedSigpipe& operator=(const BlockedSigpipe&) = delete;

 private:
  sigset_t pipe_{}, before_{};
};

RigProbe::RigProbe(const ExternalSettings& settings, const std::atomic<bool>& interrupted)
    : interrupted_(interrupted),
      sigpipe_(std::make_unique<BlockedSigpipe>()),
      connection_(settings),
      exchange_(kVersion, settings.time_outs, settings.token) {
  exchange_.begin(clock_.now_ns());
}

RigProbe::~RigProbe() = default;

void RigProbe::step() {
  if (interrupted_) {
    exchange_.stop(RigStop::emergency, clock_.now_ns());
    (void)connection_.write(exchange_.take_output());
    throw ProbeInterrupted();
  }
  connection_.wait(-1, kProbeLook_ms);
  const auto hear = [&](std::string_view line) {
    if (aside_) {
      ReadRigLine read = read_rig_line(line);
      const bool alive = read.message && std::holds_alternative<RigAlive>(*read.message);
      if (!alive) overheard_.push_back(std::move(read));
      if (!alive) return;
    }
    exchange_.hear(line, clock_.now_ns());
  };
  while (connection_.read(hear, [&](std::string_view line) { exchange_.hear_too_long(line, clock_.now_ns()); })) {
  }
  if (!connection_.is_open()) exchange_.end(RigFailure::ended, "it closed its output", clock_.now_ns());
  if (silent_) return;
  exchange_.tick(clock_.now_ns());
  if (!connection_.write(exchange_.take_output()))
    exchange_.end(RigFailure::ended, "it closed its input", clock_.now_ns());
}

bool RigProbe::until(double seconds, const std::function<bool()>& over) {
  const double end_s = now_s() + seconds;
  while (!over()) {
    if (exchange_.lost() || now_s() >= end_s) return false;
    step();
  }
  return true;
}

Probed RigProbe::present(const RenderRequest& request, const Course& course) {
  Probed probed;
  (void)exchange_.take_events();
  std::string why;
  const double asked_s = now_s();
  const std::uint64_t id = exchange_.prepare(request, clock_.now_ns(), why);
  if (id == 0) {
    probed.voided = RigVoid{0, RigFailure::ended, why};
    return probed;
  }
  double present_s = kInf;
  std::optional<double> stop_s, stopped_s;
  while (!probed.done && !probed.voided) {
    for (const RigEvent& event : exchange_.take_events()) {
      if (std::holds_alternative<RigReady>(event.what)) {
        probed.ready_ms = 1000 * (now_s() - asked_s);
        present_s = now_s() + course.hold_s;
      }
      if (std::holds_alternative<RigContact>(event.what)) {
        ++probed.contacts;
        if (course.stop_after_s && !stop_s) stop_s = now_s() + *course.stop_after_s;
      }
      if (const auto* done = std::get_if<RigDone>(&event.what)) probed.done = *done;
      if (const auto* voided = std::get_if<RigVoid>(&event.what)) probed.voided = *voided;
    }
    if (now_s() >= present_s) {
      present_s = kInf;
      (void)exchange_.present(id, clock_.now_ns());
      if (course.stop_after_s && course.reason != RigStop::enough) stop_s = now_s() + *course.stop_after_s;
    }
    if (stop_s && !stopped_s && now_s() >= *stop_s) {
      stopped_s = now_s();
      exchange_.stop(course.reason, clock_.now_ns());
    }
    if (!probed.done && !probed.voided) step();
  }
  // A presentation that is stopped is void at once; the rig's "done" tells when it really ended, its "fault" that it gave
  // up by itself.
  (void)until(kInf, [&] { return exchange_.idle(); });
  if (stopped_s) probed.stopped_ms = 1000 * (now_s() - *stopped_s);
  for (const RigEvent& event : exchange_.take_events())
    if (const auto* fault = std::get_if<RigFault>(&event.what))
      probed.voided = RigVoid{id, RigFailure::rig_fault, "the rig says: " + ascii_quote(fault->cause)};
  return probed;
}

void RigProbe::say(std::string_view line) {
  (void)connection_.write(line);
}

std::vector<ReadRigLine> RigProbe::overhear(double seconds, const std::function<bool(const RigMessage&)>& enough) {
  overheard_.clear();
  aside_ = true;
  (void)until(seconds, [&] {
    return std::any_of(overheard_.begin(), overheard_.end(),
                       [&](const ReadRigLine& read) { return read.message && enough(*read.message); });
  });
  aside_ = false;
  return std::exchange(overheard_, {});
}

std::vector<ReadRigLine> RigProbe::keep_silent(double seconds, const std::function<bool(const RigMessage&)>& enough) {
  silent_ = true;
  std::vector<ReadRigLine> read = overhear(seconds, enough);
  silent_ = false;
  return read;
}

bool RigProbe::leave(double seconds, bool with_bye) {
  if (with_bye) {
    exchange_.bye();
    (void)connection_.write(exchange_.take_output());
  } else {
    connection_.close_input();
  }
  return connection_.leave(std::chrono::milliseconds(static_cast<int>(1000 * seconds)));
}

std::string RigProbe::end(int grace_ms) {
  return connection_.end(std::chrono::milliseconds(grace_ms));
}

}  // namespace jnd
