// Lines and pages as they are typed, and the keys that do something.
#include <string>
#include <vector>

#include "protocols/input/utf8.h"
#include "protocols/tasks/task.h"
#include "runner/console/console_keys.h"
#include "runner/console/questionnaire_page.h"
#include "runner/keys/line_editor.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using State = QuestionnairePage::State;

Key named(KeyName name) {
  return {name, 0, 0};
}

void type(LineEditor& editor, const std::string& text) {
  for (const char32_t c : code_points(text)) editor.press({KeyName::character, c, 0});
}

State type(QuestionnairePage& page, const std::string& text, KeyName then = KeyName::enter) {
  for (const char32_t c : code_points(text)) page.press({KeyName::character, c, 0});
  return page.press(named(then));
}

TEST_CASE("A line is edited by characters, not by bytes") {
  LineEditor editor;
  type(editor, "né€");
  CHECK(editor.press(named(KeyName::backspace)) == LineEditor::Outcome::edited);
  CHECK(editor.text() == "né");
  editor.press(named(KeyName::left));
  CHECK(editor.before_cursor() == "n");
  type(editor, "o");
  editor.press(named(KeyName::delete_));
  CHECK(editor.text() == "no");
  editor.press(named(KeyName::home));
  CHECK(editor.press(named(KeyName::backspace)) == LineEditor::Outcome::ignored);
  CHECK(editor.press(named(KeyName::up)) == LineEditor::Outcome::ignored);
  CHECK(editor.press(named(KeyName::escape)) == LineEditor::Outcome::cancelled);
  CHECK(editor.press(named(KeyName::enter)) == LineEditor::Outcome::done);
  CHECK(editor.press({KeyName::control, 'u', 0}) == LineEditor::Outcome::edited);
  CHECK(editor.empty());
}

TEST_CASE("A line has an end, and broken UTF-8 does not break it") {
  LineEditor editor;
  for (std::size_t i = 0; i < LineEditor::kLongest + 5; ++i) type(editor, "ä");
  CHECK(code_points(editor.text()).size() == LineEditor::kLongest);
  CHECK(to_utf8(code_points("a\xff\xc3")) == "a\xef\xbf\xbd\xef\xbf\xbd");
}

struct Page {
  Page() {
    choice.id = "hand";
    choice.kind = Question::Kind::choice;
    choice.options = {"right", "left"};
    choice.shown = {"rechts", "links"};
    rating.id = "liking";
    rating.kind = Question::Kind::rating;
    rating.min = 1;
    rating.max = 9;
    text.id = "remarks";
    text.kind = Question::Kind::text;
    text.required = false;
  }
  QuestionnairePage make() { return QuestionnairePage({{&choice, "", ""}, {&rating, "A", ""}, {&text, "", ""}}); }
  Question choice, rating, text;
};

TEST_CASE("A page is answered, looked through, changed and only then committed") {
  Page questions;
  QuestionnairePage page = questions.make();
  CHECK(type(page, "2") == State::open);
  CHECK(type(page, "7") == State::open);
  CHECK(page.at() == 2);
  page.press(named(KeyName::up));
  CHECK(page.editor().text() == "7");
  page.press(named(KeyName::backspace));
  CHECK(type(page, "8") == State::open);
  CHECK(type(page, "") == State::open);
  REQUIRE(page.reviewing());
  CHECK(page.shown_reply(0) == "links");
  CHECK(type(page, "2") == State::open);  // change the second
  CHECK(page.at() == 1);
  page.press(named(KeyName::backspace));
  CHECK(type(page, "3") == State::open);
  REQUIRE(page.reviewing());
  CHECK(page.press(named(KeyName::enter)) == State::committed);
  const Replies replies = page.replies();
  CHECK(replies[0] == "left");
  CHECK(replies[1] == "3");
  CHECK_FALSE(replies[2]);
}

TEST_CASE("A page says what is wrong, and saves nothing that is") {
  Page questions;
  QuestionnairePage page = questions.make();
  CHECK(type(page, "") == State::open);
  CHECK(page.mistake() == "please type an answer");
  page.press({KeyName::character, 'x', 0});
  CHECK(page.mistake() == "please type the number of an answer");
  CHECK(page.editor().empty());
  CHECK(type(page, "3") == State::open);
  CHECK(page.mistake() == "please type the number of an answer");
  page.press(named(KeyName::backspace));
  type(page, "1");
  CHECK(type(page, "10") == State::open);
  CHECK(page.mistake() == "please stay within 1 to 9");
  CHECK(page.press(named(KeyName::escape)) == State::leaving);
  // Back to the first, which is emptied: the review does not let it through.
  page.press(named(KeyName::up));
  page.press(named(KeyName::backspace));
  page.press(named(KeyName::up));
  CHECK(page.enter("") == State::open);
  CHECK(page.at() == 0);
}

TEST_CASE("A page by lines: back with <, and a page of one question is not looked through") {
  Page questions;
  QuestionnairePage page = questions.make();
  page.enter("rechts");
  page.enter("<");
  CHECK(page.at() == 0);
  page.enter("links");
  page.enter(" 4 ");
  page.enter("fine");
  REQUIRE(page.reviewing());
  page.enter("9");
  CHECK(page.mistake().find("1 to 3") != std::string::npos);
  CHECK(page.enter("") == State::committed);
  CHECK(page.replies()[0] == "left");
  CHECK(page.replies()[1] == "4");

  QuestionnairePage single({{&questions.rating, "", ""}});
  CHECK(single.enter("5") == State::committed);
  QuestionnairePage unreviewed({{&questions.choice, "", ""}, {&questions.rating, "", ""}}, false);
  unreviewed.enter("1");
  CHECK(unreviewed.enter("5") == State::committed);
}

TEST_CASE("Numbers are kept as plain decimals") {
  Question number;
  number.kind = Question::Kind::number;
  number.min = -10;
  number.max = 120;
  CHECK(normalised(number, "3,50") == "3.5");
  CHECK(normalised(number, "030") == "30");
  for (const char* const bad : {"1e2", "0x10", "inf", "nan", "3.5.1", "12 a", "--1"})
    CHECK(mistake_in(number, bad) == "please type a number");
  CHECK(mistake_in(number, "121") == "please stay within -10 to 120");
  Question confirm;
  confirm.kind = Question::Kind::confirm;
  CHECK(mistake_in(confirm, "n") != "");
  CHECK(normalised(confirm, "y") == "yes");
}

TEST_CASE("The protocol's answer keys win, and the operator's move to another key") {
  const auto meaning = [](const KeyMap& keys, char32_t c) {
    return keys.binding_of({KeyName::character, c, 0}).value().meaning;
  };
  TaskSpec task;
  KeyMap keys = question_keys(task);
  CHECK(meaning(keys, 's') == KeyMeaning(GivenAnswer{kClassSame}));
  CHECK(meaning(keys, 'r') == KeyMeaning(Request::repeat_trial));
  CHECK(meaning(keys, 'x') == KeyMeaning(Request::stopped));
  CHECK(meaning(keys, 'X') == KeyMeaning(Request::stopped));
  task.answers[0].key = 'r';
  task.answers[1].key = 'n';
  keys = question_keys(task);
  CHECK(meaning(keys, 'r') == KeyMeaning(GivenAnswer{kClassSame}));
  CHECK(meaning(keys, 'n') == KeyMeaning(GivenAnswer{kClassDifferent}));
  CHECK(meaning(keys, 'R') == KeyMeaning(Request::repeat_trial));
  CHECK(meaning(keys, 'N') == KeyMeaning(Request::note));
  task.answers[1].key = 'R';
  keys = question_keys(task);
  CHECK(meaning(keys, 'R') == KeyMeaning(GivenAnswer{kClassDifferent}));
  CHECK(meaning(keys, '0') == KeyMeaning(Request::repeat_trial));
}

TEST_CASE("The stop key is explained as what it is, also where it is no key of the scene") {
  for (const KeyMap& keys : {pause_keys(), break_keys(false), break_keys(true), instruction_keys(), consent_keys(),
                             storage_keys(), stopped_keys()})
    for (const char32_t key : {U'x', U'X'})
      CHECK(keys.explanation({KeyName::character, key, 0}) == "STOP: the devices give nothing");
}

// The operator's own keys, in order.
std::string own_keys(const KeyMap& keys) {
  std::string text;
  for (const KeyHint& hint : keys.hints())
    if (hint.place) text += hint.key;
  return text;
}

TEST_CASE("The operator's keys have the same place in every scene, and one that does nothing there says why") {
  for (const KeyMap& keys :
       {ready_keys(true), ready_keys(false), question_keys(TaskSpec()), hand_over_keys(TaskSpec()),
        presentation_keys(Protocol()), between_trials_keys(TaskSpec()), pause_keys(), stopped_keys(), missing_keys(),
        break_keys(false), break_keys(true), instruction_keys(), exploring_keys()}) {
    CHECK(own_keys(keys) == "prunbkq?");
    for (const KeyHint& hint : keys.hints()) {
      if (hint.works) continue;
      const Key key{KeyName::character, static_cast<char32_t>(hint.key.front()), 0};
      CHECK_FALSE(keys.binding_of(key));
      CHECK(keys.explanation(key).find("does nothing now: ") != std::string::npos);
    }
  }
  CHECK(stopped_keys().explanation({KeyName::character, 'b', 0}) ==
        "[b] break does nothing now: clear the stop first: [c]");
}

TEST_CASE("Whatever the question, Enter takes the answer") {
  Question confirm;
  confirm.kind = Question::Kind::confirm;
  QuestionnairePage page({{&confirm, "", ""}});
  CHECK(page.press({KeyName::character, 'y', 0}) == State::open);
  CHECK(page.press({KeyName::character, 'y', 0}) == State::open);
  CHECK(page.editor().text() == "y");
  CHECK(page.press(named(KeyName::enter)) == State::committed);
  CHECK(page.replies().front() == "yes");
}

TEST_CASE("Wrong keys are explained") {
  const KeyMap keys = question_keys(TaskSpec());
  CHECK(keys.explanation({KeyName::character, 'S', 0}).find("Caps Lock") != std::string::npos);
  CHECK(keys.explanation({KeyName::character, 'z', 0}).find("[s] same, [d] different") != std::string::npos);
  CHECK(keys.explanation({KeyName::control, 'z', 0}).find("background") != std::string::npos);
  CHECK(!keys.binding_of(named(KeyName::up)));
  CHECK(!ready_keys(false).binding_of({KeyName::character, 'u', 0}));
  CHECK(ready_keys(true).binding_of({KeyName::character, 'u', 0}).value().asks(Request::void_last));
  CHECK(ready_keys(true).binding_of(named(KeyName::enter)).value().asks(Request::go_on));
}

}  // namespace
}  // namespace jnd
