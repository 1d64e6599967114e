#include "runner/screen/large_letters.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

#include "protocols/input/utf8.h"

namespace jnd {

namespace {

constexpr std::size_t kHigh = 9;               // pixels
using Glyph = std::array<std::string, kHigh>;  // its rows, all of one width; '#' is drawn

// Glyphs side by side, one blank column between two. Rows that are left out are blank.
struct GlyphGroup {
  std::u32string_view letters;
  std::array<std::string_view, kHigh> rows;
};

// clang-format off
constexpr std::array<GlyphGroup, 6> kGroups = {{
    {U"ABCDEFGHIJKLMN",
     {".###. ####. .###. ####. ##### ##### .###. #...# ### ..### #...# #.... #...# #...#",
      "#...# #...# #...# #...# #.... #.... #...# #...# .#. ...#. #..#. #.... ##.## ##..#",
      "#...# #...# #.... #...# #.... #.... #.... #...# .#. ...#. #.#.. #.... #.#.# ##..#",
      "##### ####. #.... #...# ####. ####. #.### ##### .#. ...#. ##... #.... #.#.# #.#.#",
      "#...# #...# #.... #...# #.... #.... #...# #...# .#. ...#. #.#.. #.... #...# #..##",
      "#...# #...# #...# #...# #.... #.... #...# #...# .#. #..#. #..#. #.... #...# #..##",
      "#...# ####. .###. ####. ##### #.... .###. #...# ### .##.. #...# ##### #...# #...#"}},
    {U"OPQRSTUVWXYZab",
     {".###. ####. .###. ####. .#### ##### #...# #...# #...# #...# #...# ##### ..... #....",
      "#...# #...# #...# #...# #.... ..#.. #...# #...# #...# #...# #...# ....# ..... #....",
      "#...# #...# #...# #...# #.... ..#.. #...# #...# #...# .#.#. .#.#. ...#. .###. ####.",
      "#...# ####. #...# ####. .###. ..#.. #...# #...# #.#.# ..#.. ..#.. ..#.. ....# #...#",
      "#...# #.... #.#.# #.#.. ....# ..#.. #...# #...# #.#.# .#.#. ..#.. .#... .#### #...#",
      "#...# #.... #..#. #..#. ....# ..#.. #...# .#.#. ##.## #...# ..#.. #.... #...# #...#",
      ".###. #.... .##.# #...# ####. ..#.. .###. ..#.. #...# #...# ..#.. ##### .#### ####."}},
    {U"cdefghijklmnopqr",
     {".... ....# ..... ..## ..... #.... # ..# #... #. ..... ..... ..... ..... ..... ....",
      ".... ....# ..... .#.. ..... #.... . ... #... #. ..... ..... ..... ..... ..... ....",
      ".### .#### .###. #### .#### ####. # ..# #..# #. ####. ####. .###. ####. .#### #.##",
      "#... #...# #...# .#.. #...# #...# # ..# #.#. #. #.#.# #...# #...# #...# #...# ##..",
      "#... #...# ##### .#.. #...# #...# # ..# ##.. #. #.#.# #...# #...# #...# #...# #...",
      "#... #...# #.... .#.. #...# #...# # ..# #.#. #. #.#.# #...# #...# #...# #...# #...",
      ".### .#### .#### .#.. .#### #...# # ..# #..# .# #.#.# #...# .###. ####. .#### #...",
      ".... ..... ..... .... ....# ..... . ..# .... .. ..... ..... ..... #.... ....# ....",
      ".... ..... ..... .... .###. ..... . ##. .... .. ..... ..... ..... #.... ....# ...."}},
    {U"stuvwxyzßæøÅ012",
     {".... .#.. ..... ..... ..... ..... ..... .... .##.. ..... ..... ..#.. .###. .#. .###.",
      ".... .#.. ..... ..... ..... ..... ..... .... #..#. ..... ..... .#.#. #...# ##. #...#",
      ".### #### #...# #...# #...# #...# #...# #### #..#. ##.#. .###. ..#.. #..## .#. ....#",
      "#... .#.. #...# #...# #.#.# .#.#. #...# ...# #.#.. ..#.# #..## .###. #.#.# .#. ...#.",
      ".##. .#.. #...# #...# #.#.# ..#.. #...# .##. #..#. .#### #.#.# #...# ##..# .#. ..#..",
      "...# .#.. #...# .#.#. #.#.# .#.#. #...# #... #...# #.#.. ##..# ##### #...# .#. .#...",
      "###. ..## .#### ..#.. .#.#. #...# .#### #### #.##. .#### .###. #...# .###. ### #####",
      ".... .... ..... ..... ..... ..... ....# .... ..... ..... ..... ..... ..... ... .....",
      ".... .... ..... ..... ..... ..... .###. .... ..... ..... ..... ..... ..... ... ....."}},
    {U"3456789.,!?:;-'\"()/",
     {"##### ...#. ##### ..##. ##### .###. .###. . .. # .###. . .. ... # #.# ..# #.. ....#",
      "...#. ..##. #.... .#... ....# #...# #...# . .. # #...# . .. ... # #.# .#. .#. ....#",
      "..#.. .#.#. ####. #.... ...#. #...# #...# . .. # ....# . .. ... . ... #.. ..# ...#.",
      "...#. #..#. ....# ####. ..#.. .###. .#### . .. # ...#. # .# ### . ... #.. ..# ..#..",
      "....# ##### ....# #...# .#... #...# ....# . .. # ..#.. . .. ... . ... #.. ..# .#...",
      "#...# ...#. #...# #...# .#... #...# ...#. . .. . ..... . .. ... . ... .#. .#. #....",
      ".###. ...#. .###. .###. .#... .###. .##.. # .# # ..#.. # .# ... . ... ..# #.. #....",
      "..... ..... ..... ..... ..... ..... ..... . .# . ..... . .# ... . ... ... ... .....",
      "..... ..... ..... ..... ..... ..... ..... . #. . ..... . #. ... . ... ... ... ....."}},
    {U"+=&%*_<>",
     {"..... .... .##.. ##..# ..... ..... ...# #...",
      "..#.. .... #..#. ##..# #.#.# ..... ..#. .#..",
      "..#.. #### #.#.. ...#. .###. ..... .#.. ..#.",
      "##### .... .#... ..#.. ##### ..... #... ...#",
      "..#.. #### #.#.# .#... .###. ..... .#.. ..#.",
      "..#.. .... #..#. #..## #.#.# ..... ..#. .#..",
      "..... .... .##.# #..## ..... ..... ...# #...",
      "..... .... ..... ..... ..... ##### .... ...."}},
}};
// clang-format on

// A letter with a mark above it, in pixel rows 0 and 1.
struct Marked {
  char32_t letter, base;
  std::string_view upper, lower;
};
constexpr std::string_view kNone = ".....", kDots = ".#.#.", kAcuteTop = "...#.", kGraveTop = ".#...", kTip = "..#..",
                           kRing = ".###.";
constexpr std::array<Marked, 39> kMarked = {{
    {U'Ä', U'A', kDots, kNone},    {U'Ö', U'O', kDots, kNone},    {U'Ü', U'U', kDots, kNone},
    {U'ä', U'a', kDots, kNone},    {U'ö', U'o', kDots, kNone},    {U'ü', U'u', kDots, kNone},
    {U'Ë', U'E', kDots, kNone},    {U'ë', U'e', kDots, kNone},    {U'Ï', U'I', kDots, kNone},
    {U'ï', U'i', kDots, kNone},    {U'Á', U'A', kAcuteTop, kTip}, {U'á', U'a', kAcuteTop, kTip},
    {U'É', U'E', kAcuteTop, kTip}, {U'é', U'e', kAcuteTop, kTip}, {U'Í', U'I', kAcuteTop, kTip},
    {U'í', U'i', kAcuteTop, kTip}, {U'Ó', U'O', kAcuteTop, kTip}, {U'ó', U'o', kAcuteTop, kTip},
    {U'Ú', U'U', kAcuteTop, kTip}, {U'ú', U'u', kAcuteTop, kTip}, {U'À', U'A', kGraveTop, kTip},
    {U'à', U'a', kGraveTop, kTip}, {U'È', U'E', kGraveTop, kTip}, {U'è', U'e', kGraveTop, kTip},
    {U'Ì', U'I', kGraveTop, kTip}, {U'ì', U'i', kGraveTop, kTip}, {U'Ò', U'O', kGraveTop, kTip},
    {U'ò', U'o', kGraveTop, kTip}, {U'Ù', U'U', kGraveTop, kTip}, {U'ù', U'u', kGraveTop, kTip},
    {U'Â', U'A', kTip, kDots},     {U'â', U'a', kTip, kDots},     {U'Ê', U'E', kTip, kDots},
    {U'ê', U'e', kTip, kDots},     {U'î', U'i', kTip, kDots},     {U'Ô', U'O', kTip, kDots},
    {U'ô', U'o', kTip, kDots},     {U'û', U'u', kTip, kDots},     {U'å', U'a', kRing, kDots},
}};

void add_group(const GlyphGroup& group, std::map<char32_t, Glyph>& font) {
  std::size_t from = 0;
  for (const char32_t letter : group.letters) {
    const std::string_view top = group.rows[0];
    const std::size_t to = std::min(top.find(' ', from), top.size());
    Glyph& glyph = font[letter];
    for (std::size_t row = 0; row < kHigh; ++row)
      glyph[row] =
          group.rows[row].empty() ? std::string(to - from, '.') : std::string(group.rows[row].substr(from, to - from));
    from = to + 1;
  }
}

// A narrow letter makes room for its mark.
Glyph widened(const Glyph& base) {
  constexpr std::size_t kLeast = 3;
  Glyph glyph = base;
  for (std::string& row : glyph)
    while (row.size() < kLeast) {
      row.insert(row.begin(), '.');
      row += '.';
    }
  return glyph;
}

// The middle of a mark, as wide as the letter.
std::string mark_of(std::string_view mark, std::size_t width) {
  const std::size_t skipped = (mark.size() - std::min(width, mark.size())) / 2;
  return std::string(mark.substr(skipped, width));
}

// A capital makes room for a mark of one row.
Glyph marked(const Glyph& base, const Marked& how) {
  constexpr std::array<std::size_t, 6> kKept = {0, 1, 2, 3, 5, 6};  // rows of a capital that is 6 pixels high
  constexpr std::string_view kWideDots = "#...#";
  Glyph glyph = widened(base);
  const std::size_t width = glyph[0].size();
  if (how.base <= U'Z') {
    for (std::size_t i = 0; i < kKept.size(); ++i) glyph[i + 1] = base[kKept[i]];
    glyph[0] = mark_of(how.upper == kDots && how.base != U'U' ? kWideDots : how.upper,
                       width);  // a U has room between its arms
    return glyph;
  }
  glyph[0] = mark_of(how.upper, width);
  glyph[1] = mark_of(how.lower, width);
  return glyph;
}

std::map<char32_t, Glyph> made_font() {
  std::map<char32_t, Glyph> font;
  for (const GlyphGroup& group : kGroups) add_group(group, font);
  for (const Marked& how : kMarked) font[how.letter] = marked(font.at(how.base), how);
  for (std::string& row : font[U' ']) row = "..";
  return font;
}

const Glyph* glyph_of(char32_t letter) {
  static const std::map<char32_t, Glyph> kFont = made_font();
  const auto found = kFont.find(letter);
  return found == kFont.end() ? nullptr : &found->second;
}

int pixels_of(const std::u32string& text) {
  int pixels = 0;
  for (const char32_t letter : text) pixels += static_cast<int>(glyph_of(letter)->front().size()) + 1;
  return std::max(0, pixels - 1);
}

std::vector<std::u32string> words_in(const std::u32string& text) {
  std::vector<std::u32string> words(1);
  for (const char32_t letter : text) {
    if (letter != U' ')
      words.back() += letter;
    else if (!words.back().empty())
      words.emplace_back();
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

// Lines of at most so many pixels; none where a word is wider, or has a letter that the font has not.
std::optional<std::vector<std::u32string>> lines_of(const std::u32string& text, int pixels) {
  std::vector<std::u32string> lines;
  for (const std::u32string& word : words_in(text)) {
    for (const char32_t letter : word)
      if (glyph_of(letter) == nullptr) return std::nullopt;
    if (pixels_of(word) > pixels) return std::nullopt;
    if (!lines.empty() && pixels_of(lines.back() + U" " + word) <= pixels)
      lines.back() += U" " + word;
    else
      lines.push_back(word);
  }
  if (lines.empty()) return std::nullopt;
  return lines;
}

std::array<std::string, kHigh> pixel_rows(const std::u32string& line) {
  std::array<std::string, kHigh> rows;
  for (const char32_t letter : line)
    for (std::size_t row = 0; row < kHigh; ++row) rows[row] += (*glyph_of(letter))[row] + ".";
  for (std::string& row : rows) row.pop_back();
  return rows;
}

std::string half_row(const std::string& upper, const std::string& lower, bool unicode) {
  std::string row;
  for (std::size_t i = 0; i < upper.size(); ++i) {
    const bool above = upper[i] == '#', below = !lower.empty() && lower[i] == '#';
    if (above && below)
      row += unicode ? "█" : "#";
    else if (above)
      row += unicode ? "▀" : "'";
    else if (below)
      row += unicode ? "▄" : "_";
    else
      row += " ";
  }
  return row;
}

std::string full_row(const std::string& pixels, bool unicode) {
  std::string row;
  for (const char pixel : pixels) row += pixel != '#' ? "  " : unicode ? "██" : "##";
  return row;
}

void draw(const std::u32string& line, LetterSize size, bool unicode, std::vector<std::string>& rows) {
  const std::array<std::string, kHigh> pixels = pixel_rows(line);
  if (size == LetterSize::full) {
    for (const std::string& row : pixels) rows.push_back(full_row(row, unicode));
    return;
  }
  for (std::size_t row = 0; row < kHigh; row += 2)
    rows.push_back(half_row(pixels[row], row + 1 < kHigh ? pixels[row + 1] : std::string(), unicode));
}

}  // namespace

int large_rows(LetterSize size) noexcept {
  return static_cast<int>(size == LetterSize::full ? kHigh : (kHigh + 1) / 2);
}

std::optional<std::vector<std::string>> large_text(const std::string& text, int columns, LetterSize size,
                                                   bool unicode) {
  const auto lines = lines_of(code_points(text), size == LetterSize::full ? columns / 2 : columns);
  if (!lines) return std::nullopt;
  std::vector<std::string> rows;
  for (const std::u32string& line : *lines) draw(line, size, unicode, rows);
  // Below the last line only what letters hang down to.
  if (size == LetterSize::full)
    while (rows.back().find_first_not_of(' ') == std::string::npos) rows.pop_back();
  return rows;
}

std::optional<std::vector<std::string>> largest_text(const std::string& text, int columns, int rows, bool unicode) {
  for (const LetterSize size : {LetterSize::full, LetterSize::half}) {
    auto drawn = large_text(text, columns, size, unicode);
    if (drawn && static_cast<int>(drawn->size()) <= rows) return drawn;
  }
  return std::nullopt;
}

}  // namespace jnd
