// The screen as a pure function: it fits every window, tells the kinds of session apart without colour, and shows
// nothing that a terminal would obey.
#include "runner/screen/screen_layout.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "runner/screen/large_letters.h"
#include "runner/screen/screen_text.h"
#include "tests/catch.h"

namespace jnd {
namespace {

ScreenModel model_of(SessionKind kind) {
  ScreenModel model;
  model.card.kind = kind;
  model.card.participant = "P01";
  model.card.title = "A study with a title that is rather longer than the room that there is for it on a screen";
  TrialOutline outline;
  outline.number = 3;
  outline.total = 108;
  outline.block = 1;
  outline.blocks = 9;
  outline.condition_code = "B";
  model.outline = outline;
  model.progress = {{"A", 1, 36}, {"B", 36, 36}, {"C", 0, 36}};
  model.health = {.presenting = true, .contact = true, .rate_hz = 1000, .lateness_max_us = 80, .fault = "stale_pose"};
  model.scene.heading = "Trial 3 of 108";
  model.scene.task = "Wait until the participant is ready";
  model.scene.keys = ready_keys(true).hints();
  model.say = "First sphere.";
  model.aloud = true;
  model.phase = {.word = "FIRST", .left_s = 2.3, .total_s = 3};
  model.clock = "14:03";
  model.left = "19 min";
  model.ends = "14:22";
  for (int i = 0; i < 12; ++i)
    model.log.push_back({"14:03:22", "trial 2 (plan no. 7) not counted (no answer in time)", Tone::warning, true});
  return model;
}

std::string text_of(const Frame& frame) {
  std::string text;
  for (const Row& row : frame.rows) {
    for (const Span& span : row) text += span.text + " ";
    text += "\n";
  }
  return text;
}

TEST_CASE("Forces are on the screen where they may be seen, and give way to what is to be read") {
  TelemetryRing ring{1000};
  ForceTrace trace({"thumb"}, true);
  for (int i = 0; i < 500; ++i)
    ring.push({.time_ns = i * 1'000'000, .penetration = 0.004, .asked_n = 2, .measured_n = 2});
  trace.take(ring);
  ScreenModel model = model_of(SessionKind::pilot);
  model.card.unblinded = true;
  CHECK(text_of(lay_out(model, 24, 80, true)).find("thumb") == std::string::npos);
  model.forces = &trace;
  const std::string usual = text_of(lay_out(model, 24, 80, true));
  INFO(usual);
  for (const char* const needed : {"UNBLINDED", "REHEARSAL", "force N", "depth mm", "2.00 N of", "SAY", "First sphere.",
                                   "FIRST", "3 s left", "FAULT: stale_pose", "[x]"})
    CHECK(usual.find(needed) != std::string::npos);
  for (const bool unicode : {true, false})
    for (int rows = kLeastRows; rows <= 50; ++rows)
      for (int columns = kLeastColumns; columns <= 140; columns += 5) {
        const Frame frame = lay_out(model, rows, columns, unicode);
        REQUIRE(static_cast<int>(frame.rows.size()) == rows);
        for (const Row& row : frame.rows)
          for (const Span& span : row) REQUIRE(span.column + columns_of(span.text) <= columns);
        const std::string text = text_of(frame);
        for (const char* const needed : {"UNBLINDED", "[x]"}) REQUIRE(text.find(needed) != std::string::npos);
      }
  model.scene.to_read = true;
  CHECK(text_of(lay_out(model, 24, 80, true)).find("force N") == std::string::npos);
}

TEST_CASE("A frame fits its window, whatever the size") {
  for (const bool unicode : {true, false})
    for (int rows = 1; rows <= 50; ++rows)
      for (int columns = 1; columns <= 140; columns += 3) {
        ScreenModel model = model_of(SessionKind::pilot);
        model.scene.text = std::string(3000, 'a') + "\n\nZoë 日本語";
        model.field = {"Reason, or Enter", std::string(300, 'n'), std::string(300, 'n')};
        const Frame frame = lay_out(model, rows, columns, unicode);
        REQUIRE(static_cast<int>(frame.rows.size()) == rows);
        for (const Row& row : frame.rows)
          for (const Span& span : row)
            REQUIRE(std::max(span.column, 0) + columns_of(span.text) <= std::max(columns, span.column));
        if (frame.cursor) {
          REQUIRE(frame.cursor->first < rows);
          REQUIRE(frame.cursor->second < columns);
        }
      }
}

TEST_CASE("What matters is on the smallest screen, and below it one line says why there is none") {
  const std::string small = text_of(lay_out(model_of(SessionKind::pilot), kLeastRows, kLeastColumns, true));
  for (const char* const needed :
       {"REHEARSAL", "P01", "Trial 3 of 108", "block 1 of 9", "condition B", "SAY", "First sphere.", "36/36",
        "ends 14:22", "FIRST", "3 s left", "FAULT: stale_pose", "contact", "[space]", "[x]", "[q]"})
    CHECK(small.find(needed) != std::string::npos);
  const std::string smaller = text_of(lay_out(model_of(SessionKind::pilot), kLeastRows - 1, kLeastColumns, true));
  CHECK(smaller.find("too small") != std::string::npos);
  CHECK(smaller.find("Trial 3 of 108") != std::string::npos);
}

// What asks for something, each in its own way.
std::vector<ScreenModel> models_that_wait(const QuestionnairePage& page) {
  std::vector<ScreenModel> models(7, model_of(SessionKind::real));
  models[1].scene.keys = question_keys(TaskSpec()).hints();
  models[2].scene.keys = presentation_keys(Protocol()).hints();
  models[3].scene = {
      .heading = "Consent", .text = std::string(2000, 'a'), .keys = consent_keys().hints(), .to_read = true};
  models[4].dialog = {"Give up the rest of this block? Its trials are left out.",
                      {{"y", "yes"}, {"n", "no"}, stop_hint()}};
  models[5].field = {"Pause. Reason, or Enter", "tired", "tired"};
  models[6].page = &page;
  return models;
}

TEST_CASE("The stop is among the keys shown at every size") {
  Question question;
  question.kind = Question::Kind::confirm;
  question.text = "Masking noise is on.";
  const QuestionnairePage page({{&question, "", ""}});
  for (const ScreenModel& model : models_that_wait(page))
    for (int rows = 1; rows <= 50; ++rows)
      for (int columns = 10; columns <= 140; columns += 5) {
        const std::string text = text_of(lay_out(model, rows, columns, true));
        INFO(rows << " x " << columns << "\n" << text);
        CHECK((text.find("[x]") != std::string::npos || text.find("[Ctrl-C]") != std::string::npos));
      }
}

TEST_CASE("What is to be answered says whether all of it can be seen") {
  Question question;
  question.kind = Question::Kind::confirm;
  question.text = "Masking noise is on.";
  const QuestionnairePage page({{&question, "", ""}});
  const std::vector<ScreenModel> models = models_that_wait(page);
  for (const std::size_t place : {std::size_t{3}, std::size_t{6}}) {
    const Frame frame = lay_out(models[place], 10, 40, true);
    CHECK(frame.unseen == Unseen::too_small);
    CHECK(text_of(frame).find("Make the window larger") != std::string::npos);
  }
  // A dialog is asked where its question fits.
  CHECK(lay_out(models[4], 10, 40, true).unseen == Unseen::nothing);
  CHECK(text_of(lay_out(models[4], 10, 40, true)).find("left out.") != std::string::npos);
  CHECK(lay_out(models[4], 2, 40, true).unseen == Unseen::too_small);
  CHECK(lay_out(models[3], 24, 80, true).unseen == Unseen::below);
  CHECK(lay_out(models[6], kLeastRows, kLeastColumns, true).unseen == Unseen::nothing);
  for (const std::size_t place : {std::size_t{0}, std::size_t{1}, std::size_t{2}})  // nothing to be read
    CHECK(lay_out(models[place], 10, 40, true).unseen == Unseen::nothing);
}

TEST_CASE("A long option of a question is broken into lines, not cut") {
  Question question;
  question.kind = Question::Kind::choice;
  question.text = "Which?";
  question.options = {std::string(30, 'a') + " " + std::string(30, 'b') + " end", "no"};
  const QuestionnairePage page({{&question, "", ""}});
  ScreenModel model = model_of(SessionKind::pilot);
  model.page = &page;
  const std::string text = text_of(lay_out(model, 24, 60, true));
  CHECK(text.find("end") != std::string::npos);
  CHECK(text.find("1 " + std::string(30, 'a')) != std::string::npos);
}

TEST_CASE("The three kinds differ in words and in lettering, not in colour alone") {
  std::set<std::string> words;
  std::set<std::string> lettering;
  for (const SessionKind kind : {SessionKind::real, SessionKind::pilot, SessionKind::simulated}) {
    const Frame frame = lay_out(model_of(kind), 24, 80, true);
    const Span& banner = frame.rows.at(0).at(0);
    words.insert(banner.text);
    lettering.insert(std::string(banner.style.bold ? "b" : "") + (banner.style.reverse ? "r" : "") +
                     (banner.style.underline ? "u" : "") + (banner.style.dim ? "d" : ""));
  }
  CHECK(words.size() == 3);
  CHECK(lettering.size() == 3);
}

TEST_CASE("Without UTF-8 the screen is ASCII") {
  ScreenModel model = model_of(SessionKind::real);
  model.scene.text = "Drücken Sie…";
  for (const char c : text_of(lay_out(model, 24, 80, false))) CHECK(static_cast<unsigned char>(c) < 0x80);
}

TEST_CASE("Nothing that a terminal would obey or turn around is shown") {
  ScreenModel model = model_of(SessionKind::real);
  model.scene.text = "a\x1b[2Jb\u202ec\u009bd\tc\rd";
  model.card.participant = "\x1b]0;x\a";
  model.log.push_back({"14:03:22", "note: \x1b[31m", Tone::plain, true});
  const std::string text = text_of(lay_out(model, 24, 80, true));
  for (const char* const bad : {"\x1b", "\u202e", "\u009b", "\t", "\r", "\a"})
    CHECK(text.find(bad) == std::string::npos);
}

TEST_CASE("A long text is scrolled, and says that there is more") {
  ScreenModel model = model_of(SessionKind::pilot);
  model.scene.task.clear();
  for (int i = 1; i <= 60; ++i) model.scene.text += "Line " + std::to_string(i) + "\n";
  Frame frame = lay_out(model, 24, 80, true);
  CHECK(frame.hidden_lines > 0);
  CHECK(text_of(frame).find("more lines") != std::string::npos);
  CHECK(text_of(frame).find("Line 60") == std::string::npos);
  model.scrolled = 1000;
  frame = lay_out(model, 24, 80, true);
  CHECK(frame.hidden_lines == 0);
  CHECK(text_of(frame).find("Line 60") != std::string::npos);
}

TEST_CASE("A question's field and its mistake are seen on the smallest screen, and the rest is scrolled") {
  Question question;
  question.kind = Question::Kind::choice;
  question.text = "Which of these?";
  for (int i = 1; i <= 20; ++i) question.options.push_back("option " + std::to_string(i));
  QuestionnairePage page({{&question, "", ""}});
  page.press({KeyName::character, 'z', 0});
  ScreenModel model = model_of(SessionKind::pilot);
  model.page = &page;
  std::set<int> seen;
  for (model.scrolled = 0;; ++model.scrolled) {
    const Frame frame = lay_out(model, kLeastRows, kLeastColumns, true);
    const std::string text = text_of(frame);
    CHECK(text.find("Number:") != std::string::npos);
    CHECK(text.find("please type the number") != std::string::npos);
    REQUIRE(frame.cursor);
    CHECK(frame.rows.at(static_cast<std::size_t>(frame.cursor->first)).at(0).text.find("Number:") == 0);
    for (int i = 1; i <= 20; ++i)
      if (text.find("option " + std::to_string(i) + " ") != std::string::npos) seen.insert(i);
    if (frame.hidden_lines == 0) break;
    CHECK(text.find("more lines: Page Down") != std::string::npos);
  }
  CHECK(seen.size() == 20);
}

TEST_CASE("A long review is scrolled below its field") {
  Question question;
  question.kind = Question::Kind::rating;
  question.min = 1;
  question.max = 9;
  std::vector<QuestionnairePage::Item> items;
  for (int i = 1; i <= 17; ++i) items.push_back({&question, "condition " + std::to_string(i), "5"});
  QuestionnairePage page(items);
  for (int i = 1; i <= 17; ++i) page.press({KeyName::enter, 0, 0});
  REQUIRE(page.reviewing());
  ScreenModel model = model_of(SessionKind::pilot);
  model.page = &page;
  CHECK(text_of(lay_out(model, 24, 80, true)).find("more lines: Page Down") != std::string::npos);
  model.scrolled = 1000;
  const std::string text = text_of(lay_out(model, 24, 80, true));
  CHECK(text.find("17. ") != std::string::npos);
  CHECK(text.find("Enter saves them") != std::string::npos);
}

TEST_CASE("From 100 x 30 there is a log, each line with its time, which can be scrolled") {
  ScreenModel model = model_of(SessionKind::pilot);
  model.log.clear();
  for (int i = 1; i <= 99; ++i)
    model.log.push_back({fmt::format("14:03:{:02}", i % 60), fmt::format("event {};", i), Tone::quiet, false});
  Frame frame = lay_out(model, kLogRows, kLogColumns, true);
  CHECK(frame.log_lines >= 5);
  CHECK(text_of(frame).find("event 99;") != std::string::npos);
  CHECK(text_of(frame).find("14:03:39   event 99;") == std::string::npos);
  CHECK(text_of(frame).find("14:03:39 event 99;") != std::string::npos);
  model.log_back = 50;
  frame = lay_out(model, kLogRows, kLogColumns, true);
  CHECK(text_of(frame).find("event 49;") != std::string::npos);
  CHECK(text_of(frame).find("event 50;") == std::string::npos);
  CHECK(text_of(frame).find("50 later: Page Down") != std::string::npos);
  for (const auto& [rows, columns] : {std::pair(kLogRows - 1, kLogColumns), std::pair(kLogRows, kLogColumns - 1)})
    CHECK(lay_out(model, rows, columns, true).log_lines == 0);
}

TEST_CASE("Where there is no log pane, what is over is not shown, and what is shown has its time") {
  ScreenModel model = model_of(SessionKind::pilot);
  model.log = {{"14:03:22", "trial 2 not counted", Tone::warning, true},
               {"14:03:40", "interval: First sphere.", Tone::quiet, false},
               {"14:03:41", "note: the door opened", Tone::plain, true}};
  std::string text = text_of(lay_out(model, 24, 80, true));
  CHECK(text.find("14:03:22 trial 2 not counted") != std::string::npos);
  CHECK(text.find("14:03:41 note: the door opened") != std::string::npos);
  CHECK(text.find("interval: First") == std::string::npos);
  model.log_of_now = 1;
  text = text_of(lay_out(model, 24, 80, true));
  CHECK(text.find("trial 2 not counted") == std::string::npos);
  CHECK(text.find("note: the door opened") != std::string::npos);
}

TEST_CASE("A stop fills the width of every window, with its age, whatever else there is") {
  ScreenModel model = model_of(SessionKind::real);
  model.stop = StopShown{"key", 1};
  model.now_ns = 75'000'000'001;
  for (int rows = 1; rows <= 50; ++rows)
    for (int columns = 40; columns <= 200; columns += 20) {
      const Frame frame = lay_out(model, rows, columns, true);
      INFO(rows << " x " << columns << "\n" << text_of(frame));
      if (rows > 1) CHECK(text_of(frame).find("STOPPED (key)") != std::string::npos);
      if (rows < kLeastRows || columns < kLeastColumns) continue;
      CHECK(text_of(frame).find("1:15 ago") != std::string::npos);
      int red = 0;
      for (const Row& row : frame.rows)
        if (row.size() == 1 && row[0].style.shade == Shade::stop && columns_of(row[0].text) == columns) ++red;
      CHECK(red >= 2);
    }
}

TEST_CASE("The first screen says in large letters whether the session counts") {
  for (const SessionKind kind : {SessionKind::real, SessionKind::pilot})
    for (const auto& [rows, columns] : {std::pair(24, 80), std::pair(40, 120), std::pair(50, 200)}) {
      ScreenModel model = model_of(kind);
      model.say.clear();
      model.scene = {};
      model.scene.heading = "Instructions: read it out";
      model.scene.text = "Two surfaces come one after the other. Say whether they are the same or different.";
      model.scene.to_read = true;
      model.phase = {.word = "READ OUT", .holds = true};
      const Shade shade = kind == SessionKind::real ? Shade::real : Shade::rehearsal;
      const auto filled_rows = [&](bool first) {
        model.first = first;
        const Frame frame = lay_out(model, rows, columns, true);
        INFO(text_of(frame));
        CHECK(text_of(frame).find("Two surfaces come") != std::string::npos);
        return std::count_if(frame.rows.begin() + 1, frame.rows.end(), [&](const Row& row) {
          return row.size() == 1 && row[0].style.shade == shade && columns_of(row[0].text) == columns;
        });
      };
      CHECK(filled_rows(true) >= large_rows(LetterSize::half));
      CHECK(filled_rows(false) == 0);
    }
}

TEST_CASE("What is queued, the expected end and how long a pause lasts are on view at every size") {
  ScreenModel model = model_of(SessionKind::pilot);
  model.say.clear();
  model.queued = {"pause after this trial", "note after this trial"};
  model.phase = {.word = "PAUSED", .since_ns = 1, .holds = true, .shade = Shade::warning};
  model.now_ns = 3'725'000'000'001;
  for (const auto& [rows, columns] : {std::pair(16, 60), std::pair(24, 80), std::pair(40, 120), std::pair(50, 200)}) {
    const std::string text = text_of(lay_out(model, rows, columns, true));
    INFO(text);
    CHECK(text.find("queued: pause after this trial, note after this trial") != std::string::npos);
    CHECK(text.find("ends 14:22") != std::string::npos);
    CHECK((text.find("1:02:05") != std::string::npos || text.find("█▀▀▀▄ ▄▀▀▀▄ █   █ ▄▀▀▀▀") != std::string::npos ||
           text.find("██████") != std::string::npos));
  }
}

TEST_CASE("The keys of a screen lie over it, and nothing can be read or answered below them") {
  ScreenModel model = model_of(SessionKind::pilot);
  model.scene = {.heading = "Consent", .text = "I agree.", .keys = consent_keys().hints(), .to_read = true};
  CHECK(lay_out(model, 24, 80, true).unseen == Unseen::nothing);
  model.help = true;
  const Frame frame = lay_out(model, 24, 80, true);
  CHECK(frame.unseen == Unseen::below);
  CHECK(text_of(frame).find("the participant does not agree") != std::string::npos);
  CHECK(text_of(frame).find("I agree.") == std::string::npos);
}

TEST_CASE("A participant's text can be shown in large letters, where a line has room for them") {
  ScreenModel model = model_of(SessionKind::pilot);
  model.say.clear();
  model.scene = {.heading = "Instructions", .text = "Say same\nor different.", .keys = {}, .to_read = true};
  model.large = true;
  const std::string text = text_of(lay_out(model, 40, 120, true));
  CHECK(text.find("Say same") == std::string::npos);
  CHECK(text.find("█▀█▀▄ ▄▀▀▀▄") != std::string::npos);  // "me"
  model.scene.text = "日本語";
  CHECK(text_of(lay_out(model, 40, 120, true)).find("日本語") != std::string::npos);
}

TEST_CASE("Text is measured in columns, cut and broken at spaces") {
  CHECK(columns_of("né日e\u0301") == 5);
  CHECK(clipped("abcdef", 4, true) == "abc…");
  CHECK(clipped("abcdef", 5, false) == "ab...");
  CHECK(clipped("日本語", 4, true) == "日…");
  CHECK(wrapped("one two three", 7) == std::vector<std::string>{"one two", "three"});
  CHECK(wrapped("abcdefgh", 3) == std::vector<std::string>{"abc", "def", "gh"});
  CHECK(wrapped("a\n\nb\n", 10) == std::vector<std::string>{"a", "", "b"});
}

}  // namespace
}  // namespace jnd
