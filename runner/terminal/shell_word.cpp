#include "runner/terminal/shell_word.h"

#include <fmt/format.h>

#include "runner/terminal/terminal.h"

namespace jnd {

std::string shell_word(std::string_view name) {
  constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./,:@%+";
  const std::string word = (name.starts_with('-') ? "./" : "") + std::string(name);
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  if (printable(word) == word) return shell_quoted(word);
  std::string escaped = "$'";  // of bash and zsh
  for (const char c : word)
    escaped += kPlain.find(c) != std::string_view::npos ? std::string(1, c)
                                                        : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  return escaped + "'";
}

}  // namespace jnd
