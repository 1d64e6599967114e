// One connection to a device, shared by every handle that this program has on it: each gets every report, as on a
// hidraw node.
//
// No thread of its own: of the handles that wait for a report one listens, and hands what comes to all of them.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/hid_bus.h"
#include "devices/hid/socket/local_socket.h"

namespace jnd {

// What a device may send: four times what one of 1 kHz does, and what a machine that was held up for half a second
// delivers at once. One that sends more is cut off: it would keep the reading thread from everything else.
inline constexpr int kMostReportsPerSecond = 4000, kMostReportsAtOnce = 2000;

// Thread rule: any thread; it must outlive its handles, which keep it.
class SharedSocket : public std::enable_shared_from_this<SharedSocket> {
 public:
  // socket: connected. meanwhile: called about ten times a second by whichever thread listens, and may be empty.
  explicit SharedSocket(OwnedFile socket, std::function<void()> meanwhile = {});

  // Its owner must be kept by a shared_ptr.
  std::unique_ptr<HidHandle> handle();
  // The other end closed it, or was cut off.
  bool is_gone() const noexcept { return gone_.load(); }
  std::string trouble() const;  // why, for people; empty: it is not gone

 private:
  class Handle;

  struct Packet {
    std::uint8_t size = 0;  // of a report JND_REPORT_SIZE; of what is none, less
    std::array<std::uint8_t, JND_REPORT_SIZE> bytes{};
  };
  // Of one handle: what it has not read yet. The oldest goes where it does not read.
  struct Mailbox {
    std::array<Packet, kReportsQueued> packets{};
    std::size_t first = 0, count = 0;
    void put(const Packet& packet) noexcept;
    int take(std::span<std::uint8_t> bytes) noexcept;
  };

  using Time = std::int64_t;  // ns of the steady clock
  int read(Mailbox& mine, std::span<std::uint8_t> bytes, int timeout_ms) noexcept;
  bool write(std::span<const std::uint8_t> report) noexcept;
  // One packet, waited for until then; false: none came.
  bool receive(Packet& packet, Time until) noexcept;
  bool may_send(Time now) noexcept;
  void lose(const char* why) noexcept;

  const OwnedFile socket_;
  const std::function<void()> meanwhile_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::list<Mailbox*> mailboxes_;
  bool listening_ = false;  // one handle is, outside the lock
  std::atomic<bool> gone_{false};
  std::atomic<const char*> trouble_{""};
  // The listening handle's.
  Time meanwhile_at_ = 0, allowed_at_ = 0;
  double allowed_ = kMostReportsAtOnce;
};

}  // namespace jnd
