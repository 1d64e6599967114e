// Reference numbers of the group statistics, recomputed.
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "analysis/group/compare.h"
#include "analysis/group/p_adjust.h"
#include "analysis/group/shapiro_wilk.h"
#include "analysis/numerics/studentised_range.h"
#include "analysis/selftest/selftest.h"

namespace jnd {
namespace {

// R 4.2.2 with car, afex and exactRankTests; 15 digits. t and Wilcoxon by pairs (0,1), (0,2), (1,2).
struct PairReference {
  double t, p, p_holm, gh_q, gh_df, gh_p, tukey_q, tukey_p, v, wilcoxon_p, permutation_p, rank_biserial;
};
struct Dataset {
  WithinTable table;
  std::array<double, 3> ci, ci_within, shapiro_w, shapiro_p;
  double mauchly_w, mauchly_p, epsilon_gg, epsilon_hf, f, p, p_gg, p_hf, eta2_generalised, eta2_partial;
  double chi2, friedman_p, kendall_w;
  std::array<PairReference, 3> pairs;
};
std::vector<Dataset> datasets() {
  return {
      {{18, 3, {253.711, 388.989, 212.1,   310.211, 322.989, 175.6,   284.511, 469.989, 288.6,   330.411, 275.489,
                259,     256.511, 274.289, 204.1,   315.211, 352.889, 193.1,   274.511, 379.489, 168.2,   253.411,
                414.189, 230.8,   431.711, 387.389, 211.7,   283.711, 278.889, 166.9,   240.011, 365.389, 179.8,
                234.711, 311.289, 209.9,   260.011, 409.589, 215.9,   298.911, 382.889, 262.2,   268.711, 283.589,
                181.6,   269.011, 349.089, 208.3,   264.811, 314.989, 216.8,   272.911, 356.589, 168.4}},
       {22.3828996471104, 27.3480263111733, 17.203325833116},
       {22.7194750246401, 22.3359505917291, 15.7813472107678},
       {0.785501134606976, 0.952074972713073, 0.91322337848086},
       {0.000954693812333434, 0.458490385540407, 0.0980765772290705},
       0.83219580281425,
       0.23004042895879,
       0.856307934506037,
       0.942839055891325,
       53.6776003517368,
       3.01884721005287e-11,
       6.2303789523293e-10,
       1.00561987940511e-10,
       0.632686271785369,
       0.759471177354676,
       28.7777777777778,
       5.63618130195002e-07,
       0.799382716049383,
       {{{-4.13287902397898, 0.000695477663662006, 0.000695477663662006, 5.69900899807696, 32.7209762792358,
          0.000890268712099185, 6.93771007580974, 6.62697271138768e-05, 15, 0.00104522705078125, 0.00104522705078125,
          -0.824561403508772},
         {6.03398586624897, 1.3411803956475e-05, 2.68236079129501e-05, 7.9269287016802, 31.8891446669536,
          1.0126159567081e-05, 7.70852995292444, 1.30852832100903e-05, 170, 1.52587890625e-05, 1.52587890625e-05,
          0.988304093567251},
         {11.7640016803879, 1.3627035091484e-09, 4.0881105274452e-09, 13.1598731460463, 28.6325470085835,
          1.10452502699587e-09, 14.6462400287342, 1.40829570227652e-11, 171, 7.62939453125e-06, 7.62939453125e-06,
          1}}}},
      {{12, 3, {7, 4, 8, 6, 3, 7, 8, 5, 8, 5, 4, 9, 7, 2, 7, 6, 3, 6,
                8, 4, 9, 7, 5, 8, 6, 6, 7, 5, 3, 8, 9, 2, 7, 7, 4, 7}},
       {0.772248069726115, 0.772248069726115, 0.57204660778351},
       {0.80393979606002, 0.706768098412173, 0.556692909996314},
       {0.939760017726028, 0.939760017726028, 0.894159245147789},
       {0.494969275165735, 0.494969275165735, 0.133337429162727},
       0.838923804816308,
       0.41553976448652,
       0.861269918501399,
       1.00622787465583,
       40.5798319327731,
       4.14992632878387e-08,
       2.98350838132516e-07,
       4.14992632878387e-08,
       0.701978812712373,
       0.78673835125448,
       20.4186046511628,
       3.6826151537013e-05,
       0.85077519379845,
       {{{5.74456264653803, 0.00012940169548044, 0.00025880339096088, 8.5503036383331, 22, 1.26732390567375e-05,
          9.47885749949847, 2.83750526552939e-06, 66, 0.00349965872290109, 0.0009765625, 1},
         {-1.88982236504614, 0.0854080266350328, 0.0854080266350328, 2.69903097646554, 20.2782067348506,
          0.161885770220657, 2.63301597208291, 0.173510841169121, 6, 0.0986765639348862, 0.1328125, -0.666666666666667},
         {-10.4781893870167, 4.62665411486174e-07, 1.38799623445852e-06, 12.4155424917415, 20.2782067348506,
          7.0254347006582e-08, 12.1118734715814, 5.48446289494464e-08, 0, 0.00223672061991041, 0.00048828125, -1}}}},
  };
}

// Exact, cross-checked by a second implementation (R's own ptukey is off by up to 1e-4 at df <= 3).
struct RangeReference {
  double given;
  int groups;
  double df, expected;
};
constexpr RangeReference kUpper[] = {
    {0.5, 2, 2, 0.7574643749636671},         {1, 3, 2, 0.7841819907145233},
    {2, 4, 2, 0.5954471733719117},           {2.67, 6, 2, 0.5652601621950366},
    {3.5, 10, 2, 0.5259536813988557},        {4.5, 2, 3, 0.05001788485429324},
    {6, 3, 3, 0.048068071872843045},         {9, 4, 3, 0.023541651067802226},
    {0.5, 10, 3, 0.9999774645208553},        {1, 2, 4.7, 0.513000544176383},
    {2, 3, 4.7, 0.4061124831065321},         {2.67, 4, 4.7, 0.34374888092696315},
    {3.5, 6, 4.7, 0.28959089144044414},      {4.5, 10, 4.7, 0.2381357680252531},
    {6, 2, 10, 0.0017092715671330047},       {9, 3, 10, 0.00021946634713706682},
    {0.5, 6, 10, 0.9990264248119125},        {1, 10, 10, 0.9986991838534316},
    {2, 2, 17, 0.17535252615524402},         {2.67, 3, 17, 0.17248369847415315},
    {3.5, 4, 17, 0.10035225382236264},       {4.5, 6, 17, 0.05164476967357907},
    {6, 10, 17, 0.014613142324932677},       {9, 2, 29.31, 5.622328823392898e-07},
    {0.5, 4, 29.31, 0.9845381042378093},     {1, 6, 29.31, 0.979589989258789},
    {2, 10, 29.31, 0.9129359181164504},      {2.67, 2, 34, 0.0675876868466273},
    {3.5, 3, 34, 0.04734735575032025},       {4.5, 4, 34, 0.015722706293418355},
    {6, 6, 34, 0.002058270404642848},        {9, 10, 34, 1.1866484621097949e-05},
    {0.5, 3, 120, 0.9334591035087091},       {1, 4, 120, 0.8941077329243302},
    {2, 6, 120, 0.7183843830783363},         {2.67, 10, 120, 0.6770618886660416},
    {3.5, 2, 1000000, 0.013328493290753354}, {4.5, 3, 1000000, 0.00417623474410986},
    {6, 4, 1000000, 0.00012982870352179113}, {9, 6, 1000000, 2.948414075224973e-09},
};
constexpr RangeReference kQuantile[] = {
    {0.9, 2, 4.7, 2.890385366669973}, {0.9, 5, 4.7, 4.755237811539466}, {0.9, 3, 17, 3.110167537385554},
    {0.9, 2, 34, 2.3913280146310125}, {0.9, 5, 34, 3.6274330879015153}, {0.9, 3, 100, 2.936068680065438},
};

// R 4.2.2: shapiro.test.
struct ShapiroReference {
  std::vector<double> x;
  double w, p;
};
std::vector<ShapiroReference> shapiro_references() {
  return {
      {{-9.62, -2.93, 2.59}, 0.99694865066564, 0.894447516854922},
      {{-15.29, 0.08, 0, 0.01}, 0.634079746492651, 0.00145743484456293},
      {{11.17, -12.19, 12.67, -7.45, -11.31}, 0.793386035553009, 0.0714976504217834},
      {{-7.16, 2.53, 1.52, -3.08, -9.53, -6.48, 12.24}, 0.919825364695952, 0.468036653138808},
  };
}

// R 4.2.2: p.adjust, n = 17.
constexpr std::array<double, 8> kP = {0.05, 0.013, 0.012, 0.003, 0.016, 0.01, 0.015, 0.005};
constexpr std::array<double, 8> kHolm = {0.5, 0.169, 0.168, 0.051, 0.18, 0.15, 0.18, 0.08};
constexpr std::array<double, 8> kBenjaminiHochberg = {0.10625,
                                                      0.0388571428571429,
                                                      0.0388571428571429,
                                                      0.0388571428571429,
                                                      0.0388571428571429,
                                                      0.0388571428571429,
                                                      0.0388571428571429,
                                                      0.0388571428571429};

// All quantities of this part, in the order in which they are printed.
struct Quantities {
  SelftestQuantity intervals{"t and Cousineau-Morey intervals (relative)", 0, 0, 1e-9};
  SelftestQuantity shapiro_w{"Shapiro-Wilk W", 0, 0, 1e-8}, shapiro_p{"Shapiro-Wilk p", 0, 0, 1e-6};
  SelftestQuantity sphericity{"Mauchly W, epsilons (relative)", 0, 0, 1e-9};
  SelftestQuantity anova{"F, eta squared, t, chi squared (relative)", 0, 0, 1e-9};
  SelftestQuantity p{"p of F, t, chi squared, Mauchly", 0, 0, 1e-9};
  SelftestQuantity range_p{"p of the studentised range", 0, 0, 1e-6};
  SelftestQuantity range_q{"quantile of the studentised range", 0, 0, 1e-4};
  SelftestQuantity wilcoxon{"Wilcoxon V, rank-biserial (relative)", 0, 0, 1e-9};
  SelftestQuantity wilcoxon_p{"Wilcoxon p", 0, 0, 1e-12};
  SelftestQuantity adjusted{"Holm, Benjamini-Hochberg", 0, 0, 1e-12};
};

void add_pair(const PairComparison& pair, const PairReference& reference, Quantities& q) {
  q.anova.relative(pair.t.t, reference.t);
  q.p.absolute(pair.t.p, reference.p);
  q.adjusted.absolute(pair.t_p_holm, reference.p_holm);
  q.anova.relative(pair.games_howell.q, reference.gh_q);
  q.anova.relative(pair.games_howell.df, reference.gh_df);
  q.range_p.absolute(pair.games_howell.p, reference.gh_p);
  q.anova.relative(pair.tukey.q, reference.tukey_q);
  q.range_p.absolute(pair.tukey.p, reference.tukey_p);
  q.wilcoxon.relative(pair.wilcoxon.v, reference.v);
  q.wilcoxon.relative(pair.wilcoxon.rank_biserial, reference.rank_biserial);
  q.wilcoxon_p.absolute(pair.wilcoxon.p, reference.wilcoxon_p);
  q.wilcoxon_p.absolute(pair.wilcoxon.p_exact_permutation, reference.permutation_p);
}

void add_dataset(const Dataset& reference, Quantities& q) {
  const Comparison found = compare(reference.table);
  for (std::size_t j = 0; j < 3; ++j) {
    const ConditionSummary& of = found.conditions[j];
    q.intervals.relative(of.ci_high - of.mean, reference.ci[j]);
    q.intervals.relative(of.ci_within_high - of.mean, reference.ci_within[j]);
    q.shapiro_w.absolute(of.shapiro.w, reference.shapiro_w[j]);
    q.shapiro_p.absolute(of.shapiro.p, reference.shapiro_p[j]);
    add_pair(found.pairs[j], reference.pairs[j], q);
  }
  const WithinEffect& effect = found.anova.effect;
  q.sphericity.relative(effect.mauchly.w, reference.mauchly_w);
  q.sphericity.relative(effect.epsilon_gg, reference.epsilon_gg);
  q.sphericity.relative(effect.epsilon_hf, reference.epsilon_hf);
  q.anova.relative(effect.f, reference.f);
  q.anova.relative(found.anova.eta2_generalised, reference.eta2_generalised);
  q.anova.relative(effect.eta2_partial, reference.eta2_partial);
  q.anova.relative(found.friedman.chi2, reference.chi2);
  q.anova.relative(found.friedman.kendall_w, reference.kendall_w);
  q.p.absolute(effect.mauchly.p, reference.mauchly_p);
  q.p.absolute(effect.p, reference.p);
  q.p.absolute(effect.p_gg, reference.p_gg);
  q.p.absolute(effect.p_hf, reference.p_hf);
  q.p.absolute(found.friedman.p, reference.friedman_p);
}

}  // namespace

std::vector<SelftestQuantity> selftest_group() {
  Quantities q;
  for (const Dataset& dataset : datasets()) add_dataset(dataset, q);
  for (const RangeReference& one : kUpper)
    q.range_p.absolute(studentised_range_upper(one.given, one.groups, one.df), one.expected);
  for (const RangeReference& one : kQuantile)
    q.range_q.absolute(studentised_range_quantile(one.given, one.groups, one.df), one.expected);
  for (const ShapiroReference& one : shapiro_references()) {
    const ShapiroWilk found = shapiro_wilk(one.x);
    q.shapiro_w.absolute(found.w, one.w);
    q.shapiro_p.absolute(found.p, one.p);
  }
  const std::vector<double> by_holm = holm(kP, 17), by_bh = benjamini_hochberg(kP, 17);
  for (std::size_t i = 0; i < kP.size(); ++i) {
    q.adjusted.absolute(by_holm[i], kHolm[i]);
    q.adjusted.absolute(by_bh[i], kBenjaminiHochberg[i]);
  }
  return {q.intervals, q.shapiro_w, q.shapiro_p, q.sphericity, q.anova,   q.p,
          q.range_p,   q.range_q,   q.wilcoxon,  q.wilcoxon_p, q.adjusted};
}

}  // namespace jnd
