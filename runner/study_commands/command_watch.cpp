// jnd watch: a board of a study that runs, for somebody who is not in the room.
#include <array>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <unistd.h>

#include "analysis/numerics/stop_request.h"
#include "data/log/storage_error.h"
#include "data/study/study_lock.h"
#include "devices/clock.h"
#include "runner/keys/interrupt.h"
#include "runner/keys/keyboard.h"
#include "runner/keys/screen_restore.h"
#include "runner/study_commands/study_board.h"
#include "runner/study_commands/study_commands.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

struct WatchOptions {
  std::string study;
  bool once = false;
};

constexpr double kRedraw_s = 1;
constexpr int kRowsBelow = 3;                           // of the board: what cannot be read just now, and the keys
constexpr const char* kEnter = "\x1b[?1049h\x1b[?25l";  // a screen of its own, without cursor
constexpr const char* kLeave = "\x1b[?25h\x1b[?1049l";

// When the study's file and what is still to be merged into it were changed, and how long they are.
using FileMark = std::array<std::int64_t, 4>;

FileMark mark_of(const fs::path& study) {
  FileMark mark{};
  std::size_t place = 0;
  for (const fs::path& file : {study, fs::path(study.string() + "-wal")}) {
    std::error_code error;
    const auto time = fs::last_write_time(file, error);
    mark[place++] = error ? 0 : time.time_since_epoch().count();
    const auto size = fs::file_size(file, error);
    mark[place++] = error ? 0 : static_cast<std::int64_t>(size);
  }
  return mark;
}

// Opened for each look and closed again: what stays open could keep the writer from bringing the study into one file.
StudyOverview look(const std::string& study) {
  StudyOverview overview = overview_of(*Study::open(study, Study::Access::read_only));
  overview.in_use = in_use(study);
  return overview;
}

class Board {
 public:
  // The mark first: what is written while it looks is seen at the next look.
  explicit Board(std::string study) : study_(std::move(study)), mark_(mark_of(study_)), overview_(look(study_)) {}

  // Looks again where the file has changed, and draws. Of a large study a look takes long: then they come less often, so
  // that the machine of the session has its processors for itself.
  void draw() {
    const SteadyClock clock;
    const std::int64_t begun = clock.now_ns();
    if (const FileMark now = mark_of(study_); now != mark_ && begun >= next_look_ns_) {
      refresh(now);
      constexpr std::int64_t kRest = 10;  // times as long as a look takes
      next_look_ns_ = clock.now_ns() + kRest * (clock.now_ns() - begun);
    }
    // A session that is killed changes no file.
    if (!overview_.open().empty()) overview_.in_use = in_use(study_);
    std::string text = board_text(overview_, study_, clock.utc_ns(), terminal_rows() - kRowsBelow, table_width());
    if (!trouble_.empty()) text += "\n  " + warn(printable("not read just now: " + trouble_)) + "\n";
    std::string screen = "\x1b[H";
    for (const char c : text) screen += c == '\n' ? std::string("\x1b[K\n") : std::string(1, c);
    fmt::print("{}\x1b[K\n  {}\x1b[K\x1b[J", screen, dim("q leaves"));
    std::fflush(stdout);
  }

 private:
  void refresh(const FileMark& now) {
    try {
      overview_ = look(study_);
      mark_ = now;
      trouble_.clear();
    } catch (const StorageError& error) {  // busy, or just replaced: the next look may see it
      trouble_ = error.what();
    }
  }

  std::string study_;
  FileMark mark_;
  StudyOverview overview_;
  std::int64_t next_look_ns_ = 0;
  std::string trouble_;
};

class FullScreen {
 public:
  FullScreen() {
    fmt::print("{}", kEnter);
    guard_screen(kLeave);
  }
  ~FullScreen() {
    std::fflush(stdout);
    [[maybe_unused]] const ssize_t written = write(STDOUT_FILENO, kLeave, std::string_view(kLeave).size());
    guard_screen("");
  }
  FullScreen(const FullScreen&) = delete;
  FullScreen& operator=(const FullScreen&) = delete;
};

bool is_leave(const std::optional<Key>& key) {
  return key && (key->is(U'q') || key->is(U'Q'));
}

int watch(const std::string& study) {
  const HoldInterrupts hold;  // Ctrl-C is a way to leave
  Board board(study);
  {
    Keyboard keyboard;
    const FullScreen screen;
    do board.draw();
    while (!is_leave(keyboard.press(kRedraw_s)) && !interrupt_requested());
  }
  interrupts().end = false;
  stop_requested() = false;
  return exit_code::kDone;
}

int command_watch(const WatchOptions& options) {
  if (options.once) {
    const SteadyClock clock;
    fmt::print("{}", board_text(look(options.study), options.study, clock.utc_ns(), 0, table_width()));
    return exit_code::kDone;
  }
  if (!is_terminal(STDOUT_FILENO) || !is_terminal(STDIN_FILENO))
    throw UsageError("jnd watch needs a terminal; --once prints the board once");
  return watch(options.study);
}

}  // namespace

void add_watch(CommandTree& tree) {
  const auto [command, options] =
      tree.add("watch", "Show the progress of a study and its open session, live; it changes nothing",
               "jnd watch s.sqlite", command_watch);
  command.add_option("STUDY", options.study, "the study's file").required();
  command.add_flag("--once", options.once, "print the board once, for scripts");
}

}  // namespace jnd
