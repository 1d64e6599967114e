// What `jnd calc compare` and `jnd calc wilcoxon` answer, for machines and for people.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/group/compare.h"
#include "analysis/group/compare_groups.h"
#include "analysis/group/signed_rank.h"
#include "runner/calc/calc_group_input.h"

namespace jnd {

struct NamedComparison {
  std::vector<std::string> conditions;  // comparison.k names
  Comparison comparison;
};

nlohmann::ordered_json comparison_json(const NamedComparison& named);
std::string comparison_text(const NamedComparison& named);

// The comparison of groups of participants, with conditions within them or without.
nlohmann::ordered_json groups_json(const GroupedLongTable& table, const GroupComparison& found);
// Computes and prints it.
void print_groups(const GroupedLongTable& table, bool json);

struct WilcoxonRow {
  std::string item;  // empty where the file has no items
  SignedRank test;
  PrattSignedRank pratt;
  double p_holm = 0, p_bh = 0;  // over the items; NaN where test.p is
};

nlohmann::ordered_json wilcoxon_json(const WilcoxonRow& row);
std::string wilcoxon_text(const std::vector<WilcoxonRow>& rows);

std::string statistic_text(double value);  // four digits; "-" where undefined

}  // namespace jnd
