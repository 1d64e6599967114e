#include "runner/console/questionnaire_page.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "runner/words/words.h"

namespace jnd {

namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Plain decimals; a decimal comma is a point.
std::optional<double> number_in(std::string text) {
  std::replace(text.begin(), text.end(), ',', '.');
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value, std::chars_format::fixed);
  if (error != std::errc() || stopped != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

// By its number, its text, or its text in the participant's language.
std::optional<std::size_t> option_in(const Question& question, const std::string& text) {
  for (std::size_t i = 0; i < question.options.size(); ++i)
    if (text == std::to_string(i + 1)) return i;
  for (std::size_t i = 0; i < question.options.size(); ++i)
    if (text == question.options[i] || (i < question.shown.size() && text == question.shown[i])) return i;
  return std::nullopt;
}

// Whether a key can be part of a reply.
bool fits(const Question& question, char32_t character) {
  if (question.kind == Question::Kind::text) return true;
  const bool digit = character >= '0' && character <= '9';
  if (question.kind == Question::Kind::choice || question.kind == Question::Kind::rating)
    return digit || (question.min < 0 && character == '-');
  if (question.kind == Question::Kind::confirm) return character == 'y' || character == 'Y';
  return digit || character == '.' || character == ',' || character == '-';
}

const std::string& shown_option(const Question& question, std::size_t option) {
  return option < question.shown.size() ? question.shown[option] : question.options[option];
}

}  // namespace

std::string mistake_in(const Question& question, const std::string& typed) {
  const std::string text = trimmed(typed);
  if (text.empty()) {
    if (!question.required) return "";
    return question.kind == Question::Kind::confirm ? tr("please type y once it is so") : tr("please type an answer");
  }
  switch (question.kind) {
    case Question::Kind::text:
      return "";
    case Question::Kind::confirm:
      return text == "y" || text == "Y" || text == "yes" ? "" : tr("please type y once it is so");
    case Question::Kind::choice:
      return option_in(question, text) ? "" : tr("please type the number of an answer");
    case Question::Kind::rating:
    case Question::Kind::number:
      break;
  }
  const std::optional<double> value = number_in(text);
  if (!value) return tr("please type a number");
  if (*value < question.min || *value > question.max)
    return tr("please stay within {} to {}", question.min, question.max);
  if (question.kind == Question::Kind::rating && *value != std::floor(*value)) return tr("please type a whole number");
  return "";
}

std::string normalised(const Question& question, const std::string& typed) {
  std::string text = trimmed(typed);
  switch (question.kind) {
    case Question::Kind::text:
      return text;
    case Question::Kind::confirm:
      return "yes";
    case Question::Kind::choice:
      return question.options[option_in(question, text).value_or(0)];
    case Question::Kind::rating:
    case Question::Kind::number:
      return fmt::format("{}", number_in(text).value_or(0));
  }
  return text;
}

QuestionnairePage::QuestionnairePage(std::vector<Item> items, bool review)
    : items_(std::move(items)), review_(review && items_.size() > 1) {
  go_to(0);
}

void QuestionnairePage::go_to(std::size_t item) {
  at_ = item;
  editor_ = reviewing() ? LineEditor() : LineEditor(items_[at_].typed);
}

void QuestionnairePage::back() {
  mistake_.clear();
  if (!reviewing()) items_[at_].typed = editor_.text();
  changing_ = false;
  if (at_ > 0) go_to(at_ - 1);
}

bool QuestionnairePage::answers(const Key& key) const noexcept {
  return key.is(KeyName::enter) || key.is(KeyName::down) || key.is(KeyName::tab);
}

QuestionnairePage::State QuestionnairePage::press(const Key& key) {
  if (key.is(KeyName::escape)) return State::leaving;
  if (key.is(KeyName::up)) {
    back();
    return State::open;
  }
  if (reviewing()) {
    if (key.is(KeyName::enter) && editor_.empty()) return commit();
    if (key.is(KeyName::enter)) return enter(editor_.text());
    editor_.press(key);
    return State::open;
  }
  if (answers(key)) return take(editor_.text());
  const Question& question = *items_[at_].question;
  mistake_.clear();
  if (key.name == KeyName::character && !fits(question, key.character))
    mistake_ = question.kind == Question::Kind::confirm  ? tr("please type y once it is so")
               : question.kind == Question::Kind::choice ? tr("please type the number of an answer")
                                                         : tr("please type a number");
  else if (question.kind == Question::Kind::confirm && key.name == KeyName::character)
    editor_ = LineEditor("y");  // however long it is held down
  else
    editor_.press(key);
  items_[at_].typed = editor_.text();
  return State::open;
}

QuestionnairePage::State QuestionnairePage::enter(const std::string& line) {
  const std::string text = trimmed(line);
  if (text == "<") {
    if (!reviewing()) editor_ = LineEditor(items_[at_].typed);
    back();
    return State::open;
  }
  if (!reviewing()) return take(text);
  if (text.empty()) return commit();
  const std::optional<double> number = number_in(text);
  if (number && *number >= 1 && *number <= static_cast<double>(items_.size()) && *number == std::floor(*number)) {
    changing_ = true;
    mistake_.clear();
    go_to(static_cast<std::size_t>(*number) - 1);
  } else {
    mistake_ = tr("please type the number of a question, 1 to {}, or nothing to save the page", items_.size());
    editor_.clear();
  }
  return State::open;
}

QuestionnairePage::State QuestionnairePage::take(const std::string& typed) {
  mistake_ = mistake_in(*items_[at_].question, typed);
  if (!mistake_.empty()) return State::open;
  items_[at_].typed = trimmed(typed);
  const bool last = at_ + 1 == items_.size();
  if (last && !review_) return commit();
  go_to(changing_ ? items_.size() : at_ + 1);
  changing_ = false;
  return State::open;
}

// An answer may be half typed: the page can be gone back through.
QuestionnairePage::State QuestionnairePage::commit() {
  for (std::size_t i = 0; i < items_.size(); ++i) {
    mistake_ = mistake_in(*items_[i].question, items_[i].typed);
    if (mistake_.empty()) continue;
    go_to(i);
    changing_ = true;
    return State::open;
  }
  return State::committed;
}

std::string QuestionnairePage::shown_reply(std::size_t item) const {
  const Question& question = *items_[item].question;
  const std::string& typed = items_[item].typed;
  if (trimmed(typed).empty()) return "-";
  if (!mistake_in(question, typed).empty()) return typed;
  if (question.kind == Question::Kind::choice)
    return shown_option(question, option_in(question, trimmed(typed)).value_or(0));
  return normalised(question, typed);
}

Replies QuestionnairePage::replies() const {
  Replies replies;
  for (const Item& item : items_) {
    if (trimmed(item.typed).empty())
      replies.emplace_back(std::nullopt);
    else
      replies.emplace_back(normalised(*item.question, item.typed));
  }
  return replies;
}

}  // namespace jnd
