#include "analysis/ratings/identification.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "analysis/ratings/ordinal_probit.h"

namespace jnd {

namespace {

constexpr auto kIdentificationStatusWords =
    words<IdentificationStatus>({{"ok", IdentificationStatus::ok},
                                 {"separated", IdentificationStatus::separated},
                                 {"single_class", IdentificationStatus::single_class},
                                 {"no_information", IdentificationStatus::no_information},
                                 {"missing", IdentificationStatus::missing}});

double row_total(const std::vector<double>& row) {
  double sum = 0;
  for (const double n : row) sum += n;
  return sum;
}

// ---- information

struct Margins {
  std::vector<double> stimuli, responses;
  double trials = 0;
};

Margins margins_of(const CategoryCounts& counts) {
  Margins out;
  out.responses.assign(counts.empty() ? 0 : counts.front().size(), 0);
  for (const std::vector<double>& row : counts) {
    out.stimuli.push_back(row_total(row));
    out.trials += out.stimuli.back();
    for (std::size_t j = 0; j < row.size(); ++j) out.responses[j] += row[j];
  }
  return out;
}

double entropy_bits(const std::vector<double>& counts, double trials) {
  double sum = 0;
  for (const double n : counts)
    if (n > 0) sum -= n / trials * std::log2(n / trials);
  return std::fmax(0, sum);
}

double occupied(const std::vector<double>& counts) {
  return static_cast<double>(std::count_if(counts.begin(), counts.end(), [](double n) { return n > 0; }));
}

// By how much x log2 x grows from x - 1 to x.
double growth(double x) {
  return x > 1 ? x * std::log2(x) - (x - 1) * std::log2(x - 1) : 0;
}

void set_information(Identification& out, const CategoryCounts& counts, const Margins& margins) {
  const double trials = margins.trials;
  double bits = 0, jackknife = 0, correct = 0, cells = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    correct += counts[i][i];
    cells += occupied(counts[i]);
    for (std::size_t j = 0; j < counts[i].size(); ++j) {
      const double n = counts[i][j];
      if (n == 0) continue;
      bits += n / trials * std::log2(n * trials / (margins.stimuli[i] * margins.responses[j]));
      jackknife +=
          n / trials * (growth(n) + growth(trials) - growth(margins.stimuli[i]) - growth(margins.responses[j]));
    }
  }
  const double rows = occupied(margins.stimuli), columns = occupied(margins.responses);
  const double unit = 1 / (2 * trials * std::numbers::ln2);
  out.information_bits = bits;
  out.stimulus_entropy_bits = entropy_bits(margins.stimuli, trials);
  out.response_entropy_bits = entropy_bits(margins.responses, trials);
  out.jackknife_bits = jackknife;
  out.miller_madow_bits = bits + (rows + columns - cells - 1) * unit;
  out.table_corrected_bits = bits - (rows - 1) * (columns - 1) * unit;
  out.relative = rows > 1 ? bits / out.stimulus_entropy_bits : kNaN;
  out.equivalent_classes = std::exp2(bits);
  out.proportion_correct = correct / trials;
}

// ---- d' between neighbours

double z_above(const std::vector<double>& row, std::size_t i) {
  double above = 0, total = 0;
  for (std::size_t j = 0; j < row.size(); ++j) {
    total += row[j];
    if (j > i) above += row[j];
  }
  return total > 0 ? normal_quantile((above + 0.5) / (total + 1)) : kNaN;
}

// Stimuli whose responses overlap so far that all d' among them are finite.
struct Block {
  std::vector<std::size_t> rows;   // of the whole table, in its order
  std::vector<double> criteria;    // of the responses given in the block
  std::vector<double> mu;          // one a row, the first 0
  std::vector<double> covariance;  // of mu, by rows
  double log_likelihood = 0;
};

// The category at which the rows fall apart: those that use only lower ones and it, and those that use only it and
// higher ones, neither of them empty. A d' between the two has no bound.
struct Split {
  std::vector<std::size_t> lower, upper;  // places in the list of rows
};

std::optional<Split> split_of(const CategoryCounts& counts) {
  const std::size_t categories = counts.front().size();
  for (std::size_t at = 0; at < categories; ++at) {
    Split split;
    bool all = true;
    for (std::size_t i = 0; i < counts.size() && all; ++i) {
      bool uses_lower = false, uses_higher = false;
      for (std::size_t j = 0; j < categories; ++j) {
        uses_lower = uses_lower || (j < at && counts[i][j] > 0);
        uses_higher = uses_higher || (j > at && counts[i][j] > 0);
      }
      all = !(uses_lower && uses_higher);
      // A row that gives this response alone lies above those with lower ones, and below those with higher ones.
      const bool to_upper = uses_higher || (!uses_lower && at + 1 == categories);
      (to_upper ? split.upper : split.lower).push_back(i);
    }
    if (all && !split.lower.empty() && !split.upper.empty()) return split;
  }
  return std::nullopt;
}

Block fitted_block(const CategoryCounts& counts, std::vector<std::size_t> rows) {
  const std::size_t n = rows.size();
  Block block;
  block.rows = std::move(rows);
  block.mu.assign(n, 0);
  block.covariance.assign(n * n, 0);
  if (counts.front().size() < 2) return block;  // one response: certain
  std::vector<std::vector<double>> design(n, std::vector<double>(n - 1, 0));
  for (std::size_t i = 1; i < n; ++i) design[i][i - 1] = 1;
  const OrdinalProbit model(counts, design);
  const OrdinalFit fit = fit_ordinal(model, model.box(), model.start());
  const std::size_t first = model.criteria();
  block.log_likelihood = fit.log_likelihood;
  block.criteria.assign(fit.place.begin(), fit.place.begin() + static_cast<std::ptrdiff_t>(first));
  for (std::size_t i = 1; i < n; ++i) {
    block.mu[i] = fit.place[first + i - 1];
    for (std::size_t j = 1; j < n; ++j)
      block.covariance[i * n + j] = fit.covariance[(first + i - 1) * fit.place.size() + first + j - 1];
  }
  return block;
}

// Appends the blocks of the rows from low to high.
void add_blocks(const CategoryCounts& counts, const std::vector<std::size_t>& rows, std::vector<Block>& blocks) {
  CategoryCounts own;
  own.reserve(rows.size());
  for (const std::size_t row : rows) own.push_back(counts[row]);
  own = used_categories(own).counts;
  const std::optional<Split> split = split_of(own);
  if (!split) {
    blocks.push_back(fitted_block(own, rows));
    return;
  }
  for (const std::vector<std::size_t>& part : {split->lower, split->upper}) {
    std::vector<std::size_t> places;
    places.reserve(part.size());
    for (const std::size_t i : part) places.push_back(rows[i]);
    add_blocks(counts, places, blocks);
  }
}

// Where a row stands: its block, and its place in there.
struct BlockPlace {
  std::size_t block, place;
};

AdjacentDprime difference_of(const std::vector<Block>& blocks, const BlockPlace& from, const BlockPlace& to) {
  if (from.block != to.block) return {to.block > from.block ? kInf : -kInf, kNaN};
  const Block& block = blocks[from.block];
  const std::size_t n = block.mu.size(), i = from.place, j = to.place;
  const double variance = block.covariance[i * n + i] + block.covariance[j * n + j] - 2 * block.covariance[i * n + j];
  return {block.mu[j] - block.mu[i], std::sqrt(variance)};
}

IdentificationScale undefined_scale(IdentificationStatus status, std::size_t classes) {
  IdentificationScale out;
  out.status = status;
  out.log_likelihood = out.total_dprime = kNaN;
  if (classes > 1) out.adjacent.assign(classes - 1, {kNaN, kNaN});
  return out;
}

IdentificationScale scale_of(const CategoryCounts& counts, const Margins& margins) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (margins.stimuli[i] > 0) rows.push_back(i);
  std::vector<int> used;
  for (const int category : used_categories(counts).used) used.push_back(category + 1);
  const bool one_response = used.size() < 2;
  IdentificationScale out = undefined_scale(rows.empty()      ? IdentificationStatus::missing
                                            : one_response    ? IdentificationStatus::no_information
                                            : rows.size() < 2 ? IdentificationStatus::single_class
                                                              : IdentificationStatus::ok,
                                            counts.size());
  out.categories_used = used;
  if (out.status != IdentificationStatus::ok) return out;

  std::vector<Block> blocks;
  add_blocks(counts, rows, blocks);
  std::vector<BlockPlace> places(counts.size(), {blocks.size(), 0});
  out.log_likelihood = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    out.log_likelihood += blocks[b].log_likelihood;
    for (std::size_t k = 0; k < blocks[b].rows.size(); ++k) places[blocks[b].rows[k]] = {b, k};
  }
  for (std::size_t i = 0; i + 1 < counts.size(); ++i)
    if (margins.stimuli[i] > 0 && margins.stimuli[i + 1] > 0)
      out.adjacent[i] = difference_of(blocks, places[i], places[i + 1]);
  out.total_dprime = difference_of(blocks, places[rows.front()], places[rows.back()]).dprime;
  if (blocks.size() > 1) {
    out.status = IdentificationStatus::separated;
    return out;
  }
  out.criteria = blocks.front().criteria;
  out.mu.assign(counts.size(), kNaN);
  for (const std::size_t row : rows) out.mu[row] = blocks.front().mu[places[row].place];
  return out;
}

}  // namespace

std::string_view to_string(IdentificationStatus status) noexcept {
  return word_of(kIdentificationStatusWords, status);
}

Identification identification(const std::vector<std::vector<int>>& confusion) {
  CategoryCounts counts;
  counts.reserve(confusion.size());
  for (const std::vector<int>& row : confusion) counts.emplace_back(row.begin(), row.end());
  const Margins margins = margins_of(counts);
  Identification out;
  out.trials = static_cast<std::int64_t>(margins.trials);
  for (std::size_t i = 0; i + 1 < counts.size(); ++i)
    out.adjacent_loglinear.push_back(z_above(counts[i + 1], i) - z_above(counts[i], i));
  out.ml = scale_of(counts, margins);
  if (margins.trials > 0) {
    set_information(out, counts, margins);
    return out;
  }
  out.information_bits = out.stimulus_entropy_bits = out.response_entropy_bits = kNaN;
  out.jackknife_bits = out.miller_madow_bits = out.table_corrected_bits = out.relative = kNaN;
  out.equivalent_classes = out.proportion_correct = kNaN;
  return out;
}

}  // namespace jnd
