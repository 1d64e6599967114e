// Real-time scheduling of the thread that drives devices: what was asked of the kernel, what it gave, and what to do
// where it did not.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace jnd {

// off: touch nothing. prefer: take what the machine gives. require: all of it or DeviceError.
enum class RealtimePolicy { off, prefer, require };

std::string_view to_string(RealtimePolicy policy) noexcept;
std::optional<RealtimePolicy> parse_realtime_policy(std::string_view word) noexcept;  // "off", "prefer", "require"

inline constexpr int kRealtimePriority = 50;  // of SCHED_FIFO: above programs, below the kernel's own urgent threads

struct RealtimeItem {
  std::string what;  // "SCHED_FIFO priority 50"
  bool ok = false;
  std::string detail;      // what is now so: "processor 1 of 0-1"
  std::string why_not;     // empty where ok
  std::string what_to_do;  // empty where ok
};

struct RealtimeReport {
  RealtimePolicy policy = RealtimePolicy::off;
  std::vector<RealtimeItem> items;  // empty for off; else scheduling, memory, processor, timer slack, power
  bool all_ok() const noexcept;
  bool fifo() const noexcept;  // whether SCHED_FIFO was given
  // One line an item that failed: what, why not, what to do. Empty where all is ok.
  std::string problems() const;
};

// Makes the calling thread real-time for as long as it lives, and gives the thread its former scheduling back:
// SCHED_FIFO priority 50, the process's memory locked (now and in future; unlocked with the last scope), one processor
// of its own, timer slack 1 ns; and, where the login may ask for it (not a failure where not), no deep sleep.
// Thread rule: made and destroyed by the same thread. Throws DeviceError under `require` where an item failed, naming
// all that did; nothing is then changed.
class RealtimeScope {
 public:
  explicit RealtimeScope(RealtimePolicy policy);
  ~RealtimeScope();
  RealtimeScope(const RealtimeScope&) = delete;
  RealtimeScope& operator=(const RealtimeScope&) = delete;

  const RealtimeReport& report() const noexcept { return report_; }

 private:
  struct Former;
  RealtimeReport report_;
  std::unique_ptr<Former> former_;
};

// Linux's list of processors, such as "0-3,8": ascending, without doubles. Empty for what is no such list.
std::vector<int> parse_processor_list(std::string_view text);
std::string processor_list_text(const std::vector<int>& processors);  // "0-3,8"

// Where a real-time thread goes: the last isolated processor, else the last allowed one; none where there is no choice.
std::optional<int> choose_processor(const std::vector<int>& allowed, const std::vector<int>& isolated) noexcept;

}  // namespace jnd
