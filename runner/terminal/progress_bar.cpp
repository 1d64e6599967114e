#include "runner/terminal/progress_bar.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

ProgressBar::ProgressBar(std::string what, std::int64_t total)
    : what_(std::move(what)), total_(std::max<std::int64_t>(total, 1)), terminal_(is_terminal(STDERR_FILENO)) {}

ProgressBar::~ProgressBar() {
  if (drawn_) write_message("\n");
}

void ProgressBar::update(std::int64_t done) {
  const double share = std::clamp(static_cast<double>(done) / static_cast<double>(total_), 0.0, 1.0);
  if (!terminal_) {
    const int tenths = static_cast<int>(share * 10);
    if (tenths <= shown_tenths_) return;
    shown_tenths_ = tenths;
    print_message("{}: {} of {}\n", what_, done, total_);
    return;
  }
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const std::string left = share > 0.02 && share < 1 ? duration_text(elapsed * (1 - share) / share) + " left" : "";
  constexpr int kWidth = 30;
  const int filled = static_cast<int>(share * kWidth);
  print_message("\r{} [{}{}] {} of {}  {:<14}", what_, std::string(static_cast<std::size_t>(filled), '#'),
                std::string(static_cast<std::size_t>(kWidth - filled), '.'), done, total_, left);
  drawn_ = true;
}

}  // namespace jnd
