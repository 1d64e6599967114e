#include "runner/screen/screen_painter.h"

#include <clocale>
#include <cstdint>
#include <cstdlib>
#include <string>

#define NCURSES_WIDECHAR 1
#include <curses.h>
#include <langinfo.h>
#include <sys/ioctl.h>
#include <term.h>
#include <unistd.h>

#include "protocols/input/utf8.h"
#include "runner/keys/line_editor.h"
#include "runner/keys/screen_restore.h"

// ncurses defines these as macros.
#undef columns
#undef lines

namespace jnd {

namespace {

// The pair of a shade in ncurses' table; 0 is the terminal's own.
short pair_number(Shade shade) noexcept {
  return static_cast<short>(shade);
}

// A terminfo string, without its padding marks.
std::string capability(const char* name) {
  const char* const value = tigetstr(const_cast<char*>(name));
  if (value == nullptr || reinterpret_cast<std::intptr_t>(value) == -1) return "";
  std::string text = value;
  for (std::size_t from = text.find("$<"); from != std::string::npos; from = text.find("$<")) {
    const std::size_t to = text.find('>', from);
    text.erase(from, to == std::string::npos ? std::string::npos : to - from + 1);
  }
  return text;
}

std::wstring wide(const std::string& utf8) {
  std::wstring text;
  for (const char32_t c : code_points(utf8)) text += static_cast<wchar_t>(c);
  return text;
}

}  // namespace

struct ScreenPainter::Screen {
  SCREEN* screen = nullptr;
};

bool ScreenPainter::possible() {
  int error = 0;
  const bool able =
      setupterm(nullptr, STDOUT_FILENO, &error) == OK && !capability("cup").empty() && !capability("clear").empty();
  if (cur_term != nullptr) del_curterm(cur_term);  // newterm() makes its own
  return able;
}

ScreenPainter::ScreenPainter() : screen_(std::make_unique<Screen>()), losses_(terminal_losses()) {
  std::setlocale(LC_CTYPE, "");
  unicode_ = std::string(nl_langinfo(CODESET)) == "UTF-8";
  screen_->screen = newterm(nullptr, stdout, stdin);
  if (screen_->screen == nullptr) return;
  guard_screen(capability("sgr0") + capability("rmcup") + capability("cnorm"));
  nl();           // as the keyboard sets the terminal
  typeahead(-1);  // standard input is the keyboard's alone
  curs_set(0);
  colours_ = std::getenv("NO_COLOR") == nullptr && has_colors();
  if (!colours_) return;
  start_color();
  use_default_colors();
  for (const Shade shade : kShades) {
    const ColourPair pair = colours_of(shade, COLORS);
    init_pair(pair_number(shade), pair.foreground, pair.background);
  }
}

ScreenPainter::~ScreenPainter() {
  if (screen_->screen == nullptr) return;
  endwin();
  guard_screen("");
  delscreen(screen_->screen);
}

int ScreenPainter::rows() const noexcept {
  return screen_->screen == nullptr ? 0 : LINES;
}
int ScreenPainter::columns() const noexcept {
  return screen_->screen == nullptr ? 0 : COLS;
}

bool ScreenPainter::changed() {
  if (screen_->screen == nullptr) return false;
  bool changed = false;
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 && size.ws_col > 0 &&
      (size.ws_row != LINES || size.ws_col != COLS)) {
    resizeterm(size.ws_row, size.ws_col);
    changed = true;
  }
  if (const int now = terminal_losses(); now != losses_) {
    losses_ = now;
    reset_prog_mode();
    clearok(curscr, TRUE);
    changed = true;
  }
  return changed;
}

bool ScreenPainter::works() const noexcept {
  return screen_->screen != nullptr;
}

unsigned long ScreenPainter::attributes(const Style& style) const {
  chtype attributes = A_NORMAL;
  if (style.bold) attributes |= A_BOLD;
  const bool coloured = colours_ && style.shade != Shade::none;
  if (style.reverse && !coloured) attributes |= A_REVERSE;
  if (style.dim) attributes |= A_DIM;
  if (style.underline) attributes |= A_UNDERLINE;
  if (coloured) attributes |= static_cast<chtype>(COLOR_PAIR(pair_number(style.shade)));
  return attributes;
}

void ScreenPainter::paint(const Frame& frame) {
  if (screen_->screen == nullptr) return;
  erase();
  int row = 0;
  for (const Row& spans : frame.rows) {
    if (row >= LINES) break;
    for (const Span& span : spans) {
      if (span.column >= COLS) continue;
      attrset(static_cast<chtype>(attributes(span.style)));
      mvaddnwstr(row, span.column, wide(span.text).c_str(), -1);
    }
    ++row;
  }
  attrset(A_NORMAL);
  if (frame.cursor && frame.cursor->first < LINES && frame.cursor->second < COLS) {
    curs_set(1);
    move(frame.cursor->first, frame.cursor->second);
  } else {
    curs_set(0);
  }
  refresh();
}

void ScreenPainter::beep() {
  if (screen_->screen != nullptr) ::beep();
}

}  // namespace jnd
