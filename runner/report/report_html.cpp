#include "runner/report/report_html.h"

#include <cctype>

#include <fmt/format.h>

namespace jnd {

namespace {

// Columns from which a table is set smaller; rows up to which it stays on one printed page, and above which it is
// folded: on the screen it opens, on paper its title stands for it.
constexpr std::size_t kWideFrom = 10, kWidestFrom = 14, kShortUpTo = 20, kOpenUpTo = 120;

std::string table_classes(const ResultTable& table) {
  std::string names = "table";
  if (table.columns.size() >= kWideFrom) names += " wide";
  if (table.columns.size() >= kWidestFrom) names += " widest";
  if (table.rows.size() <= kShortUpTo) names += " short";
  return names;
}

std::string anchor(std::string_view prefix, std::string_view id) {
  std::string text(prefix);
  for (const char character : id) text += std::isalnum(static_cast<unsigned char>(character)) != 0 ? character : '-';
  return text;
}

std::string row_html(const ResultTable& table, const std::vector<std::string>& row) {
  std::string html = "<tr>";
  for (std::size_t i = 0; i < row.size(); ++i) {
    const bool number = i < table.columns.size() && table.columns[i].number;
    const std::string_view css = number ? " class=\"number\"" : "";
    // An empty first cell stands for the one above it: nothing to head the row with.
    if (i == 0 && !row[i].empty())
      html += fmt::format("<th scope=\"row\"{}>{}</th>", css, escape_markup(row[i]));
    else
      html += fmt::format("<td{}>{}</td>", css, escape_markup(row[i]));
  }
  return html + "</tr>\n";
}

}  // namespace

std::string user_text(std::string_view text) {
  return "<bdi>" + escape_markup(text) + "</bdi>";
}

std::string table_anchor(const ResultTable& table) {
  return anchor("table-", table.id);
}

std::string table_html(const ResultTable& table) {
  const std::string id = table_anchor(table);
  const bool folded = table.rows.size() > kOpenUpTo;
  std::string html = fmt::format("<section class=\"{}\" id=\"{}\">\n", table_classes(table), id);
  if (folded)
    html += fmt::format(
        "<details>\n<summary>{} <span class=\"note\">{} rows; jnd export writes them as CSV</span></summary>\n",
        escape_markup(table.title), table.rows.size());
  html += fmt::format(
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
      "aria-label=\"{}\">\n<table>\n<caption>{}",
      escape_markup("Table: " + table.title), escape_markup(table.title));
  if (!table.note.empty()) html += fmt::format("<span class=\"note\">{}</span>", escape_markup(table.note));
  html += "</caption>\n<thead><tr>";
  for (const ResultTable::Column& column : table.columns)
    html += fmt::format("<th scope=\"col\"{}>{}</th>", column.number ? " class=\"number\"" : "",
                        escape_markup(column.name));
  html += "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) html += row_html(table, row);
  html += "</tbody>\n</table>\n</div>\n" + list_html(table.footnotes, "footnotes");
  return html + (folded ? "</details>\n</section>\n" : "</section>\n");
}

std::string figure_anchor(const Figure& figure) {
  return anchor("fig-", figure.id);
}

std::string figure_html(const Figure& figure, int number) {
  std::string pictures = fmt::format("<div class=\"picture\">\n{}</div>\n", figure.svg.element());
  if (figure.narrow)
    pictures =
        fmt::format("<div class=\"picture wide-only\">\n{}</div>\n<div class=\"picture narrow-only\">\n{}</div>\n",
                    figure.svg.element(), figure.narrow->element());
  return fmt::format("<figure id=\"{}\">\n{}<figcaption><strong>Figure {}. {}.</strong> {}</figcaption>\n</figure>\n",
                     figure_anchor(figure), pictures, number, escape_markup(figure.title),
                     escape_markup(figure.caption));
}

std::string list_html(const std::vector<std::string>& items, std::string_view css_class) {
  if (items.empty()) return {};
  std::string html = css_class.empty() ? "<ul>\n" : fmt::format("<ul class=\"{}\">\n", css_class);
  for (const std::string& item : items) html += fmt::format("<li>{}</li>\n", escape_markup(item));
  return html + "</ul>\n";
}

}  // namespace jnd
