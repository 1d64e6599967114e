// The levels that the answers chose: every track of a participant, trial by trial.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "protocols/tasks/level_source.h"
#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kTrackLeft = 62, kTrackWidth = 230, kTrackHeight = 130, kTrackGapX = 22, kTrackGapY = 34,
                 kTrackBottom = 52;
constexpr std::size_t kTrackColumns = 3;

struct TrackPanel {
  std::string participant;
  std::vector<const TrackRow*> tracks, whole;  // whole: of all tracks of a condition
};

std::vector<TrackPanel> track_panels(const TaskResults& results) {
  std::vector<TrackPanel> panels;
  for (const TrackRow& row : results.tracks) {
    if (panels.empty() || panels.back().participant != row.participant) panels.push_back({row.participant, {}, {}});
    (row.track == 0 ? panels.back().whole : panels.back().tracks).push_back(&row);
  }
  return panels;
}

struct TrackScales {
  Range trial, level;
};

TrackScales track_scales(const std::vector<TrackPanel>& panels) {
  double trials = 1, level = 0;
  for (const TrackPanel& panel : panels)
    for (const TrackRow* row : panel.tracks) {
      trials = std::max(trials, static_cast<double>(row->levels.size()));
      for (const double one : row->levels) level = std::max(level, one);
    }
  return {round_range(0, trials, 4), round_range(0, level > 0 ? level : 1, 4)};
}

// Behind the levels: what the posterior said after each answer, a band of its middle 95 % and its mean.
void draw_course(Svg& svg, const TrackRow& row, const Scale& x, const Scale& y) {
  if (row.course.size() < 2) return;
  std::vector<SvgPoint> band, mean;
  for (std::size_t i = 0; i < row.course.size(); ++i) {
    const double at = x.at(static_cast<double>(i) + 1);
    band.emplace_back(at, y.clipped(row.course[i].low));
    mean.emplace_back(at, y.clipped(row.course[i].jnd));
  }
  for (std::size_t i = row.course.size(); i-- > 0;)
    band.emplace_back(x.at(static_cast<double>(i) + 1), y.clipped(row.course[i].high));
  ShapeStyle shade = condition_fill(row.condition);
  shade.opacity = 0.18;
  svg.polygon(band, shade);
  ShapeStyle line = condition_line(row.condition);
  line.stroke_width = 2.2;
  svg.polyline(mean, line);
}

void draw_track(Svg& svg, const TrackRow& row, const Scale& x, const Scale& y, const Protocol& protocol) {
  std::vector<SvgPoint> corners;
  for (std::size_t i = 0; i < row.levels.size(); ++i)
    corners.emplace_back(x.at(static_cast<double>(i) + 1), y.at(row.levels[i]));
  svg.begin("", fmt::format("{}, {}, track {}: {}", row.participant, condition_text(protocol, row.condition), row.track,
                            counted(static_cast<std::int64_t>(row.levels.size()), "trial")));
  ShapeStyle line = condition_line(row.condition);
  line.stroke_width = 1.4;
  if (row.track % 2 == 0) line.dash = "4 2";
  draw_course(svg, row, x, y);
  if (!row.course.empty()) line.stroke_width = 0.8;
  if (corners.size() > 1) svg.polyline(corners, line);
  if (!corners.empty())
    draw_marker(svg, row.condition, corners.back().first, corners.back().second, 3, condition_fill(row.condition));
  svg.end();
}

void draw_tracks(Svg& svg, const Panel& panel, const TrackPanel& content, const TrackScales& scales,
                 const Protocol& protocol, bool y_labels, bool x_labels) {
  const Scale x{scales.trial.low, scales.trial.high, panel.left, panel.right};
  const Scale y{scales.level.low, scales.level.high, panel.bottom, panel.top};
  svg.text(panel.left, panel.top - 8, fitted(content.participant, kLabel.size, panel.width()), strong(kLabel));
  draw_grid_rows(svg, panel, y, 4);
  svg.rectangle(panel.left, panel.top, panel.width(), panel.height(), kFrame);
  if (y_labels) draw_y_axis(svg, panel, y, "", 4);
  if (x_labels) draw_x_axis(svg, panel, x, "", 4);
  for (const TrackRow* row : content.tracks) draw_track(svg, *row, x, y, protocol);
  // What they come to stands at the right edge.
  for (const TrackRow* row : content.whole) {
    if (!row->threshold || row->threshold->status != AdaptiveStatus::ok || !y.inside(row->threshold->threshold))
      continue;
    const double threshold = row->threshold->threshold;
    const double at = y.at(threshold);
    svg.polygon({{panel.right - 8, at}, {panel.right + 1, at - 4}, {panel.right + 1, at + 4}},
                condition_fill(row->condition));
  }
}

constexpr std::size_t kNarrowTracks = 1;
constexpr double kLeastTracks = 480;

Svg draw_track_panels(const std::vector<TrackPanel>& panels, const TrackScales& scales, const Protocol& protocol,
                      const FigurePage& page, std::size_t most_columns) {
  const bool narrow = most_columns == kNarrowTracks;
  const std::size_t columns = std::min(most_columns, panels.size()), rows = (panels.size() + columns - 1) / columns;
  const double width =
      std::max(narrow ? 0.0 : kLeastTracks, kTrackLeft + static_cast<double>(columns) * (kTrackWidth + kTrackGapX));
  std::vector<LegendEntry> legend;
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i)
    legend.push_back({LegendEntry::Kind::condition, static_cast<int>(i), condition_title(protocol.conditions[i])});
  const double top = 8 + draw_legend(nullptr, legend, 0, 0, width - kTrackLeft - 10) + 24;
  const double bottom = top + static_cast<double>(rows) * (kTrackHeight + kTrackGapY) - kTrackGapY;
  Svg svg(fmt::format("figure-{}{}", page.id, narrow ? "-narrow" : ""), width, bottom + kTrackBottom, page.title,
          fmt::format("A panel for every participant, from {} to {}.", panels.front().participant,
                      panels.back().participant));
  draw_legend(&svg, legend, kTrackLeft, 8, width - kTrackLeft - 10);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const std::size_t row = i / columns, column = i % columns;
    const double left = kTrackLeft + static_cast<double>(column) * (kTrackWidth + kTrackGapX);
    const double upper = top + static_cast<double>(row) * (kTrackHeight + kTrackGapY);
    draw_tracks(svg, {left, upper, left + kTrackWidth, upper + kTrackHeight}, panels[i], scales, protocol,
                i % columns == 0, i + columns >= panels.size());
  }
  TextStyle upwards = anchored(kLabel, "middle");
  upwards.upwards = true;
  svg.text(
      18, (top + bottom) / 2,
      fmt::format("{} ({})",
                  sides_of_comparisons(protocol, protocol.series.front()).front() == 0 ? "comparison" : "difference",
                  unit_of(protocol)),
      upwards);
  svg.text((kTrackLeft + width) / 2, bottom + 42, "trial of the track", anchored(kLabel, "middle"));
  return svg;
}

}  // namespace

std::vector<Figure> track_figures(const StudyResults& results, const Protocol& protocol) {
  const std::vector<TrackRow>& rows = results.task.tracks;
  if (rows.empty()) return {};
  std::vector<TrackPanel> panels = track_panels(results.task);
  const std::size_t participants = panels.size();
  panels.resize(std::min(participants, kMostPeopleDrawn));
  const TrackScales scales = track_scales(panels);
  const bool has_course =
      std::any_of(rows.begin(), rows.end(), [](const TrackRow& row) { return !row.course.empty(); });
  const std::string caption = fmt::format(
      "Presented differences of every track in the order of its trials; a second track of a condition is dashed.{} The "
      "wedges at the right are what the tracks of a condition come to.{}",
      has_course ? " The thick line is the JND by the posterior after each answer, the band its middle 95 %, as far as "
                   "the scale goes."
                 : "",
      first_of(panels.size(), participants));
  std::vector<Figure> figures;
  for (const FigurePage& page :
       figure_pages("tracks", "Levels that the answers chose", panels.size(), kPeopleInFigure)) {
    const std::vector<TrackPanel> shown(panels.begin() + static_cast<std::ptrdiff_t>(page.from),
                                        panels.begin() + static_cast<std::ptrdiff_t>(page.to));
    figures.push_back({page.id, page.title, caption, draw_track_panels(shown, scales, protocol, page, kTrackColumns),
                       draw_track_panels(shown, scales, protocol, page, kNarrowTracks)});
  }
  return figures;
}

}  // namespace jnd
