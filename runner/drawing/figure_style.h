// How the figures of a report look: the same ink, and for each condition the same colour and shape everywhere.
//
// Colours: Okabe and Ito 2008 (Color Universal Design), which people with every common colour vision can tell apart;
// a condition is never known by its colour alone, but by its shape too. The classes are those of report_style.cpp.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocols/protocol.h"
#include "runner/drawing/svg.h"

namespace jnd {

inline constexpr ShapeStyle kFrame{
    .css_class = "axis", .fill = "none", .stroke = "#4d4d4d", .stroke_width = 1, .dash = {}};
inline constexpr ShapeStyle kGrid{.css_class = "grid", .fill = {}, .stroke = "#e3e3e3", .stroke_width = 1, .dash = {}};
inline constexpr ShapeStyle kRule{
    .css_class = "rule", .fill = {}, .stroke = "#9a9a9a", .stroke_width = 1, .dash = "2 3"};
inline constexpr ShapeStyle kBand{.css_class = "band", .fill = "#f3f3f3", .stroke = {}, .stroke_width = 0, .dash = {}};
inline constexpr ShapeStyle kFaint{
    .css_class = "faint", .fill = {}, .stroke = "#b5b5b5", .stroke_width = 0.8, .dash = {}};
inline constexpr ShapeStyle kInk{
    .css_class = "ink-line", .fill = {}, .stroke = "#1a1a1a", .stroke_width = 2, .dash = {}};
inline constexpr ShapeStyle kInkFill{
    .css_class = "ink-fill", .fill = "#1a1a1a", .stroke = "#ffffff", .stroke_width = 1, .dash = {}};
inline constexpr ShapeStyle kMedian{
    .css_class = "ink-line", .fill = {}, .stroke = "#1a1a1a", .stroke_width = 1.5, .dash = "3 2"};
inline constexpr ShapeStyle kWithin{
    .css_class = "within", .fill = {}, .stroke = "#5c5c5c", .stroke_width = 1.5, .dash = {}};
// Of another study: hollow, so that it is never taken for this one's.
inline constexpr ShapeStyle kPublished{
    .css_class = "published", .fill = "#ffffff", .stroke = "#8a5a00", .stroke_width = 1.6, .dash = {}};
inline constexpr double kLegendSize = 11.5;

inline constexpr TextStyle kLabel{};
inline constexpr TextStyle kMuted{.css_class = "muted", .fill = "#595959", .size = 11};

TextStyle anchored(TextStyle style, std::string_view anchor);
TextStyle strong(TextStyle style);

// By the condition's place in the protocol; after seven colours and eight shapes they begin again, each for itself.
ShapeStyle condition_line(int condition);
ShapeStyle condition_fill(int condition);
ShapeStyle condition_hollow(int condition);  // the outline alone, on paper

// The condition's shape, about `radius` from its centre to its edge.
void draw_marker(Svg& svg, int condition, double x, double y, double radius, const ShapeStyle& style);
// Points away from the panel: at an edge, what lies beyond it.
void draw_arrow(Svg& svg, double x, double y, double radius, bool up, const ShapeStyle& style);
void draw_cross(Svg& svg, double x, double y, double radius, const ShapeStyle& style);  // nothing could be estimated
void draw_within(Svg& svg, double x, double top, double bottom);
// interval: both ends on the page, where one was published.
void draw_published(Svg& svg, double x, double y, const std::optional<std::pair<double, double>>& interval);

// About how wide a text of the figures is, in pixels: for room, not for exact places.
double text_width(std::string_view text, double size);
// Cut to that width, with an ellipsis; never inside a character.
std::string fitted(std::string_view text, double size, double width);

// At spaces, at most `most` lines of that width; the last one is cut where it does not fit.
std::vector<std::string> wrapped(std::string_view text, double size, double width, std::size_t most);

struct LegendEntry {
  enum class Kind { condition, hollow, interval, within, published, median, line, arrow, cross } kind = Kind::condition;
  int condition = 0;  // of Kind::condition and Kind::hollow
  std::string text;
};
// Entries in rows from the left, wrapped at width; draws them from y downwards and returns the height taken. With
// svg = nullptr it only measures.
double draw_legend(Svg* svg, const std::vector<LegendEntry>& entries, double x, double y, double width);

}  // namespace jnd
