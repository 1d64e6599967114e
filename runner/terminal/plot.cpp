#include "runner/terminal/plot.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <unistd.h>

#include "analysis/numerics/special_values.h"
#include "protocols/input/utf8.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

constexpr int kNarrowestPlot = 40, kWidestPlot = 100;  // columns

// Low to high, in the axis's own scale.
struct Axis {
  double low = 0, high = 1;
  bool logarithmic = false;
  double scaled(double value) const { return logarithmic ? std::log10(value) : value; }
  // 0..1 from low to high.
  double share(double value) const { return (scaled(value) - scaled(low)) / (scaled(high) - scaled(low)); }
};

// The character or dot, of `count` in a row, that a share of the row falls on.
int place(double share, int count) {
  return std::clamp(static_cast<int>(std::lround(share * (count - 1))), 0, count - 1);
}

struct XAxisText {
  std::string rule, labels;
};

std::string tick_text(double value, double step) {
  if (std::abs(value) < 1e-9 * step) value = 0;
  return fmt::format("{:.6g}", value);
}

std::vector<double> ticks_of(const Axis& axis, int wanted) {
  if (!axis.logarithmic) return axis_ticks(axis.low, axis.high, wanted);
  std::vector<double> ticks, decades;
  for (int exponent = static_cast<int>(std::floor(std::log10(axis.low))); std::pow(10.0, exponent) <= axis.high;
       ++exponent)
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double tick = digit * std::pow(10.0, exponent);
      if (tick < axis.low * (1 - 1e-9) || tick > axis.high * (1 + 1e-9)) continue;
      ticks.push_back(tick);
      if (digit == 1.0) decades.push_back(tick);
    }
  if (static_cast<int>(ticks.size()) > 2 * wanted) return decades;
  return ticks;
}

std::string padded_left(const std::string& text, std::size_t width) {
  return std::string(width - std::min(width, display_width(text)), ' ') + text;
}

// The labels of an x axis under their ticks; one that would touch its neighbour is left out.
XAxisText x_axis(const Axis& axis, int columns, bool unicode) {
  const std::vector<double> ticks = ticks_of(axis, std::max(2, columns / 12));
  const double step = ticks.size() > 1 ? std::abs(ticks[1] - ticks[0]) : 1;
  std::vector<std::string> rule(static_cast<std::size_t>(columns), unicode ? "─" : "-");
  std::string labels;
  for (const double tick : ticks) {
    const auto at = static_cast<std::size_t>(place(axis.share(tick), columns));
    rule[at] = unicode ? "┬" : "+";
    const std::string text = tick_text(tick, step);
    if (text.size() > rule.size()) continue;
    // Under its tick, but never past either end of the axis.
    const std::size_t centred = at >= text.size() / 2 ? at - text.size() / 2 : 0;
    const std::size_t begin = std::min(centred, rule.size() - text.size());
    if (!labels.empty() && begin < labels.size() + 2) continue;
    labels += std::string(begin - labels.size(), ' ') + text;
  }
  XAxisText text{.rule = {}, .labels = labels};
  for (const std::string& character : rule) text.rule += character;
  return text;
}

// Ended by a newline.
std::string centred_under(const std::string& label, std::size_t gutter, int columns) {
  const auto width = static_cast<std::size_t>(columns);
  const std::size_t before = gutter + (width > label.size() ? (width - label.size()) / 2 : 0);
  return std::string(before, ' ') + label + "\n";
}

// Characters of series after the first; they start again after the last.
constexpr std::array<const char*, 4> kMarks = {"·", "+", "x", "o"};
constexpr std::array<const char*, 4> kAsciiMarks = {".", "+", "x", "o"};

bool drawable(const PlotSeries& series, std::size_t i, bool log_x) {
  return std::isfinite(series.x[i]) && std::isfinite(series.y[i]) && (!log_x || series.x[i] > 0);
}

struct Frame {
  Axis x, y;
  bool empty = true;
};

// A little space above and below the curves, so that they do not run along the frame.
Frame frame_of(const std::vector<PlotSeries>& series, const PlotOptions& options) {
  Frame frame;
  frame.x = {.low = kInf, .high = -kInf, .logarithmic = options.log_x};
  frame.y = {.low = kInf, .high = -kInf};
  for (const PlotSeries& one : series) {
    for (std::size_t i = 0; i < std::min(one.x.size(), one.y.size()); ++i) {
      if (!drawable(one, i, options.log_x)) continue;
      frame.empty = false;
      frame.x.low = std::min(frame.x.low, one.x[i]);
      frame.x.high = std::max(frame.x.high, one.x[i]);
      frame.y.low = std::min(frame.y.low, one.y[i]);
      frame.y.high = std::max(frame.y.high, one.y[i]);
    }
  }
  if (frame.empty) return frame;
  if (options.x_range) {
    frame.x.low = std::min(frame.x.low, options.x_range->first);
    frame.x.high = std::max(frame.x.high, options.x_range->second);
  }
  if (options.from_zero) {
    frame.y.low = std::min(frame.y.low, 0.0);
    frame.y.high = std::max(frame.y.high, 0.0);
  }
  const double spread = frame.y.high - frame.y.low;
  const double margin = spread > 0 ? 0.04 * spread : std::max(1e-9, 0.1 * std::abs(frame.y.high));
  if (!options.from_zero || frame.y.low < 0) frame.y.low -= margin;
  frame.y.high += margin;
  if (!(frame.x.high > frame.x.low)) {
    const double half = frame.x.high != 0 ? 0.1 * std::abs(frame.x.high) : 1;
    frame.x.low -= half;
    frame.x.high += half;
  }
  return frame;
}

// The plotting area, character by character.
class Area {
 public:
  Area(int columns, int rows, bool unicode)
      : columns_(columns),
        rows_(rows),
        unicode_(unicode),
        cells_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), " "),
        dots_(cells_.size(), 0U) {}

  // Dots of the finest grid: 2 x 4 a character in braille, 1 x 1 in ASCII.
  int dot_columns() const { return unicode_ ? 2 * columns_ : columns_; }
  int dot_rows() const { return unicode_ ? 4 * rows_ : rows_; }

  // row 0 is the lowest.
  void dot(int column, int row) {
    if (column < 0 || column >= dot_columns() || row < 0 || row >= dot_rows()) return;
    const int from_top = dot_rows() - 1 - row;
    if (!unicode_) {
      cell(column, from_top) = "*";
      return;
    }
    // Bits of U+2800: 1 2 3 7 down the left column, 4 5 6 8 down the right one.
    constexpr std::array<std::array<unsigned, 4>, 2> kBits = {{{0x01, 0x02, 0x04, 0x40}, {0x08, 0x10, 0x20, 0x80}}};
    dots_[index(column / 2, from_top / 4)] |=
        kBits[static_cast<std::size_t>(column % 2)][static_cast<std::size_t>(from_top % 4)];
  }

  void mark(int column, int row, const char* character) {
    if (column >= 0 && column < columns_ && row >= 0 && row < rows_) cell(column, rows_ - 1 - row) = character;
  }

  std::string line(int from_top) const {
    std::string text;
    for (int column = 0; column < columns_; ++column) {
      const std::size_t at = index(column, from_top);
      text += dots_[at] != 0 ? to_utf8(0x2800U + dots_[at]) : cells_[at];
    }
    return text;
  }

 private:
  std::size_t index(int column, int from_top) const {
    return static_cast<std::size_t>(from_top) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  std::string& cell(int column, int from_top) { return cells_[index(column, from_top)]; }

  int columns_, rows_;
  bool unicode_;
  std::vector<std::string> cells_;
  std::vector<unsigned> dots_;
};

void draw_line(const PlotSeries& series, const Frame& frame, Area& area) {
  int last_column = -1, last_row = 0;
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
    if (!drawable(series, i, frame.x.logarithmic)) {
      last_column = -1;
      continue;
    }
    const int column = place(frame.x.share(series.x[i]), area.dot_columns());
    const int row = place(frame.y.share(series.y[i]), area.dot_rows());
    if (last_column < 0) area.dot(column, row);
    const int steps = last_column < 0 ? 0 : std::max(std::abs(column - last_column), std::abs(row - last_row));
    for (int step = 1; step <= steps; ++step)
      area.dot(last_column + (column - last_column) * step / steps, last_row + (row - last_row) * step / steps);
    last_column = column;
    last_row = row;
  }
}

// One mark a character column, so that a straight line is a row of marks.
void draw_marks(const PlotSeries& series, const Frame& frame, const char* character, int columns, int rows,
                Area& area) {
  int last_column = -1;
  double last_y = 0;
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
    if (!drawable(series, i, frame.x.logarithmic)) {
      last_column = -1;
      continue;
    }
    const int column = place(frame.x.share(series.x[i]), columns);
    const int from = last_column < 0 ? column : last_column + 1;
    for (int at = from; at <= column; ++at) {
      const double part = column == last_column ? 1 : static_cast<double>(at - last_column) / (column - last_column);
      const double y = last_column < 0 ? series.y[i] : last_y + (series.y[i] - last_y) * part;
      area.mark(at, place(frame.y.share(y), rows), character);
    }
    last_column = column;
    last_y = series.y[i];
  }
}

std::string legend(const std::vector<PlotSeries>& series, bool unicode) {
  std::string text;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const std::string mark = i == 0    ? (unicode ? to_utf8(char32_t{0x2812}) + to_utf8(char32_t{0x2812}) : "**")
                             : unicode ? std::string(kMarks[(i - 1) % kMarks.size()]) + kMarks[(i - 1) % kMarks.size()]
                                       : std::string(kAsciiMarks[(i - 1) % 4]) + kAsciiMarks[(i - 1) % 4];
    text += (i == 0 ? "" : "   ") + mark + " " + series[i].name;
  }
  return text;
}

}  // namespace

Canvas canvas_of_terminal() {
  Canvas canvas{.columns = std::clamp(terminal_width() - 1, kNarrowestPlot, kWidestPlot)};
  for (const char* variable : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(variable);
    if (value == nullptr || *value == '\0') continue;
    std::string locale(value);
    std::transform(locale.begin(), locale.end(), locale.begin(),
                   [](unsigned char character) { return static_cast<char>(std::tolower(character)); });
    canvas.unicode = locale.find("utf-8") != std::string::npos || locale.find("utf8") != std::string::npos;
    break;
  }
  canvas.unicode = canvas.unicode && is_terminal(STDOUT_FILENO);
  return canvas;
}

std::vector<double> axis_ticks(double low, double high, int wanted) {
  std::vector<double> ticks;
  if (!(high > low) || !std::isfinite(high - low)) return ticks;
  const double rough = (high - low) / std::max(1, wanted);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= rough * (1 - 1e-9)) {
      step = digit * power;
      break;
    }
  const double slack = 1e-9 * step;
  // NOLINTNEXTLINE(cert-flp30-c)
  for (double index = std::ceil((low - slack) / step); index * step <= high + slack; ++index)
    ticks.push_back(index * step);
  return ticks;
}

std::string line_plot(const std::vector<PlotSeries>& series, const PlotOptions& options, const Canvas& canvas) {
  const Frame frame = frame_of(series, options);
  if (frame.empty) return "  nothing to plot\n";
  const int rows = std::max(4, options.rows);
  const std::vector<double> y_ticks = ticks_of(frame.y, std::max(2, rows / 3));
  const double y_step = y_ticks.size() > 1 ? y_ticks[1] - y_ticks[0] : 1;
  std::size_t gutter = 1;
  for (const double tick : y_ticks) gutter = std::max(gutter, tick_text(tick, y_step).size());
  const int used = std::clamp(canvas.columns, kNarrowestPlot, kWidestPlot);
  const int columns = used - static_cast<int>(gutter) - 4;  // the indent, a space and the axis

  Area area(columns, rows, canvas.unicode);
  for (std::size_t i = series.size(); i-- > 1;)
    draw_marks(series[i], frame, (canvas.unicode ? kMarks : kAsciiMarks)[(i - 1) % kMarks.size()], columns, rows, area);
  if (!series.empty()) draw_line(series[0], frame, area);

  std::vector<std::string> labels(static_cast<std::size_t>(rows));
  for (const double tick : y_ticks)
    labels[static_cast<std::size_t>(rows - 1 - place(frame.y.share(tick), rows))] = tick_text(tick, y_step);

  std::string text = "  " + options.y_label;
  if (series.size() > 1) text += (options.y_label.empty() ? "" : "      ") + legend(series, canvas.unicode);
  text += "\n";
  for (int row = 0; row < rows; ++row) {
    const std::string& label = labels[static_cast<std::size_t>(row)];
    std::string line = "  " + padded_left(label, gutter) + " ";
    if (canvas.unicode)
      line += label.empty() ? "│" : "┤";
    else
      line += label.empty() ? "|" : "+";
    line += area.line(row);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  const XAxisText axis = x_axis(frame.x, columns, canvas.unicode);
  text += "  " + std::string(gutter + 1, ' ') + (canvas.unicode ? "└" : "+") + axis.rule + "\n";
  text += "  " + std::string(gutter + 2, ' ') + axis.labels + "\n";
  return text + centred_under(options.x_label, gutter + 4, columns);
}

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
