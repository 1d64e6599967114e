// The legend of a figure: what every kind of mark means.
#include <algorithm>

#include "runner/figures/figure_look.h"

namespace jnd {

namespace {

constexpr double kRow = 18, kSymbol = 22, kGap = 16;

void draw_symbol(Svg& svg, const LegendEntry& entry, double x, double y) {
  using Kind = LegendEntry::Kind;
  const double middle = x + kSymbol / 2 - 3;
  switch (entry.kind) {
    case Kind::condition:
      return draw_marker(svg, entry.condition, middle, y, 4.5, condition_fill(entry.condition));
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
    const std::string text = fitted(entry.text, kLegendSize, width - kSymbol);
    const double wide = kSymbol + text_width(text, kLegendSize) + kGap;
    if (across > 0 && across + wide - kGap > width) {
      across = 0;
      down += kRow;
    }
    if (svg != nullptr) {
      draw_symbol(*svg, entry, x + across, y + down);
      TextLook look = kLabel;
      look.size = kLegendSize;
      svg->text(x + across + kSymbol, y + down + 4, text, look);
    }
    across += wide;
  }
  return entries.empty() ? 0 : down + kRow / 2;
}

}  // namespace jnd
