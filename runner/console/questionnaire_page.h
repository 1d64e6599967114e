// A page of questions: answer, go back, change, look through it once more, and only then commit. Pure: keys or lines
// in, replies out.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "devices/responder.h"
#include "protocols/protocol.h"
#include "runner/keys/key_parser.h"
#include "runner/keys/line_editor.h"

namespace jnd {

// What is wrong with a reply, or an empty text.
std::string mistake_in(const Question& question, const std::string& typed);
// A reply without a mistake, as the log keeps it: plain decimals, the option rather than its number or translation.
std::string normalised(const Question& question, const std::string& typed);

class QuestionnairePage {
 public:
  struct Item {
    const Question* question = nullptr;
    std::string about;  // the condition, where the question is about one
    std::string typed;
  };
  enum class State { open, committed, leaving };

  // review: whether the page is shown once more before it is committed; a page of one question never is.
  explicit QuestionnairePage(std::vector<Item> items, bool review = true);

  // Whether a key, on the screen, takes the answer or the page as it stands, rather than editing, or going back. Whatever the
  // question, it is Enter that does.
  bool answers(const Key& key) const noexcept;
  // A key on the screen: text into the field, Enter or down to the next, up to the one before; Escape asks to leave.
  State press(const Key& key);
  // A whole line: a reply, "<" to the question before; in the review a question's number, or nothing to commit.
  State enter(const std::string& line);

  const std::vector<Item>& items() const noexcept { return items_; }
  std::size_t at() const noexcept { return at_; }  // items().size(): the review
  bool reviewing() const noexcept { return at_ == items_.size(); }
  const LineEditor& editor() const noexcept { return editor_; }
  const std::string& mistake() const noexcept { return mistake_; }  // in what was entered last; empty: none
  // The reply in words that people read, "-" where there is none.
  std::string shown_reply(std::size_t item) const;
  Replies replies() const;

 private:
  void go_to(std::size_t item);
  void back();
  State take(const std::string& typed);
  State commit();

  std::vector<Item> items_;
  bool review_;
  std::size_t at_ = 0;
  bool changing_ = false;  // came from the review, and goes back there
  LineEditor editor_;
  std::string mistake_;
};

}  // namespace jnd
