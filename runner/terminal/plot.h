// Pictures of text: curves, and maps of a quantity over two others. Braille or block characters where the terminal
// shows them, plain ASCII otherwise; a series is told from another by its characters, never by colour.
//
// Pure functions but for canvas_of_terminal().
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace jnd {

// What may be drawn on.
struct Canvas {
  int columns = 80;      // of the whole picture, axis labels included; 40 to 100 are used
  bool unicode = false;  // braille, block and box characters
};
// Of standard output. Unicode where that is a terminal with a UTF-8 locale.
Canvas canvas_of_terminal();

struct PlotSeries {
  std::string name;          // in the legend; a plot of one series has none
  std::vector<double> x, y;  // of one length; a point that is not finite interrupts the line
};

struct PlotOptions {
  std::string x_label, y_label;  // with units: "time (s)"
  int rows = 16;                 // of the plotting area, at least 4
  bool log_x = false;            // only x > 0 is drawn
  bool from_zero = false;        // the y axis includes 0
  // Where the x axis begins and ends at the latest, whatever is drawn; none: at the first and the last point.
  std::optional<std::pair<double, double>> x_range{};
};

// Lines ended by a newline, each indented by two spaces. The first series is drawn as a line, the others as dots, plus
// signs, crosses and circles, in their order, behind it. Says so where there is nothing to draw.
std::string line_plot(const std::vector<PlotSeries>& series, const PlotOptions& options, const Canvas& canvas);

struct HeatMap {
  std::string x_label, y_label;  // with units
  std::vector<double> x, y;      // ascending
  std::vector<double> values;    // a row of x for each y; not finite: there is none
  std::string value_label;       // "condition number"
  std::vector<double> edges;     // ascending, at most 3: a shade below the first, between each two, and from the last
  std::string none_label = "none";  // for values that are not finite
};
// y upwards. The shades and what they mean stand below.
std::string heat_map(const HeatMap& map, const Canvas& canvas);

// The ticks of an axis, ascending, at 1, 2 or 5 times a power of ten, about `wanted` of them within low..high. Empty
// where there is no range.
std::vector<double> axis_ticks(double low, double high, int wanted);

}  // namespace jnd
