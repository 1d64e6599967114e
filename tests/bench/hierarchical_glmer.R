# glmer of lme4 on a study of 18 participants, 3 conditions and 36 trials a cell: seconds a fit, random intercepts (which
# equals our tw alone) and, with Laplace's approximation only, random slopes by condition.
library(lme4)
set.seed(1)
cells <- expand.grid(level = c(0, 200, 300, 400), condition = factor(1:3), person = factor(1:18))
cells$n <- ifelse(cells$level == 0, 18, 6)
jnd <- c(208.5, 283.5, 351)[cells$condition] * exp(rnorm(18, 0, .3))[cells$person] * exp(rnorm(54, 0, .15))[
  as.integer(interaction(cells$person, cells$condition))]
k <- .75 + rnorm(18, 0, .3)[cells$person]
cells$y <- rbinom(nrow(cells), cells$n, pnorm(cells$level / jnd - k))
fit <- function(formula, nodes) system.time(glmer(formula, cells, binomial("probit"), nAGQ = nodes))[["elapsed"]]
cells$x <- cells$level / 100
cat(sprintf("random intercepts, 25 nodes: %.2f s a fit\n",
            fit(cbind(y, n - y) ~ 0 + condition + condition:x + (1 | person), 25)))
cat(sprintf("random intercepts and slopes, Laplace: %.2f s a fit\n",
            fit(cbind(y, n - y) ~ 0 + condition + condition:x + (1 + x | person), 1)))
