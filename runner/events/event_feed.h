// What happens in a session, told to another program while it happens: a JSON object a line, each with its time. A
// bridge makes of it what a laboratory's other instruments read (README.md of this folder).
//
// Nothing of a stimulus, a condition, an answer or its correctness is in it. A reader that is slow or gone delays
// nothing: what does not fit into a queue is dropped, and counted.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include <nlohmann/json.hpp>

#include "devices/hid/socket/local_socket.h"
#include "runner/session/session_listener.h"

namespace jnd {

inline constexpr std::size_t kMostEventsQueued = 1024;

// Thread rule: the session's thread; a thread of its own writes.
class EventFeed final : public SessionListener {
 public:
  // where: the number of an open file descriptor above 2, or the path of a Unix socket (stream) on which the reader
  // listens. Throws InputError where it is neither, or a file that would be written over. study: whose files are none
  // of its places.
  explicit EventFeed(const std::string& where, const std::filesystem::path& study = {});
  // Within half a second, whatever the reader does.
  ~EventFeed() override;
  EventFeed(const EventFeed&) = delete;
  EventFeed& operator=(const EventFeed&) = delete;

  void trial(const TrialOutline& outline) override;
  bool cue(CuePlace place, const CueSignal& cue) override;
  void interval_over() override;
  void answered(const TrialOutline& outline, const Answer& answer) override;
  void voided(const TrialOutline& outline, const std::string& reason) override;
  void happened(std::string_view moment) override;

  // Lets the reader have what is queued, for at most half a second; then nothing more is told.
  void finish();
  // Lines that the reader did not get.
  std::int64_t dropped() const;

 private:
  void tell(std::string_view event, const nlohmann::ordered_json& members = nlohmann::ordered_json::object());
  void serve() noexcept;
  bool hand_over(std::string_view line) noexcept;

  OwnedFile file_;
  bool is_socket_ = false;
  int interval_ = 0;  // of the trial, from 1; 0: none yet

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> queue_;
  std::int64_t told_ = 0, dropped_ = 0;
  bool ends_ = false, gone_ = false;
  std::int64_t give_up_ns_ = 0;  // once it ends; of the monotonic clock
  std::thread thread_;
};

}  // namespace jnd
