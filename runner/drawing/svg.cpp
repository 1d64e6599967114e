#include "runner/drawing/svg.h"

#include <cctype>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>

namespace jnd {

namespace {

constexpr std::string_view kReplacement = "\xef\xbf\xbd";  // U+FFFD
constexpr std::string_view kFont = "Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif";

// The code point at `at` and its length in bytes; length 0 where the bytes are not UTF-8 (overlong forms and
// surrogates are not).
struct CodePoint {
  char32_t value = 0;
  std::size_t length = 0;
};
CodePoint code_point(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t place) { return static_cast<unsigned char>(text[place]); };
  const unsigned char first = byte(at);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || at + length > text.size()) return {};
  char32_t value = first & (0x7fU >> length);
  for (std::size_t next = at + 1; next < at + length; ++next) {
    if ((byte(next) & 0xc0U) != 0x80) return {};
    value = (value << 6U) | (byte(next) & 0x3fU);
  }
  const bool overlong = (length == 3 && value < 0x800) || (length == 4 && value < 0x10000);
  const bool surrogate = value >= 0xd800 && value <= 0xdfff;
  return overlong || surrogate || value > 0x10ffff ? CodePoint{} : CodePoint{value, length};
}

bool forbidden(char32_t value) {
  if (value < 0x20) return value != '\t' && value != '\n';
  return (value >= 0x7f && value < 0xa0) || (value >= 0x202a && value <= 0x202e) ||
         (value >= 0x2066 && value <= 0x2069) || value == 0xfffe || value == 0xffff;
}

std::string attribute(std::string_view name, std::string_view value) {
  return fmt::format(" {}=\"{}\"", name, escape_markup(value));
}

std::string number_attribute(std::string_view name, double value) {
  return fmt::format(" {}=\"{}\"", name, svg_number(value));
}

std::string attributes(const ShapeStyle& style) {
  std::string text;
  if (!style.css_class.empty()) text += attribute("class", style.css_class);
  if (!style.fill.empty()) text += attribute("fill", style.fill);
  if (!style.stroke.empty()) text += attribute("stroke", style.stroke);
  if (style.stroke_width > 0) text += number_attribute("stroke-width", style.stroke_width);
  if (!style.dash.empty()) text += attribute("stroke-dasharray", style.dash);
  if (style.opacity < 1) text += number_attribute("opacity", style.opacity);
  return text;
}

}  // namespace

std::string escape_markup(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint point = code_point(text, at);
    if (point.length == 0 || forbidden(point.value))
      safe += kReplacement;
    else if (point.value == '&')
      safe += "&amp;";
    else if (point.value == '<')
      safe += "&lt;";
    else if (point.value == '>')
      safe += "&gt;";
    else if (point.value == '"')
      safe += "&quot;";
    else if (point.value == '\'')
      safe += "&#39;";
    else
      safe += text.substr(at, point.length);
    at += point.length == 0 ? 1 : point.length;
  }
  return safe;
}

std::string svg_number(double value) {
  if (!std::isfinite(value)) throw std::logic_error("a figure has a coordinate that is not a finite number");
  std::string text = fmt::format("{:.2f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

Svg::Svg(std::string id, double width, double height, std::string title, std::string description)
    : id_(std::move(id)),
      title_(std::move(title)),
      description_(std::move(description)),
      width_(width),
      height_(height) {}

void Svg::rectangle(double x, double y, double width, double height, const ShapeStyle& style) {
  body_ += fmt::format("<rect{}{}{}{}{}/>\n", number_attribute("x", x), number_attribute("y", y),
                       number_attribute("width", width), number_attribute("height", height), attributes(style));
}

void Svg::line(double x1, double y1, double x2, double y2, const ShapeStyle& style) {
  body_ += fmt::format("<line{}{}{}{}{}/>\n", number_attribute("x1", x1), number_attribute("y1", y1),
                       number_attribute("x2", x2), number_attribute("y2", y2), attributes(style));
}

void Svg::circle(double x, double y, double radius, const ShapeStyle& style) {
  body_ += fmt::format("<circle{}{}{}{}/>\n", number_attribute("cx", x), number_attribute("cy", y),
                       number_attribute("r", radius), attributes(style));
}

void Svg::points(std::string_view tag, const std::vector<SvgPoint>& points, const ShapeStyle& style) {
  std::string list;
  for (const auto& [x, y] : points)
    list += fmt::format("{}{},{}", list.empty() ? "" : " ", svg_number(x), svg_number(y));
  body_ += fmt::format("<{} points=\"{}\"{}/>\n", tag, list, attributes(style));
}

void Svg::polygon(const std::vector<SvgPoint>& corners, const ShapeStyle& style) {
  points("polygon", corners, style);
}

void Svg::polyline(const std::vector<SvgPoint>& corners, const ShapeStyle& style) {
  ShapeStyle open = style;
  open.fill = "none";
  points("polyline", corners, open);
}

namespace {

// The minus of a number is as long as a plus: a hyphen that a digit follows and no letter or digit precedes.
std::string with_minus(std::string_view text) {
  const auto alphanumeric = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool minus = text[i] == '-' && i + 1 < text.size() && text[i + 1] >= '0' && text[i + 1] <= '9' &&
                       (i == 0 || !alphanumeric(text[i - 1]));
    if (minus)
      out += "\u2212";
    else
      out += text[i];
  }
  return out;
}

}  // namespace

void Svg::text(double x, double y, std::string_view content, const TextStyle& style) {
  std::string turn;
  if (style.upwards) turn = fmt::format(" transform=\"rotate(-90 {} {})\"", svg_number(x), svg_number(y));
  body_ += fmt::format(
      "<text{}{}{}{}{}{}{}{}>{}</text>\n", number_attribute("x", x), number_attribute("y", y),
      attribute("class", style.css_class), attribute("fill", style.fill), number_attribute("font-size", style.size),
      style.anchor == "start" ? std::string() : attribute("text-anchor", style.anchor),
      style.bold ? attribute("font-weight", "bold") : std::string(), turn, escape_markup(with_minus(content)));
}

void Svg::begin(std::string_view css_class, std::string_view label) {
  body_ += "<g" + (css_class.empty() ? std::string() : attribute("class", css_class)) + ">\n";
  if (!label.empty()) body_ += fmt::format("<title>{}</title>\n", escape_markup(label));
}

void Svg::end() {
  body_ += "</g>\n";
}

std::string Svg::markup(bool alone) const {
  const std::string width = svg_number(width_), height = svg_number(height_);
  return fmt::format(
      "<svg{6} role=\"img\" aria-labelledby=\"{0}-title {0}-desc\" width=\"{1}\" height=\"{2}\" "
      "viewBox=\"0 0 {1} {2}\" font-family=\"{3}\">\n"
      "<title id=\"{0}-title\">{4}</title>\n<desc id=\"{0}-desc\">{5}</desc>\n"
      "<rect class=\"paper\" x=\"0\" y=\"0\" width=\"{1}\" height=\"{2}\" fill=\"#ffffff\"/>\n{7}</svg>\n",
      id_, width, height, kFont, escape_markup(title_), escape_markup(description_),
      alone ? " xmlns=\"http://www.w3.org/2000/svg\"" : "", body_);
}

std::string Svg::element() const {
  return markup(false);
}

std::string Svg::file() const {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + markup(true);
}

}  // namespace jnd
