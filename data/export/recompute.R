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
#     cells, trials             -> estimates.csv   slope of d' on the difference, JND = 1 / slope; times of every task
#     levels of reversals       -> tracks.csv      thresholds of staircases; all tracks of a condition together
#     estimates                 -> group.csv       means, intervals, medians over participants
#                                  values.csv      what is compared (ratings: from answers.csv), and from it
#                                  contrasts.csv, conditions.csv, tests.csv, groups.csv, pairs.csv
#
# Each step works on what the step before it computed, not on the file. Estimates of the tasks other than same-different
# with given levels, and those of maximum likelihood, are taken from estimates.csv as they are, and everything from
# there on is computed again.
#
# What it prints: for each file how many numbers and words were compared and the largest relative difference; which
# numbers it does not compute (x_*: all whose names begin so); how many rows it read of how many that were written; the
# files that it does not compute. Rscript ends with status 1 where a row is missing, or a number differs by more than
# 1e-9 of itself; a number next to zero, such as a difference of equal means, may differ by 1e-14 of the largest number
# of its column, and a mean by 1e-14 of its spread.
#
# Of the hierarchical model it computes nothing but ratios of its JNDs; recompute.py computes its likelihood.

recompute <- function(folder) {
  tolerance <- 1e-9
  near_zero <- 1e-5    # a number next to zero may differ by tolerance of this share of what it comes from
  least_slope <- 1e-9  # at or below it no difference is noticeable
  rounding <- 1e-13    # a spread of less than this share of the values is none
  # Columns that are no results: of the design, or what others published.
  given <- c("standard_value", "reference", "published", "published_half_width", "track")
  # Files that are no results.
  records <- c("participants.csv", "sessions.csv", "trials.csv", "intervals.csv", "voided.csv", "answers.csv",
               "log.csv", "dictionary.csv")
  # What is computed once: f, which is asked by texts.
  once <- function(f) {
    kept <- new.env()
    function(...) {
      key <- paste(c("of", ...), collapse = "\r")
      if (is.null(kept[[key]])) kept[[key]] <- list(f(...))
      kept[[key]][[1]]
    }
  }

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

  # All cells are read as text, so that a participant "007" or a series "T" stays what it is. NULL where the export has
  # no such file.
  read <- once(function(name) {
    if (!(name %in% listed)) return(NULL)
    path <- file.path(folder, name)
    if (!file.exists(path)) trouble("%s is missing: SHA256SUMS lists it", name)
    rows <- read.csv(path, colClasses = "character", check.names = FALSE, na.strings = character(0), encoding = "UTF-8")
    if (!nrow(rows)) trouble("%s has no rows: there is nothing in it to compare or to compute from", name)
    rows_read[name] <<- nrow(rows)
    rows
  })
  number <- function(text) suppressWarnings(as.numeric(text))  # an empty cell is a missing value
  # The columns of a file that are numbers, by the dictionary.
  numbers_in <- once(function(name) {
    dictionary <- read("dictionary.csv")
    dictionary <- dictionary[dictionary$file == name & dictionary$type %in% c("number", "integer"), ]
    setdiff(dictionary$column, given)
  })
  largest <- function(text) {
    sizes <- abs(number(text))
    max(0, sizes[is.finite(sizes)])
  }

  results <- list()
  # Compares what was computed with what BLOCK.csv says. computed(row): what the row should say, by column;
  # computed(row, outcome) if rows are about outcomes, each found by outcome_of(name, standard): NULL if this script cannot
  # compute it.
  check <- function(block, source, computed, outcome_of = NULL) {
    name <- paste0(block, ".csv")
    said <- read(name)
    if (is.null(said)) return(invisible())
    found <- lapply(seq_len(nrow(said)), function(i) {
      if (is.null(outcome_of)) return(computed(said[i, ]))
      outcome <- outcome_of(said$outcome[i], said$standard[i])
      if (!is.null(outcome)) computed(said[i, ], outcome)
    })
    numbers <- numbers_in(name)
    # Of a mean, whose rounding is that of the values that it is taken from.
    of_mean <- grep("(^|_)(mean|sd|ci)(_|$)", numbers, value = TRUE)
    result <- list(source = source, compared = 0, largest = 0, wrong = character(0), numbers = numbers,
                   skipped = if (!is.null(outcome_of)) unique(said$outcome[vapply(found, is.null, NA)]),
                   open = Filter(function(column) any(said[[column]] != ""), numbers))
    for (column in intersect(unique(unlist(lapply(found, names))), names(said))) {
      rows <- which(vapply(found, function(one) column %in% names(one), NA))
      value <- unlist(lapply(found[rows], `[[`, column), use.names = FALSE)
      text <- said[rows, column]
      if (is.character(value)) {
        difference <- ifelse(text == value, 0, Inf)
      } else {
        scale <- near_zero * largest(said[[column]])
        if (column %in% of_mean)
          scale <- pmax(scale, near_zero * apply(said[rows, of_mean, drop = FALSE], 1, largest))
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
  # The columns that are not computed; those of one beginning, none of which is, as one.
  folded <- function(result) {
    first <- sub("_.*", "", result$open)
    done <- sub("_.*", "", setdiff(grep("_", result$numbers, value = TRUE), result$open))
    unlist(lapply(unique(first), function(begin) {
      columns <- result$open[first == begin]
      if (length(columns) < 2 || begin %in% done) columns else paste0(begin, if (begin %in% columns) "*" else "_*")
    }))
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
  at_standard <- function(table) paste(table$participant, table$condition, table$standard, sep = "\r")

  # What the devices delivered in each interval of each trial: the mean over its devices; NA where nothing was fitted.
  delivered_stiffness <- function(trials, intervals) {
    got <- matrix(NA_real_, nrow(trials), 2)
    column <- grep("^stiffness_", names(intervals), value = TRUE)[1]  # with the unit in its name
    if (is.na(column)) return(got)
    stiffness <- number(intervals[[column]])
    fitted <- !is.na(stiffness)
    place <- paste(intervals$session, intervals$seq, intervals$interval, sep = "\r")[fitted]
    means <- tapply(stiffness[fitted], place, mean)
    for (i in 1:2) got[, i] <- means[paste(trials$session, trials$seq, i, sep = "\r")]
    got
  }

  # A row for each row of cells.csv. From it comes which cells are planned, and which correction and differences (as
  # asked, or as delivered) were registered. x: the difference that the slope is on.
  cells <- once(function() {
    trials <- read("trials.csv")
    said <- read("cells.csv")
    main <- trials[trials$practice == "0", ]
    used <- counted(trials)
    stimuli <- names(trials)[startsWith(names(trials), "stimulus_")]
    asked <- sapply(stimuli, function(column) number(main[[column]]))
    low <- tapply(pmin(asked[, 1], asked[, 2]), main$series, min)
    high <- tapply(pmax(asked[, 1], asked[, 2]), main$series, max)
    got <- delivered_stiffness(used, read("intervals.csv"))
    of_cell <- split(seq_len(nrow(used)), cell_name(used))
    all_trials <- table(cell_name(main))
    asked <- cbind(number(used[[stimuli[1]]]), number(used[[stimuli[2]]]))
    # Answered "different": a pair of equals by mistake, any other pair rightly.
    different <- (used$same == "1") != (used$correct == "1")
    found <- said[c("participant", "condition", "series")]
    for (i in seq_len(nrow(said))) {
      rows <- of_cell[[cell_name(said[i, ])]]
      pair <- unname(c(low[said$series[i]], high[said$series[i]]))
      unequal <- rows[used$same[rows] == "0"]
      equal <- rows[used$same[rows] == "1"]
      between <- abs(got[unequal, 2] - got[unequal, 1])
      stiffer <- asked[rows, , drop = FALSE] > mean(pair)
      k <- got[rows, , drop = FALSE]
      hits <- sum(different[unequal])
      false_alarms <- sum(different[equal])
      total <- all_trials[cell_name(said[i, ])]
      values <- c(list(difference = pair[2] - pair[1], delivered_difference = mean(between[!is.na(between)]),
                       n_delivered = sum(!is.na(between)), n_without_fit = sum(is.na(between)),
                       delivered_softer = mean(k[!stiffer & !is.na(k)]), n_softer = sum(!stiffer & !is.na(k)),
                       delivered_stiffer = mean(k[stiffer & !is.na(k)]), n_stiffer = sum(stiffer & !is.na(k)),
                       n_diff = length(unequal), hits = hits, n_same = length(equal), false_alarms = false_alarms,
                       excluded = (if (is.na(total)) 0 else total[[1]]) - length(rows)),
                  rates(length(unequal), hits, length(equal), false_alarms, said$correction[i]))
      values$x <- if (said$difference_source[i] == "delivered") values$delivered_difference else values$difference
      found[i, names(values)] <- values
    }
    found
  })

  # The yes-no model: d' = z(H) - z(F), with its standard error (Gourevitch and Galanter 1967).
  rates <- function(n_diff, hits, n_same, false_alarms, correction) {
    missing <- n_diff == 0 || n_same == 0
    of <- function(value) if (missing) NA_real_ else value
    z_hit <- of(z_of(hits, n_diff, correction))
    z_false <- of(z_of(false_alarms, n_same, correction))
    dprime <- z_hit - z_false
    criterion <- -(z_hit + z_false) / 2
    se <- of(sqrt(z_variance(hits, n_diff, correction) + z_variance(false_alarms, n_same, correction)))
    one_answer <- (hits + false_alarms) %in% c(0, n_diff + n_same)
    list(raw_hit_rate = of(hits / n_diff), raw_false_alarm_rate = of(false_alarms / n_same),
         hit_rate = of(corrected_rate(hits, n_diff, correction)),
         false_alarm_rate = of(corrected_rate(false_alarms, n_same, correction)),
         z_hit = z_hit, z_false_alarm = z_false, dprime = dprime, se = se, ci_low = dprime - qnorm(0.975) * se,
         ci_high = dprime + qnorm(0.975) * se, criterion = criterion, ln_beta = dprime * criterion,
         status = if (missing) "missing" else if (one_answer) "no_information" else "ok")
  }

  # --- Tracks of a procedure ------------------------------------------------------------------------------------------

  # Of a staircase the mean and standard deviation of its last reversals; of other tracks there is nothing to compute.
  of_track <- function(row) {
    if (row$track == "") return(tracks_together()[[at_standard(row)]])
    if (!("sd" %in% names(row))) return(list())
    last <- tail(number(strsplit(row$reversals, " ")[[1]]), number(row$n))
    list(threshold = mean_of(last), sd = sd(last))
  }
  # By participant, condition and standard: all of the tracks together. The threshold is the mean of theirs, of QUEST by
  # logarithms; a posterior of all answers is no mean, and not computed.
  tracks_together <- once(function() {
    rows <- read("tracks.csv")
    lapply(split(rows, at_standard(rows)), function(rows) {
      all <- rows[rows$track == "", ]
      tracks <- rows[rows$track != "", ]
      sums <- c("trials", "hits", "catch_trials", "false_alarms")
      values <- c(lapply(tracks[sums], function(text) sum(number(text))), finished = all(tracks$finished == "1"))
      behind <- number(tracks$n)
      used <- tracks$status == "ok"
      short <- used | (tracks$status == "too_few_reversals" & behind > 0)
      if (sum(behind[short]) == number(all$n)) used <- short  # the protocol lets them count
      n <- behind[used]
      if ("sd" %in% names(rows)) {
        of <- lapply(which(used), function(i) of_track(tracks[i, ]))
        values$threshold <- mean_of(vapply(of, function(one) one$threshold, 0))
        values$sd <- sqrt(sum(vapply(of, function(one) one$sd, 0)^2 * (n - 1)) / sum(n - 1))
      } else if ("sd_log10" %in% names(rows)) {
        values$threshold <- 10^mean_of(log10(number(tracks$threshold[used])))
        values$sd_log10 <- sqrt(sum(number(tracks$sd_log10[used])^2)) / sum(used)
      }
      values
    })
  })

  # --- From cells and trials to estimates -----------------------------------------------------------------------------

  # d' of the independent-observation model from that of the yes-no model (Macmillan and Creelman 2005, chapter 9).
  unit_slope <- function(dprime) {
    value <- sign(dprime) * 2 * qnorm((1 + sqrt(2 * pnorm(abs(dprime) / 2) - 1)) / 2)
    ifelse(is.finite(dprime), value, dprime)
  }

  # The slope of d' on the difference x, through the origin; NA without information, NULL where it is refused.
  slope_of <- function(cells, method, model) {
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

  # Slope and JND of a participant and condition.
  cells_of_people <- once(function() split(cells(), person_name(cells())))
  of_cells <- function(row) {
    own <- cells_of_people()[[person_name(row)]]
    used <- own[own$status != "missing", ]
    slope <- slope_of(used, row$method, row$model)
    status <- if (is.null(slope)) "no_sensitivity" else if (is.na(slope)) "no_information" else
      if (slope == Inf) "ceiling" else if (slope <= least_slope) "no_sensitivity" else "ok"
    jnd <- if (status == "ok") 1 / slope else NA_real_
    list(series_used = nrow(used), slope = if (is.null(slope)) NA_real_ else slope, jnd = jnd,
         weber = jnd / number(row$reference), status = status,
         cautions = cautions(used, nrow(used) < nrow(own), status, jnd))
  }
  # The threshold of all tracks together; of answers with a posterior of their own there is none.
  of_tracks <- function(row) {
    threshold <- if (!is.null(read("tracks.csv"))) tracks_together()[[at_standard(row)]]$threshold
    if (is.null(threshold)) return(list())
    if ("track_threshold" %in% names(row)) return(list(track_threshold = threshold))
    list(threshold = threshold, weber = threshold / number(row$standard_value))
  }
  # Trials and times of a participant and condition at a standard.
  of_trials <- function(main) {
    used <- counted(main)
    list(trials = nrow(used), excluded = nrow(main) - nrow(used),
         median_response_time_s = middle(number(used$response_time_s[used$entered_by == "participant"])),
         mean_trial_s = mean_of(number(used$duration_s)))
  }

  # Rows of estimates.csv, as computed here where they are, and what they rest on.
  estimates <- read("estimates.csv")
  if (is.null(estimates)) trouble("there is nothing to compute: this folder has no estimates of participants")
  check_estimates <- function() {
    said <- estimates
    trials <- read("trials.csv")
    pairs <- !is.null(trials) && "method" %in% names(said) &&
      said$method[1] %in% c("least_squares", "weighted", "inverse_mean_slope", "mean_of_ratios")
    main <- trials[trials$practice == "0", ]
    several <- length(unique(said$standard)) > 1  # else one stands for all series
    rows_of <- split(seq_along(main$series), paste(person_name(main), if (several) main$series, sep = "\r"))
    values <- lapply(seq_len(nrow(said)), function(i) {
      own <- rows_of[[paste(person_name(said[i, ]), if (several) said$standard[i], sep = "\r")]]
      c(if (!is.null(trials)) of_trials(main[own, ]), if (pairs) of_cells(said[i, ]) else of_tracks(said[i, ]))
    })
    for (column in numbers_in("estimates.csv")) estimates[[column]] <<- number(said[[column]])
    for (i in seq_along(values)) estimates[i, names(values[[i]])] <<- values[[i]]
    there <- Filter(function(name) !is.null(read(name)), c("trials.csv", "tracks.csv"))
    check("estimates", if (length(there)) paste(there, collapse = " and ") else "nothing that is in this folder",
          function(row) values[[as.integer(rownames(row))]])
    if (pairs) "trials.csv" else "the participants' estimates in estimates.csv"
  }

  # --- From participants to the group ---------------------------------------------------------------------------------

  mean_of <- function(values) if (length(values)) mean(values) else NA_real_
  middle <- function(values) if (length(values)) median(values) else NA_real_
  # n, mean, standard deviation and Student's 95 % interval.
  mean_columns <- function(values, mean = "mean") {
    n <- length(values)
    half <- if (n > 1) qt(0.975, n - 1) * sd(values) / sqrt(n) else NA_real_
    of <- list(n, mean_of(values), sd(values), mean_of(values) - half, mean_of(values) + half)
    setNames(of, c("n", mean, "sd", "ci_low", "ci_high"))
  }

  # Values of an outcome by participant (rows) and condition (columns). NaN: one is missing; NA: the participant's group
  # does not get the condition.
  new_outcome <- function(name, participant, condition, value) {
    value[is.na(value)] <- NaN
    conditions <- unique(read("group.csv")$condition)
    table <- matrix(NA_real_, length(unique(participant)), length(conditions),
                    dimnames = list(unique(participant), conditions))
    table[cbind(participant, condition)] <- value
    absent <- is.na(table) & !is.nan(table)
    all_conditions <- rowSums(absent) == 0
    complete <- rowSums(is.finite(table)) == ncol(table)
    left_out <- sum(all_conditions & !complete)
    too_few <- sum(complete) < 2 || ncol(table) < 2
    list(name = name, table = table, absent = absent, crossed = all(all_conditions), left_out = left_out,
         complete = table[complete, , drop = FALSE], too_few = too_few,
         # A mean over those who have a value would pick the good ones; slopes exist for nearly everyone.
         refused = (name != "slope" && left_out > 0) || too_few)
  }
  # The intervals of a share end at 0 and 1.
  within_limits <- function(outcome, found) {
    if (outcome %in% c("correct", "area", "r2"))
      for (name in intersect(c("ci_low", "ci_high", "ci_within_low", "ci_within_high"), names(found)))
        found[[name]] <- min(max(found[[name]], 0), 1)
    found
  }
  # n and the interval without differences between participants (Cousineau 2005, Morey 2008).
  within <- function(outcome, condition) {
    table <- outcome$complete
    n <- nrow(table)
    k <- ncol(table)
    if (outcome$too_few) return(list(n_within = 0, ci_within_low = NA_real_, ci_within_high = NA_real_))
    half <- qt(0.975, n - 1) * sd((table - rowMeans(table))[, condition]) * sqrt(k / (k - 1) / n)
    centre <- mean(table[, condition])
    list(n_within = n, ci_within_low = centre - half, ci_within_high = centre + half)
  }

  check_group <- function(source) {
    at <- once(function(standard, outcome) {
      rows <- estimates[estimates$standard == standard, ]
      new_outcome(outcome, rows$participant, rows$condition, rows[[outcome]])
    })
    check("group", source, function(row) {
      rows <- estimates[estimates$condition == row$condition & estimates$standard == row$standard, ]
      there <- is.finite(rows[[row$outcome]])
      values <- rows[[row$outcome]][there]
      # Why an outcome has no finite value.
      own <- rows[[paste0(row$outcome, "_status")]]
      reason <- if (is.null(own)) ifelse(is.infinite(rows[[row$outcome]]), "infinite", "undefined") else own
      without <- ifelse(rows$status == "ok", reason, rows$status)[!there]
      each <- sort(unique(without), method = "radix")
      # No sensitivity counts as an infinite JND, the ceiling as none at all. Of two in the middle that are not both
      # values the one that is none decides.
      if ("method" %in% names(rows) && row$outcome != "slope")
        limited <- sort(c(values, rep(Inf, sum(without == "no_sensitivity")), rep(-Inf, sum(without == "ceiling"))))
      else
        limited <- sort(values)
      n <- length(limited)
      half <- if (n && limited[n %/% 2 + 1] == Inf) Inf else if (n && limited[(n - 1) %/% 2 + 1] == -Inf) NA_real_ else
        middle(limited)
      found <- c(list(participants = nrow(rows), median = half, n_median = n,
                      without = paste(vapply(each, function(one) sum(without == one), 0), each, collapse = ", ")),
                 mean_columns(values), within(at(row$standard, row$outcome), row$condition))
      if (row$geometric_mean != "") {
        of_logarithms <- mean_columns(log(values))
        found$geometric_mean <- exp(of_logarithms$mean)
        found$geometric_ci_low <- exp(of_logarithms$ci_low)
        found$geometric_ci_high <- exp(of_logarithms$ci_high)
        found$geometric_sd <- exp(of_logarithms$sd)
      }
      if (row$outcome == "slope")
        found$inverse_mean <- if (length(values) && mean(values) > least_slope) 1 / mean(values) else NA_real_
      if (!is.null(read("tracks.csv"))) {
        tracks <- tracks_together()[at_standard(rows[there, ])]
        found$false_alarm_rate <- mean_of(vapply(tracks, function(one) one$false_alarms / one$catch_trials, 0))
      }
      within_limits(row$outcome, found)
    })
  }

  # --- Conditions against each other ----------------------------------------------------------------------------------

  # NULL: neither an estimate nor a question that is asked for each condition. Of estimates, that at the standard, or the
  # mean over all of them, of logarithms where the name says ln_; of ratings, the mean within a session, then over
  # sessions.
  outcome_of <- once(function(name, standard) {
    estimates <- estimates[standard == "all" | estimates$standard == standard, ]
    column <- if (startsWith(name, "ln_") && !(name %in% names(estimates))) substring(name, 4) else name
    person <- factor(person_name(estimates), unique(person_name(estimates)))
    answers <- read("answers.csv")
    if (!is.null(answers))
      answers <- answers[answers$question == name & answers$condition != "" & answers$answer != "", ]
    if (name == "trial_time") {
      timed <- ifelse(estimates$trials > 0, estimates$trials * estimates$mean_trial_s, 0)
      value <- tapply(timed, person, sum) / tapply(estimates$trials, person, sum)
    } else if (column %in% names(estimates)) {
      value <- estimates[[column]]
      if (column != name) value <- ifelse(value > 0, log(abs(value)), NA_real_)
      value[!is.finite(value)] <- NA_real_
      value <- tapply(value, person, mean)
    } else if (!is.null(answers) && nrow(answers)) {
      session <- answers[c("participant", "condition", "session")]
      of_sessions <- aggregate(list(value = number(answers$answer)), session, mean)
      value <- tapply(of_sessions$value, person_name(of_sessions), mean)[levels(person)]
    } else {
      return(NULL)
    }
    first <- !duplicated(person)
    new_outcome(name, estimates$participant[first], estimates$condition[first], as.vector(value))
  })

  paired_t <- function(differences) {
    of <- mean_columns(differences)
    if (of$n < 2 || of$sd <= rounding * max(abs(differences)))
      return(list(t_t = NA_real_, t_df = if (of$n > 1) of$n - 1 else NA_real_, t_p = NA_real_, t_ci_low = NA_real_,
                  t_ci_high = NA_real_, t_dz = NA_real_))
    t <- of$mean / (of$sd / sqrt(of$n))
    list(t_t = t, t_df = of$n - 1, t_p = 2 * pt(-abs(t), of$n - 1), t_ci_low = of$ci_low, t_ci_high = of$ci_high,
         t_dz = of$mean / of$sd)
  }
  # Twice the smaller tail of the sum of those ranks that are positive by chance, both including v; of 200 at most.
  permutation_p <- function(ranks, v) {
    if (length(ranks) > 200) return(NA_real_)
    ranks <- 2 * ranks  # midranks are halves
    ways <- c(1, rep(0, sum(ranks)))  # how many subsets of the ranks have each sum
    for (rank in ranks) ways <- ways + c(rep(0, rank), head(ways, -rank))
    min(1, 2 * sum(ways[seq_len(min(2 * v, sum(ranks) - 2 * v) + 1)]) / 2^length(ranks))
  }
  # p exact below 50 pairs without ties and zeros, else by the normal distribution with a correction for continuity:
  # what wilcox.test does. Differences of decimals that are equal but for rounding are ties.
  wilcoxon <- function(differences) {
    used <- differences[differences != 0]
    if (!length(used))
      return(list(wilcoxon_v = 0, wilcoxon_p = NA_real_, wilcoxon_p_exact_permutation = NA_real_,
                  wilcoxon_rank_biserial = NA_real_))
    ranks <- rank(signif(abs(used), 12))
    v <- sum(ranks[used > 0])
    test <- suppressWarnings(wilcox.test(sign(differences) * signif(abs(differences), 12)))
    list(wilcoxon_v = v, wilcoxon_p = test$p.value, wilcoxon_p_exact_permutation = permutation_p(ranks, v),
         wilcoxon_rank_biserial = 2 * v / sum(ranks) - 1)
  }
  adjusted <- function(p, method) {
    p[!is.na(p)] <- p.adjust(p[!is.na(p)], method)
    p
  }

  # Values of those who get both conditions.
  of_both <- function(outcome, ab) outcome$table[rowSums(outcome$absent[, ab, drop = FALSE]) == 0, ab, drop = FALSE]
  finite_rows <- function(pairs) pairs[rowSums(is.finite(pairs)) == 2, , drop = FALSE]

  # The p of each contrast, corrected as registered; NULL if this script does not have the test. (Those of Games and
  # Howell, and of Tukey, need the studentised range, of which R's ptukey gives about seven digits.)
  p_of_contrasts <- function(outcome, contrasts, each_alone, test) {
    test_of <- switch(test, "holm-t" = function(d) paired_t(d)$t_p, wilcoxon = function(d) wilcoxon(d)$wilcoxon_p)
    if (is.null(test_of)) return(NULL)
    p <- apply(contrasts, 1, function(ab) {
      both <- of_both(outcome, ab)
      pairs <- if (each_alone) finite_rows(both) else outcome$complete[, ab, drop = FALSE]
      refused <- if (each_alone) (outcome$name != "slope" && nrow(pairs) < nrow(both)) || nrow(pairs) < 2 else
        outcome$refused
      if (refused) NA_real_ else test_of(pairs[, 1] - pairs[, 2])
    })
    adjusted(p, "holm")
  }
  # JND of a / JND of b in the hierarchical model, at a standard; NA where one has none.
  model_ratio <- function(a, b, standard) {
    rows <- read("hierarchical.csv")
    rows <- rows[rows$standard == standard, ]
    jnds <- number(rows$jnd[match(c(a, b), rows$condition)])
    if (all(is.finite(jnds) & jnds > 0)) jnds[1] / jnds[2] else NA_real_
  }

  check_contrasts <- function(source) {
    said <- read("contrasts.csv")
    if (is.null(said)) return()
    of_model <- said$outcome == "hierarchical_ln_jnd"
    scale <- said$outcome[!of_model][1]
    on_scale <- said$outcome == scale
    tested <- outcome_of(scale, said$standard[!of_model][1])
    # Where somebody has no value in one condition, contrasts of the others are tested all the same.
    each_alone <- !tested$crossed || (tested$refused && tested$left_out > 0)
    contrasts <- as.matrix(said[c("a", "b")])
    p <- if (any(of_model)) adjusted(number(said$p[of_model]), "holm") else
      p_of_contrasts(tested, contrasts[on_scale, , drop = FALSE], each_alone, max(said$test[on_scale]))
    registered <- said$registered == "1"
    check("contrasts", source, function(row) {
      i <- as.integer(rownames(row))
      of_p <- if (registered[i] && !is.null(p)) list(p_registered = p[sum(registered[1:i])])
      if (of_model[i])
        return(c(mean_difference = log(model_ratio(row$a, row$b, read("hierarchical.csv")$standard[1])), of_p))
      both <- of_both(outcome_of(row$outcome, row$standard), contrasts[i, ])
      everyone <- nrow(both)
      pairs <- finite_rows(both)
      if (on_scale[i] && !each_alone) {
        everyone <- nrow(tested$complete) + tested$left_out
        pairs <- tested$complete[, contrasts[i, ], drop = FALSE]
      }
      differences <- pairs[, 1] - pairs[, 2]
      c(list(participants = everyone, p = paired_t(differences)$t_p), mean_columns(differences, "mean_difference"),
        of_p)
    })
  }

  of_condition <- function(row, outcome) {
    own <- outcome$table[!outcome$absent[, row$condition], row$condition]
    values <- own[is.finite(own)]
    within_limits(outcome$name, c(list(participants = length(own), median = middle(values)), mean_columns(values),
                                  within(outcome, row$condition)))
  }
  of_participant <- function(row, outcome) {
    own <- outcome$table[row$participant, !outcome$absent[row$participant, ]]
    list(value = outcome$table[row$participant, row$condition], tested = all(is.finite(own)))
  }
  # Of a group of participants under a condition, or of each participant's mean over all of theirs.
  of_group <- function(row, outcome) {
    members <- estimates$participant[estimates$group == row$group]
    own <- outcome$table[rownames(outcome$table) %in% members, , drop = FALSE]
    values <- if (row$condition != "") own[, row$condition] else
      apply(own, 1, function(one) mean(one[!is.na(one) | is.nan(one)]))
    values <- unname(values[is.finite(values)])
    within_limits(outcome$name, c(list(participants = nrow(own), median = middle(values)), mean_columns(values)))
  }

  # Every pair of conditions.
  pairs_of <- once(function(name) {
    said <- read("pairs.csv")
    table <- outcome_of(name, said$standard[said$outcome == name][1])$complete
    found <- lapply(which(said$outcome == name), function(i) {
      x <- table[, said$a[i]]
      y <- table[, said$b[i]]
      t <- paired_t(x - y)
      c(list(n = length(x), mean_difference = mean(x - y)), t, wilcoxon(x - y),
        list(t_d_av = if (is.na(t$t_t)) NA_real_ else mean(x - y) / sqrt((var(x) + var(y)) / 2)))
    })
    for (test in c("t_p", "wilcoxon_p"))
      for (method in c("holm", "BH", "bonferroni")) {
        p <- adjusted(vapply(found, `[[`, 0, test), method)
        for (i in seq_along(found)) found[[i]][[paste0(test, "_", tolower(method))]] <- p[i]
      }
    setNames(found, paste(said$a, said$b, sep = "\r")[said$outcome == name])
  })

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
    p <- function(epsilon) pf(f, epsilon * df1, epsilon * df2, lower.tail = FALSE)
    list(anova_f = f, anova_df1 = df1, anova_df2 = df2, anova_p = p(1), anova_p_gg = p(epsilon),
         anova_p_hf = p(min(1, huynh_feldt)), anova_p_lower_bound = p(1 / df1), anova_ss = between,
         anova_ss_error = error, anova_ss_subjects = people, epsilons_gg = epsilon, epsilons_hf = huynh_feldt,
         effect_eta2_generalised = between / (between + error + people),
         effect_eta2_partial = between / (between + error),
         effect_omega2_partial = df1 * (f - 1) / (df1 * (f - 1) + n * k), effect_cohen_f = sqrt(between / error))
  }
  friedman <- function(table) {
    n <- nrow(table)
    k <- ncol(table)
    ranks <- friedman.test(signif(table, 12))
    chi2 <- unname(ranks$statistic)
    rest <- n * (k - 1) - chi2
    f <- if (is.na(chi2)) NA_real_ else if (rest > 1e-12 * n * k) (n - 1) * chi2 / rest else Inf
    list(friedman_chi2 = chi2, friedman_df = k - 1, friedman_p = unname(ranks$p.value),
         friedman_kendall_w = chi2 / (n * (k - 1)), friedman_f_iman_davenport = f,
         friedman_p_iman_davenport = pf(f, k - 1, (k - 1) * (n - 1), lower.tail = FALSE))
  }
  of_tests <- function(row, outcome) {
    table <- outcome$complete
    refused <- if (row$registered == "1") outcome$refused else outcome$too_few
    c(list(n = nrow(table), participants = nrow(table) + outcome$left_out, left_out = outcome$left_out),
      if (!refused) c(analysis_of_variance(table), friedman(table)))
  }

  # --- All of it ------------------------------------------------------------------------------------------------------

  if (!is.null(read("trials.csv")) && !is.null(read("cells.csv")))
    check("cells", "trials.csv and intervals.csv",
          function(row) as.list(cells()[as.integer(rownames(row)), -(1:3)]))  # without their names
  check("tracks", "the levels of its reversals", of_track)
  source <- check_estimates()
  check_group(source)
  check_contrasts(source)
  with_ratings <- paste0(source, if (!is.null(read("answers.csv"))) "; ratings from answers.csv")
  check("values", with_ratings, of_participant, outcome_of)
  check("conditions", with_ratings, of_condition, outcome_of)
  check("tests", with_ratings, of_tests, outcome_of)
  check("groups", with_ratings, of_group, outcome_of)
  check("pairs", with_ratings, function(row, outcome) pairs_of(outcome$name)[[paste(row$a, row$b, sep = "\r")]],
        outcome_of)
  check("hierarchical_ratios", "hierarchical.csv",
        function(row) list(ratio = model_ratio(row$a, row$b, row$standard)))
  for (name in names(results)) {
    result <- results[[name]]
    cat(sprintf("%s: from %s\n  %d values compared, largest difference %.1e\n", name, result$source, result$compared,
                result$largest))
    if (length(result$open)) cat("  not computed: ", paste(folded(result), collapse = ", "), "\n", sep = "")
    if (length(result$skipped))
      cat("  not computed: the rows of ", paste(result$skipped, collapse = ", "), "\n", sep = "")
    for (line in head(result$wrong, 5)) cat("  DIFFERS: ", line, "\n", sep = "")
  }
  said <- rows_listed[names(rows_read)]
  cat("rows read: ", paste(sprintf("%d of %d in %s", rows_read, said, names(rows_read)), collapse = ", "), "\n",
      sep = "")
  changed <- names(rows_read)[is.na(said) | said != rows_read]
  if (length(changed)) cat("  DIFFERS: the number of rows in ", paste(changed, collapse = ", "), "\n", sep = "")
  left <- setdiff(grep("/", names(rows_listed), value = TRUE, invert = TRUE), c(names(rows_read), records))
  if (length(left)) cat("files not computed: ", paste(left, collapse = ", "), "\n", sep = "")
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
