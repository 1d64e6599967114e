#include "data/methods/references.h"

#include <array>

#include <fmt/format.h>

namespace jnd {

namespace {

constexpr std::array kReferences = {
    Reference{
        "Benjamini and Hochberg 1995",
        "Benjamini Y., Hochberg Y. (1995). Controlling the false discovery rate: a practical and powerful approach "
        "to multiple testing. Journal of the Royal Statistical Society: Series B 57(1), 289-300. "
        "https://doi.org/10.1111/j.2517-6161.1995.tb02031.x"},
    Reference{
        "Clopper and Pearson 1934",
        "Clopper C. J., Pearson E. S. (1934). The use of confidence or fiducial limits illustrated in the case of "
        "the binomial. Biometrika 26(4), 404-413. https://doi.org/10.1093/biomet/26.4.404"},
    Reference{"Conover 1999", "Conover W. J. (1999). Practical Nonparametric Statistics, 3rd ed. Wiley, New York."},
    Reference{"Cousineau 2005",
              "Cousineau D. (2005). Confidence intervals in within-subject designs: A simpler solution to Loftus and "
              "Masson's method. Tutorials in Quantitative Methods for Psychology 1(1), 42-45. "
              "https://doi.org/10.20982/tqmp.01.1.p042"},
    Reference{"Efron and Tibshirani 1993",
              "Efron B., Tibshirani R. J. (1993). An Introduction to the Bootstrap. Chapman and Hall, New York."},
    Reference{"Ennis 1993",
              "Ennis D. M. (1993). The power of sensory discrimination methods. Journal of Sensory Studies 8(4), "
              "353-370."},
    Reference{"Friedman 1937",
              "Friedman M. (1937). The use of ranks to avoid the assumption of normality implicit in the analysis of "
              "variance. Journal of the American Statistical Association 32(200), 675-701. "
              "https://doi.org/10.1080/01621459.1937.10503522"},
    Reference{"Games and Howell 1976",
              "Games P. A., Howell J. F. (1976). Pairwise multiple comparison procedures with unequal n's and/or "
              "variances: A Monte Carlo study. Journal of Educational Statistics 1(2), 113-125. "
              "https://doi.org/10.3102/10769986001002113"},
    Reference{"Gescheider 1997",
              "Gescheider G. A. (1997). Psychophysics: The Fundamentals, 3rd ed. Lawrence Erlbaum Associates, Mahwah, "
              "NJ."},
    Reference{"Gourevitch and Galanter 1967",
              "Gourevitch V., Galanter E. (1967). A significance test for one parameter isosensitivity functions. "
              "Psychometrika 32(1), 25-33. https://doi.org/10.1007/BF02289402"},
    Reference{"Greenhouse and Geisser 1959",
              "Greenhouse S. W., Geisser S. (1959). On methods in the analysis of profile data. Psychometrika 24(2), "
              "95-112. https://doi.org/10.1007/BF02289823"},
    Reference{"Hautus 1995",
              "Hautus M. J. (1995). Corrections for extreme proportions and their biasing effects on estimated values "
              "of d'. Behavior Research Methods, Instruments, & Computers 27(1), 46-51. "
              "https://doi.org/10.3758/BF03203619"},
    Reference{"Holm 1979",
              "Holm S. (1979). A simple sequentially rejective multiple test procedure. Scandinavian Journal of "
              "Statistics 6(2), 65-70."},
    Reference{
        "Kaernbach 1991",
        "Kaernbach C. (1991). Simple adaptive testing with the weighted up-down method. Perception & Psychophysics "
        "49(3), 227-229. https://doi.org/10.3758/BF03214307"},
    Reference{"Kerby 2014",
              "Kerby D. S. (2014). The simple difference formula: An approach to teaching nonparametric correlation. "
              "Comprehensive Psychology 3, 11.IT.3.1. https://doi.org/10.2466/11.IT.3.1"},
    Reference{"Kesten 1958",
              "Kesten H. (1958). Accelerated stochastic approximation. Annals of Mathematical Statistics 29(1), 41-59. "
              "https://doi.org/10.1214/aoms/1177706705"},
    Reference{"King-Smith et al. 1994",
              "King-Smith P. E., Grigsby S. S., Vingrys A. J., Benes S. C., Supowit A. (1994). Efficient and unbiased "
              "modifications of the QUEST threshold method: Theory, simulations, experimental evaluation and practical "
              "implementation. Vision Research 34(7), 885-912. https://doi.org/10.1016/0042-6989(94)90039-6"},
    Reference{"Kontsevich and Tyler 1999",
              "Kontsevich L. L., Tyler C. W. (1999). Bayesian adaptive estimation of psychometric slope and threshold. "
              "Vision Research 39(16), 2729-2737. https://doi.org/10.1016/S0042-6989(98)00285-5"},
    Reference{"Levitt 1971",
              "Levitt H. (1971). Transformed up-down methods in psychoacoustics. Journal of the Acoustical Society of "
              "America 49(2B), 467-477. https://doi.org/10.1121/1.1912375"},
    Reference{"Macmillan and Creelman 2005",
              "Macmillan N. A., Creelman C. D. (2005). Detection Theory: A User's Guide, 2nd ed. Lawrence Erlbaum "
              "Associates, Mahwah, NJ."},
    Reference{"Macmillan and Kaplan 1985",
              "Macmillan N. A., Kaplan H. L. (1985). Detection theory analysis of group data: Estimating sensitivity "
              "from average hit and false-alarm rates. Psychological Bulletin 98(1), 185-199. "
              "https://doi.org/10.1037/0033-2909.98.1.185"},
    Reference{"Mann and Whitney 1947",
              "Mann H. B., Whitney D. R. (1947). On a test of whether one of two random variables is stochastically "
              "larger than the other. Annals of Mathematical Statistics 18(1), 50-60. "
              "https://doi.org/10.1214/aoms/1177730491"},
    Reference{"Mauchly 1940",
              "Mauchly J. W. (1940). Significance test for sphericity of a normal n-variate distribution. Annals of "
              "Mathematical Statistics 11(2), 204-209. https://doi.org/10.1214/aoms/1177731915"},
    Reference{"Maxwell and Delaney 2004",
              "Maxwell S. E., Delaney H. D. (2004). Designing Experiments and Analyzing Data: A Model Comparison "
              "Perspective, 2nd ed. Lawrence Erlbaum Associates, Mahwah, NJ."},
    Reference{"McCullagh 1980",
              "McCullagh P. (1980). Regression models for ordinal data. Journal of the Royal Statistical Society: "
              "Series B 42(2), 109-142. https://doi.org/10.1111/j.2517-6161.1980.tb01109.x"},
    Reference{"Morey 2008",
              "Morey R. D. (2008). Confidence intervals from normalized data: A correction to Cousineau (2005). "
              "Tutorials in Quantitative Methods for Psychology 4(2), 61-64. https://doi.org/10.20982/tqmp.04.2.p061"},
    Reference{
        "Moscatelli et al. 2012",
        "Moscatelli A., Mezzetti M., Lacquaniti F. (2012). Modeling psychophysical data at the population-level: The "
        "generalized linear mixed model. Journal of Vision 12(11), 26. https://doi.org/10.1167/12.11.26"},
    Reference{"Pinheiro and Bates 2000",
              "Pinheiro J. C., Bates D. M. (2000). Mixed-Effects Models in S and S-PLUS. Springer, New York."},
    Reference{"Royston 1995",
              "Royston P. (1995). Remark AS R94: A remark on Algorithm AS 181: The W-test for normality. Applied "
              "Statistics 44(4), 547-551. https://doi.org/10.2307/2986146"},
    Reference{"Salmon et al. 2011",
              "Salmon J. K., Moraes M. A., Dror R. O., Shaw D. E. (2011). Parallel random numbers: as easy as 1, 2, 3. "
              "Proceedings of SC '11: International Conference for High Performance Computing, Networking, Storage and "
              "Analysis, article 16. https://doi.org/10.1145/2063384.2063405"},
    Reference{"Venzon and Moolgavkar 1988",
              "Venzon D. J., Moolgavkar S. H. (1988). A method for computing profile-likelihood-based confidence "
              "intervals. Applied Statistics 37(1), 87-94. https://doi.org/10.2307/2347496"},
    Reference{"Watson and Pelli 1983",
              "Watson A. B., Pelli D. G. (1983). QUEST: A Bayesian adaptive psychometric method. Perception & "
              "Psychophysics 33(2), 113-120. https://doi.org/10.3758/BF03202828"},
    Reference{
        "Welch 1947",
        "Welch B. L. (1947). The generalization of 'Student's' problem when several different population variances "
        "are involved. Biometrika 34(1-2), 28-35. https://doi.org/10.1093/biomet/34.1-2.28"},
    Reference{"Wilcoxon 1945",
              "Wilcoxon F. (1945). Individual comparisons by ranking methods. Biometrics Bulletin 1(6), 80-83. "
              "https://doi.org/10.2307/3001968"},
    Reference{"Zahl 1977",
              "Zahl S. (1977). Jackknifing an index of diversity. Ecology 58(4), 907-913. "
              "https://doi.org/10.2307/1936227"}};

}  // namespace

std::span<const Reference> all_references() noexcept {
  return kReferences;
}

std::string references_of(std::string_view text) {
  std::string list;
  for (const Reference& reference : kReferences)
    if (text.find(reference.cited) != std::string_view::npos) list += fmt::format("- {}\n", reference.full);
  return list.empty() ? "" : "\n## References\n\n" + list;
}

}  // namespace jnd
