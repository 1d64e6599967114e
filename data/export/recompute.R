# Computes the results of a study again, from the CSV files of the folder that this script lies in.
#
#     Rscript --vanilla recompute.R          (or: Rscript --vanilla recompute.R FOLDER)
#     source("recompute.R")                  from a session of R whose working folder is this one
#
# Without --vanilla, R itself runs a file .Rprofile of its working folder when it starts.
#
# It needs R 3.5 or later and no package. It is meant to be read: each step from the answers to the group is a short
# function. dictionary.csv says what every column of every file means.
#
#     trials.csv, intervals.csv -> cells.csv       how often "different" was said, rates, z, d'
#     cells                     -> thresholds.csv  slope of d' on the difference, JND = 1 / slope
#     thresholds                -> group.csv       means, intervals, medians over participants
#                                  contrasts.csv   conditions against each other, with the registered test
#                                  pairs.csv, tests.csv (ratings: from answers.csv), groups.csv
#
# Each step works on what the step before it computed, not on the file. Of the tasks other than same-different, and of
# adaptive procedures, the participants' own estimates (estimates.csv, tracks.csv) are taken as they are, and everything
# from there on is computed again. So are the JNDs of maximum likelihood (thresholds.csv).
#
# What it prints: for each file how many numbers and words were compared and the largest relative difference; which
# columns it does not compute; how many rows it read of how many that were written. Rscript ends with status 1 where a
# row is missing, or a number differs by more than 1e-9 of itself; a number next to zero, such as a difference of equal
# means, may differ by 1e-14 of the largest number of its column, and a mean by 1e-14 of its spread.
#
# Bootstrap intervals of single JNDs are drawn at random, from the study's own seed, and are not computed here.

recompute <- function(folder) {
  tolerance <- 1e-9
  near_zero <- 1e-5    # a number next to zero may differ by tolerance of this share of what it comes from
  least_slope <- 1e-9  # at or below it no difference is noticeable
  rounding <- 1e-13    # a spread of less than this share of the values is none
  # What every row says of the analysis: read, not computed.
  convention <- c("difference_source", "model", "correction", "method", "protocol_sha256", "kind", "group")

  # --- Files ----------------------------------------------------------------------------------------------------------

  trouble <- function(...) stop(sprintf(...), call. = FALSE)
  # The files that the export holds, by its own list.
  sums <- file.path(folder, "SHA256SUMS")
  if (!file.exists(sums)) trouble("%s: SHA256SUMS is missing: this is no folder of jnd export", folder)
  lines <- readLines(sums, encoding = "UTF-8")
  listed <- sub("^[0-9a-f]+  ", "", grep("^#", lines, value = TRUE, invert = TRUE))
  # And how many rows those have that are tables.
  counts <- grep("^# [0-9]+ rows: ", lines, value = TRUE)
  rows_listed <- setNames(as.integer(sub("^# ([0-9]+) rows: .*", "\\1", counts)), sub("^# [0-9]+ rows: ", "", counts))
  rows_read <- integer(0)

  # All cells are read as text, so that a participant "007" or a series "T" stays what it is. NULL where the export has no
  # such file.
  read <- function(name) {
    if (!(name %in% listed)) return(NULL)
    path <- file.path(folder, name)
    if (!file.exists(path)) trouble("%s is missing: SHA256SUMS lists it", name)
    rows <- read.csv(path, colClasses = "character", check.names = FALSE, na.strings = character(0), encoding = "UTF-8")
    if (!nrow(rows)) trouble("%s has no rows: there is nothing in it to compare or to compute from", name)
    rows_read[name] <<- nrow(rows)
    rows
  }
  number <- function(text) suppressWarnings(as.numeric(text))  # an empty cell is a missing value
  # The column whose name begins so: slope_per_ is slope_per_n_per_m in one study, slope_per_s in another.
  begins <- function(table, begin) names(table)[startsWith(names(table), begin)][1]

  largest <- function(text) {
    sizes <- abs(number(text))
    max(0, sizes[is.finite(sizes)])
  }
  # Whether a column is of a mean, whose rounding is that of the values that it is taken from.
  is_of_mean <- function(column) grepl("mean|sd|ci95", column)

  results <- list()
  check <- function(name, source, said, keys, aside = character(0)) {
    results[[name]] <<- list(source = source, compared = 0, largest = 0, wrong = character(0), aside = aside,
                             keys = keys, skipped = character(0), open = setdiff(names(said), keys))
    said
  }
  # Rows of an outcome that are not computed.
  skip <- function(name, outcome) results[[name]]$skipped <<- c(results[[name]]$skipped, outcome)
  # Compares what was computed with what a file says. rows: of the file; values: a vector for each column.
  compare <- function(name, said, rows, values) {
    result <- results[[name]]
    for (column in setdiff(intersect(names(values), names(said)), result$keys)) {
      value <- values[[column]]
      text <- said[rows, column]
      if (is.character(value)) {
        difference <- ifelse(text == value, 0, Inf)
      } else {
        scale <- near_zero * largest(said[[column]])
        if (is_of_mean(column)) {
          of_mean <- Filter(is_of_mean, names(said))
          scale <- pmax(scale, near_zero * apply(said[rows, of_mean, drop = FALSE], 1, largest))
        }
        there <- number(text)
        difference <- abs(there - value) / pmax(abs(there), abs(value), scale)
        difference[(is.na(there) & is.na(value)) | (!is.na(there) & !is.na(value) & there == value)] <- 0
        difference[is.na(difference)] <- Inf
      }
      result$compared <- result$compared + length(rows)
      result$largest <- max(result$largest, difference)
      result$open <- setdiff(result$open, column)
      for (i in which(difference > tolerance))
        result$wrong <- c(result$wrong, sprintf("%s: the file says %s, computed %s", column,
                                                if (text[i] == "") "nothing" else text[i],
                                                format(value[i], digits = 17)))
    }
    results[[name]] <<- result
  }

  # --- From trials to cells -------------------------------------------------------------------------------------------

  # What is done about rates of 0 and 1, whose z is infinite.
  corrected_rate <- function(k, n, correction) {
    if (correction == "loglinear") return((k + 0.5) / (n + 1))
    if (correction == "half") return(ifelse(k == 0, 0.5 / n, ifelse(k == n, 1 - 0.5 / n, k / n)))
    k / n
  }
  # Rates above 1/2 go by their complement: no digit is lost.
  z_of <- function(k, n, correction)
    ifelse(2 * k > n, -qnorm(corrected_rate(n - k, n, correction)), qnorm(corrected_rate(k, n, correction)))
  z_variance <- function(k, n, correction)
    corrected_rate(k, n, correction) * corrected_rate(n - k, n, correction) / (n * dnorm(z_of(k, n, correction))^2)

  # Practice never counts; neither do trials that a registered rule leaves out.
  counted <- function(trials) trials[trials$practice == "0" & trials$excluded == "0", ]
  cell_name <- function(table) paste(table$participant, table$condition, table$series, sep = "\r")
  person_name <- function(table) paste(table$participant, table$condition, sep = "\r")

  # What the devices delivered in each interval of each trial: the mean over its devices; NA where nothing was fitted.
  delivered_stiffness <- function(trials, intervals) {
    got <- matrix(NA_real_, nrow(trials), 2)
    column <- begins(intervals, "stiffness_")
    if (is.na(column)) return(got)
    stiffness <- number(intervals[[column]])
    fitted <- !is.na(stiffness)
    place <- paste(intervals$session, intervals$seq, intervals$interval, sep = "\r")[fitted]
    means <- tapply(stiffness[fitted], place, mean)
    for (i in 1:2) got[, i] <- means[paste(trials$session, trials$seq, i, sep = "\r")]
    got
  }

  # A row for each row of cells.csv. From those it takes which cells are planned, and which correction and differences
  # (as asked, or as delivered) were registered.
  cells_of <- function(trials, intervals, said) {
    main <- trials[trials$practice == "0", ]
    used <- counted(trials)
    stimuli <- names(trials)[startsWith(names(trials), "stimulus_")]
    asked <- sapply(stimuli, function(column) number(main[[column]]))
    low <- tapply(pmin(asked[, 1], asked[, 2]), main$series, min)
    high <- tapply(pmax(asked[, 1], asked[, 2]), main$series, max)
    got <- delivered_stiffness(used, intervals)
    name <- cell_name(used)
    of_cell <- split(seq_len(nrow(used)), name)
    all_trials <- table(cell_name(main))
    asked <- cbind(number(used[[stimuli[1]]]), number(used[[stimuli[2]]]))
    # Answered "different": a pair of equals by mistake, any other pair rightly.
    different <- (used$same == "1") != (used$correct == "1")
    cells <- data.frame(row.names = seq_len(nrow(said)))
    for (i in seq_len(nrow(said))) {
      rows <- of_cell[[cell_name(said[i, ])]]
      pair <- c(low[said$series[i]], high[said$series[i]])
      unequal <- rows[used$same[rows] == "0"]
      equal <- rows[used$same[rows] == "1"]
      between <- abs(got[unequal, 2] - got[unequal, 1])
      stiffer <- asked[rows, , drop = FALSE] > mean(pair)
      k <- got[rows, , drop = FALSE]
      hits <- sum(different[unequal])
      false_alarms <- sum(different[equal])
      n_diff <- length(unequal)
      n_same <- length(equal)
      values <- list(pair[2] - pair[1], mean(between[!is.na(between)]), sum(!is.na(between)), sum(is.na(between)),
                     mean(k[!stiffer & !is.na(k)]), sum(!stiffer & !is.na(k)),
                     mean(k[stiffer & !is.na(k)]), sum(stiffer & !is.na(k)))
      names(values) <- c(begins(said, "difference_"), begins(said, "delivered_difference_"), "n_delivered",
                         "n_without_fit", begins(said, "delivered_softer_"), "n_softer",
                         begins(said, "delivered_stiffer_"), "n_stiffer")
      total <- all_trials[cell_name(said[i, ])]
      values <- c(values, list(n_diff = n_diff, hits = hits, n_same = n_same, false_alarms = false_alarms,
                               excluded = (if (is.na(total)) 0 else total[[1]]) - length(rows)),
                  rates(n_diff, hits, n_same, false_alarms, said$correction[i]))
      values$x <- if (said$difference_source[i] == "delivered") values[[2]] else values[[1]]
      for (column in names(values)) cells[i, column] <- values[[column]]
    }
    cbind(said[c("participant", "condition", "series")], cells)
  }

  # The yes-no model: d' = z(H) - z(F), with its standard error (Gourevitch and Galanter 1967).
  rates <- function(n_diff, hits, n_same, false_alarms, correction) {
    missing <- n_diff == 0 || n_same == 0
    of <- function(value) if (missing) NA_real_ else value
    z_hit <- of(z_of(hits, n_diff, correction))
    z_false <- of(z_of(false_alarms, n_same, correction))
    dprime <- z_hit - z_false
    se <- of(sqrt(z_variance(hits, n_diff, correction) + z_variance(false_alarms, n_same, correction)))
    one_answer <- (hits + false_alarms) %in% c(0, n_diff + n_same)
    list(raw_hit_rate = of(hits / n_diff), raw_false_alarm_rate = of(false_alarms / n_same),
         hit_rate = of(corrected_rate(hits, n_diff, correction)),
         false_alarm_rate = of(corrected_rate(false_alarms, n_same, correction)),
         z_hit = z_hit, z_false_alarm = z_false, dprime = dprime, dprime_se = se,
         dprime_ci95_low = dprime - qnorm(0.975) * se, dprime_ci95_high = dprime + qnorm(0.975) * se,
         criterion = -(z_hit + z_false) / 2,
         status = if (missing) "missing" else if (one_answer) "no_information" else "ok")
  }

  # --- From cells to thresholds ---------------------------------------------------------------------------------------

  # d' of the independent-observation model from that of the yes-no model (Macmillan and Creelman 2005, chapter 9).
  unit_slope <- function(dprime) {
    value <- sign(dprime) * 2 * qnorm((1 + sqrt(2 * pnorm(abs(dprime) / 2) - 1)) / 2)
    ifelse(is.finite(dprime), value, dprime)
  }

  # The slope of d' on the difference x, through the origin; NA without information, NULL where it is refused.
  slope_of <- function(cells, method, model, correction) {
    if (!any(cells$status == "ok")) return(NA_real_)
    x <- cells$x
    d <- if (model == "independent-observation") unit_slope(cells$dprime) else cells$dprime
    if (method == "inverse_mean_slope") return(mean(d / x))
    if (method == "mean_of_ratios") {
      if (anyNA(d)) return(NA_real_)
      if (any(d / x <= least_slope)) return(NULL)
      return(1 / mean(x / d))
    }
    weight <- 1
    if (method == "weighted")
      weight <- 1 / (z_variance(cells$hits, cells$n_diff, "loglinear") +
                       z_variance(cells$false_alarms, cells$n_same, "loglinear"))
    sum(weight * x * d) / sum(weight * x^2)
  }

  cautions <- function(cells, missing, status, jnd) {
    names <- c(extrapolated = status == "ok" && !(min(cells$x) <= jnd && jnd <= max(cells$x)),
               floor = status == "ok" && all(cells$hits == cells$n_diff & cells$false_alarms == 0),
               few_trials = any(pmin(cells$n_diff, cells$n_same) < 10), series_missing = missing)
    paste(names(names)[names], collapse = " ")
  }

  # A row for each row of thresholds.csv.
  thresholds_of <- function(cells, trials, said) {
    used_trials <- counted(trials)
    times <- split(used_trials, person_name(used_trials))
    of_person <- split(cells, person_name(cells))
    thresholds <- said[c("participant", "condition")]
    for (i in seq_len(nrow(said))) {
      own <- of_person[[person_name(said[i, ])]]
      used <- own[own$status != "missing", ]
      slope <- slope_of(used, said$method[i], said$model[i], said$correction[i])
      status <- if (is.null(slope)) "no_sensitivity" else if (is.na(slope)) "no_information" else
        if (slope == Inf) "ceiling" else if (slope <= least_slope) "no_sensitivity" else "ok"
      jnd <- if (status == "ok") 1 / slope else if (status == "ceiling") 0 else NA_real_
      time <- times[[person_name(said[i, ])]]
      typed <- number(time$response_time_s[time$entered_by == "participant"])
      thresholds$series_used[i] <- nrow(used)
      thresholds[i, begins(said, "slope_per_")] <- if (is.null(slope)) NA_real_ else slope
      thresholds[i, jnd_column(said)] <- jnd
      thresholds$weber[i] <- jnd / number(said[i, begins(said, "reference_")])
      thresholds$status[i] <- status
      thresholds$cautions[i] <- cautions(used, nrow(used) < nrow(own), status, jnd)
      thresholds$median_response_time_s[i] <- if (length(typed)) median(typed) else NA_real_
      thresholds$mean_trial_s[i] <- mean(number(time$duration_s))
    }
    thresholds
  }
  jnd_column <- function(table) {
    names <- names(table)[startsWith(names(table), "jnd_")]
    names[!grepl("ci95", names)][1]
  }
  # Where the method is none of those above, the rows of thresholds.csv themselves.
  thresholds_as_said <- function(said) {
    for (column in c(begins(said, "slope_per_"), jnd_column(said), "weber", "mean_trial_s"))
      said[[column]] <- number(said[[column]])
    said
  }

  # --- From participants to the group ---------------------------------------------------------------------------------

  # n, mean, standard deviation and Student's 95 % interval.
  mean_with_interval <- function(values) {
    n <- length(values)
    if (n < 2) return(list(n = n, mean = if (n) values else NA_real_, sd = NA_real_, low = NA_real_, high = NA_real_))
    half <- qt(0.975, n - 1) * sd(values) / sqrt(n)
    list(n = n, mean = mean(values), sd = sd(values), low = mean(values) - half, high = mean(values) + half)
  }
  mean_columns <- function(name, unit, values) {
    columns <- mean_with_interval(values)
    names(columns) <- c(paste0("n_", name), paste0(name, c("_mean", "_sd", "_ci95_low", "_ci95_high"), unit))
    columns
  }
  middle <- function(values) if (length(values)) median(values) else NA_real_

  # No sensitivity counts as an infinite JND, the ceiling as none at all.
  median_of_jnds <- function(status, jnd) {
    values <- sort(ifelse(status == "ok", jnd, ifelse(status == "ceiling", 0, Inf))[status != "no_information"])
    n <- length(values)
    if (n == 0) return(list(n = 0, median = NA_real_, status = "no_information"))
    if (values[n %/% 2 + 1] == Inf) return(list(n = n, median = Inf, status = "no_sensitivity"))
    if (values[(n - 1) %/% 2 + 1] == 0) return(list(n = n, median = NA_real_, status = "ceiling"))
    list(n = n, median = median(values), status = "ok")
  }

  check_jnd_group <- function(thresholds, source) {
    said <- check("group.csv", source, read("group.csv"), c("condition", "kind"), convention)
    slope <- begins(thresholds, "slope_per_")
    unit <- sub("slope_per", "", slope)
    jnd <- paste0("jnd", unit)
    for (i in seq_len(nrow(said))) {
      rows <- thresholds[thresholds$condition == said$condition[i], ]
      ok <- rows[rows$status == "ok", ]
      slopes <- rows[[slope]][is.finite(rows[[slope]]) & rows$status != "no_information"]
      half <- median_of_jnds(rows$status, rows[[jnd]])
      values <- c(list(participants = nrow(rows), n_median = half$n, jnd_median_status = half$status,
                       n_slope = length(slopes), n_used = nrow(ok)),
                  mean_columns("jnd", unit, ok[[jnd]]), mean_columns("log_jnd", "", log(ok[[jnd]])),
                  mean_columns("weber", "", ok$weber))
      values[[paste0("jnd_median", unit)]] <- half$median
      values[[paste0("inverse_mean_slope", unit)]] <-
        if (length(slopes) && mean(slopes) > least_slope) 1 / mean(slopes) else NA_real_
      for (status in c("no_sensitivity", "ceiling", "no_information"))
        values[[paste0("n_", status)]] <- sum(rows$status == status)
      compare("group.csv", said, i, values)
    }
  }

  # The columns of a mean of those who have a value.
  summary_of <- function(values) {
    of <- mean_with_interval(values)
    list(n_used = of$n, mean = of$mean, sd = of$sd, ci95_low = of$low, ci95_high = of$high, median = middle(values))
  }

  # Of an adaptive procedure.
  check_threshold_group <- function(tracks, source) {
    said <- check("group.csv", source, read("group.csv"), "condition")
    for (i in seq_len(nrow(said))) {
      rows <- tracks[tracks$condition == said$condition[i] & tracks$track == "", ]
      ok <- rows[rows$status == "ok", ]
      of <- mean_with_interval(number(ok$threshold))
      compare("group.csv", said, i,
              list(participants = nrow(rows), n_used = of$n, threshold_mean = of$mean, threshold_sd = of$sd,
                   false_alarm_rate = mean(number(ok$false_alarms) / number(ok$catch_trials))))
    }
  }

  # Of the tasks that have estimates of their own.
  check_estimate_group <- function(estimates, source) {
    said <- read("group.csv")
    check("group.csv", source, said, c("condition", "standard", "kind", "outcome", "unit"),
          names(said)[startsWith(names(said), "standard_")])
    for (i in seq_len(nrow(said))) {
      rows <- estimates[estimates$condition == said$condition[i] & estimates$standard == said$standard[i], ]
      values <- number(rows[[said$outcome[i]]])
      values <- values[is.finite(values)]
      compare("group.csv", said, i, c(list(participants = nrow(rows)), summary_of(values)))
    }
  }

  # --- Conditions against each other ----------------------------------------------------------------------------------

  # Values of an outcome by participant (rows) and condition (columns). NaN: one is missing; NA: the participant's group
  # does not get the condition.
  outcome <- function(name, participant, condition, value) {
    value[is.na(value)] <- NaN
    table <- matrix(NA_real_, length(unique(participant)), length(unique(condition)),
                    dimnames = list(unique(participant), unique(condition)))
    table[cbind(participant, condition)] <- value
    absent <- is.na(table) & !is.nan(table)
    all_conditions <- rowSums(absent) == 0
    complete <- rowSums(is.finite(table)) == ncol(table)
    left_out <- sum(all_conditions & !complete)
    list(name = name, table = table, absent = absent, crossed = all(all_conditions), left_out = left_out,
         complete = table[complete, , drop = FALSE],
         # A mean over those who have a value would pick the good ones; slopes exist for nearly everyone.
         refused = (name != "slope" && left_out > 0) || sum(complete) < 2 || ncol(table) < 2)
  }
  outcome_of_thresholds <- function(name, rows) {
    jnd <- ifelse(rows$status == "ok", rows[[jnd_column(rows)]], NA_real_)
    value <- switch(name, slope = rows[[begins(rows, "slope_per_")]], trial_time = rows$mean_trial_s, jnd = jnd,
                    log_jnd = log(jnd))
    if (is.null(value)) NULL else outcome(name, rows$participant, rows$condition, value)
  }
  outcome_of_tracks <- function(name, tracks) {
    if (name != "threshold") return(NULL)
    rows <- tracks[tracks$track == "", ]
    outcome(name, rows$participant, rows$condition, ifelse(rows$status == "ok", number(rows$threshold), NA_real_))
  }
  # Of each participant and condition the mean over the standards, of logarithms where the name says ln_.
  outcome_of_estimates <- function(name, rows) {
    column <- if (startsWith(name, "ln_") && !(name %in% names(rows))) substring(name, 4) else name
    if (!(column %in% names(rows))) return(NULL)
    value <- number(rows[[column]])
    if (column != name) value <- ifelse(value > 0, log(abs(value)), NA_real_)
    value[!is.finite(value)] <- NA_real_
    first <- !duplicated(person_name(rows))
    means <- tapply(value, factor(person_name(rows), person_name(rows)[first]), mean)
    outcome(name, rows$participant[first], rows$condition[first], as.vector(means))
  }

  # Of the answers to a question that is asked for each condition: the mean within a session, then over sessions.
  # people: rows of whoever counts, with the conditions that they get.
  outcome_of_ratings <- function(question, answers, people) {
    rows <- answers[answers$question == question & answers$condition != "" & answers$answer != "", ]
    if (is.null(answers) || !nrow(rows)) return(NULL)
    of_sessions <- aggregate(list(value = number(rows$answer)), rows[c("participant", "condition", "session")], mean)
    means <- tapply(of_sessions$value, person_name(of_sessions), mean)
    people <- people[!duplicated(person_name(people)), ]
    outcome(question, people$participant, people$condition, as.vector(means[person_name(people)]))
  }

  paired_t <- function(differences) {
    of <- mean_with_interval(differences)
    if (of$n < 2 || of$sd <= rounding * max(abs(differences)))
      return(list(t = NA_real_, df = if (of$n > 1) of$n - 1 else NA_real_, p = NA_real_, low = NA_real_,
                  high = NA_real_, dz = NA_real_))
    t <- of$mean / (of$sd / sqrt(of$n))
    list(t = t, df = of$n - 1, p = 2 * pt(-abs(t), of$n - 1), low = of$low, high = of$high, dz = of$mean / of$sd)
  }
  # Exact below 50 pairs without ties and zeros, else by the normal distribution with a correction for continuity: what
  # wilcox.test does. Differences of decimals that are equal but for rounding are ties.
  wilcoxon <- function(differences) {
    used <- differences[differences != 0]
    if (!length(used)) return(list(v = 0, p = NA_real_))
    sizes <- signif(abs(used), 12)
    v <- sum(rank(sizes)[used > 0])
    test <- suppressWarnings(wilcox.test(sign(differences) * signif(abs(differences), 12)))
    list(v = v, p = test$p.value)
  }
  holm <- function(p) {
    p[!is.na(p)] <- p.adjust(p[!is.na(p)], "holm")
    p
  }
  # p of a contrast, before any correction; NULL: this script has no such test. (Games and Howell's and Tukey's need the
  # studentised range, of which R's ptukey gives about seven digits.)
  test_of <- function(test, x, y)
    switch(test, "holm-t" = paired_t(x - y)$p, wilcoxon = wilcoxon(x - y)$p)

  # Values of those who get both conditions.
  of_both <- function(outcome, ab) outcome$table[rowSums(outcome$absent[, ab, drop = FALSE]) == 0, ab, drop = FALSE]
  finite_rows <- function(pairs) pairs[rowSums(is.finite(pairs)) == 2, , drop = FALSE]

  # The p of each contrast, corrected as registered; NULL where this script does not have the test.
  p_of_contrasts <- function(outcome, contrasts, each_alone, test) {
    p <- rep(NA_real_, nrow(contrasts))
    for (i in seq_along(p)) {
      both <- of_both(outcome, contrasts[i, ])
      pairs <- if (each_alone) finite_rows(both) else outcome$complete[, contrasts[i, ], drop = FALSE]
      refused <- if (each_alone) (outcome$name != "slope" && nrow(pairs) < nrow(both)) || nrow(pairs) < 2 else
        outcome$refused
      one <- if (refused) NA_real_ else test_of(test, pairs[, 1], pairs[, 2])
      if (is.null(one)) return(NULL)
      p[i] <- one
    }
    holm(p)
  }

  check_contrasts <- function(outcome_named, source) {
    said <- read("contrasts.csv")
    if (is.null(said)) return()
    check("contrasts.csv", source, said,
          c("condition_a", "condition_b", "kind", "outcome", "unit", "registered", "test"), convention)
    # Those of the hierarchical model have no separate values that they could be computed from.
    hierarchical <- said$outcome == "hierarchical_log_jnd"
    if (any(hierarchical)) skip("contrasts.csv", "hierarchical_log_jnd")
    computed <- which(!hierarchical)
    scale <- said$outcome[computed[1]]
    on_scale <- said$outcome == scale
    registered <- which(on_scale & said$registered == "1")
    tested <- outcome_named(scale)
    # Where somebody has no value in one condition, contrasts of the others are tested all the same.
    each_alone <- !tested$crossed || (tested$refused && tested$left_out > 0)
    contrasts <- as.matrix(said[c("condition_a", "condition_b")])
    for (i in computed) {
      of_row <- if (on_scale[i]) tested else outcome_named(said$outcome[i])
      pairs <- finite_rows(of_both(of_row, contrasts[i, ]))
      if (on_scale[i] && !each_alone && tested$name != "jnd")
        pairs <- tested$complete[, contrasts[i, ], drop = FALSE]
      of <- mean_with_interval(pairs[, 1] - pairs[, 2])
      everyone <- if (each_alone) nrow(of_both(tested, contrasts[i, ])) else nrow(tested$complete) + tested$left_out
      compare("contrasts.csv", said, i,
              list(participants = everyone, n_difference = of$n, difference_mean = of$mean, difference_sd = of$sd,
                   difference_ci95_low = of$low, difference_ci95_high = of$high))
    }
    if (!length(registered)) return()
    test <- max(said$test[registered])  # empty in rows without p
    if (test == "") return()
    p <- p_of_contrasts(tested, contrasts[registered, , drop = FALSE], each_alone, test)
    if (!is.null(p)) compare("contrasts.csv", said, registered, list(p = p))
  }

  # Every pair of conditions.
  check_pairs <- function(outcome_named, source) {
    said <- read("pairs.csv")
    if (is.null(said)) return()
    check("pairs.csv", source, said, c("outcome", "condition_a", "condition_b"))
    for (name in unique(said$outcome)) {
      of <- outcome_named(name)
      if (is.null(of)) {
        skip("pairs.csv", name)
        next
      }
      rows <- which(said$outcome == name)
      x <- of$complete[, said$condition_a[rows], drop = FALSE]
      y <- of$complete[, said$condition_b[rows], drop = FALSE]
      t <- lapply(seq_along(rows), function(i) paired_t(x[, i] - y[, i]))
      ranks <- lapply(seq_along(rows), function(i) wilcoxon(x[, i] - y[, i]))
      part <- function(list, name) vapply(list, function(one) one[[name]], 0)
      compare("pairs.csv", said, rows,
              list(n_used = rep(nrow(x), length(rows)), mean_difference = unname(colMeans(x - y)),
                   ci95_low = part(t, "low"), ci95_high = part(t, "high"), t = part(t, "t"), t_df = part(t, "df"),
                   t_p = part(t, "p"),
                   t_p_holm = holm(part(t, "p")), dz = part(t, "dz"), wilcoxon_v = part(ranks, "v"),
                   wilcoxon_p = part(ranks, "p"), wilcoxon_p_holm = holm(part(ranks, "p"))))
    }
  }

  # Of one factor within participants; table: a row a participant, a column a condition.
  analysis_of_variance <- function(table) {
    n <- nrow(table)
    k <- ncol(table)
    between <- n * sum((colMeans(table) - mean(table))^2)
    people <- k * sum((rowMeans(table) - mean(table))^2)
    error <- sum((table - outer(rowMeans(table), colMeans(table), "+") + mean(table))^2)
    if (error <= rounding^2 * sum(table^2)) return(list())  # nothing but rounding is left, and there is no test
    df1 <- k - 1
    df2 <- (n - 1) * (k - 1)
    f <- between / df1 / (error / df2)
    # Greenhouse and Geisser's epsilon, from the double-centred covariances of the conditions.
    covariance <- cov(table)
    centred <- covariance - outer(rowMeans(covariance), colMeans(covariance), "+") + mean(covariance)
    epsilon <- sum(diag(centred))^2 / (df1 * sum(centred^2))
    rest <- df1 * (n - 1 - df1 * epsilon)
    huynh_feldt <- if (k == 2) 1 else if (n <= 2) NA_real_ else if (rest > 0) (n * df1 * epsilon - 2) / rest else Inf
    capped <- min(1, huynh_feldt)
    p <- function(epsilon) pf(f, epsilon * df1, epsilon * df2, lower.tail = FALSE)
    list(f = f, df1 = df1, df2 = df2, p = p(1), epsilon_gg = epsilon, p_gg = p(epsilon), epsilon_hf = huynh_feldt,
         p_hf = p(capped), eta2_partial = between / (between + error),
         eta2_generalised = between / (between + error + people))
  }
  check_tests <- function(outcome_named, source) {
    said <- read("tests.csv")
    if (is.null(said)) return()
    check("tests.csv", source, said, c("outcome", "unit", "registered"))
    for (i in seq_len(nrow(said))) {
      of <- outcome_named(said$outcome[i])
      if (is.null(of)) {
        skip("tests.csv", said$outcome[i])
        next
      }
      table <- of$complete
      ranks <- friedman.test(signif(table, 12))
      chi2 <- unname(ranks$statistic)
      values <- list(n_used = nrow(table), participants = nrow(table) + of$left_out, friedman_chi2 = chi2,
                     friedman_p = unname(ranks$p.value), kendall_w = chi2 / (nrow(table) * (ncol(table) - 1)))
      compare("tests.csv", said, i, c(values, analysis_of_variance(table)))
    }
  }

  # Groups of participants: means under each condition, and of each participant's mean over all of theirs.
  check_groups <- function(outcome_named, source) {
    said <- read("groups.csv")
    if (is.null(said)) return()
    check("groups.csv", source, said, c("group", "condition", "kind", "outcome", "unit"))
    people <- read("participants.csv")
    for (i in seq_len(nrow(said))) {
      of <- outcome_named(said$outcome[i])
      own <- of$table[people$group[match(rownames(of$table), people$participant)] == said$group[i], , drop = FALSE]
      absent <- is.na(own) & !is.nan(own)
      values <- if (said$condition[i] != "") own[, said$condition[i]] else
        vapply(seq_len(nrow(own)), function(row) mean(own[row, !absent[row, ]]), 0)
      values <- unname(values[is.finite(values)])
      compare("groups.csv", said, i, c(list(participants = nrow(own)), summary_of(values)))
    }
  }

  # --- All of it ------------------------------------------------------------------------------------------------------

  # From the trials upwards. Gives the outcomes by their names, and says what they rest on.
  same_different <- function(trials, cells_said, said) {
    cells <- cells_of(trials, read("intervals.csv"), cells_said)
    check("cells.csv", "trials.csv and intervals.csv", cells_said, c("participant", "condition", "series"), convention)
    compare("cells.csv", cells_said, seq_len(nrow(cells)), as.list(cells))
    source <- "trials.csv"
    if (said$method[1] %in% c("least_squares", "weighted", "inverse_mean_slope", "mean_of_ratios")) {
      thresholds <- thresholds_of(cells, trials, said)
      check("thresholds.csv", source, said, c("participant", "condition"), c(convention, begins(said, "reference_")))
      compare("thresholds.csv", said, seq_len(nrow(said)), as.list(thresholds))
    } else {
      source <- sprintf("the participants' JNDs in thresholds.csv (method %s)", said$method[1])
      thresholds <- thresholds_as_said(said)
    }
    check_jnd_group(thresholds, source)
    list(source = source, people = said, named = function(name) outcome_of_thresholds(name, thresholds))
  }

  outcomes <- function() {
    trials <- read("trials.csv")
    thresholds <- read("thresholds.csv")
    tracks <- read("tracks.csv")
    estimates <- read("estimates.csv")
    if (!is.null(thresholds) && !is.null(trials)) return(same_different(trials, read("cells.csv"), thresholds))
    if (!is.null(thresholds)) {
      source <- "the participants' JNDs in thresholds.csv (trials.csv is not in this folder)"
      rows <- thresholds_as_said(thresholds)
      check_jnd_group(rows, source)
      return(list(source = source, people = rows, named = function(name) outcome_of_thresholds(name, rows)))
    }
    if (!is.null(tracks)) {
      source <- "the participants' thresholds in tracks.csv"
      check_threshold_group(tracks, source)
      return(list(source = source, people = tracks, named = function(name) outcome_of_tracks(name, tracks)))
    }
    if (is.null(estimates)) return(NULL)
    source <- "the participants' estimates in estimates.csv"
    check_estimate_group(estimates, source)
    list(source = source, people = estimates, named = function(name) outcome_of_estimates(name, estimates))
  }

  of <- outcomes()
  if (is.null(of))
    trouble("there is nothing to compute: this folder has no thresholds, tracks or estimates of participants")
  check_contrasts(of$named, of$source)
  answers <- read("answers.csv")
  of_any <- function(name) {
    found <- of$named(name)
    if (is.null(found)) outcome_of_ratings(name, answers, of$people) else found
  }
  with_ratings <- paste0(of$source, if (!is.null(answers)) "; ratings from answers.csv")
  check_pairs(of_any, with_ratings)
  check_tests(of_any, with_ratings)
  check_groups(of$named, of$source)
  for (name in names(results)) {
    result <- results[[name]]
    cat(sprintf("%s: from %s\n  %d values compared, largest difference %.1e\n", name, result$source, result$compared,
                result$largest))
    left <- setdiff(result$open, result$aside)
    if (length(left)) cat("  not computed: ", paste(left, collapse = ", "), "\n", sep = "")
    if (length(result$skipped)) cat("  not computed: the rows of ", paste(result$skipped, collapse = ", "), "\n", sep = "")
    for (line in head(result$wrong, 5)) cat("  DIFFERS: ", line, "\n", sep = "")
  }
  said <- rows_listed[names(rows_read)]
  cat("rows read: ", paste(sprintf("%d of %d in %s", rows_read, said, names(rows_read)), collapse = ", "), "\n", sep = "")
  changed <- names(rows_read)[is.na(said) | said != rows_read]
  if (length(changed)) cat("  DIFFERS: the number of rows in ", paste(changed, collapse = ", "), "\n", sep = "")
  cat("not computed here: intervals of single estimates (bootstrap or profile likelihood; methods.md says which)\n")
  wrong <- sum(sapply(results, function(result) length(result$wrong)))
  compared <- sum(sapply(results, function(result) result$compared))
  cat(sprintf("%d values compared, %d differ by more than %s\n", compared, wrong, format(tolerance)))
  wrong == 0 && compared > 0 && !length(changed)
}

# The folder: named behind the script, that of the script, or the one that R works in.
local({
  script <- sub("^--file=", "", grep("^--file=", commandArgs(FALSE), value = TRUE))
  script <- gsub("~+~", " ", script, fixed = TRUE)  # so R writes a blank there
  named <- commandArgs(TRUE)
  sourced <- Filter(Negate(is.null), lapply(sys.frames(), function(frame) frame$ofile))
  of_script <- if (length(sourced)) sourced[[length(sourced)]] else script
  folder <- if (length(named) && !length(sourced)) named[1] else if (length(of_script)) dirname(of_script) else "."
  agrees <- recompute(folder)
  if (agrees) return(invisible())
  # Of R that runs this script alone; else whoever sourced it goes on or not.
  if (length(script) && !length(sourced)) quit(status = 1)
  if (!interactive()) stop("the files differ from what was computed", call. = FALSE)
})
