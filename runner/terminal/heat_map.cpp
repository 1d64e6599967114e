#include <array>
#include <cmath>

#include <fmt/format.h>

#include "runner/terminal/plot.h"
#include "runner/terminal/plot_axis.h"

namespace jnd {

std::string heat_map(const HeatMap& map, const Canvas& canvas) {
  if (map.x.empty() || map.y.empty()) return "  nothing to plot\n";
  constexpr std::array<const char*, 5> kShades = {"░", "▒", "▓", "█", "█"};
  constexpr std::array<const char*, 5> kAsciiShades = {".", "o", "%", "#", "@"};
  const auto& shades = canvas.unicode ? kShades : kAsciiShades;
  const std::size_t edges = std::min<std::size_t>(map.edges.size(), canvas.unicode ? 3 : 4);
  const auto shade = [&](double value) -> std::string {
    if (!std::isfinite(value)) return " ";
    std::size_t level = 0;
    while (level < edges && value >= map.edges[level]) ++level;
    return shades[level];
  };

  std::size_t gutter = 1;
  for (const double y : map.y) gutter = std::max(gutter, fmt::format("{:.4g}", y).size());
  const int used = std::clamp(canvas.columns, kNarrowestPlot, kWidestPlot);
  const int room = used - static_cast<int>(gutter) - 4;
  // A character is about twice as high as wide, so a value takes two where there is room.
  const int repeat = std::clamp(room / static_cast<int>(map.x.size()), 1, 2);
  const int columns = repeat * static_cast<int>(map.x.size());

  std::string text = "  " + map.y_label + "\n";
  const std::size_t label_every = std::max<std::size_t>(1, (map.y.size() - 1) / 4);
  for (std::size_t row = map.y.size(); row-- > 0;) {
    const bool labelled = row % label_every == 0;
    std::string line = "  " + padded_left(labelled ? fmt::format("{:.4g}", map.y[row]) : "", gutter) + " ";
    if (canvas.unicode)
      line += labelled ? "┤" : "│";
    else
      line += labelled ? "+" : "|";
    for (std::size_t column = 0; column < map.x.size(); ++column)
      for (int i = 0; i < repeat; ++i) line += shade(map.values[row * map.x.size() + column]);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  const XAxisText axis = x_axis({.low = map.x.front(), .high = map.x.back()}, columns, canvas.unicode);
  text += "  " + std::string(gutter + 1, ' ') + (canvas.unicode ? "└" : "+") + axis.rule + "\n";
  text += "  " + std::string(gutter + 2, ' ') + axis.labels + "\n";
  text += centred_under(map.x_label, gutter + 4, columns);
  text += "  " + map.value_label + ":";
  for (std::size_t level = 0; level <= edges; ++level) {
    const std::string mark = std::string(shades[level]) + shades[level];
    if (edges == 0)
      text += fmt::format("  {} any", mark);
    else if (level == 0)
      text += fmt::format("  {} below {:g}", mark, map.edges[0]);
    else if (level == edges)
      text += fmt::format("  {} {:g} or more", mark, map.edges[edges - 1]);
    else
      text += fmt::format("  {} {:g} to {:g}", mark, map.edges[level - 1], map.edges[level]);
  }
  return text + "   blank: " + map.none_label + "\n";
}

}  // namespace jnd
