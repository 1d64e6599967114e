#include "runner/drawing/figure_style.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace jnd {

namespace {

struct ConditionColour {
  std::string_view colour, fill_class, line_class, hollow_class;
};
constexpr std::array<ConditionColour, 7> kColours = {{{"#0072b2", "f0", "s0", "h0"},
                                                      {"#d55e00", "f1", "s1", "h1"},
                                                      {"#009e73", "f2", "s2", "h2"},
                                                      {"#cc79a7", "f3", "s3", "h3"},
                                                      {"#e69f00", "f4", "s4", "h4"},
                                                      {"#56b4e9", "f5", "s5", "h5"},
                                                      {"#5c5c5c", "f6", "s6", "h6"}}};
constexpr int kShapes = 8;

const ConditionColour& colour_of(int condition) {
  return kColours[static_cast<std::size_t>(condition) % kColours.size()];
}

std::vector<SvgPoint> regular(double x, double y, double radius, int corners, double first_angle) {
  std::vector<SvgPoint> points;
  for (int corner = 0; corner < corners; ++corner) {
    const double angle = first_angle + 2 * 3.14159265358979 * corner / corners;
    points.emplace_back(x + radius * std::cos(angle), y + radius * std::sin(angle));
  }
  return points;
}

std::vector<SvgPoint> star(double x, double y, double radius, int rays, double inner) {
  std::vector<SvgPoint> points;
  for (int corner = 0; corner < 2 * rays; ++corner) {
    const double angle = 3.14159265358979 * (corner / static_cast<double>(rays) - 0.5);
    const double here = corner % 2 == 0 ? radius : inner * radius;
    points.emplace_back(x + here * std::cos(angle), y + here * std::sin(angle));
  }
  return points;
}

// Where the character that begins at `at` ends.
std::size_t next_character(std::string_view text, std::size_t at) {
  ++at;
  while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0U) == 0x80) ++at;
  return at;
}

// In units of the font's size. Characters of three and more bytes (Chinese, Japanese, Korean, ...) are square.
double character_width(std::string_view character) {
  if (character.size() >= 3) return 1.0;
  const char letter = character.front();
  if (std::string_view("iljtfrI.,:;'|!()[] ").find(letter) != std::string_view::npos) return 0.34;
  if (std::string_view("mwMW%@").find(letter) != std::string_view::npos) return 0.88;
  return letter >= 'A' && letter <= 'Z' ? 0.7 : 0.585;
}

}  // namespace

TextStyle anchored(TextStyle style, std::string_view anchor) {
  style.anchor = anchor;
  return style;
}

TextStyle strong(TextStyle style) {
  style.bold = true;
  return style;
}

ShapeStyle condition_line(int condition) {
  const ConditionColour& colour = colour_of(condition);
  return {.css_class = colour.line_class, .fill = {}, .stroke = colour.colour, .stroke_width = 1.5, .dash = {}};
}

ShapeStyle condition_fill(int condition) {
  const ConditionColour& colour = colour_of(condition);
  return {.css_class = colour.fill_class, .fill = colour.colour, .stroke = {}, .stroke_width = 0, .dash = {}};
}

ShapeStyle condition_hollow(int condition) {
  const ConditionColour& colour = colour_of(condition);
  return {
      .css_class = colour.hollow_class, .fill = "#ffffff", .stroke = colour.colour, .stroke_width = 1.5, .dash = {}};
}

void draw_marker(Svg& svg, int condition, double x, double y, double radius, const ShapeStyle& style) {
  constexpr double kQuarter = 3.14159265358979 / 2;
  switch (condition % kShapes) {
    case 0:
      return svg.circle(x, y, 0.9 * radius, style);
    case 1:
      return svg.rectangle(x - 0.8 * radius, y - 0.8 * radius, 1.6 * radius, 1.6 * radius, style);
    case 2:
      return svg.polygon(regular(x, y + 0.15 * radius, 1.2 * radius, 3, -kQuarter), style);
    case 3:
      return svg.polygon(regular(x, y, 1.15 * radius, 4, -kQuarter), style);
    case 4:
      return svg.polygon(regular(x, y - 0.15 * radius, 1.2 * radius, 3, kQuarter), style);
    case 5:
      return svg.polygon(star(x, y, 1.3 * radius, 5, 0.45), style);
    case 6:
      return svg.polygon(regular(x, y, 1.05 * radius, 6, 0), style);
    default:
      return svg.polygon(star(x, y, 1.3 * radius, 4, 0.4), style);
  }
}

void draw_arrow(Svg& svg, double x, double y, double radius, bool up, const ShapeStyle& style) {
  const double sign = up ? -1 : 1;
  svg.polygon({{x, y + sign * 1.2 * radius},
               {x + radius, y},
               {x + 0.35 * radius, y},
               {x + 0.35 * radius, y - sign * 1.1 * radius},
               {x - 0.35 * radius, y - sign * 1.1 * radius},
               {x - 0.35 * radius, y},
               {x - radius, y}},
              style);
}

void draw_cross(Svg& svg, double x, double y, double radius, const ShapeStyle& style) {
  const double arm = 0.8 * radius;
  svg.line(x - arm, y - arm, x + arm, y + arm, style);
  svg.line(x - arm, y + arm, x + arm, y - arm, style);
}

double text_width(std::string_view text, double size) {
  double width = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t next = next_character(text, at);
    width += character_width(text.substr(at, next - at));
    at = next;
  }
  return width * size;
}

std::string fitted(std::string_view text, double size, double width) {
  if (text_width(text, size) <= width) return std::string(text);
  double used = size;  // of the ellipsis
  std::size_t end = 0;
  while (end < text.size()) {
    const std::size_t next = next_character(text, end);
    used += character_width(text.substr(end, next - end)) * size;
    if (used > width) break;
    end = next;
  }
  return std::string(text.substr(0, end)) + "…";
}

std::vector<std::string> wrapped(std::string_view text, double size, double width, std::size_t most) {
  std::vector<std::string> lines;
  while (!text.empty() && lines.size() + 1 < most && text_width(text, size) > width) {
    std::size_t cut = std::string_view::npos;
    for (std::size_t space = text.find(' '); space != std::string_view::npos; space = text.find(' ', space + 1)) {
      if (text_width(text.substr(0, space), size) > width) break;
      cut = space;
    }
    if (cut == std::string_view::npos) break;
    lines.emplace_back(text.substr(0, cut));
    text.remove_prefix(cut + 1);
  }
  lines.push_back(fitted(text, size, width));
  return lines;
}

// The legend of a figure: what every kind of mark means.

namespace {

constexpr double kRow = 18, kSymbol = 22, kGap = 16, kLine = 14;
constexpr std::size_t kMostLines = 3;  // of an entry

void draw_symbol(Svg& svg, const LegendEntry& entry, double x, double y) {
  using Kind = LegendEntry::Kind;
  const double middle = x + kSymbol / 2 - 3;
  switch (entry.kind) {
    case Kind::condition:
      return draw_marker(svg, entry.condition, middle, y, 4.5, condition_fill(entry.condition));
    case Kind::hollow:
      return draw_marker(svg, entry.condition, middle, y, 4.5, condition_hollow(entry.condition));
    case Kind::interval:
      svg.line(middle, y - 7, middle, y + 7, kInk);
      return svg.circle(middle, y, 4, kInkFill);
    case Kind::within:
      return draw_within(svg, middle, y - 7, y + 7);
    case Kind::published:
      return draw_published(svg, middle, y, {});
    case Kind::median:
      return svg.line(middle - 8, y, middle + 8, y, kMedian);
    case Kind::line:
      return svg.line(x, y, x + kSymbol - 6, y, kInk);
    case Kind::arrow:
      return draw_arrow(svg, middle, y, 4, true, kInkFill);
    case Kind::cross:
      return draw_cross(svg, middle, y, 4, kInk);
  }
}

}  // namespace

void draw_within(Svg& svg, double x, double top, double bottom) {
  for (const double edge : {top, bottom}) svg.line(x - 3.5, edge, x + 3.5, edge, kWithin);
  svg.line(x, top, x, bottom, kWithin);
}

void draw_published(Svg& svg, double x, double y, const std::optional<std::pair<double, double>>& interval) {
  if (interval) svg.line(x, interval->first, x, interval->second, kPublished);
  svg.polygon({{x, y - 5.5}, {x + 5.5, y}, {x, y + 5.5}, {x - 5.5, y}}, kPublished);
}

double draw_legend(Svg* svg, const std::vector<LegendEntry>& entries, double x, double y, double width) {
  double across = 0, down = kRow / 2;
  for (const LegendEntry& entry : entries) {
    const std::vector<std::string> lines = wrapped(entry.text, kLegendSize, width - kSymbol, kMostLines);
    double wide = 0;
    for (const std::string& line : lines) wide = std::max(wide, kSymbol + text_width(line, kLegendSize) + kGap);
    if (across > 0 && across + wide - kGap > width) {
      across = 0;
      down += kRow;
    }
    if (svg != nullptr) {
      draw_symbol(*svg, entry, x + across, y + down);
      TextStyle style = kLabel;
      style.size = kLegendSize;
      for (std::size_t i = 0; i < lines.size(); ++i)
        svg->text(x + across + kSymbol, y + down + 4 + kLine * static_cast<double>(i), lines[i], style);
    }
    across += wide;
    // What takes more lines than one filled its row.
    if (lines.size() > 1) down += kLine * static_cast<double>(lines.size() - 1);
  }
  return entries.empty() ? 0 : down + kRow / 2;
}

}  // namespace jnd
