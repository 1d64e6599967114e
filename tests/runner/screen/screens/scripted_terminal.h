// A program on a pseudo-terminal, looked at through libvterm: what a person would see, with its attributes. Waits for
// texts, never for time; a text that does not come within ten minutes is a failure.
#pragma once

#include <chrono>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>
#include <vterm.h>

namespace jnd::test {

class ScriptedTerminal {
 public:
  static constexpr std::chrono::minutes kGuard{10};  // ends a test that hangs

  ScriptedTerminal(const std::vector<std::string>& command, const std::string& folder, int rows, int columns)
      : rows_(rows), columns_(columns) {
    winsize size{};
    size.ws_row = static_cast<unsigned short>(rows);
    size.ws_col = static_cast<unsigned short>(columns);
    pid_ = forkpty(&master_, nullptr, nullptr, &size);
    if (pid_ < 0) throw std::runtime_error("no pseudo-terminal");
    if (pid_ == 0) run(command, folder);
    vterm_ = vterm_new(rows, columns);
    vterm_set_utf8(vterm_, 1);
    screen_ = vterm_obtain_screen(vterm_);
    static const VTermScreenCallbacks kCallbacks = callbacks();
    vterm_screen_set_callbacks(screen_, &kCallbacks, this);
    vterm_screen_enable_altscreen(screen_, 1);
    vterm_screen_reset(screen_, 1);
  }
  ~ScriptedTerminal() {
    if (!ended_) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    vterm_free(vterm_);
    close(master_);
  }
  ScriptedTerminal(const ScriptedTerminal&) = delete;
  ScriptedTerminal& operator=(const ScriptedTerminal&) = delete;

  void press(const std::string& keys) {
    if (write(master_, keys.data(), keys.size()) != static_cast<ssize_t>(keys.size()))
      throw std::runtime_error("the program does not take keys");
  }
  // Until the screen shows the text, as a regular expression over its lines joined by line ends.
  void wait_for(const std::string& text) {
    wait_until([&] { return shows(text); }, text);
  }
  void wait_until_gone(const std::string& text) {
    wait_until([&] { return !shows(text); }, "no more: " + text);
  }
  // A key, until the text is shown. One that the program takes for held down is pressed again once it may be.
  void press_for(const std::string& keys, const std::string& text) {
    static const std::string kHeld = "was down already";
    for (;;) {
      press(keys);
      wait_until([&] { return shows(text) || shows(kHeld); }, text);
      if (shows(text)) return;
      wait_until_gone(kHeld);
    }
  }
  // Whether the screen comes to be as asked before the time is over: it may still be half drawn.
  template <typename Condition>
  bool comes_to(Condition condition, std::chrono::milliseconds within) {
    const auto deadline = std::chrono::steady_clock::now() + within;
    while (!condition()) {
      pollfd input{master_, POLLIN, 0};
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      if (left.count() <= 0 || poll(&input, 1, static_cast<int>(left.count())) <= 0 || !read_some()) return condition();
    }
    return true;
  }
  bool shows(const std::string& text) const { return std::regex_search(plain(), std::regex(text)); }
  void resize(int rows, int columns) {
    rows_ = rows;
    columns_ = columns;
    vterm_set_size(vterm_, rows, columns);
    winsize size{};
    size.ws_row = static_cast<unsigned short>(rows);
    size.ws_col = static_cast<unsigned short>(columns);
    ioctl(master_, TIOCSWINSZ, &size);
  }
  void signal(int number) const { kill(pid_, number); }

  // How the program ended, after everything it wrote is on the screen.
  int wait_for_end() {
    for (pollfd input{master_, POLLIN, 0};;) {
      if (poll(&input, 1, static_cast<int>(std::chrono::milliseconds(kGuard).count())) <= 0)
        throw std::runtime_error("the program does not end\nThe screen is\n" + plain());
      if (!read_some()) break;
    }
    int status = 0;
    waitpid(pid_, &status, 0);
    ended_ = true;
    return status;
  }

  std::string plain() const {
    std::string text;
    for (int row = 0; row < rows_; ++row) text += line(row, false) + "\n";
    return text;
  }
  // Lines with their attributes: {b} bold, {r} reverse, {u} underlined, {cN/M} colour N on M, {} none.
  std::string styled() const {
    std::string text;
    for (int row = 0; row < rows_; ++row) text += line(row, true) + "\n";
    return text;
  }
  bool full_screen() const noexcept { return full_screen_; }
  bool cursor_visible() const noexcept { return cursor_visible_; }
  // The terminal's own settings are a shell's: lines, with echo.
  bool settings_of_shell() const {
    termios settings{};
    return tcgetattr(master_, &settings) == 0 && (settings.c_lflag & ICANON) != 0 && (settings.c_lflag & ECHO) != 0;
  }
  // Control bytes that came raw, other than what moves and colours.
  const std::string& output() const noexcept { return output_; }

 private:
  [[noreturn]] static void run(const std::vector<std::string>& command, const std::string& folder) {
    setenv("TERM", "xterm-256color", 1);
    setenv("LC_ALL", "C.UTF-8", 1);
    unsetenv("NO_COLOR");
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    if (chdir(folder.c_str()) == 0) execv(arguments[0], arguments.data());
    _exit(127);
  }

  static VTermScreenCallbacks callbacks() {
    VTermScreenCallbacks made{};
    made.settermprop = [](VTermProp property, VTermValue* value, void* self) {
      auto* const terminal = static_cast<ScriptedTerminal*>(self);
      if (property == VTERM_PROP_ALTSCREEN) terminal->full_screen_ = value->boolean != 0;
      if (property == VTERM_PROP_CURSORVISIBLE) terminal->cursor_visible_ = value->boolean != 0;
      return 1;
    };
    return made;
  }

  template <typename Condition>
  void wait_until(Condition condition, const std::string& what) {
    if (!comes_to(condition, kGuard))
      throw std::runtime_error("waited in vain for: " + what + "\nThe screen is\n" + plain());
  }
  // False: the program has ended.
  bool read_some() {
    char bytes[4096];
    const ssize_t got = read(master_, bytes, sizeof bytes);
    if (got <= 0) return false;
    output_.append(bytes, static_cast<std::size_t>(got));
    vterm_input_write(vterm_, bytes, static_cast<std::size_t>(got));
    return true;
  }

  std::string style(const VTermScreenCell& cell) const {
    std::string marks;
    if (cell.attrs.bold != 0) marks += "b";
    if (cell.attrs.reverse != 0) marks += "r";
    if (cell.attrs.underline != 0) marks += "u";
    if (!VTERM_COLOR_IS_DEFAULT_FG(&cell.fg) && VTERM_COLOR_IS_INDEXED(&cell.fg))
      marks += "c" + std::to_string(cell.fg.indexed.idx);
    if (!VTERM_COLOR_IS_DEFAULT_BG(&cell.bg) && VTERM_COLOR_IS_INDEXED(&cell.bg))
      marks += "/" + std::to_string(cell.bg.indexed.idx);
    return marks;
  }
  VTermScreenCell cell(int row, int column) const {
    VTermScreenCell found{};
    vterm_screen_get_cell(screen_, {row, column}, &found);
    return found;
  }
  static bool blank(const VTermScreenCell& cell) { return cell.chars[0] == 0 || cell.chars[0] == ' '; }
  // Of a blank on a coloured ground only the ground is seen, and ncurses 6.4 and 6.5 differ in the rest of its style: it
  // has that of the letters beside it on the same ground.
  std::vector<std::string> styles(int row) const {
    std::vector<std::string> found;
    std::vector<bool> bare;
    for (int column = 0; column < columns_; ++column) {
      const VTermScreenCell at = cell(row, column);
      std::string now = style(at);
      bare.push_back(blank(at) && now.find('/') != now.npos && now.find_first_of("ru") == now.npos);
      found.push_back(bare.back() ? now.substr(now.find('/')) : now);
    }
    const auto take = [&](std::size_t to, std::size_t from) {
      if (bare[to] && found[from].ends_with(found[to]) && found[from].find_first_of("ru") == std::string::npos)
        found[to] = found[from];
    };
    for (std::size_t i = 1; i < found.size(); ++i) take(i, i - 1);
    for (std::size_t i = found.size(); i-- > 1;) take(i - 1, i);
    return found;
  }
  std::string line(int row, bool styled) const {
    std::string text, before, spaces;
    const std::vector<std::string> looks = styles(row);
    for (int column = 0; column < columns_;) {
      const VTermScreenCell at = cell(row, column);
      const std::string now = looks[static_cast<std::size_t>(column)];
      if (styled && now != before) {
        text += spaces + "{" + now + "}";
        spaces.clear();
        before = now;
      }
      if (blank(at) && now.empty()) {
        spaces += ' ';
      } else {
        text += spaces;
        spaces.clear();
        if (blank(at)) text += ' ';
        for (int i = 0; !blank(at) && i < VTERM_MAX_CHARS_PER_CELL && at.chars[i] != 0; ++i) append(text, at.chars[i]);
      }
      column += at.width > 0 ? at.width : 1;
    }
    return text;
  }
  static void append(std::string& text, std::uint32_t c) {
    const auto byte = [&](std::uint32_t bits) { text += static_cast<char>(static_cast<unsigned char>(bits)); };
    if (c < 0x80) {
      byte(c);
    } else if (c < 0x800) {
      byte(0xc0 | (c >> 6));
      byte(0x80 | (c & 0x3f));
    } else {
      byte(0xe0 | (c >> 12));
      byte(0x80 | ((c >> 6) & 0x3f));
      byte(0x80 | (c & 0x3f));
    }
  }

  int rows_, columns_;
  int master_ = -1;
  pid_t pid_ = -1;
  bool ended_ = false;
  bool full_screen_ = false, cursor_visible_ = true;
  VTerm* vterm_ = nullptr;
  VTermScreen* screen_ = nullptr;
  std::string output_;
};

}  // namespace jnd::test
