// The hierarchical model with one thing more in it: each variant is that model of the answers it needs.
#include "analysis/hierarchical/model_variants.h"

#include <algorithm>
#include <stdexcept>

#include "tests/analysis/hierarchical/hierarchical_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using testing::published_study;

// Five people; half of every cell's answers come in the second half, with more "different" among them.
std::vector<HierarchicalCell> drifting_study() {
  std::vector<HierarchicalCell> cells;
  for (const HierarchicalCell& cell : published_study(5, 3)) {
    HierarchicalCell first = cell, second = cell;
    const double trials = cell.positive + cell.negative, more = std::min(cell.positive, trials / 2);
    second.second_half = true;
    second.positive = more;
    second.negative = trials / 2 - more;
    first.positive = cell.positive - more;
    first.negative = trials / 2 - first.positive;
    cells.push_back(first);
    cells.push_back(second);
  }
  return cells;
}

const ModelVariant& variant_of(const std::vector<ModelVariant>& variants, VariantKind kind) {
  const auto found =
      std::find_if(variants.begin(), variants.end(), [kind](const ModelVariant& one) { return one.kind == kind; });
  if (found == variants.end()) throw std::runtime_error("no such variant");
  return *found;
}

void check_equal(const ModelVariant& found, const std::vector<HierarchicalCell>& cells, const SharedForm& estimated) {
  HierarchicalModel model;
  model.estimated = estimated;
  HierarchicalAnalysis analysis(cells, model);
  const std::vector<SharedEstimate> shared = analysis.shared_estimates();
  REQUIRE(found.shared.size() == shared.size());
  for (std::size_t i = 0; i < shared.size(); ++i) {
    CHECK(found.shared[i].parameter == shared[i].parameter);
    CHECK(found.shared[i].status == shared[i].status);
    CHECK(found.shared[i].value == Approx(shared[i].value).margin(1e-9));
    CHECK(found.shared[i].p == Approx(shared[i].p).margin(1e-9));
  }
  REQUIRE(found.conditions.size() == 3);
  const HierarchicalFit& fit = analysis.add_intervals();
  for (std::size_t c = 0; c < 3; ++c) CHECK(found.conditions[c].ends.high == Approx(fit.conditions[c].ends.high));
}

TEST_CASE("every variant is a model of its own", "[analysis][hierarchical][long]") {
  const std::vector<HierarchicalCell> halves = drifting_study();
  const std::vector<HierarchicalCell> plain = without_halves_and_sureness(halves);
  CHECK(std::none_of(plain.begin(), plain.end(), [](const HierarchicalCell& cell) { return cell.second_half; }));
  const std::vector<ModelVariant> variants = model_variants(halves, {});
  REQUIRE(variants.size() == 3);
  const SharedForm none;
  check_equal(variant_of(variants, VariantKind::overdispersion), plain, none.with(SharedParameter::overdispersion));
  check_equal(variant_of(variants, VariantKind::drift), halves,
              none.with(SharedParameter::drift_ln_s).with(SharedParameter::drift_criterion));
  CHECK(variant_of(variants, VariantKind::drift).shared[1].p < 0.001);
  CHECK(variant_of(variants, VariantKind::lapse).shared[0].parameter == SharedParameter::lapse);
}

TEST_CASE("what these answers cannot tell, or the model has no place for, is left out or says so",
          "[analysis][hierarchical]") {
  std::vector<HierarchicalCell> cells = published_study(4, 1);
  std::erase_if(cells, [](const HierarchicalCell& cell) { return cell.level == 200 || cell.level == 300; });
  for (HierarchicalCell& cell : cells) {  // of a PSE that is taken as known, every answer counts half
    cell.positive /= 2;
    cell.negative /= 2;
  }
  HierarchicalModel model;
  model.tw = false;
  cells.front().positive += 0.5;
  const std::vector<ModelVariant> variants = model_variants(cells, model);
  REQUIRE(variants.size() == 2);  // no over-dispersion
  for (const ModelVariant& one : variants) {
    REQUIRE(one.shared.size() == 1);
    CHECK(one.shared[0].status == SharedStatus::not_identified);
    CHECK(one.conditions.empty());
  }
  CHECK(variants[0].shared[0].parameter == SharedParameter::drift_ln_s);
  CHECK(variants[1].shared[0].parameter == SharedParameter::lapse);
  for (HierarchicalCell& cell : cells) cell.sure_positive = cell.positive / 2;
  const std::vector<ModelVariant> graded = model_variants(cells, model);
  REQUIRE(graded.size() == 3);
  CHECK(graded[2].kind == VariantKind::sureness);
  CHECK(graded[2].shared[0].status == SharedStatus::not_identified);  // nobody was sure of "same"
  CHECK(graded[2].shared[1].status == SharedStatus::ok);
}

}  // namespace
}  // namespace jnd
