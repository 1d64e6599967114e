// jnd with rigs of the tests, never installed. Their devices are the simulated ones, and no person feels anything.
// Usually the rig declares itself real: for tests of what only real sessions do. With JND_TEST_RIG=paced it is an
// ordinary simulated rig that lasts as long as in a laboratory and is never held up.
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "runner/command_line.h"
#include "runner/opening/rig_source.h"

namespace {

using namespace jnd;

// The loop runs on a simulated clock, so that a busy machine cannot make it late: presentations take no time.
class DeclaredRealRig final : public Rig {
 public:
  DeclaredRealRig(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                  int participant, std::uint64_t seed, RigOptions options) {
    options.realtime.reset();
    rig_ = make_simulated_rig(protocol, rig, profile, participant, seed, clock_, options);
    info_ = rig_->info();
    info_.simulated = false;
  }
  const RigInfo& info() const noexcept override { return info_; }
  Presentation present(const PresentRequest& request) override {
    rig_->stop.clear();
    if (stop.latched()) rig_->stop.latch(stop.source());
    return rig_->present(request);
  }
  void neutral() noexcept override { rig_->neutral(); }
  TelemetryRing* telemetry() noexcept override { return rig_->telemetry(); }
  TelemetryRing* live() noexcept override { return rig_->live(); }

 private:
  SimulatedClock clock_{0};
  std::unique_ptr<Rig> rig_;
  RigInfo info_;
};

// A wait lasts as long as on the machine's clock, and ends exactly when it was to.
class PacedClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override { return now_ns_.load(); }
  std::int64_t utc_ns() const noexcept override { return machine_.utc_ns(); }
  void sleep_until_ns(std::int64_t deadline) noexcept override {
    if (deadline <= now_ns_) return;
    machine_.sleep_until_ns(machine_.now_ns() + deadline - now_ns_);
    now_ns_ = deadline;
  }

 private:
  SteadyClock machine_;
  std::atomic<std::int64_t> now_ns_ = machine_.now_ns();
};

class PacedRigs final : public RigSource {
 public:
  RigInfo info(const Protocol& protocol, const RigSpec& spec) const override {
    return simulated_rig_info(protocol, spec);
  }
  std::unique_ptr<Rig> make(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                            int participant, std::uint64_t seed, Clock& /*clock*/,
                            const RigOptions& options) const override {
    return make_simulated_rig(protocol, rig, profile, participant, seed, clock_, options);
  }

 private:
  mutable PacedClock clock_;  // of one session
};

class DeclaredRealRigs final : public RigSource {
 public:
  RigInfo info(const Protocol& protocol, const RigSpec& spec) const override {
    RigInfo info = simulated_rig_info(protocol, spec);
    info.simulated = false;
    return info;
  }
  std::unique_ptr<Rig> make(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                            int participant, std::uint64_t seed, Clock& /*clock*/,
                            const RigOptions& options) const override {
    return std::make_unique<DeclaredRealRig>(protocol, rig, profile, participant, seed, options);
  }
};

}  // namespace

int main(int argc, char** argv) {
  const DeclaredRealRigs real;
  const PacedRigs paced;
  const char* const wanted = std::getenv("JND_TEST_RIG");  // NOLINT(concurrency-mt-unsafe): one thread yet
  jnd::set_rig_source(wanted != nullptr && std::string_view(wanted) == "paced" ? static_cast<const RigSource*>(&paced)
                                                                               : &real);
  return jnd::run_command_line(argc, argv);
}
