#include "devices/trackers/pose_feed.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace jnd {

namespace {

// A longer wait is an outage, not a slow stream: it does not count towards the rate.
constexpr std::int64_t kOutage_ns = 1'000'000'000;
// A source that goes back by more has begun anew.
constexpr std::int64_t kAnew_ns = 1'000'000'000;

std::string in_words(const std::string& finger) {
  return finger == "thumb" ? finger : finger + " finger";
}

}  // namespace

void DelayHistogram::add(std::int64_t delay_ns) noexcept {
  const std::int64_t delay = std::max<std::int64_t>(delay_ns, 0);
  largest_ns_ = std::max(largest_ns_, delay);
  ++counts_[std::min(static_cast<std::size_t>(delay / kStep_ns), kSteps - 1)];
  ++total_;
}

double DelayHistogram::percentile_ms(double share) const noexcept {
  const double wanted = share * static_cast<double>(total_);
  std::int64_t seen = 0;
  for (std::size_t step = 0; step < kSteps; ++step) {
    seen += counts_[step];
    if (seen > 0 && static_cast<double>(seen) >= wanted)
      return step + 1 < kSteps ? 1e-6 * static_cast<double>(static_cast<std::int64_t>(step) * kStep_ns) : largest_ms();
  }
  return 0;
}

PoseFeed::PoseFeed(const std::vector<std::string>& fingers, const Eigen::Isometry3d& to_world)
    : fingers_(fingers), to_world_(to_world), slots_(fingers.size()), streams_(fingers.size()) {
  places_.fill(-1);
  for (std::size_t name = 0; name < kFingerNames.size(); ++name)
    for (std::size_t place = 0; place < fingers.size(); ++place)
      if (fingers[place] == kFingerNames[name]) places_[name] = static_cast<int>(place);
}

void PoseFeed::begin() noexcept {
  clock_.begin();
  const std::lock_guard lock(mutex_);
  sequence_.reset();
  for (Stream& stream : streams_) stream.any = stream.lost = false;
}

void PoseFeed::count_sequence(const PoseLine& pose) noexcept {
  if (!pose.sequence) return;
  if (sequence_) {
    const std::uint32_t skipped = *pose.sequence - *sequence_ - 1;
    if (skipped < 0x8000'0000U) gaps_ += skipped;  // otherwise it went back
  }
  sequence_ = pose.sequence;
}

void PoseFeed::count_wait(Stream& stream, std::int64_t arrival_ns) noexcept {
  if (stream.arrival_ns) {
    const std::int64_t wait_ns = arrival_ns - *stream.arrival_ns;
    longest_wait_ns_ = std::max(longest_wait_ns_, wait_ns);
    if (wait_ns <= kOutage_ns) {
      ++stream.waits;
      stream.waited_ns += wait_ns;
    }
    if (!sequence_ && wait_ns > kOldestPose_ns) ++gaps_;
  }
  stream.arrival_ns = arrival_ns;
}

// Nothing arrives before it was true: the shortest delay of late is taken for none.
std::int64_t PoseFeed::on_our_clock_ns(std::int64_t source_ns, std::int64_t arrival_ns) noexcept {
  const auto source_us = static_cast<std::uint64_t>((source_ns + kLongestPoseTime_ns) / 1000);
  clock_.add_arrival(source_us, arrival_ns);
  return clock_.to_host_ns(source_us);
}

bool PoseFeed::take(const PoseLine& pose, PoseClock clock, std::int64_t arrival_ns) noexcept {
  const std::int64_t true_ns = clock == PoseClock::source ? on_our_clock_ns(pose.time_ns, arrival_ns) : pose.time_ns;
  const std::lock_guard lock(mutex_);
  count_sequence(pose);
  const int place = places_[static_cast<std::size_t>(pose.finger)];
  if (place < 0) return true;
  Stream& stream = streams_[static_cast<std::size_t>(place)];
  if (!pose.seen) {
    stream.lost = true;
    stream.arrival_ns.reset();  // waiting for a finger that is not there is no fault of the stream
    return true;
  }
  const std::int64_t back_ns = stream.time_ns - pose.time_ns;
  if (true_ns > arrival_ns + kMostAhead_ns || (stream.any && back_ns >= 0 && back_ns < kAnew_ns)) {
    ++refused_;
    return false;
  }
  stream.any = true;
  stream.lost = false;
  stream.time_ns = pose.time_ns;
  stream.true_ns = std::min(true_ns, arrival_ns);  // no pose is newer than its arrival
  ++poses_;
  delays_.add(arrival_ns - true_ns);
  count_wait(stream, arrival_ns);

  const Eigen::Vector3d position = to_world_ * pose.position_m;
  const Eigen::Matrix3d axes = to_world_.linear() * pose.orientation.toRotationMatrix();
  Slot slot;
  std::copy_n(position.data(), 3, slot.position.begin());
  std::copy_n(axes.data(), 9, slot.axes.begin());
  slot.flexion = pose.flexion_rad;
  slot.time_ns = stream.true_ns;
  slot.any = 1;
  slots_[static_cast<std::size_t>(place)].put(slot);
  return true;
}

void PoseFeed::refuse() noexcept {
  const std::lock_guard lock(mutex_);
  ++refused_;
}

bool PoseFeed::read(int finger, FingerPose& pose) noexcept {
  if (finger < 0 || static_cast<std::size_t>(finger) >= slots_.size()) return false;
  const Slot slot = slots_[static_cast<std::size_t>(finger)].look();
  if (slot.any == 0) return false;
  pose.position_m = Eigen::Map<const Eigen::Vector3d>(slot.position.data());
  pose.device_axes = Eigen::Map<const Eigen::Matrix3d>(slot.axes.data());
  pose.flexion_rad = slot.flexion;
  pose.time_ns = slot.time_ns;
  return true;
}

void PoseFeed::add_to(TrackerReport& report) const {
  const std::lock_guard lock(mutex_);
  report.poses = poses_;
  report.gaps = gaps_;
  report.refused = refused_;
  report.latency_p50_ms = delays_.percentile_ms(0.5);
  report.latency_p99_ms = delays_.percentile_ms(0.99);
  report.latency_max_ms = delays_.largest_ms();
  report.longest_wait_ms = 1e-6 * static_cast<double>(longest_wait_ns_);
  bool first = true;
  for (const Stream& stream : streams_) {
    const double rate =
        stream.waited_ns > 0 ? 1e9 * static_cast<double>(stream.waits) / static_cast<double>(stream.waited_ns) : 0;
    report.rate_hz = first ? rate : std::min(report.rate_hz, rate);  // of the slowest finger
    first = false;
  }
}

std::string PoseFeed::missing(std::int64_t now_ns) const {
  const std::lock_guard lock(mutex_);
  for (std::size_t place = 0; place < fingers_.size(); ++place) {
    const Stream& stream = streams_[place];
    if (stream.lost) return fmt::format("the tracker does not see the {}", in_words(fingers_[place]));
    if (!stream.any) return fmt::format("no pose of the {} has come yet", in_words(fingers_[place]));
    const std::int64_t age_ns = now_ns - stream.true_ns;
    if (age_ns > kOldestPose_ns)
      return fmt::format("the newest pose of the {} is {:.0f} ms old (at most {} ms)", in_words(fingers_[place]),
                         1e-6 * static_cast<double>(age_ns), kOldestPose_ns / 1'000'000);
  }
  return {};
}

}  // namespace jnd
