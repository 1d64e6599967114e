// The parts of the report's page that are the same for every study: tables, figures, lists. Every text is escaped here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "runner/figures/figure.h"
#include "runner/results/block_output.h"

namespace jnd {

// Escaped, and kept apart from what stands around it whatever its direction of writing.
std::string user_text(std::string_view text);

// id="table-..." of a section; letters, digits and '-' of the table's id.
std::string table_anchor(const ResultTable& table);
std::string table_html(const ResultTable& table);

std::string figure_anchor(const Figure& figure);
std::string figure_html(const Figure& figure, int number);

// <ul>; empty where there are no items.
std::string list_html(const std::vector<std::string>& items, std::string_view css_class = {});

}  // namespace jnd
