// Writes one SVG picture. Every mark has plain presentation attributes, so that the file is right on its own, and a
// class, so that the style sheet of a page can give it other colours (dark mode, print).
//
// Coordinates are in CSS pixels from the top left corner, written with at most two decimals. A coordinate that is not a
// finite number is a mistake of the caller: std::logic_error, never a mark in the wrong place.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace jnd {

// Text for XML and HTML, in content and in attributes. What is not valid UTF-8, control characters that XML forbids and
// the controls that reorder text (U+202A..U+202E, U+2066..U+2069) become U+FFFD: no text of a user changes what stands
// around it.
std::string escape_markup(std::string_view text);

// At most two decimals, none that are zero: "12.5", "-3". Throws std::logic_error for NaN and infinity.
std::string svg_number(double value);

// How a mark looks. Empty fields are not written: SVG then fills black and strokes nothing.
struct ShapeStyle {
  std::string_view css_class;
  std::string_view fill;    // "#0072b2", "none"
  std::string_view stroke;  // the same
  double stroke_width = 0;  // 0: not written
  std::string_view dash;    // "4 3"
  double opacity = 1;       // of fill and stroke, 0..1
};

struct TextStyle {
  std::string_view css_class = "ink";
  std::string_view fill = "#1a1a1a";
  double size = 12;
  std::string_view anchor = "start";  // start, middle, end
  bool bold = false;
  bool upwards = false;  // turned by a quarter: an axis title at the left
};

using SvgPoint = std::pair<double, double>;

class Svg {
 public:
  // id: of letters, digits and '-', unique in a page. title and description are what a screen reader says.
  Svg(std::string id, double width, double height, std::string title, std::string description);

  void rectangle(double x, double y, double width, double height, const ShapeStyle& style);
  void line(double x1, double y1, double x2, double y2, const ShapeStyle& style);
  void circle(double x, double y, double radius, const ShapeStyle& style);
  void polygon(const std::vector<SvgPoint>& corners, const ShapeStyle& style);
  void polyline(const std::vector<SvgPoint>& corners, const ShapeStyle& style);  // never filled
  void text(double x, double y, std::string_view content, const TextStyle& style);
  // Marks until the matching end() belong together; label, where not empty, is the tooltip of them.
  void begin(std::string_view css_class, std::string_view label = {});
  void end();

  double width() const noexcept { return width_; }
  double height() const noexcept { return height_; }
  std::string element() const;  // <svg ...>...</svg>, to stand in HTML
  std::string file() const;     // the same as an XML document of its own

 private:
  std::string markup(bool alone) const;
  void points(std::string_view tag, const std::vector<SvgPoint>& points, const ShapeStyle& style);

  std::string id_, title_, description_, body_;
  double width_, height_;
};

}  // namespace jnd
