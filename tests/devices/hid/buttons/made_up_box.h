// A bus with made-up devices that say what a test makes them say.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "devices/device_error.h"
#include "devices/hid/hid_bus.h"

namespace jnd::test {

// Any thread.
class MadeUpBus final : public HidBus {
 public:
  std::vector<HidInfo> list() override {
    const std::scoped_lock lock(wires_->mutex);
    return wires_->devices;
  }
  std::unique_ptr<HidHandle> open(const std::string& path) override;

  void plug(const HidInfo& info) {
    const std::scoped_lock lock(wires_->mutex);
    wires_->devices.push_back(info);
  }
  // All of them.
  void unplug() {
    const std::scoped_lock lock(wires_->mutex);
    wires_->devices.clear();
    wires_->reports.clear();
    wires_->changed.notify_all();
  }
  void send(const std::vector<std::uint8_t>& report) {
    const std::scoped_lock lock(wires_->mutex);
    wires_->reports.push_back(report);
    wires_->changed.notify_all();
  }
  // Until everything that was sent has been read and understood.
  void heard() {
    std::unique_lock lock(wires_->mutex);
    const std::int64_t before = wires_->empty_reads;
    wires_->changed.wait(lock, [&] { return wires_->reports.empty() && wires_->empty_reads > before; });
  }
  void refuse(const std::string& why) {
    const std::scoped_lock lock(wires_->mutex);
    wires_->refusal = why;
  }
  // What a device says to each report that is written to it; an empty report: nothing. Without this it takes none.
  using Answers = std::function<std::vector<std::uint8_t>(std::span<const std::uint8_t>)>;
  void answer(Answers answers) {
    const std::scoped_lock lock(wires_->mutex);
    wires_->answers = std::move(answers);
  }

 private:
  struct Wires {
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<HidInfo> devices;
    std::deque<std::vector<std::uint8_t>> reports;
    std::int64_t empty_reads = 0;
    std::string refusal;
    Answers answers;
  };
  class Handle final : public HidHandle {
   public:
    explicit Handle(std::shared_ptr<Wires> wires) : wires_(std::move(wires)) {}
    int read(std::span<std::uint8_t> bytes, int timeout_ms) noexcept override {
      std::unique_lock lock(wires_->mutex);
      if (wires_->reports.empty()) {
        ++wires_->empty_reads;
        wires_->changed.notify_all();
      }
      wires_->changed.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                               [this] { return !wires_->reports.empty() || wires_->devices.empty(); });
      if (wires_->devices.empty()) return kHidGone;
      if (wires_->reports.empty()) return kHidTimeOut;
      const std::vector<std::uint8_t> report = std::move(wires_->reports.front());
      wires_->reports.pop_front();
      const std::size_t count = std::min(report.size(), bytes.size());
      std::copy_n(report.begin(), count, bytes.begin());
      return static_cast<int>(count);
    }
    bool write(std::span<const std::uint8_t> bytes) noexcept override {
      const std::scoped_lock lock(wires_->mutex);
      if (!wires_->answers || wires_->devices.empty()) return false;
      if (std::vector<std::uint8_t> report = wires_->answers(bytes); !report.empty())
        wires_->reports.push_back(std::move(report));
      return true;
    }
    std::string error() const override { return "pulled out"; }

   private:
    std::shared_ptr<Wires> wires_;
  };
  std::shared_ptr<Wires> wires_ = std::make_shared<Wires>();
};

inline std::unique_ptr<HidHandle> MadeUpBus::open(const std::string& path) {
  const std::scoped_lock lock(wires_->mutex);
  if (!wires_->refusal.empty()) throw DeviceError(wires_->refusal);
  for (const HidInfo& info : wires_->devices)
    if (info.path == path) return std::make_unique<Handle>(wires_);
  throw DeviceError(path + " is not there");
}

inline HidInfo pedal_info() {
  HidInfo info;
  info.path = "/dev/made-up-pedal";
  info.vendor = 0x05f3;
  info.product = 0x00ff;
  info.usage_page = 0x0c;
  info.usage = 0x03;
  info.manufacturer = "PI Engineering";
  info.product_name = "Foot pedal";
  return info;
}

}  // namespace jnd::test
