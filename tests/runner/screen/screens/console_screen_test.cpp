// The tutorial, played on a pseudo-terminal with pause, repeat, an answer taken back, a note, resizes, an emergency
// stop, a break and a questionnaire. What is on the screen is compared with the approved screens beside this file, text
// and attributes; times are masked. What an operator looks at longest is there in four sizes: STATE-COLUMNSxROWS.
//
// Usage: console_screen_test JND JND_WITH_REAL_RIG FOLDER_OF_SCREENS [--approve]   --approve: writes them anew; look at
// the difference
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "tests/runner/screen/screens/scripted_terminal.h"

namespace jnd::test {
namespace {

namespace fs = std::filesystem;

const std::string kEnter = "\r", kEscape = "\x1b", kUp = "\x1b[A", kLarge = "\x0c";

enum class Letters { compared, timed };

// In another size; the rule above the keys goes from edge to edge once it is drawn.
void draw_again(ScriptedTerminal& terminal, int rows, int columns) {
  terminal.resize(rows, columns);
  terminal.wait_for("\n(─){" + std::to_string(columns) + "}\n([^\n]*\n){1,5}$");
}

// Until the program reads keys again: what it does before that draws the screen fewer times.
void until_it_listens(ScriptedTerminal& terminal) {
  for (int times = 0; times < 5; ++times)
    for (const auto& [rows, columns] : {std::pair(40, 120), std::pair(24, 80)}) draw_again(terminal, rows, columns);
}

class Screens {
 public:
  Screens(fs::path folder, bool approve) : folder_(std::move(folder)), approve_(approve) {}

  // letters: large letters are compared; otherwise there is a time among them.
  void check(const std::string& name, ScriptedTerminal& terminal, Letters letters = Letters::compared) {
    const fs::path file = folder_ / (name + ".txt");
    const auto now = [&] { return masked(terminal.styled(), letters); };
    if (approve_) {
      terminal.comes_to([] { return false; }, kDrawn);
      std::ofstream(file) << now();
      return;
    }
    std::stringstream approved;
    approved << std::ifstream(file).rdbuf();
    // What comes after the first difference is not waited for.
    const std::chrono::milliseconds patience = failed_ == 0 ? ScriptedTerminal::kGuard : kDrawn;
    if (terminal.comes_to([&] { return now() == approved.str(); }, patience)) return;
    ++failed_;
    std::cout << "The screen '" << name << "' is not as approved in " << file.filename() << ". It is\n"
              << now() << "\n";
  }
  // In four sizes, and back to the usual one.
  void check_sizes(const std::string& state, ScriptedTerminal& terminal, Letters letters = Letters::compared) {
    for (const auto& [rows, columns] : {std::pair(16, 60), std::pair(40, 120), std::pair(50, 200), std::pair(24, 80)}) {
      draw_again(terminal, rows, columns);
      check(state + "-" + std::to_string(columns) + "x" + std::to_string(rows), terminal, letters);
    }
  }
  void require(bool holds, const std::string& what) {
    if (holds) return;
    ++failed_;
    std::cout << "FAILED: " << what << "\n";
  }
  int failed() const { return failed_; }

 private:
  static std::string masked(std::string text, Letters letters) {
    for (const auto& [what, mask] :
         {std::pair("[0-9]+\\.[0-9]*( s\\b|…)", "#.##$1"),
          std::pair(" *(\\{b\\})?about [0-9]+ (s|min|h [0-9]+ min) left", " $1about # left"),
          std::pair("[0-9]{2}:[0-9]{2}(:[0-9]{2})?", "##:##"),
          std::pair("(for )[0-9]+:[0-9]{2}|[0-9]+:[0-9]{2}( ago)", "$1#:##$2"),
          std::pair("after [0-9]+ s", "after # s"), std::pair("(work: )(no )?contact", "$1#"),
          std::pair("[0-9]+ Hz, [a-z]+( by up to [0-9]+ ms)?", "# Hz")})
      text = std::regex_replace(text, std::regex(what), mask);
    if (letters == Letters::compared) return text;
    for (const auto& [what, mask] :
         {std::pair("(\\{\\}  )(█|░)+(  \\{b\\})", "$1(bar)$3"),  // also where it is full
          std::pair("(\\}|\n)([ █▀▄]*[█▀▄]+[ █▀▄]*)(\\{|\n)", "$1(large)$3"), std::pair("(█|░)+", "(bar)"),
          std::pair("[0-9]+ s left", "# s left"), std::pair("(left\\{\\})  [a-z ]+", "$1")})
      for (std::string before; before != text;) {
        before = text;
        text = std::regex_replace(text, std::regex(what), mask);
      }
    return text;
  }

  static constexpr std::chrono::milliseconds kDrawn{500};
  fs::path folder_;
  bool approve_;
  int failed_ = 0;
};

// Through a trial to the question, from its announcement.
void to_question(ScriptedTerminal& terminal) {
  terminal.press_for(" ", "\\[s\\] same");
}
const std::string kReady = "\\[space\\] when the participant is ready";

// The next trial's announcement is told from the last one's by the answer being gone from the question.
void answer(ScriptedTerminal& terminal, const std::string& key) {
  terminal.press_for(key, kReady);
}

// The first question of the checklist. What readiness found about a busy machine is to be read first.
void to_checklist(ScriptedTerminal& terminal) {
  const std::string question = "y once it is so";
  terminal.wait_for(question + "|Before the session");
  if (!terminal.shows(question)) terminal.press_for(" ", question);
}

void begin(ScriptedTerminal& terminal, Screens& screens) {
  to_checklist(terminal);
  screens.require(terminal.full_screen(), "the session has a screen of its own");
  screens.check("checklist", terminal);
  terminal.press_for("y", "Enter: *y");
  terminal.press_for(kEnter, "Question 2 of 2");
  terminal.press_for(kEnter, "was down already");  // as a key that is held down: it confirms one question only
  terminal.wait_until_gone("was down already");
  terminal.press_for("y", "Enter: *y");
  terminal.press_for(kEnter, "Please look through");
  screens.check("checklist-review", terminal);
  terminal.press_for(kEnter, "Instructions");
  screens.check("instructions", terminal);
  terminal.press_for(kLarge, "[█▀▄]{2}");
  screens.check("instructions-large", terminal);
  terminal.press(kLarge);
  terminal.wait_for("In each trial");
  terminal.press_for(" ", "Consent");
  screens.check("consent", terminal);
  terminal.resize(10, 40);
  terminal.wait_for("Make the window larger");
  terminal.press_for("y", "too small to read this");  // no consent to what is not on the screen
  screens.check("consent-too-small", terminal);
  terminal.resize(24, 80);
  terminal.wait_for("giving a");
  terminal.press_for("y", "Handedness");
  terminal.press("z");
  terminal.wait_for("please type the number of an answer");
  terminal.press("1");
  terminal.wait_for("Number:  *1");
  screens.check("questionnaire-choice", terminal);
  terminal.press_for(kEnter, "Instructions");
  terminal.press_for(" ", kReady);
  screens.check_sizes("ready", terminal);
  // Narrow for a moment, in which the terminal cuts off what was drawn, and as wide as before when the program looks.
  terminal.resize(24, 40);
  draw_again(terminal, 24, 80);
}

void practise(ScriptedTerminal& terminal, Screens& screens) {
  to_question(terminal);
  screens.check_sizes("question", terminal);
  terminal.press("z");
  terminal.wait_for("\\[z\\] does nothing here");
  screens.check("question-wrong-key", terminal);
  answer(terminal, "s");
  terminal.wait_for("Practice 2 of 4");
  screens.check("answered", terminal);

  terminal.press_for("u", "Take back the last answer\\?");
  screens.check("take-back-asked", terminal);
  terminal.press_for("y", "Reason, or Enter");
  terminal.press("mispressed, sagt er: größer");
  terminal.wait_for("größer");
  screens.check("take-back-reason", terminal);
  terminal.press_for(kEnter, "taken back; its trial");
  screens.check("taken-back", terminal);

  terminal.press_for("n", "Note:");
  terminal.press("\x1b[31m");  // neither a colour nor a word: a sequence is no text
  terminal.press("the door opened");
  terminal.wait_for("the door opened");
  terminal.press_for(kEnter, "note: the door opened");
  // Not while the note is still being written: then the pause is queued, and the log says so.
  until_it_listens(terminal);
  terminal.press_for("p", "Pause. Reason");
  terminal.press_for(kEnter, "Paused");
  screens.check_sizes("paused", terminal, Letters::timed);
  terminal.press_for("b", "does nothing now");
  screens.check("key-not-now", terminal, Letters::timed);
  terminal.press_for(" ", kReady);
  terminal.press_for("?", "Keys of this screen");
  screens.check("help", terminal);
  terminal.press_for(" ", kReady);

  to_question(terminal);
  terminal.press_for("r", "comes again later. Reason");
  terminal.press_for(kEnter, "not counted \\(repeated");
  terminal.wait_for(kReady);
  screens.check("repeated", terminal);

  to_question(terminal);
  terminal.press_for("x", "See to the participant");
  screens.check_sizes("stopped", terminal);
  terminal.press_for("z", "\\[z\\] does nothing here");
  terminal.press_for("c", "What was the matter");
  terminal.press("the sleeve was caught");
  terminal.press_for(kEnter, kReady);
  screens.check("stop-cleared", terminal);
}

// What is pressed before the trial is over is queued; and a window that is too small says so.
void queue(ScriptedTerminal& terminal, Screens& screens) {
  to_question(terminal);
  terminal.press_for("n", "queued: note after this trial");
  screens.check("queued", terminal);
  terminal.press_for("d", "Note:");
  terminal.press_for(kEscape, kReady);
  terminal.resize(10, 50);
  terminal.wait_for("too small");
  screens.check("too-small", terminal);
  terminal.resize(24, 80);
  terminal.wait_for("\\[\\?\\] keys[^\n]*\n$");
}

// To the break and to the end, whatever comes: each prompt is answered.
void go_on_to(ScriptedTerminal& terminal, const std::string& place) {
  const std::string prompts = "Instructions|may end|" + kReady + "|" + place;
  while (!terminal.shows(place)) {
    if (terminal.shows("Instructions") || terminal.shows("may end")) {
      terminal.press_for(" ", kReady + "|" + place);
      continue;
    }
    to_question(terminal);
    terminal.press_for("s", prompts);
  }
}

// However many questions the tutorial has: ratings, and choices whose first answer will do.
void rate_the_rest(ScriptedTerminal& terminal) {
  for (int question = 2; !terminal.shows("Please look through"); ++question) {
    const std::string next = "Question " + std::to_string(question + 1) + " of |Please look through";
    if (terminal.shows("Number:")) {
      terminal.press_for("1", "Number:  *1");
    } else if (terminal.shows("Answer:")) {
      terminal.press_for("5", "Answer:  *5");
    }
    terminal.press_for(kEnter, next);
  }
}

// A copy of the tutorial with other times.
std::string changed_tutorial(const std::string& jnd, const std::string& folder,
                             const std::vector<std::pair<std::string, int>>& times) {
  const std::string name = times.front().first + ".json", path = folder + "/" + name;
  const std::string command = "'" + jnd + "' new '" + path + "' --from tutorial > /dev/null";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("no copy of the tutorial");
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::string protocol = text.str();
  for (const auto& [key, seconds] : times)
    protocol = std::regex_replace(protocol, std::regex("(\"" + key + "\": *)[0-9.]+"), "$01" + std::to_string(seconds));
  std::ofstream(path) << protocol;
  return name;
}

void play(const std::string& jnd, const std::string& folder, Screens& screens) {
  // So long for an answer that no second of it is seen to pass.
  ScriptedTerminal terminal({jnd, "run", changed_tutorial(jnd, folder, {{"answer_time_out_s", 600}}), "--study",
                             "tutorial.sqlite", "--participant", "P01", "--seed", "1", "--fast"},
                            folder, 24, 80);
  begin(terminal, screens);
  practise(terminal, screens);
  queue(terminal, screens);
  go_on_to(terminal, "The break may end");
  screens.check_sizes("break", terminal, Letters::timed);
  terminal.press_for(" ", kReady);
  terminal.press_for("q", "End this session\\?");
  screens.check("end-asked", terminal);
  terminal.press_for("n", kReady);
  go_on_to(terminal, "How effective");
  terminal.press("7");
  terminal.wait_for("Answer:  *7");
  screens.check_sizes("questionnaire", terminal);
  terminal.press_for(kEnter, "Question 2 of ");
  terminal.press(kUp);
  terminal.wait_for("Question 1 of ");
  terminal.press_for("\x7f", "Answer:  *\n");
  terminal.press("8");
  terminal.press_for(kEnter, "Question 2 of ");
  rate_the_rest(terminal);
  screens.check("questionnaire-review", terminal);
  terminal.press_for(kEnter, "Done\\.");
  const int status = terminal.wait_for_end();
  screens.require(WIFEXITED(status) && WEXITSTATUS(status) == 0, "the session ends with 0");
  screens.require(terminal.shows("Done\\. The session of P01 is complete"),
                  "the last words stand on the shell's screen");
  screens.require(!terminal.full_screen() && terminal.cursor_visible() && terminal.settings_of_shell(),
                  "the terminal is put back");
}

// On the rig that is never held up, in an interval that lasts.
void present(const std::string& paced, const std::string& folder, Screens& screens) {
  setenv("JND_TEST_RIG", "paced", 1);  // NOLINT(concurrency-mt-unsafe): one thread
  ScriptedTerminal terminal({paced, "run", changed_tutorial(paced, folder, {{"explore_s", 60}}), "--study",
                             "slow.sqlite", "--participant", "P01", "--seed", "1", "--bell", "--realtime", "off"},
                            folder, 24, 80);
  to_checklist(terminal);
  for (const char* const next : {"Question 2 of 2", "Please look through"}) {
    terminal.press_for("y", "Enter: *y");
    terminal.press_for(kEnter, next);
  }
  terminal.press_for(kEnter, "Instructions");
  terminal.press_for(" ", "the participant agrees");
  terminal.press_for("y", "Handedness");
  terminal.press_for("1", "Number:  *1");
  terminal.press_for(kEnter, "Instructions");
  terminal.press_for(" ", kReady);
  terminal.press_for(" ", "work: contact");
  screens.check_sizes("presenting", terminal, Letters::timed);
  terminal.press_for("x", "See to the participant");
  terminal.press_for("q", "End this session\\?");
  terminal.press_for("q", "Reason");
  terminal.press_for(kEnter, "Stopped\\. Every answer");
  const int status = terminal.wait_for_end();
  screens.require(WIFEXITED(status) && WEXITSTATUS(status) == 130, "a session that is left can be gone on with");
}

// A crash and a signal leave the terminal as it was.
void end_by(const std::string& jnd, const std::string& folder, int signal_number, Screens& screens) {
  const std::string study = "signal" + std::to_string(signal_number) + ".sqlite";
  ScriptedTerminal terminal({jnd, "run", "tutorial", "--study", study, "--participant", "P01", "--seed", "1", "--fast"},
                            folder, 24, 80);
  to_checklist(terminal);
  terminal.signal(SIGPIPE);  // a reader that is gone ends nothing
  terminal.press_for("y", "Enter: *y");
  terminal.signal(signal_number);
  const int status = terminal.wait_for_end();
  const std::string name = "after signal " + std::to_string(signal_number);
  screens.require(WIFSIGNALED(status) || WEXITSTATUS(status) != 0, name + " the program says that it was ended");
  screens.require(!terminal.full_screen() && terminal.cursor_visible() && terminal.settings_of_shell(),
                  name + " the terminal is put back");
}

int run(int argc, char** argv) {
  if (argc < 4) {
    std::cerr << "usage: console_screen_test JND JND_WITH_REAL_RIG FOLDER_OF_SCREENS [--approve]\n";
    return 2;
  }
  Screens screens(argv[3], argc > 4 && std::string(argv[4]) == "--approve");
  std::string folder = (fs::temp_directory_path() / "jnd-screens-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) return 2;
  try {
    const std::string jnd = fs::absolute(argv[1]).string();
    play(jnd, folder, screens);
    present(fs::absolute(argv[2]).string(), folder, screens);
    // What was paused, repeated, taken back and stopped is in the study, and follows from the rules.
    const std::string verify = "'" + jnd + "' verify --deep '" + folder + "/tutorial.sqlite'";
    screens.require(std::system(verify.c_str()) == 0, "the study agrees with itself");
    for (const int crash : {SIGSEGV, SIGABRT, SIGTERM, SIGUSR1, SIGALRM}) end_by(jnd, folder, crash, screens);
  } catch (const std::exception& error) {
    screens.require(false, error.what());
  }
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  if (screens.failed() > 0) return 1;
  std::cout << "Every screen is as approved, and the terminal was put back each time.\n";
  return 0;
}

}  // namespace
}  // namespace jnd::test

int main(int argc, char** argv) {
  return jnd::test::run(argc, argv);
}
